//! The filter removes the pattern of interleaving, and keeps edges.

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
