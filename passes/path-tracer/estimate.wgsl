// Measures progress: counts the samples of the picture, and estimates its error from how much its mean has moved since there were
// half as many.
//
// relMSE = mean over the pixels of (m - µ)² / (µ² + ε), where m is the luminance of a pixel's mean, µ that without noise, and ε a
// hundredth of the squared mean of the picture, as in `lightloom compare`. Where a sequence is as good in any of its parts, the mean
// square of what m moves by from N to r N samples is the variance at N less that at r N, so r - 1 times the latter where variance
// falls as 1/N. The variance of single samples would not tell how much better a scrambled sequence is.
//
// µ is taken as the median of the means of both halves and that of the pixels around: a rare bright path is in one of the three,
// and the error of a pixel that has one would never seem to be above 1 if it were in µ as well.
//
// Where few pixels have most of the sum, there are paths that others have not met yet, and the error cannot be known.

#option PAST false // whether there are samples of earlier frames
#option SUM error one_of [luminance, error] internal // what is summed over the pixels: the second needs the first

#if SUM == luminance
#import "algorithms/sum-f32.wgsl"
#else
#import "algorithms/sum-vec4.wgsl"
#endif
#import "color.wgsl"
#import "path-samples.wgsl"
#import "progress.wgsl"

struct Settings {
    samples_size: vec2<u32>,
    samples: u32,
    samples_per_frame: u32,
    error: f32,
}

var<uniform> settings: Settings;
var samples_image: texture_2d<f32>;
#if PAST
var<storage, read> past_progress: Progress;
var<storage, read> past_halves: Halves;
#endif

/// The fewest samples for which the estimate is known: with 64 and more it was within a quarter of the error in ten scenes of eleven
/// (docs/results/error-estimate.md).
const LEAST_SAMPLES: u32 = 64u;

/// The most that it may scatter for it to be known: its standard error over the pixels, relative to itself.
const MOST_SCATTER: f32 = 0.25;

/// The progress before this frame.
fn progress_before() -> Progress {
    var before: Progress;
#if PAST
    before = past_progress;
#endif
    return before;
}

/// Samples per pixel, this frame included.
fn samples_so_far() -> u32 {
    let before = progress_before();
    return before.step + steps_of_frame(before, settings.samples_per_frame, settings.samples);
}

/// Mean over the samples of a pixel, and in alpha the luminance of its first half.
fn pixel(index: u32) -> vec4<f32> {
    let width = settings.samples_size.x;
    return textureLoad(samples_image, vec2(index % width, index / width), 0);
}

fn reduce_length() -> u32 {
    return settings.samples_size.x * settings.samples_size.y;
}

#if SUM == luminance
/// Sum over all pixels.
var<storage, read_write> luminance_sum: f32;

fn reduce_element(i: u32) -> f32 {
    return luminance(pixel(i).rgb);
}

fn reduce_store(result: f32) {
    luminance_sum = result;
}
#else
var<storage, read> luminance_sum: f32;
var<storage, read_write> samples_progress: Progress;
var<storage, read_write> samples_halves: Halves;

/// When samples were last twice as many as before, before this frame.
fn halves_before() -> Halves {
    var before: Halves;
#if PAST
    before = past_halves;
#endif
    return before;
}

/// Samples over those of the first half.
fn growth() -> f32 {
    return f32(samples_so_far()) / f32(max(halves_before().samples, 1u));
}

/// The squared error of a pixel, and its square.
fn reduce_element(i: u32) -> vec4<f32> {
    // In units of the picture's mean, so that values neither vanish nor overflow at any intensity of the lights.
    let mean = max(luminance_sum / f32(reduce_length()), 1e-30);
    let pixel = pixel(i);
    let all = luminance(pixel.rgb) / mean;
    let first = pixel.a / mean;
    let grown = max(growth() - 1.0, 1e-6);
    let second = max(all + (all - first) / grown, 0.0);
    let around = luminance_around(i) / mean;
    let true_mean = max(min(first, second), min(max(first, second), around));
    let error = (all - first) * (all - first) / grown / (true_mean * true_mean + 0.01);
    return vec4(error, error * error, 0.0, 0.0);
}

/// Mean luminance of the up to eight pixels around one; its own where it is the only one of the frame.
fn luminance_around(index: u32) -> f32 {
    let size = vec2<i32>(settings.samples_size);
    let centre = vec2<i32>(vec2(index % settings.samples_size.x, index / settings.samples_size.x));
    var sum = 0.0;
    var count = 0u;
    for (var y = max(centre.y - 1, 0); y <= min(centre.y + 1, size.y - 1); y++) {
        for (var x = max(centre.x - 1, 0); x <= min(centre.x + 1, size.x - 1); x++) {
            if x != centre.x || y != centre.y {
                sum += luminance(textureLoad(samples_image, vec2(x, y), 0).rgb);
                count++;
            }
        }
    }
    return select(sum / f32(max(count, 1u)), luminance(pixel(index).rgb), count == 0u);
}

fn reduce_store(result: vec4<f32>) {
    let before = progress_before();
    let samples = samples_so_far();
    var halves = halves_before();
    if halves.samples == 0u {
        halves.samples = samples;
    } else if samples >= 2u * halves.samples {
        let is_known = samples >= LEAST_SAMPLES && sqrt(result.y) <= MOST_SCATTER * result.x;
        halves = Halves(samples, select(-1.0, result.x / f32(reduce_length()), is_known));
    }
    let error = halves.error * f32(halves.samples) / f32(max(samples, 1u));
    // A few samples that are all black would look like no error at all.
    let good = samples >= LEAST_SAMPLES && error >= 0.0 && error <= settings.error && settings.error > 0.0;
    let finished = before.done != 0u || samples >= settings.samples || good;
    samples_halves = halves;
    samples_progress = Progress(samples, settings.samples, error, select(0u, 1u, finished));
}
#endif
