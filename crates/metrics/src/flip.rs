//! ꟻLIP: the difference that a person perceives when two pictures alternate in the same place.
//!
//! Andersson et al. 2020, "ꟻLIP: A Difference Evaluator for Alternating Images", for display light; Andersson
//! et al. 2021, "Visualizing Errors in Rendered High Dynamic Range Images", for radiance. Section numbers are
//! those of the former. The filters are separable: Gaussians and their derivatives.

use rayon::prelude::*;

use crate::image::{is_finite, luminance};
use crate::{Display, Image, Pair};

/// The usual viewing condition (pixels per degree of visual angle): a display 3840 pixels and 0.7 m
/// wide, seen from 0.7 m, which is 3840·π/180.
pub const PIXELS_PER_DEGREE: f32 = 67.020_645;

/// Exponent q_c of the color difference (§4.1.3).
const COLOR_EXPONENT: f32 = 0.7;
/// p_c and p_t (§4.1.3): the share p_c of the greatest possible color difference is mapped to the error p_t.
const KNEE: f32 = 0.4;
const KNEE_ERROR: f32 = 0.95;
/// Peak-to-trough width w of the feature detectors (degrees) (§4.2.1).
const FEATURE_WIDTH: f32 = 0.082;
/// Exponent q_f of the feature difference (§4.2.2).
const FEATURE_EXPONENT: f32 = 0.5;
/// Gaussians (a, b) of the contrast sensitivity in each opponent channel (§4.1.1, Table 1).
const CSF_ACHROMATIC: (f64, f64) = (1.0, 0.0047);
const CSF_RED_GREEN: (f64, f64) = (1.0, 0.0053);
const CSF_BLUE_YELLOW: [(f64, f64); 2] = [(34.1, 0.04), (13.5, 0.025)];

/// The ꟻLIP error of each pixel, 0 (no visible difference) to 1.
#[derive(Debug, Clone, PartialEq)]
pub struct FlipMap {
    width: usize,
    height: usize,
    errors: Vec<f32>,
}

impl FlipMap {
    /// Returns the `[height * width]` errors, row by row from the top left, each 0..=1.
    pub fn errors(&self) -> &[f32] {
        &self.errors
    }

    /// Returns the mean error, the usual single figure.
    pub fn mean(&self) -> f64 {
        self.errors.iter().map(|&e| f64::from(e)).sum::<f64>() / self.errors.len() as f64
    }

    /// Returns the smallest error that at least a share `q` (0..=1) of the pixels does not exceed.
    pub fn quantile(&self, q: f64) -> f32 {
        let mut sorted = self.errors.clone();
        let rank = (q.clamp(0.0, 1.0) * sorted.len() as f64).ceil() as usize;
        *sorted.select_nth_unstable_by(rank.saturating_sub(1), f32::total_cmp).1
    }

    /// Returns the error in the magma color map, as the original tool shows it: linear display light, to be
    /// written with [`Display::AS_IS`].
    pub fn to_image(&self) -> Image {
        crate::difference::magma(self.width, self.height, &self.errors)
    }
}

/// Computes ꟻLIP between two pictures after applying `display` ([`Display::AS_IS`] for display light), seen
/// at `pixels_per_degree`, above 0 ([`PIXELS_PER_DEGREE`]).
///
/// A pixel that is NaN or infinite in either picture counts as black in both for its neighbours, and its own
/// error is 1. O(pixels · pixels_per_degree).
pub fn flip(pair: &Pair<'_>, display: Display, pixels_per_degree: f32) -> FlipMap {
    let filters = Filters::new(pixels_per_degree);
    map(pair, |rgb| display.map(rgb), &filters)
}

/// Computes HDR-ꟻLIP: the greatest ꟻLIP error of each pixel over the exposures at which the reference is neither too
/// dark nor too bright on a display (2021, §4), through the ACES curve of that paper.
/// The exposures range, in steps of at most 1 EV, from the one that maps the reference's maximum luminance to
/// 0.85 to the one that maps its median luminance to 0.85; a median of 0 counts as `f32::EPSILON`. Pixels
/// that are NaN or infinite are treated as in [`flip`].
pub fn hdr_flip(pair: &Pair<'_>, pixels_per_degree: f32) -> FlipMap {
    let filters = Filters::new(pixels_per_degree);
    let [start, stop] = exposure_range(pair.reference());
    let count = ((stop - start).ceil() as usize).max(2);
    let exposures = (0..count).map(|k| start + (stop - start) * k as f32 / (count - 1) as f32);
    let maps = exposures.map(|exposure| {
        let gain = exposure.exp2();
        let tone_map = |rgb: [f32; 3]| rgb.map(|channel| Aces::map(channel.max(0.0) * gain));
        map(pair, tone_map, &filters)
    });
    maps.reduce(|mut most, other| {
        for (a, &b) in most.errors.iter_mut().zip(&other.errors) {
            *a = a.max(b);
        }
        most
    })
    .expect("there are at least two exposures")
}

