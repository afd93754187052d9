// Sees how far the picture is: counts its samples, and estimates its error from their spread.
//
// relMSE = mean over the pixels of σ² / (m² + ε), where m is a pixel's mean luminance, σ² the variance of that mean,
// and ε a hundredth of the squared mean of the picture, as in `lightloom compare`.

#option PAST false // whether there are samples of earlier frames

#import "color.wgsl"
#import "path-progress.wgsl"

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
var<storage, read_write> samples_progress: Progress;

const THREADS: u32 = 256u;
var<workgroup> partial: array<f32, THREADS>;

/// The sum of what each thread brings.
fn sum(local: u32, value: f32) -> f32 {
    partial[local] = value;
    for (var half = THREADS / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if local < half {
            partial[local] += partial[local + half];
        }
    }
    let total = workgroupUniformLoad(&partial[0]);
    workgroupBarrier();
    return total;
}

fn pixel(index: u32) -> vec4<f32> {
    let width = settings.samples_size.x;
    return textureLoad(samples_image, vec2(index % width, index / width), 0);
}

@compute @workgroup_size(THREADS)
fn estimate(@builtin(local_invocation_index) local: u32) {
    var before: Progress;
#if PAST
    before = past_progress;
#endif
    let samples = before.samples + samples_of_frame(before, settings.samples_per_frame, settings.samples);
    let pixels = settings.samples_size.x * settings.samples_size.y;
    // In units of the picture's mean: neither vanishes nor overflows at any intensity of the lights.
    var mine = 0.0;
    for (var i = local; i < pixels; i += THREADS) {
        mine += luminance(pixel(i).rgb);
    }
    let mean = max(sum(local, mine) / f32(pixels) / f32(max(samples, 1u)), 1e-30);
    mine = 0.0;
    for (var i = local; i < pixels; i += THREADS) {
        let sums = pixel(i) / f32(max(samples, 1u));
        let own = luminance(sums.rgb) / mean;
        let variance = max(sums.a / mean / mean - own * own, 0.0) / f32(max(samples, 2u) - 1u);
        mine += variance / (own * own + 0.01);
    }
    let error = sum(local, mine) / f32(pixels);
    if local == 0u {
        let estimated = select(0.0, error, samples >= 2u);
        // A few samples all in the dark would look like no error at all.
        let good = samples >= 16u && error <= settings.error && settings.error > 0.0;
        let finished = before.done != 0u || samples >= settings.samples || good;
        samples_progress = Progress(samples, estimated, select(0u, 1u, finished), settings.samples);
    }
}
