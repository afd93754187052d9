//! ACRSM Alg. 5.2 as it is printed, in double precision.

use glam::DVec3;

/// Returns the points on a triangle with these levels of the edges opposite to its vertices and inside, by their barycentric
/// coordinates.
pub(crate) fn points([a, b, c]: [u32; 3], inside: u32) -> Vec<DVec3> {
    let step = |edge: u32| 1.0 / f64::from(edge + inside);
    let (sa, sb, sc) = (step(a), step(b), step(c));
    let mut points = Vec::new();
    for row in 0..=c + inside {
        let gamma = f64::from(row) * sc;
        let (mut alpha, mut beta) = (1.0 - gamma, 0.0);
        // In place of 0: what rounding leaves.
        while alpha > 1e-6 {
            points.push(DVec3::new(alpha, beta, gamma));
            alpha -= (1.0 - alpha) * sa + (1.0 - beta) * sb + (1.0 - gamma) * sc;
            beta = 1.0 - alpha - gamma;
        }
    }
    points
}

/// Returns the level of an area \[m²\] or edge \[m\] between the least and the greatest of the scene (Eq. 5.3-5.4).
pub(crate) fn level([least, greatest]: [f64; 2], value: f64, [low, high]: [u32; 2]) -> u32 {
    let x = if greatest > least { (value - least) / (greatest - least) } else { 1.0 };
    ((x * x * (3.0 - 2.0 * x) * f64::from(high)).ceil() as u32).max(low)
}

#[test]
fn a_row_is_as_long_as_the_triangle_is_wide() {
    // Steps of 1/10 along all edges move 2/10 along a row: 5, 5, 4, 4, 3, 3, 2, 2, 1, 1 points.
    assert_eq!(points([5; 3], 5).len(), 30);
    let rows: Vec<usize> = (0..10)
        .map(|row| points([5; 3], 5).iter().filter(|p| (p.z * 10.0).round() as i32 == row).count())
        .collect();
    assert_eq!(rows, [5, 5, 4, 4, 3, 3, 2, 2, 1, 1]);
    // f[5,64], greatest levels: 128 rows, of 64, 64, 63, 63, … points.
    assert_eq!(points([64; 3], 64).len(), 64 * 65);
}
