// Averages irradiance by a wavelet filter that stops at edges of the geometry. [Dammertz et al. 2010; Lee 1980]
//
// An iteration takes 5×5 pixels `stride` apart, with the weights of a cubic B-spline, times the likeness of the surfaces that
// they see.
//
// filtered: rgba32float [W/m²]; all four channels are averaged alike.

#input view: GBuffer // Determines which pixels see the same surface.
#input irradiance: Irradiance like view // The irradiance to average; of the size of `view`.
#input mean: FrameMean optional // The irradiance as a mean over frames, with their variance: where pixels differ by more than their
    // noise, they are averaged less.
#output filtered: Irradiance // The averages.
#exact filter: input irradiance // Irradiance as it is gathered.

#option MEAN false // whether the noise of the irradiance is known

#if MEAN
#import "color.wgsl"
#endif
#import "surface-around.wgsl"

struct Settings {
    view_size: vec2<u32>,
    /// Iterations, each of which doubles the window; 0 takes as many as leave no pattern of the interleaving (the facts
    /// `interleave_x`, `interleave_y` of the input): 2 for 4, 3 for 8. More: less noise, but less detail. [default: 0, max: 8]
    iterations: u32,
    /// Distance between taps [px]: 2^i in iteration i.
    stride: u32,
    /// Distance of a pixel from the plane of the centre at which its weight falls to 1/e, as a fraction of the depth.
    /// Larger: blur across steps. Smaller: noise on curved surfaces. [default: 0.01, min: 0.0]
    plane: f32,
    /// Power of the cosine between normals. Smaller: blur across creases. Larger: noise on curved surfaces. [default: 32,
    /// min: 0.0, max: 1024.0]
    normal_power: f32,
    /// Factor on the noise of the irradiance, where `mean` is linked. More: less noise, but less detail. 0: nothing is averaged where
    /// there are two frames. [default: 2.0, min: 0.0, max: 1000.0]
    noise: f32,
    /// 1 for the last iteration.
    last: u32,
}

var<uniform> settings: Settings;
/// The irradiance, or what the iteration before has made of it.
var source: texture_2d<f32>;
#if MEAN
var irradiance: texture_2d<f32>;
var mean_frames: texture_2d<f32>;
#endif
var filtered: texture_storage_2d<rgba32float, write>;

/// The cubic B-spline at offsets of 0, 1 and 2.
const SPLINE = array<f32, 3>(0.375, 0.25, 0.0625);

/// A pixel of the window.
struct Tap {
    pixel: vec2<i32>,
    /// 0 outside of the view.
    weight: f32,
}

/// Returns the pixel so many strides from the centre. The centre is like itself, whatever rounding says, so weights never sum to zero.
fn tap_at(around: SurfaceAround, x: i32, y: i32) -> Tap {
    let pixel = around.pixel + vec2(x, y) * i32(settings.stride);
    if any(pixel < vec2(0)) || any(pixel >= vec2<i32>(settings.view_size)) {
        return Tap(pixel, 0.0);
    }
    let is_centre = x == 0 && y == 0;
    let alike = select(likeness(around, pixel, settings.plane, settings.normal_power), 1.0, is_centre);
    return Tap(pixel, SPLINE[abs(x)] * SPLINE[abs(y)] * alike);
}

#if MEAN
/// The share of noise in how pixels around one differ from their average: what is left of the filter there. Where all have one frame,
/// nothing is known of their noise, and it is 1. [Lee 1980]
fn share_of_noise(around: SurfaceAround, average: f32) -> f32 {
    var spread = 0.0;
    var noise = 0.0;
    var known = 0.0;
    for (var y = -2; y <= 2; y++) {
        for (var x = -2; x <= 2; x++) {
            let tap = tap_at(around, x, y);
            let frames = textureLoad(mean_frames, tap.pixel, 0).xy;
            if tap.weight <= 0.0 || frames.x <= 1.0 {
                continue;
            }
            let away = luminance(textureLoad(irradiance, tap.pixel, 0).rgb) - average;
            spread += tap.weight * away * away;
            noise += tap.weight * frames.y / (frames.x - 1.0);
            known += tap.weight;
        }
    }
    return select(min(settings.noise * noise / max(spread, 1e-37), 1.0), 1.0, known <= 0.0);
}
#endif

/// Averages once more. In the last iteration the average takes its share.
@compute @workgroup_size(8, 8)
fn smooth_once(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = id.xy;
    if any(pixel >= settings.view_size) {
        return;
    }
    let depth = textureLoad(view_depth, pixel, 0).x;
    if depth <= 0.0 {
        textureStore(filtered, pixel, vec4(0.0));
        return;
    }
    let normal = normalize(textureLoad(view_normal, pixel, 0).xyz);
    let around = surface_around(pixel, settings.view_size, depth, normal);
    let own = tap_at(around, 0, 0).weight;
    var sum = own * textureLoad(source, pixel, 0);
    var weights = own;
    for (var y = -2; y <= 2; y++) {
        for (var x = -2; x <= 2; x++) {
            let tap = tap_at(around, x, y);
            if tap.weight <= 0.0 || (x == 0 && y == 0) {
                continue;
            }
            sum += tap.weight * textureLoad(source, tap.pixel, 0);
            weights += tap.weight;
        }
    }
    var average = sum / weights;
#if MEAN
    if settings.last != 0u {
        let single = textureLoad(irradiance, pixel, 0);
        average = mix(single, average, share_of_noise(around, luminance(average.rgb)));
    }
#endif
    textureStore(filtered, pixel, average);
}