/// The ACES curve with its pre-exposure of 0.6 included, as HDR-ꟻLIP uses it: (a x² + b x) / (c x² + d x +
/// e), clamped to 0..=1.
struct Aces;

impl Aces {
    const A: f32 = 0.6 * 0.6 * 2.51;
    const B: f32 = 0.6 * 0.03;
    const C: f32 = 0.6 * 0.6 * 2.43;
    const D: f32 = 0.6 * 0.59;
    const E: f32 = 0.14;

    fn map(x: f32) -> f32 {
        // The curve exceeds 1 long before 100; x² must not overflow.
        let x = x.min(100.0);
        ((x * (Self::A * x + Self::B)) / (x * (Self::C * x + Self::D) + Self::E)).clamp(0.0, 1.0)
    }

    /// Returns the exposed radiance that is mapped to `t`.
    fn inverse(t: f32) -> f32 {
        let (a, b, c) = (Self::A - t * Self::C, Self::B - t * Self::D, -t * Self::E);
        let half = -0.5 * b / a;
        half + (half * half - c / a).sqrt()
    }
}

/// Returns the first and last exposure (EV) of HDR-ꟻLIP.
fn exposure_range(reference: &Image) -> [f32; 2] {
    let finite = reference.pixels().iter().filter(|&&rgba| is_finite(rgba));
    let mut luminances: Vec<f32> = finite.map(|&[r, g, b, _]| luminance([r, g, b])).collect();
    luminances.sort_unstable_by(f32::total_cmp);
    let n = luminances.len();
    let median = (luminances[(n - 1) / 2] + luminances[n / 2]) * 0.5;
    let white = Aces::inverse(0.85);
    [luminances[n - 1], median].map(|l| (white / l.max(f32::EPSILON)).log2())
}

fn map(pair: &Pair<'_>, tone_map: impl Fn([f32; 3]) -> [f32; 3] + Sync, filters: &Filters) -> FlipMap {
    let (image, reference) = (pair.image(), pair.reference());
    let (width, height) = (image.width(), image.height());
    let pixels = || image.pixels().par_iter().zip(reference.pixels());
    let broken: Vec<bool> = pixels().map(|(&i, &r)| !(is_finite(i) && is_finite(r))).collect();
    let [seen, expected] = [image, reference].map(|picture| {
        let opponent: Vec<[f32; 3]> = picture
            .pixels()
            .par_iter()
            .zip(&broken)
            .map(|(&[r, g, b, _], &broken)| {
                opponent_from_linear(if broken { [0.0; 3] } else { tone_map([r, g, b]) })
            })
            .collect();
        filters.see(&opponent, width, height)
    });
    let greatest = greatest_color_difference();
    let errors = (0..width * height)
        .into_par_iter()
        .map(|pixel| {
            if broken[pixel] {
                return 1.0;
            }
            let difference = hyab(seen.color[pixel], expected.color[pixel]).powf(COLOR_EXPONENT);
            let color = remap(difference, greatest);
            let [edge, point] = [0, 1].map(|k| (seen.features[pixel][k] - expected.features[pixel][k]).abs());
            let feature = (edge.max(point) * std::f32::consts::FRAC_1_SQRT_2).powf(FEATURE_EXPONENT);
            // §4.3. 0^0 is 1 in powf; equal colors with unequal features still differ, as in the original.
            color.powf(1.0 - feature).clamp(0.0, 1.0)
        })
        .collect();
    FlipMap { width, height, errors }
}

/// The features of a picture that the eye perceives: for each pixel the filtered color (Hunt-adjusted
/// L*a*b*) and the strengths of the edge and of the point there.
struct Seen {
    color: Vec<[f32; 3]>,
    features: Vec<[f32; 2]>,
}

/// One-dimensional kernels, `[2 * radius + 1]` each.
struct Filters {
    achromatic: Vec<f32>,
    red_green: Vec<f32>,
    /// The two Gaussians of blue-yellow, and the weight of each in the sum.
    blue_yellow: [(Vec<f32>, f32); 2],
    /// Gaussian, its first derivative and its second, for features.
    smooth: Vec<f32>,
    edge: Vec<f32>,
    point: Vec<f32>,
}

