//! The shaders are valid; the CPU reference against closed forms.

mod cpu_reference;
mod gpu;

use cpu_reference::{composite, displayed, srgb, tonemap};
use std::f64::consts::PI;

const CURVES: [&str; 5] = ["reinhard", "reinhard-simple", "aces", "filmic", "none"];

pass_test::shaders_are_valid!(composite::PASS);

#[test]
fn a_white_surface_in_irradiance_pi_has_radiance_one() {
    let sum = composite([0.5, 0.0, 0.0], [1.0; 3], [PI; 3], [0.0, 0.25, 0.0], [0.0, 0.0, 2.0]);
    assert_eq!(sum, [1.5, 1.25, 3.0]);
}

#[test]
fn curves_follow_their_formulas() {
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
    near(tonemap("reinhard-simple", [1.0; 3], 4.0)[0], 0.5);
    // 1 · (1 + 1/16) / 2
    near(tonemap("reinhard", [1.0; 3], 4.0)[0], 0.53125);
    near(tonemap("reinhard", [4.0; 3], 4.0)[0], 1.0);
    near(tonemap("aces", [1.0; 3], 4.0)[0], 2.54 / 3.16);
    near(tonemap("filmic", [11.2; 3], 11.2)[0], 1.0);
    // (0.15 + 0.05 + 0.004) / (0.15 + 0.5 + 0.06) − 0.02/0.3, over the same at 11.2
    let at_one = 0.204 / 0.71 - 0.02 / 0.3;
    let at_white = (11.2 * (0.15 * 11.2 + 0.05) + 0.004) / (11.2 * (0.15 * 11.2 + 0.5) + 0.06) - 0.02 / 0.3;
    near(tonemap("filmic", [1.0; 3], 11.2)[0], at_one / at_white);
    near(srgb(0.5), 0.735_356_983_052_449_6);
    near(srgb(1.0), 1.0);
}

#[test]
fn black_is_black_and_every_curve_rises() {
    for curve in CURVES {
        assert!(displayed(curve, [0.0; 3], 3.0, 4.0).iter().all(|x| x.abs() < 1e-9), "{curve}");
        let mut last = 0.0;
        for i in -60..60 {
            let [now, ..] = displayed(curve, [2f64.powf(f64::from(i) * 0.5); 3], 0.0, 4.0);
            assert!(now >= last && (0.0..=1.0).contains(&now), "{curve}: {now} after {last}");
            last = now;
        }
        assert!(last > 0.99, "{curve} never gets white: {last}");
    }
}

#[test]
fn an_exposure_of_one_doubles() {
    for curve in CURVES {
        let (a, b) = (displayed(curve, [0.3; 3], 1.0, 4.0), displayed(curve, [0.6; 3], 0.0, 4.0));
        assert!((a[0] - b[0]).abs() < 1e-12, "{curve}");
    }
}

#[test]
fn what_is_no_number_shows() {
    for broken in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(displayed("reinhard", [0.0, broken, 0.0], 0.0, 4.0), [1.0, 0.0, 1.0]);
    }
}
