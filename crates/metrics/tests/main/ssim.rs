//! Structural similarity against another implementation: the expected values are those of scikit-image
//! 0.26 (`structural_similarity` with `gaussian_weights`, σ 1.5, `use_sample_covariance` off, a data range
//! of 1) on Rec. 709 luma of the same bytes. Theirs is `f64`; here luma is `f32`, so agreement is to 10⁻⁵.

use metrics::{Display, Image, Pair, srgb_from_linear};

use crate::patterns::{
    HEIGHT, Pattern, WIDTH, checkers, gradient, noise, noisy_gradient, picture, shifted_gradient, srgb,
    tinted_checkers,
};

/// Display light whose luma is as given.
fn row(lumas: &[f32]) -> Image {
    let pixels = lumas.iter().map(|&luma| [srgb(luma * 255.0); 3]).map(|[r, g, b]| [r, g, b, 1.0]);
    Image::new(lumas.len(), 1, pixels.collect()).unwrap()
}

fn ssim(image: &Image, reference: &Image) -> f64 {
    Pair::new(image, reference).unwrap().ssim(Display::AS_IS)
}

#[track_caller]
fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-5, "{found} instead of {expected}");
}

#[test]
fn agrees_with_scikit_image() {
    let check = |reference: Pattern, image: Pattern, expected| {
        close(ssim(&picture(image, srgb), &picture(reference, srgb)), expected);
    };
    check(gradient, noisy_gradient, 0.399_601_8);
    check(gradient, shifted_gradient, 0.999_736_0);
    check(noise, gradient, 0.018_872_5);
    check(checkers, tinted_checkers, 0.629_410_4);
}

#[test]
fn small_pictures_by_hand() {
    let (c1, c2) = (1e-4, 9e-4);
    // One pixel has no variance: (2·0.5·0.25 + C₁) / (0.25 + 0.0625 + C₁).
    close(ssim(&row(&[0.5]), &row(&[0.25])), (0.25 + c1) / (0.3125 + c1));
    // Two weigh a half each: means 1/2, variances 1/4, covariance −1/4.
    close(ssim(&row(&[0.0, 1.0]), &row(&[1.0, 0.0])), (c2 - 0.5) / (c2 + 0.5));
    // Twelve have two windows of eleven. Flat pictures that differ in the first pixel, which is in one of
    // them with the outermost weight w: means w and 0, variance w − w².
    let mut corner = [0.0; 12];
    corner[0] = 1.0;
    let bell = |x: f64| (-x * x / 4.5).exp();
    let w = bell(5.0) / (-5..=5).map(|x| bell(f64::from(x))).sum::<f64>();
    let touched = c1 * c2 / ((w * w + c1) * (w - w * w + c2));
    close(ssim(&row(&corner), &row(&[0.0; 12])), (touched + 1.0) / 2.0);
}

#[test]
fn a_picture_is_like_itself_and_likeness_is_mutual() {
    let (a, b) = (picture(noisy_gradient, srgb), picture(noise, srgb));
    assert_eq!(ssim(&a, &a), 1.0);
    assert_eq!(ssim(&a, &b), ssim(&b, &a));
    assert!(ssim(&a, &b) < 0.5);
}

#[test]
fn a_broken_pixel_loses_its_own_window_and_no_other() {
    let reference = picture(noise, srgb);
    let windows = ((WIDTH - 10) * (HEIGHT - 10)) as f64;
    let broken = |x: usize, y: usize| {
        let mut image = reference.clone();
        image.pixels_mut()[y * WIDTH + x] = [f32::NAN, 1.0, f32::INFINITY, 1.0];
        ssim(&image, &reference)
    };
    close(broken(30, 20), 1.0 - 1.0 / windows);
    close(broken(5, 5), 1.0 - 1.0 / windows);
    assert_eq!(broken(4, 20), 1.0, "the centre of no window");
}

#[test]
fn it_sees_what_the_display_shows() {
    // Both are white on a display that cuts at 1, and a long way apart before.
    let [one, nine] = [1.0, 9.0].map(|v| Image::new(1, 1, vec![[v, v, v, 1.0]]).unwrap());
    let pair = Pair::new(&one, &nine).unwrap();
    assert_eq!(pair.ssim(Display::AS_IS), 1.0);
    // The Reinhard operator makes 1/2 and 9/10 of them; one pixel has no variance.
    let [a, b] = [0.5, 0.9].map(|light| f64::from(srgb_from_linear(light)));
    close(pair.ssim(Display::default()), (2.0 * a * b + 1e-4) / (a * a + b * b + 1e-4));
}