impl Filters {
    fn new(pixels_per_degree: f32) -> Self {
        let ppd = f64::from(pixels_per_degree.max(f32::MIN_POSITIVE));
        // §4.1.1: the radius of all filters is 3 standard deviations of the widest.
        let widest = CSF_BLUE_YELLOW[0].1;
        let radius = (3.0 * (widest / (2.0 * std::f64::consts::PI.powi(2))).sqrt() * ppd).ceil() as i32;
        let gaussian = |b: f64| sampled(radius, |x| (-(std::f64::consts::PI * x / ppd).powi(2) / b).exp());
        // The two-dimensional sum of a Gaussian is the square of its one-dimensional sum.
        let weight = |(a, b): (f64, f64)| {
            a * (std::f64::consts::PI / b).sqrt() * gaussian(b).iter().sum::<f64>().powi(2)
        };
        let total: f64 = CSF_BLUE_YELLOW.into_iter().map(weight).sum();

        // §4.2.1
        let sigma = 0.5 * f64::from(FEATURE_WIDTH) * ppd;
        let feature_radius = (3.0 * sigma).ceil() as i32;
        let bell = |x: f64| (-x * x / (2.0 * sigma * sigma)).exp();
        Self {
            achromatic: normalised(gaussian(CSF_ACHROMATIC.1)),
            red_green: normalised(gaussian(CSF_RED_GREEN.1)),
            blue_yellow: CSF_BLUE_YELLOW
                .map(|term| (normalised(gaussian(term.1)), (weight(term) / total) as f32)),
            smooth: normalised(sampled(feature_radius, bell)),
            edge: normalised(sampled(feature_radius, |x| -x * bell(x))),
            point: normalised(sampled(feature_radius, |x| (x * x / (sigma * sigma) - 1.0) * bell(x))),
        }
    }

    /// Computes the features of a picture. `opponent: [height * width]` YCxCz.
    fn see(&self, opponent: &[[f32; 3]], width: usize, height: usize) -> Seen {
        let plane = |k: usize| opponent.par_iter().map(|c| c[k]).collect::<Vec<f32>>();
        let blur =
            |plane: &[f32], kernel: &[f32]| columns(&rows(plane, width, kernel), width, height, kernel);

        let y = plane(0);
        let filtered_y = blur(&y, &self.achromatic);
        let filtered_cx = blur(&plane(1), &self.red_green);
        let cz = plane(2);
        let [wide, narrow] = self.blue_yellow.each_ref().map(|(kernel, _)| blur(&cz, kernel));
        let [share_wide, share_narrow] = self.blue_yellow.each_ref().map(|&(_, share)| share);
        let color = (0..y.len())
            .into_par_iter()
            .map(|p| {
                let cz = share_wide * wide[p] + share_narrow * narrow[p];
                hunt_lab_from_opponent([filtered_y[p], filtered_cx[p], cz])
            })
            .collect();

        let grey: Vec<f32> = y.par_iter().map(|y| (y + 16.0) / 116.0).collect();
        let smooth = rows(&grey, width, &self.smooth);
        let strength = |kernel: &[f32]| -> Vec<f32> {
            let across = columns(&rows(&grey, width, kernel), width, height, &self.smooth);
            let down = columns(&smooth, width, height, kernel);
            across.par_iter().zip(&down).map(|(x, y)| x.hypot(*y)).collect()
        };
        let (edge, point) = (strength(&self.edge), strength(&self.point));
        let features = edge.into_iter().zip(point).map(|(edge, point)| [edge, point]).collect();
        Seen { color, features }
    }
}

fn sampled(radius: i32, weight: impl Fn(f64) -> f64) -> Vec<f64> {
    (-radius..=radius).map(|x| weight(f64::from(x))).collect()
}

/// Scales the positive weights to a sum of 1, and the negative ones, if there are any, to a sum of −1.
fn normalised(weights: Vec<f64>) -> Vec<f32> {
    let positive: f64 = weights.iter().filter(|w| **w > 0.0).sum();
    let negative: f64 = -weights.iter().filter(|w| **w < 0.0).sum::<f64>();
    weights.into_iter().map(|w| if w > 0.0 { w / positive } else if w < 0.0 { w / negative } else { 0.0 } as f32).collect()
}

