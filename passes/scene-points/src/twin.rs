//! `scene-points.wgsl` with the same integers, and double precision after them.

/// A position or direction.
pub type Vec3 = [f64; 3];

/// A sample of a surface: struct Point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// World space \[m\].
    pub position: Vec3,
    /// Index of the triangle.
    pub triangle: u32,
    /// Unit; zero where the triangle has no area.
    pub normal: Vec3,
    /// Of the second and third vertex, times 65535.
    pub barycentric: [u32; 2],
}

/// Element `index` of Sobol's sequence in two dimensions, in units of 2^-32.
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

/// Owen's nested scrambling (Laine & Karras 2011, constants of Burley 2020).
pub fn scramble(value: u32, seed: u32) -> u32 {
    let mut bits = value.reverse_bits().wrapping_add(seed);
    for factor in [0x6c50_b47c, 0xb82f_1e52, 0xc7af_e638, 0x8d22_f6e6_u32] {
        bits ^= bits.wrapping_mul(factor);
    }
    bits.reverse_bits()
}

/// The triangle whose interval of the table (one entry more than triangles) holds the number.
pub fn triangle_at(table: &[u32], number: u32) -> u32 {
    table[1..table.len() - 1].partition_point(|start| *start <= number) as u32
}

/// Barycentric coordinates of the second and third vertex from the unit square (Heitz 2019).
pub fn triangle_from_square(square: [f64; 2]) -> [f64; 2] {
    let [x, y] = square;
    if y > x { [0.5 * x, y - 0.5 * x] } else { [x - 0.5 * y, 0.5 * y] }
}

/// Unit normal of the triangle with these edges; zero where it has no area.
pub fn geometric_normal(a: Vec3, b: Vec3) -> Vec3 {
    let scale = a.iter().chain(&b).fold(0.0, |m: f64, x| m.max(x.abs()));
    if scale == 0.0 {
        return [0.0; 3];
    }
    let (a, b) = (a.map(|x| x / scale), b.map(|x| x / scale));
    let across = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let length = across.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 { across.map(|x| x / length) } else { [0.0; 3] }
}

/// The scrambled pair of numbers of point `index`; `seeds` are those of the two dimensions.
pub fn numbers(index: u32, seeds: [u32; 2]) -> [u32; 2] {
    let sobol = sobol2(index);
    [scramble(sobol[0], seeds[0]).min(0xffff_fffe), scramble(sobol[1], seeds[1])]
}

/// The point that a pair of numbers places: `corner` gives vertex 0, 1 or 2 of a triangle; at least one triangle.
pub fn place(numbers: [u32; 2], table: &[u32], corner: impl Fn(u32, u32) -> Vec3) -> Point {
    let [first, second] = numbers;
    let triangle = triangle_at(table, first);
    let start = table[triangle as usize];
    let width = (table[triangle as usize + 1] - start).max(1);
    let square =
        [(f64::from(first - start) / f64::from(width)).min(1.0), f64::from(second >> 8) / 16_777_216.0];
    let [x, y] = triangle_from_square(square).map(|b| (b * 65535.0 + 0.5) as u32);
    let x = x.min(65535);
    let barycentric = [x, y.min(65535 - x)];
    let at = barycentric.map(|b| f64::from(b) / 65535.0);
    let origin = corner(triangle, 0);
    let [a, b] = [1, 2].map(|k| {
        let vertex = corner(triangle, k);
        [0, 1, 2].map(|c| vertex[c] - origin[c])
    });
    let position = [0, 1, 2].map(|c| origin[c] + at[0] * a[c] + at[1] * b[c]);
    Point { position, triangle, normal: geometric_normal(a, b), barycentric }
}
