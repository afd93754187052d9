// Points that stand for parts of triangles, in the order of their triangles.

struct LatticePoint {
    /// World space [m].
    position: vec3<f32>,
    triangle: u32,
    /// Geometric normal, unit; its sign means nothing.
    normal: vec3<f32>,
    /// Area that it stands for among all points [m²]; 0 where the surface is cut out.
    area: f32,
}

struct LatticePoints {
    /// Samples of all maps together: the number of points times the splat factor.
    requested: u32,
    /// Number of points that are stored.
    stored: u32,
    /// 2³¹ over `requested`: whole part, and fraction in units of 2⁻³².
    step: vec2<u32>,
    points: array<LatticePoint>,
}