/// Filters each row; values beyond an edge are those at the edge.
fn rows(plane: &[f32], width: usize, kernel: &[f32]) -> Vec<f32> {
    let radius = kernel.len() / 2;
    let mut out = vec![0.0; plane.len()];
    out.par_chunks_mut(width).zip(plane.par_chunks(width)).for_each_init(
        || Vec::with_capacity(width + 2 * radius),
        |padded, (out, row)| {
            padded.clear();
            padded.extend(std::iter::repeat_n(row[0], radius));
            padded.extend_from_slice(row);
            padded.extend(std::iter::repeat_n(row[width - 1], radius));
            for (tap, &weight) in kernel.iter().enumerate() {
                for (out, value) in out.iter_mut().zip(&padded[tap..]) {
                    *out += weight * value;
                }
            }
        },
    );
    out
}

/// Filters each column; values beyond an edge are those at the edge.
fn columns(plane: &[f32], width: usize, height: usize, kernel: &[f32]) -> Vec<f32> {
    let radius = kernel.len() / 2;
    let mut out = vec![0.0; plane.len()];
    out.par_chunks_mut(width).enumerate().for_each(|(y, out)| {
        for (tap, &weight) in kernel.iter().enumerate() {
            let source = (y + tap).saturating_sub(radius).min(height - 1);
            for (out, value) in out.iter_mut().zip(&plane[source * width..]) {
                *out += weight * value;
            }
        }
    });
    out
}

/// Converts linear Rec. 709 to CIE XYZ relative to the white point (D65), so that white is (1, 1, 1).
fn relative_xyz([r, g, b]: [f32; 3]) -> [f32; 3] {
    [
        (0.412_386_57 * r + 0.357_591_49 * g + 0.180_450_48 * b) / WHITE[0],
        (0.212_636_82 * r + 0.715_182_98 * g + 0.072_180_2 * b) / WHITE[1],
        (0.019_330_62 * r + 0.119_197_17 * g + 0.950_372_6 * b) / WHITE[2],
    ]
}

/// XYZ of linear (1, 1, 1).
const WHITE: [f32; 3] = [0.950_428_55, 1.0, 1.088_900_4];

/// Converts relative XYZ back: the inverse of [`relative_xyz`].
fn linear_from_relative_xyz(xyz: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = [xyz[0] * WHITE[0], xyz[1] * WHITE[1], xyz[2] * WHITE[2]];
    [
        3.241_003_3 * x - 1.537_398_9 * y - 0.498_615_86 * z,
        -0.969_224_33 * x + 1.875_930_1 * y + 0.041_554_224 * z,
        0.055_639_423 * x - 0.204_011_2 * y + 1.057_149 * z,
    ]
}

/// Converts to YCxCz, the linearised L*a*b* (§4.1.1).
fn opponent_from_linear(rgb: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = relative_xyz(rgb);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Converts filtered YCxCz, clamped to the gamut of the display, to L*a*b* with the Hunt effect (§4.1.2: a
/// and b times 0.01 L).
fn hunt_lab_from_opponent([y, cx, cz]: [f32; 3]) -> [f32; 3] {
    let y = (y + 16.0) / 116.0;
    let rgb = linear_from_relative_xyz([y + cx / 500.0, y, y - cz / 200.0]);
    hunt_lab(rgb.map(|channel| channel.clamp(0.0, 1.0)))
}

fn hunt_lab(rgb: [f32; 3]) -> [f32; 3] {
    let [x, y, z] = relative_xyz(rgb).map(|t| {
        const DELTA: f32 = 6.0 / 29.0;
        if t > DELTA * DELTA * DELTA { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    });
    let lightness = 116.0 * y - 16.0;
    [lightness, 0.01 * lightness * 500.0 * (x - y), 0.01 * lightness * 200.0 * (y - z)]
}

/// Returns the HyAB distance (§4.1.3): city block in lightness, Euclidean in a and b.
fn hyab(p: [f32; 3], q: [f32; 3]) -> f32 {
    (p[0] - q[0]).abs() + (p[1] - q[1]).hypot(p[2] - q[2])
}

/// Returns the color difference between the green and the blue primary (§4.1.3).
fn greatest_color_difference() -> f32 {
    hyab(hunt_lab([0.0, 1.0, 0.0]), hunt_lab([0.0, 0.0, 1.0])).powf(COLOR_EXPONENT)
}

/// Maps a color difference to an error 0..=1, by two linear segments (§4.1.3).
fn remap(difference: f32, greatest: f32) -> f32 {
    let knee = KNEE * greatest;
    if difference < knee {
        KNEE_ERROR / knee * difference
    } else {
        KNEE_ERROR + (difference - knee) / (greatest - knee) * (1.0 - KNEE_ERROR)
    }
}
