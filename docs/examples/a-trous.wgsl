// One iteration of the edge-avoiding à-trous wavelet transform. [Dammertz et al. 2010]
//
// The B3 spline, 5×5 taps with 2^level - 1 pixels between them, each weighted by how much it may be of the same
// surface and the same light as the pixel itself. Iterations 0 to 4 together reach 62 pixels to each side.

#import "camera.wgsl"

#option EDGES all one_of [all, geometry] // what the filter stops at: edges of geometry and of light, or of geometry alone

struct Settings {
    /// Number of the iteration: taps are 2^level pixels apart. [default: 0, max: 12]
    level: u32,
    /// Difference of luminance, relative to the sum of both, at which a tap's weight has fallen to 1/e in iteration 0. It
    /// is halved with each iteration (§2.3), as noise is by then. More blurs shadows, less leaves noise. [default: 0.5, min: 0.01]
    sigma_irradiance: f32,
    /// Length of the difference of unit normals at which a tap's weight has fallen to 1/e. [default: 0.35, min: 0.001]
    sigma_normal: f32,
    /// Distance from the tangent plane, as a fraction of the depth, at which a tap's weight has fallen to 1/e.
    /// [default: 0.02, min: 0.00001]
    sigma_plane: f32,
}

var<uniform> settings: Settings;
var view_depth: texture_2d<f32>;
var view_normal: texture_2d<f32>;
var irradiance: texture_2d<f32>;
var smoothed: texture_storage_2d<rgba32float, write>;

/// 1/e where `difference` is `sigma`.
fn edge_weight(difference: f32, sigma: f32) -> f32 {
    let ratio = difference / sigma;
    return exp(-ratio * ratio);
}

fn luminance(color: vec3<f32>) -> f32 {
    return dot(color, vec3(0.2126, 0.7152, 0.0722));
}

@compute @workgroup_size(8, 8)
fn smooth_once(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(smoothed);
    if any(id.xy >= size) {
        return;
    }
    let depth = textureLoad(view_depth, id.xy, 0).x;
    let center = textureLoad(irradiance, id.xy, 0);
    if depth <= 0.0 {
        textureStore(smoothed, id.xy, vec4(0.0));
        return;
    }
    let normal = textureLoad(view_normal, id.xy, 0).xyz;
    let position = position_from_depth(id.xy, textureDimensions(view_depth), depth);
    let light = luminance(center.rgb);
    let kernel = array(3.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0);
    let step = i32(1u << settings.level);
    var sum = vec4(0.0);
    var weights = 0.0;
    for (var y = -2; y <= 2; y++) {
        for (var x = -2; x <= 2; x++) {
            let at = vec2<i32>(id.xy) + step * vec2(x, y);
            if any(at < vec2(0)) || any(at >= vec2<i32>(size)) {
                continue;
            }
            let tap = vec2<u32>(at);
            let tap_depth = textureLoad(view_depth, tap, 0).x;
            if tap_depth <= 0.0 {
                continue;
            }
            let tap_normal = textureLoad(view_normal, tap, 0).xyz;
            let tap_color = textureLoad(irradiance, tap, 0);
            let off_plane = dot(normal, position_from_depth(tap, textureDimensions(view_depth), tap_depth) - position) / depth;
            var weight = kernel[abs(x)] * kernel[abs(y)]
                * edge_weight(length(tap_normal - normal), settings.sigma_normal)
                * edge_weight(off_plane, settings.sigma_plane);
#if EDGES == all
            let tap_light = luminance(tap_color.rgb);
            // Black beside black differs by nothing.
            let contrast = (tap_light - light) / max(tap_light + light, 1e-30);
            weight *= edge_weight(contrast, settings.sigma_irradiance / f32(step));
#endif
            sum += weight * tap_color;
            weights += weight;
        }
    }
    // The middle tap alone gives 9/64.
    textureStore(smoothed, id.xy, sum / weights);
}
