// Measures progress: counts the samples of the picture, and estimates its error from their variance.
//
// relMSE = mean over the pixels of σ² / (m² + ε), where σ² is the variance of a pixel's mean luminance, m that luminance
// without noise, and ε a hundredth of the squared mean of the picture, as in `lightloom compare`.
//
// σ² is estimated from the pixel's own samples, and m from the pixels around it, without itself. Both must not contain
// the same samples: a rare bright path adds its square to σ² and to the square of the pixel's own mean alike, and the
// error of such a pixel would never seem to be above 1, however bright it is.

#option PAST false // whether there are samples of earlier frames
#option SUM error one_of [luminance, error] internal // what is summed over the pixels: the second needs the first

#import "algorithms/sum-f32.wgsl"
#import "color.wgsl"
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
#endif

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

/// Means over the samples of a pixel, and in alpha the sum of their squared deviations.
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

fn reduce_element(i: u32) -> f32 {
    let samples = samples_so_far();
    // In units of the picture's mean, so that values neither vanish nor overflow at any intensity of the lights.
    let mean = max(luminance_sum / f32(reduce_length()), 1e-30);
    let variance = pixel(i).a / f32(max(samples, 1u)) / mean / mean / f32(max(samples, 2u) - 1u);
    let around = luminance_around(i) / mean;
    return variance / (around * around + 0.01);
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

fn reduce_store(result: f32) {
    let before = progress_before();
    let samples = samples_so_far();
    let error = result / f32(reduce_length());
    let estimated = select(0.0, error, samples >= 2u);
    // A few samples that are all black would look like no error at all.
    let good = samples >= 16u && error <= settings.error && settings.error > 0.0;
    let finished = before.done != 0u || samples >= settings.samples || good;
    samples_progress = Progress(samples, settings.samples, estimated, select(0u, 1u, finished));
}
#endif
