//! Bias and variance apart.

use metrics::seeds::{Decomposition, PseudoValues, mean_image};
use metrics::statistics::Summary;
use metrics::{Image, ImageError};

fn grey(value: f32) -> Image {
    Image::new(1, 1, vec![[value, value, value, 1.0]]).unwrap()
}

/// Returns a picture of 4×4 pixels with these values.
fn picture(mut value: impl FnMut() -> f64) -> Image {
    Image::from_fn(4, 4, |_, _| {
        let [r, g, b] = std::array::from_fn(|_| value() as f32);
        [r, g, b, 1.0]
    })
    .unwrap()
}

/// Random numbers (SplitMix64).
struct Noise(u64);

impl Noise {
    /// Returns a number in 0..1.
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut n = self.0;
        for (shift, multiplier) in [(30, 0xbf58_476d_1ce4_e5b9), (27, 0x94d0_49bb_1331_11eb)] {
            n = (n ^ (n >> shift)).wrapping_mul(multiplier);
        }
        ((n ^ (n >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns a number of mean 0 and variance 1 (Box & Muller 1958).
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
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
    assert_eq!(found.seeds, 2);
    // Neither can be left out.
    assert!(found.by_seed.iter().all(|seed| (seed.bias_squared, seed.variance) == (3.0, 2.0)), "{found:?}");
}

#[test]
fn three_seeds_by_hand() {
    // Mean 3, variance 4, bias² 9 − 4/3. With one seed left out, bias² is the product of the other two:
    // 15, 5 and 3, whose mean is 23/3.
    let found = Decomposition::of(&[1.0, 3.0, 5.0].map(grey), &grey(0.0)).unwrap();
    close(found.mse, 35.0 / 3.0);
    close(found.variance, 4.0);
    close(found.bias_squared, 23.0 / 3.0);
    // The variances of the other two are 2, 8 and 2.
    for (seed, (bias, variance)) in found.by_seed.iter().zip([(15.0, 2.0), (5.0, 8.0), (3.0, 2.0)]) {
        close(seed.bias_squared, 3.0 * 23.0 / 3.0 - 2.0 * bias);
        close(seed.variance, 3.0 * 4.0 - 2.0 * variance);
    }
}

/// Bias² and variance are U-statistics: the mean of their pseudo-values is the estimate, for any pictures.
#[test]
fn pseudo_values_average_to_the_estimates() {
    for seeds in 2..7 {
        let mut noise = Noise(seeds);
        let pictures: Vec<Image> = (0..seeds).map(|_| picture(|| noise.uniform() * 5.0)).collect();
        let found = Decomposition::of(&pictures, &picture(|| noise.uniform())).unwrap();
        let mean = |value: fn(&PseudoValues) -> f64| {
            found.by_seed.iter().map(value).sum::<f64>() / found.by_seed.len() as f64
        };
        close(mean(|seed| seed.bias_squared), found.bias_squared);
        close(mean(|seed| seed.variance), found.variance);
    }
}

/// In 95 of 100 repetitions the interval over five seeds should contain the truth. Gaussian noise of variance 1, a
/// part of which is shared by all pixels of a picture, as noise of virtual lights is.
#[test]
fn intervals_contain_the_truth_as_often_as_they_say() {
    const REPETITIONS: usize = 2000;
    let shares = |bias: f64, shared: f64| {
        let mut noise = Noise(1);
        let mut hits = [0; 2];
        for _ in 0..REPETITIONS {
            let pictures: Vec<Image> = (0..5)
                .map(|_| {
                    let common = shared.sqrt() * noise.normal();
                    picture(|| bias + common + (1.0 - shared).sqrt() * noise.normal())
                })
                .collect();
            let found = Decomposition::of(&pictures, &picture(|| 0.0)).unwrap();
            let contains = |value: fn(&PseudoValues) -> f64, truth: f64| {
                let values: Vec<f64> = found.by_seed.iter().map(value).collect();
                let summary = Summary::of(&values).unwrap();
                usize::from((summary.mean - truth).abs() <= summary.half_width_95)
            };
            hits[0] += contains(|seed| seed.bias_squared, bias * bias);
            hits[1] += contains(|seed| seed.variance, 1.0);
        }
        hits.map(|hits| hits as f64 / REPETITIONS as f64)
    };
    // One deviation of a share of 0.95 is 0.005.
    let [bias, variance] = shares(2.0, 0.0);
    assert!((bias - 0.95).abs() < 0.015 && (variance - 0.95).abs() < 0.03, "{bias} {variance}");
    // The variance of noise that is shared is that of few numbers, which is skewed: five of them are too few.
    let [bias, variance] = shares(2.0, 0.5);
    assert!((bias - 0.95).abs() < 0.015 && (0.8..0.9).contains(&variance), "{bias} {variance}");
    // Without a bias, its estimate has no slope in the pictures, and its interval is too wide.
    let [bias, _] = shares(0.0, 0.5);
    assert!(bias > 0.97, "{bias}");
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
    let mut noise = Noise(0);
    let pictures: Vec<Image> = (0..SEEDS)
        .map(|_| {
            Image::from_fn(SIDE, SIDE, |_, _| {
                let [r, g, b] = std::array::from_fn(|_| 3.0 * noise.uniform() as f32);
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
    let biases: Vec<f64> = found.by_seed.iter().map(|seed| seed.bias_squared).collect();
    assert!(Summary::of(&biases).unwrap().half_width_95 < 0.06, "{found:?}");
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
