use crate::cpu_reference::{
    Point, normal_and_area, numbers, place, sobol2, triangle_at, triangle_from_square,
};
use glam::{DVec3, dvec3};

const SEEDS: [u32; 2] = [0x1234_5678, 0x9abc_def0];

/// Triangles of a plane, each with its area as a share of the whole.
struct Surface {
    triangles: Vec<[DVec3; 3]>,
    table: Vec<u32>,
}

impl Surface {
    /// As the scene makes its table: running sums times 2^32, rounded, at most `u32::MAX`.
    fn new(triangles: Vec<[DVec3; 3]>) -> Surface {
        let areas: Vec<f64> = triangles.iter().map(area).collect();
        let total: f64 = areas.iter().sum();
        let mut sum = 0.0;
        let ends = areas.iter().map(|area| {
            sum += area / total;
            (sum * 4_294_967_296.0).round() as u32
        });
        let table = std::iter::once(0).chain(ends).collect();
        Surface { triangles, table }
    }

    fn point(&self, index: u32) -> Point {
        place(numbers(index, SEEDS), &self.table, |triangle, k| self.triangles[triangle as usize][k as usize])
    }
}

fn area([a, b, c]: &[DVec3; 3]) -> f64 {
    0.5 * (b - a).cross(c - a).length()
}

/// A rectangle in the plane z = 0 as two triangles.
fn rectangle(x: f64, y: f64, width: f64, height: f64) -> [[DVec3; 3]; 2] {
    let at = |u: f64, v: f64| dvec3(x + u * width, y + v * height, 0.0);
    [[at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0)], [at(0.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]]
}

#[test]
fn every_aligned_run_is_a_net() {
    // One point in each box of area 1/256, for all nine shapes of box, in runs anywhere in 32 bits.
    for start in [0, 256, 77 * 256, 8_388_352, 0x8000_0000, 0xffff_ff00_u32] {
        for columns in 0..=8 {
            let mut seen = [0; 256];
            for i in 0..256 {
                let [x, y] = numbers(start + i, SEEDS);
                let column = (u64::from(x) << columns >> 32) as usize;
                let row = (u64::from(y) << (8 - columns) >> 32) as usize;
                seen[(row << columns) + column] += 1;
            }
            assert!(seen.iter().all(|n| *n == 1), "from {start}, {columns} bits of columns: {seen:?}");
        }
    }
}

#[test]
fn plain_sequence_starts_as_in_the_textbook() {
    let eighths: Vec<[u32; 2]> = (0..8).map(|i| sobol2(i).map(|x| x >> 29)).collect();
    assert_eq!(eighths, [[0, 0], [4, 4], [2, 6], [6, 2], [1, 5], [5, 1], [3, 3], [7, 7]]);
}

#[test]
fn triangles_get_points_by_area_in_every_part() {
    // Triangles of very different sizes, one of them without area.
    let mut triangles = Vec::new();
    triangles.extend(rectangle(0.0, 0.0, 10.0, 10.0));
    triangles.push([1.0, 2.0, 3.0].map(|x| dvec3(x, x, 0.0)));
    triangles.extend(rectangle(10.0, 0.0, 1.0, 10.0));
    triangles.extend((0..20).flat_map(|i| rectangle(20.0, f64::from(i), 0.5, 1.0)));
    let surface = Surface::new(triangles);
    let total: f64 = surface.triangles.iter().map(area).sum();
    for (start, count) in [(0, 65_536), (65_536, 4096), (262_144 - 256, 256)] {
        let mut seen = vec![0.0; surface.triangles.len()];
        (start..start + count).for_each(|i| seen[surface.point(i).triangle as usize] += 1.0);
        for (n, triangle) in std::iter::zip(&seen, &surface.triangles) {
            // Sums of a net over an interval are off by one at each end at most.
            let expected = area(triangle) / total * f64::from(count);
            assert!(f64::abs(n - expected) <= 2.0, "{n} points of {expected}, of {count} from {start}");
        }
        assert_eq!(seen[2], 0.0, "a triangle without area has no points");
    }
}

#[test]
fn a_part_covers_a_wall_more_evenly_than_independent_points_would() {
    let surface = Surface::new(rectangle(0.0, 0.0, 1.0, 1.0).to_vec());
    for start in [0, 256, 512, 100 * 256] {
        let mut seen = [0_u32; 64];
        for i in start..start + 256 {
            let at = surface.point(i).position;
            seen[((at.y * 8.0) as usize).min(7) * 8 + ((at.x * 8.0) as usize).min(7)] += 1;
        }
        // Chi squared of 63 degrees of freedom: 63 on average for independent points.
        let statistic: f64 = seen.iter().map(|n| (f64::from(*n) - 4.0).powi(2) / 4.0).sum();
        assert!(statistic < 32.0, "from {start}: {statistic}");
    }
}

#[test]
fn the_square_is_laid_over_the_triangle_area_for_area() {
    // Barycentrics are uniform in the triangle: as many in each of four halves-of-sides triangles.
    let mut seen = [0; 4];
    for i in 0..200 {
        for j in 0..200 {
            let [b, c] = triangle_from_square([(f64::from(i) + 0.5) / 200.0, (f64::from(j) + 0.5) / 200.0]);
            assert!(b >= 0.0 && c >= 0.0 && b + c <= 1.0);
            seen[if b > 0.5 {
                0
            } else if c > 0.5 {
                1
            } else if b + c < 0.5 {
                2
            } else {
                3
            }] += 1;
        }
    }
    assert!(seen.iter().all(|n: &i32| n.abs_diff(10_000) < 200), "{seen:?}");
}

#[test]
fn points_lie_on_their_triangles() {
    let surface = Surface::new(rectangle(-3.0, 2.0, 5.0, 0.25).to_vec());
    for i in 0..1000 {
        let point = surface.point(i);
        let [b, c] = point.barycentric.map(|b| f64::from(b) / 65535.0);
        assert!(b + c <= 1.0, "{point:?}");
        let [p, q, r] = surface.triangles[point.triangle as usize];
        let at = p * (1.0 - b - c) + q * b + r * c;
        assert!(at.abs_diff_eq(point.position, 1e-12), "{point:?}");
        assert_eq!(point.normal.abs(), DVec3::Z);
    }
}

#[test]
fn tables_of_one_triangle_of_zeros_and_of_slivers() {
    assert_eq!(triangle_at(&[0, u32::MAX], 0xffff_fffe), 0);
    assert_eq!(triangle_at(&[0, 0, 0, 10, 10, u32::MAX], 0), 2);
    assert_eq!(triangle_at(&[0, 0, 0, 10, 10, u32::MAX], 9), 2);
    assert_eq!(triangle_at(&[0, 0, 0, 10, 10, u32::MAX], 10), 4);
    // Triangles without area at the end.
    assert_eq!(triangle_at(&[0, 5, u32::MAX, u32::MAX], 0xffff_fffe), 1);
}

#[test]
fn normals_and_areas_of_any_scale() {
    for scale in [1e-12, 1.0, 1e12] {
        let (normal, area) = normal_and_area(scale * DVec3::X, scale * DVec3::Y);
        assert_eq!((normal, area / scale / scale), (DVec3::Z, 0.5));
    }
    assert_eq!(normal_and_area(DVec3::ZERO, DVec3::ZERO), (DVec3::ZERO, 0.0));
    assert_eq!(normal_and_area(dvec3(1.0, 2.0, 3.0), dvec3(2.0, 4.0, 6.0)), (DVec3::ZERO, 0.0));
}
