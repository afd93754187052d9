//! `scene-points.wgsl` with the same integers, and double precision after them.

use glam::DVec3;
use gpu_algorithms::reference::triangle_samples::edges;
pub(crate) use gpu_algorithms::reference::triangle_samples::{
    normal_and_area, scramble, sobol2, triangle_at, triangle_from_square,
};

/// A sample of a surface: struct Point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point {
    /// World space \[m\].
    pub(crate) position: DVec3,
    /// Index of the triangle.
    pub(crate) triangle: u32,
    /// Unit; zero where the triangle has no area.
    pub(crate) normal: DVec3,
    /// Weights of the second and third vertex, times 65535.
    pub(crate) barycentric: [u32; 2],
}

/// Returns the scrambled pair of numbers of point `index`; `seeds` are those of the two dimensions.
pub(crate) fn numbers(index: u32, seeds: [u32; 2]) -> [u32; 2] {
    let sobol = sobol2(index);
    [scramble(sobol[0], seeds[0]).min(0xffff_fffe), scramble(sobol[1], seeds[1])]
}

/// Returns the point that a pair of numbers selects: `corner` gives vertex 0, 1 or 2 of a triangle, of which
/// there is at least one.
pub(crate) fn place(numbers: [u32; 2], table: &[u32], corner: impl Fn(u32, u32) -> DVec3) -> Point {
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
    let (origin, a, b) = edges(triangle, corner);
    let position = origin + at[0] * a + at[1] * b;
    Point { position, triangle, normal: normal_and_area(a, b).0, barycentric }
}
