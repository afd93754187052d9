//! The window is a Gaussian, and edges stay.

use pass_test::Harness;
use pass_test::view::{Light, SIDE, See, TOWARDS, assert_edges_stay};

/// Filters a picture of 4×4 sub-images.
fn filtered(see: See<'_>, light: Light<'_>, radius: u32) -> Option<Vec<[f32; 4]>> {
    let harness = Harness::new(cross_bilateral::PASS).frame(SIDE, SIDE).set("radius", radius);
    Some(harness.view(see).irradiance((4, 4), light).run()?.read("filtered"))
}

fn wall(_: u32, _: u32) -> (f32, [f32; 3]) {
    (3.0, TOWARDS)
}

#[test]
fn the_pattern_of_the_interleaving_nearly_goes() {
    let subset = |x: u32, y: u32| [(y % 4 * 4 + x % 4) as f32; 4];
    let (Some(wide), Some(narrow)) = (filtered(&wall, &subset, 6), filtered(&wall, &subset, 1)) else {
        return;
    };
    // So far from the edges of the picture that windows end within it.
    let inner = || (16..32).flat_map(|y| (16..32).map(move |x| (y * SIDE + x) as usize));
    for i in inner() {
        assert!((wide[i][0] - 7.5).abs() < 0.1, "{:?} for the mean of all subsets", wide[i]);
    }
    assert!(
        inner().any(|i| (narrow[i][0] - 7.5).abs() > 0.5),
        "three pixels are too few for four sub-images"
    );
}

/// One bright pixel spreads as a Gaussian whose standard deviation is half the radius.
#[test]
fn a_window_is_gaussian() {
    let spot = |x: u32, y: u32| if (x, y) == (24, 24) { [1.0; 4] } else { [0.0; 4] };
    let Some(pixels) = filtered(&wall, &spot, 4) else { return };
    let at = |x: u32| f64::from(pixels[(24 * SIDE + x) as usize][0]);
    for offset in 0..=4u32 {
        let (found, wanted) = (at(24 + offset) / at(24), (-0.125 * f64::from(offset * offset)).exp());
        assert!((found - wanted).abs() < 1e-3, "{found} at {offset} for {wanted}");
    }
    assert_eq!(at(29), 0.0, "the window ends");
    // In all directions alike.
    for (dx, dy) in [(0, 4), (0, -4), (-4, 0), (3, -4), (-2, 4), (1, 1)] {
        let pixel = (24_u32.wrapping_add_signed(dy) * SIDE + 24_u32.wrapping_add_signed(dx)) as usize;
        let (found, wanted) =
            (f64::from(pixels[pixel][0]) / at(24), (-0.125 * f64::from(dx * dx + dy * dy)).exp());
        assert!((found - wanted).abs() < 1e-3, "{found} at {dx}, {dy} for {wanted}");
    }
}

#[test]
fn without_a_window_nothing_is_averaged() {
    let subset = |x: u32, y: u32| [(y % 4 * 4 + x % 4) as f32; 4];
    let Some(pixels) = filtered(&wall, &subset, 0) else { return };
    assert!((0..SIDE * SIDE).all(|i| pixels[i as usize] == subset(i % SIDE, i / SIDE)));
}

#[test]
fn edges_of_the_geometry_stay() {
    for radius in [4, 9] {
        assert_edges_stay(|see, light| filtered(see, light, radius));
    }
}
