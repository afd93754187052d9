//! ꟻLIP against its authors' implementation: the expected values are those of the Python package
//! flip-evaluator 1.7 (`evaluate(reference, test, "LDR" or "HDR", …)`) on the same pictures.
//! Agreement is to 10⁻⁴ for the mean and 10⁻³ for one pixel: theirs, too, is in `f32`.

use metrics::{Display, FlipMap, Image, PIXELS_PER_DEGREE, Pair, flip, hdr_flip};

use crate::patterns::{
    HEIGHT, Pattern, WIDTH, checkers, gradient, noise, noisy_gradient, picture, radiance, shifted_gradient,
    srgb, tinted_checkers,
};

fn check(map: &FlipMap, mean: f64, pixels: [f32; 4]) {
    assert!((map.mean() - mean).abs() < 1e-4, "mean {} instead of {mean}", map.mean());
    for ((x, y), expected) in [(0, 0), (31, 20), (63, 47), (10, 40)].into_iter().zip(pixels) {
        let found = map.errors()[y * WIDTH + x];
        assert!((found - expected).abs() < 1e-3, "({x}, {y}): {found} instead of {expected}");
    }
}

fn check_ldr(reference: Pattern, image: Pattern, ppd: f32, mean: f64, pixels: [f32; 4]) {
    let (image, reference) = (picture(image, srgb), picture(reference, srgb));
    check(&flip(&Pair::new(&image, &reference).unwrap(), Display::AS_IS, ppd), mean, pixels);
}

#[test]
fn noise_on_a_gradient() {
    check_ldr(gradient, noisy_gradient, 67.0, 0.141_869_4, [0.018_558, 0.109_907, 0.324_586, 0.147_207]);
    check_ldr(gradient, noisy_gradient, 20.0, 0.346_769_2, [0.010_718, 0.338_141, 0.528_211, 0.355_793]);
}

#[test]
fn a_shifted_gradient() {
    check_ldr(gradient, shifted_gradient, 67.0, 0.119_639_3, [0.011_015, 0.123_966, 0.157_565, 0.084_547]);
}

#[test]
fn a_gradient_instead_of_noise() {
    check_ldr(noise, gradient, 67.0, 0.783_535_3, [0.900_356, 0.506_534, 0.844_017, 0.946_903]);
    check_ldr(noise, gradient, 20.0, 0.866_824_4, [0.853_308, 0.895_133, 0.964_433, 0.921_937]);
}

#[test]
fn moved_and_tinted_edges() {
    check_ldr(checkers, tinted_checkers, 67.0, 0.386_661_2, [0.520_159, 0.550_304, 0.987_557, 0.216_336]);
    check_ldr(checkers, tinted_checkers, 20.0, 0.405_539_2, [0.457_250, 0.962_938, 0.989_391, 0.463_974]);
}

#[test]
fn high_dynamic_range() {
    let [gradient, noisy, noise] = [gradient, noisy_gradient, noise].map(|p: Pattern| picture(p, radiance));
    let map = hdr_flip(&Pair::new(&noisy, &gradient).unwrap(), PIXELS_PER_DEGREE);
    check(&map, 0.193_587_1, [0.156_905, 0.076_893, 0.088_974, 0.156_861]);
    let map = hdr_flip(&Pair::new(&gradient, &noise).unwrap(), PIXELS_PER_DEGREE);
    check(&map, 0.797_832_4, [0.972_659, 0.493_551, 0.813_571, 0.954_429]);
}

#[test]
fn equal_pictures_have_no_error_and_symmetry_holds() {
    let (a, b) = (picture(gradient, srgb), picture(checkers, srgb));
    let pair = |image, reference| Pair::new(image, reference).unwrap();
    let same = flip(&pair(&a, &a), Display::AS_IS, 67.0);
    assert!(same.errors().iter().all(|&error| error == 0.0));
    assert_eq!(flip(&pair(&a, &b), Display::AS_IS, 67.0), flip(&pair(&b, &a), Display::AS_IS, 67.0));
}

#[test]
fn broken_pixels_are_wholly_wrong_and_spread_no_nan() {
    let reference = picture(gradient, radiance);
    let mut image = reference.clone();
    image.pixels_mut()[5 * WIDTH + 7] = [f32::NAN, 1.0, f32::INFINITY, 1.0];
    let pair = Pair::new(&image, &reference).unwrap();
    for map in [flip(&pair, Display::default(), 67.0), hdr_flip(&pair, 67.0)] {
        assert_eq!(map.errors()[5 * WIDTH + 7], 1.0);
        assert_eq!(map.errors().iter().filter(|&&error| error == 0.0).count(), WIDTH * HEIGHT - 1);
    }
}

#[test]
fn extremes_stay_in_range() {
    let one = |v: f32| Image::new(1, 1, vec![[v, v, v, 1.0]]).unwrap();
    for (a, b) in [(0.0, 0.0), (0.0, 1e30), (1e-30, -1.0), (f32::MAX, f32::MAX), (f32::MAX, 0.0)] {
        let (a, b) = (one(a), one(b));
        let pair = Pair::new(&a, &b).unwrap();
        for ppd in [0.0, 1.0, 300.0] {
            for map in [flip(&pair, Display::default(), ppd), hdr_flip(&pair, ppd)] {
                assert!(map.errors().iter().all(|error| (0.0..=1.0).contains(error)), "{map:?}");
            }
        }
    }
}

#[test]
fn quantiles_by_rank() {
    // One pixel of four is broken: the errors are 0 0 0 1.
    let reference = Image::new(4, 1, vec![[0.5, 0.5, 0.5, 1.0]; 4]).unwrap();
    let mut image = reference.clone();
    image.pixels_mut()[0][0] = f32::NAN;
    let map = flip(&Pair::new(&image, &reference).unwrap(), Display::AS_IS, 67.0);
    assert_eq!([0.0, 0.75, 0.76, 1.0].map(|q| map.quantile(q)), [0.0, 0.0, 1.0, 1.0]);
    assert_eq!(map.mean(), 0.25);
    assert!(map.to_image().pixels()[0][0] > 0.9 && map.to_image().pixels()[1][0] == 0.0);
}
