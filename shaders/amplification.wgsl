// The number of points that each triangle is amplified into (TCAS §5.2).

struct Amplification {
    /// Points that the rule asks for; ANY_NUMBER where it is content with all that are wanted.
    requested: u32,
    /// Binary logarithm of the number of entries of the guide table.
    guide_bits: u32,
    /// 2³¹ over `requested`: whole part, and fraction in units of 2⁻³².
    step: vec2<u32>,
    /// [triangles + 1] Where in 0..2³¹ the interval of a triangle begins; its width is its share of the points. Then
    /// the guide table (Chen & Asau 1974), [2^guide_bits + 1]: the triangle at each of that many steps of equal width,
    /// and the last.
    starts: array<u32>,
}
