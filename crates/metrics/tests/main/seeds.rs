//! Bias and variance apart.

use metrics::seeds::{Decomposition, mean_image};
use metrics::{Image, ImageError};

fn grey(value: f32) -> Image {
    Image::new(1, 1, vec![[value, value, value, 1.0]]).unwrap()
}

#[track_caller]
fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-9, "{found} instead of {expected}");
}

#[test]
fn two_seeds_by_hand() {
    // Mean 2, variance 2; of the squared error 4 of the mean, 2/2 is noise.
    let found = Decomposition::of(&[1.0, 3.0].map(grey), &grey(0.0)).unwrap();
    close(found.mse, 5.0);
    close(found.variance, 2.0);
    close(found.bias_squared, 3.0);
    close(found.standard_error, 1.0);
    assert_eq!((found.seeds, found.bias_squared_error), (2, None));
}

#[test]
fn three_seeds_by_hand() {
    // Mean 3, variance 4, bias² 9 − 4/3. With one seed left out, bias² is the product of the other two:
    // 15, 5 and 3, whose mean is 23/3.
    let found = Decomposition::of(&[1.0, 3.0, 5.0].map(grey), &grey(0.0)).unwrap();
    close(found.mse, 35.0 / 3.0);
    close(found.variance, 4.0);
    close(found.bias_squared, 23.0 / 3.0);
    let scatter: f64 = [15.0, 5.0, 3.0].iter().map(|b: &f64| (b - 23.0 / 3.0).powi(2)).sum();
    close(found.bias_squared_error.unwrap(), (scatter * 2.0 / 3.0).sqrt());
}

#[test]
fn no_bias_comes_out_below_zero_now_and_then() {
    let found = Decomposition::of(&[-1.0, 1.0].map(grey), &grey(0.0)).unwrap();
    close(found.bias_squared, -1.0);
    close(found.bias_squared + found.variance, found.mse);
}

#[test]
fn a_known_bias_is_found_in_noise() {
    // Uniform noise over 0..3 about the reference's 2 has a bias of −1/2 and a variance of 9/12.
    const SEEDS: usize = 4;
    const SIDE: usize = 64;
    let noise = |seed: usize, x: usize, y: usize, channel: usize| {
        let mut n = (((seed * SIDE + y) * SIDE + x) * 3 + channel) as u64;
        for multiplier in [0xbf58_476d_1ce4_e5b9, 0x94d0_49bb_1331_11eb] {
            n = (n ^ (n >> 30)).wrapping_add(0x9e37_79b9_7f4a_7c15).wrapping_mul(multiplier);
        }
        3.0 * (n >> 40) as f32 / (1_u32 << 24) as f32
    };
    let pictures: Vec<Image> = (0..SEEDS)
        .map(|seed| {
            Image::from_fn(SIDE, SIDE, |x, y| {
                let [r, g, b] = [0, 1, 2].map(|channel| noise(seed, x, y, channel));
                [r, g, b, 1.0]
            })
            .unwrap()
        })
        .collect();
    let reference = Image::new(SIDE, SIDE, vec![[2.0, 2.0, 2.0, 1.0]; SIDE * SIDE]).unwrap();
    let found = Decomposition::of(&pictures, &reference).unwrap();
    // 3·64² independent values: the variance is good for some 0.005 (its own deviation is
    // √(0.9 + …)/√(3·64²·3)), bias² for some 0.004 (2·0.5·√(0.75/(4·3·64²))).
    assert!((found.variance - 0.75).abs() < 0.02, "{found:?}");
    assert!((found.bias_squared - 0.25).abs() < 0.016, "{found:?}");
    assert!(found.bias_squared_error.unwrap() < 0.016, "{found:?}");
    close(found.bias_squared + found.variance, found.mse);
    close(found.standard_error, (found.variance / 4.0).sqrt());
}

#[test]
fn broken_pixels_are_left_out() {
    let two = |a: f32, b: f32| Image::new(2, 1, vec![[a, a, a, 1.0], [b, b, b, 1.0]]).unwrap();
    let pictures = [two(1.0, 7.0), two(3.0, f32::NAN)];
    let found = Decomposition::of(&pictures, &two(0.0, 0.0)).unwrap();
    close(found.mse, 5.0);
    assert_eq!(found.non_finite, 1);
    let all = Decomposition::of(&pictures, &two(f32::INFINITY, 0.0));
    assert!(matches!(all, Err(ImageError::NoFinitePixels { pixels: 2 })));
    assert!(matches!(Decomposition::of(&pictures[..1], &pictures[0]), Err(ImageError::TooFew { .. })));
    assert!(matches!(Decomposition::of(&pictures, &grey(0.0)), Err(ImageError::SizesDiffer { .. })));
}

#[test]
fn mean_images_by_hand() {
    let images =
        [[1.0, 2.0, 3.0, 1.0], [3.0, 4.0, f32::NAN, 0.0]].map(|p| Image::new(1, 1, vec![p]).unwrap());
    let [r, g, b, a] = mean_image(&images).unwrap().pixels()[0];
    assert_eq!([r, g, a], [2.0, 3.0, 0.5]);
    assert!(b.is_nan());
    assert!(matches!(mean_image(&[]), Err(ImageError::TooFew { expected: 1, .. })));
}
