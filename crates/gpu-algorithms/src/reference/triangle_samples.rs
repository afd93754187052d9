//! The f64 CPU reference of `shaders/triangle-samples.wgsl`, `shaders/triangle.wgsl` and `shaders/sobol.wgsl`, for
//! those of the passes that share them: the same functions, by the same names. See there for what they mean.

use glam::DVec3;

/// Returns element `index` of Sobol's sequence in two dimensions, in units of 2^-32.
pub fn sobol2(index: u32) -> [u32; 2] {
    let mut second = 0;
    let mut direction = 0x8000_0000_u32;
    let mut rest = index;
    while rest > 0 {
        if rest & 1 != 0 {
            second ^= direction;
        }
        direction ^= direction >> 1;
        rest >>= 1;
    }
    [index.reverse_bits(), second]
}

/// Applies Owen's nested scrambling (Laine & Karras 2011, constants of Burley 2020).
pub fn scramble(value: u32, seed: u32) -> u32 {
    let mut bits = value.reverse_bits().wrapping_add(seed);
    for factor in [0x6c50_b47c, 0xb82f_1e52, 0xc7af_e638, 0x8d22_f6e6_u32] {
        bits ^= bits.wrapping_mul(factor);
    }
    bits.reverse_bits()
}

/// Returns the triangle whose interval of the table (one entry more than triangles) holds the number.
pub fn triangle_at(table: &[u32], number: u32) -> u32 {
    table[1..table.len() - 1].partition_point(|start| *start <= number) as u32
}

/// Returns the barycentric coordinates of the second and third vertex from the unit square (Heitz 2019).
pub fn triangle_from_square(square: [f64; 2]) -> [f64; 2] {
    let [x, y] = square;
    if y > x { [0.5 * x, y - 0.5 * x] } else { [x - 0.5 * y, 0.5 * y] }
}

/// Returns the geometric normal, unit, and area of the triangle with these edges; zeros where it has no area.
pub fn normal_and_area(a: DVec3, b: DVec3) -> (DVec3, f64) {
    let scale = a.abs().max(b.abs()).max_element();
    if scale == 0.0 {
        return (DVec3::ZERO, 0.0);
    }
    let across = (a / scale).cross(b / scale);
    let length = across.length();
    if length > 0.0 { (across / length, 0.5 * length * scale * scale) } else { (DVec3::ZERO, 0.0) }
}

/// Returns the corner and edges of a triangle, of which `corner` gives vertex 0, 1 or 2.
pub fn edges(triangle: u32, corner: impl Fn(u32, u32) -> DVec3) -> (DVec3, DVec3, DVec3) {
    let origin = corner(triangle, 0);
    (origin, corner(triangle, 1) - origin, corner(triangle, 2) - origin)
}
