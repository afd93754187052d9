//! The filter removes the pattern of interleaving, and keeps edges.

use pass::{Format, ResourceDesc};
use pass_test::Harness;
use pass_test::view::{Light, SIDE, See, TOWARDS, assert_edges_stay};

/// Filters a picture of 4×4 sub-images.
fn filtered(see: See<'_>, light: Light<'_>, iterations: u32) -> Option<Vec<[f32; 4]>> {
    let harness = Harness::new(a_trous::PASS).frame(SIDE, SIDE).set("iterations", iterations);
    Some(harness.view(see).irradiance((4, 4), light).run()?.read("filtered"))
}

/// Each subset has the same weight after two iterations, and not after one.
#[test]
fn the_pattern_of_the_interleaving_goes() {
    let wall = |_: u32, _: u32| (3.0, TOWARDS);
    let subset = |x: u32, y: u32| [(y % 4 * 4 + x % 4) as f32; 4];
    let (Some(two), Some(one)) = (filtered(&wall, &subset, 0), filtered(&wall, &subset, 1)) else { return };
    // So far from the edges of the picture that windows end within it.
    let inner = || (16..32).flat_map(|y| (16..32).map(move |x| (y * SIDE + x) as usize));
    for i in inner() {
        assert!((two[i][0] - 7.5).abs() < 1e-4, "{:?} for the mean of all subsets", two[i]);
    }
    assert!(inner().any(|i| (one[i][0] - 7.5).abs() > 0.1), "one iteration is too few for four sub-images");
}

#[test]
fn edges_of_the_geometry_stay() {
    for iterations in [1, 2, 5] {
        assert_edges_stay(|see, light| filtered(see, light, iterations));
    }
}

/// On a wall an iteration is a convolution with the B-spline, cut at the edges of the picture: no pixel counts twice, and none
/// that is not there.
#[test]
fn an_iteration_is_a_spline_cut_at_the_edges() {
    let wall = |_: u32, _: u32| (3.0, TOWARDS);
    let value = |x: u32, y: u32| f64::from((7 * x + 13 * y + x * y) % 17 + 1);
    let light = |x: u32, y: u32| [value(x, y) as f32; 4];
    let Some(found) = filtered(&wall, &light, 1) else { return };
    let spline = [3.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0];
    for (y, x) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (y, x))) {
        let (mut sum, mut weights) = (0.0, 0.0);
        for (dy, dx) in (-2..=2_i32).flat_map(|dy| (-2..=2_i32).map(move |dx| (dy, dx))) {
            let (Some(x), Some(y)) = (x.checked_add_signed(dx), y.checked_add_signed(dy)) else { continue };
            if x < SIDE && y < SIDE {
                let weight = spline[dx.unsigned_abs() as usize] * spline[dy.unsigned_abs() as usize];
                sum += weight * value(x, y);
                weights += weight;
            }
        }
        let found = f64::from(found[(y * SIDE + x) as usize][0]);
        assert!((found / (sum / weights) - 1.0).abs() < 1e-4, "({x}, {y}): {found} for {}", sum / weights);
    }
}

/// Where pixels differ as their noise lets them, the filter stays; where they differ by more, it leaves what is more: Lee's filter over
/// one window.
#[test]
fn what_is_no_noise_is_left() {
    let wall = |_: u32, _: u32| (3.0, TOWARDS);
    let value = |x: u32, y: u32| ((7 * x + 13 * y) % 17 + 1) as f32;
    let light = |x: u32, y: u32| [value(x, y); 4];
    let Some(whole) = filtered(&wall, &light, 1) else { return };
    let pixels = (SIDE * SIDE) as usize;
    let texture = |format| ResourceDesc::texture_2d(format, (SIDE, SIDE));
    let spline = [1.0 / 16.0, 1.0 / 4.0, 3.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0f32];
    for (frames, variance) in [(1.0, 0.0), (5.0, 0.0), (5.0, 40.0), (5.0, 1e6), (65.0, 640.0f32)] {
        let mean = vec![
            pass_test::member("value", texture(Format::Rgba32Float), &vec![[0.0f32; 4]; pixels]),
            pass_test::member("frames", texture(Format::Rg32Float), &vec![[frames, variance]; pixels]),
        ];
        let harness = Harness::new(a_trous::PASS).frame(SIDE, SIDE).set("iterations", 1);
        let harness = harness.view(wall).irradiance((4, 4), light).input("mean", "FrameMean", &[], mean);
        let found: Vec<[f32; 4]> = harness.run().expect("the adapter is still there").read("filtered");
        // So far from the edges of the picture that windows end within it.
        for (y, x) in (4..SIDE - 4).flat_map(|y| (4..SIDE - 4).map(move |x| (y, x))) {
            let i = (y * SIDE + x) as usize;
            let average = whole[i][0];
            let away = |dx: u32, dy: u32| (value(x + dx - 2, y + dy - 2) - average).powi(2);
            let taps = (0..5).flat_map(|dy| (0..5).map(move |dx| (dx, dy)));
            let spread: f32 =
                taps.map(|(dx, dy)| spline[dx as usize] * spline[dy as usize] * away(dx, dy)).sum();
            let left = if frames > 1.0 { (2.0 * variance / (frames - 1.0) / spread).min(1.0) } else { 1.0 };
            let expected = value(x, y) + (average - value(x, y)) * left;
            assert!(
                (found[i][0] - expected).abs() < 1e-3,
                "{i}: {} for {expected}, left {left}",
                found[i][0]
            );
        }
    }
}
