//! The number of points of a triangle.

use crate::cpu_reference::{
    ANY_NUMBER, WHOLE, Wanted, level, place, starts, tessellated_points, triangle_at, weights,
};
use glam::DVec3;

#[test]
fn points_of_a_tessellator_are_those_of_opengl() {
    // OpenGL 4.6 §11.2.2.2: the triangle itself; with a point in its middle; with one triangle inside.
    assert_eq!(tessellated_points([1, 1, 1], 1), 3);
    assert_eq!(tessellated_points([1, 1, 1], 2), 4);
    assert_eq!(tessellated_points([2, 1, 1], 1), 5, "inside 1 counts as 2 where an edge is divided");
    assert_eq!(tessellated_points([3, 3, 3], 3), 12);
    // Of one level throughout: 3 ((n+1)/2)² where it is odd, 3 n/2 (n/2 + 1) + 1 where it is even.
    for n in 1..=64_u32 {
        let uniform = if n % 2 == 1 { 3 * n.div_ceil(2).pow(2) } else { 3 * (n / 2) * (n / 2 + 1) + 1 };
        assert_eq!(tessellated_points([n; 3], n), uniform, "level {n}");
    }
}

#[test]
fn levels_follow_acrsm() {
    let at = |x| level([2.0, 4.0], x, [5, 64]);
    // ceil(64 · (3x² − 2x³)): x = ¼ gives 0.15625 · 64 = 10 exactly, x = ½ gives 32.
    assert_eq!([at(2.0), at(2.5), at(3.0), at(4.0)], [5, 10, 32, 64]);
    assert_eq!(level([3.0, 3.0], 3.0, [5, 64]), 64, "what is as large as the largest is large");
}

#[test]
fn small_triangles_have_more_than_their_share_by_tessellation() {
    // Edges 1, 1, √2 and 10, 10, 10√2: the least area and all levels at 5 but the long edge's; the greatest at 64.
    let right = |side: f64| [DVec3::ZERO, side * DVec3::X, side * DVec3::Y];
    let pair = [right(1.0), right(10.0)];
    assert_eq!(weights(&pair, None), [0.5, 50.0]);
    // x = 0.4142 / 13.142 for the small one's long edge: ceil(0.19) = 1, and so 5. 15 + 3 · (3 + 1).
    let edge = level([1.0, 200f64.sqrt()], 10.0, [5, 64]);
    let large = f64::from(2 * edge + 64 + 1 + 3 * 32 * 31);
    assert_eq!(weights(&pair, Some([5, 64])), [27.0, large]);
    // Alone it has the greatest area, and the greatest and twice the least edge: 64 + 5 + 5 + 2977.
    assert_eq!(weights(&[right(1.0), right(0.0)], Some([5, 64])), [3051.0, 0.0], "no area, no points");
}

#[test]
fn a_triangle_has_its_share_of_the_points() {
    let weights = [3.0, 0.0, 1.0, 4.0, 1e-12, 8.0];
    let starts = starts(&weights, |_| 0.5);
    assert_eq!((starts[0], starts[6]), (0, WHOLE));
    for all in [16_u32, 160, 1600, 1 << 24] {
        let wanted = Wanted::new(1, all, ANY_NUMBER);
        let mut counts = [0; 6];
        for index in 0..all {
            counts[triangle_at(&starts, place(index, &wanted).unwrap().number) as usize] += 1;
        }
        for (count, weight) in counts.into_iter().zip(weights) {
            let share = weight / 16.0 * f64::from(all);
            assert!((f64::from(count) - share).abs() <= 1.0, "{counts:?} of {all}");
        }
    }
}

#[test]
fn roundings_do_not_add_up() {
    // A million triangles, each of which would lose almost a unit by rounding down.
    let weights = vec![1.0; 1 << 20];
    let dither = |i: u32| f64::from(pass_test::random::hash2(7, i)) / 4_294_967_296.0;
    let starts = starts(&weights[..1_048_575], dither);
    let last = WHOLE - starts[1_048_574];
    assert!(last.abs_diff(2048) < 2048, "the last triangle has {last} of 2048");
}
