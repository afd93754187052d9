//! The f64 CPU reference of `shaders/triangle-samples.wgsl`, `shaders/triangle.wgsl` and `shaders/sobol.wgsl`, for
//! those of the passes that share them: the same functions, by the same names. See there for what they mean.

/// A position or direction.
pub type Vec3 = [f64; 3];

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
pub fn normal_and_area(a: Vec3, b: Vec3) -> (Vec3, f64) {
    let scale = a.iter().chain(&b).fold(0.0, |m: f64, x| m.max(x.abs()));
    if scale == 0.0 {
        return ([0.0; 3], 0.0);
    }
    let (a, b) = (a.map(|x| x / scale), b.map(|x| x / scale));
    let across = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let length = across.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 { (across.map(|x| x / length), 0.5 * length * scale * scale) } else { ([0.0; 3], 0.0) }
}

/// Returns the corner and edges of a triangle, of which `corner` gives vertex 0, 1 or 2.
pub fn edges(triangle: u32, corner: impl Fn(u32, u32) -> Vec3) -> (Vec3, Vec3, Vec3) {
    let origin = corner(triangle, 0);
    let [a, b] = [1, 2].map(|k| {
        let vertex = corner(triangle, k);
        [0, 1, 2].map(|c| vertex[c] - origin[c])
    });
    (origin, a, b)
}
