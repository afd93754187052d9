// Averages interleaved irradiance over pixels of one surface. [ISM §4, ACRSM §5.3.3]
//
// The window has the size of the interleaving, so it holds each subset of the lights exactly once. A window of even
// size has no centre pixel: it takes one pixel more, and its two outermost rows and columns, which have the same
// subsets, have half the weight each. Where the window crosses the edge of the image, it continues one period further
// inside, at pixels of the same subset.
//
// filtered: rgba32float [W/m²]; all four channels are averaged alike.

#input view: GBuffer // Determines which pixels see the same surface.
#input irradiance: Irradiance like view // The irradiance to average; of the size of `view`.
#output filtered: Irradiance // The averages.
#exact filter: input irradiance // Irradiance as it is gathered.

#option SEPARABLE true // Whether to filter rows first, then columns, which reads width + height pixels in place of
    // width · height. The result differs only where pixels are rejected.

#import "surface-around.wgsl"

struct Settings {
    view_size: vec2<u32>,
    irradiance_interleave_x: u32,
    irradiance_interleave_y: u32,
    /// Width of the window; 0 takes the interleaving of the input (the fact `interleave_x` of its output metadata).
    /// Multiples of the interleaving leave no pattern. Larger: less noise, but less detail. [default: 0, max: 64, unit: "px"]
    width: u32,
    /// Height of the window; 0 takes the interleaving of the input (the fact `interleave_y` of its output metadata).
    /// [default: 0, max: 64, unit: "px"]
    height: u32,
    /// Greatest distance of a pixel from the plane of the centre pixel, as a fraction of its depth (ACRSM gives none).
    /// Larger: blur across steps. Smaller: noise on curved surfaces. [default: 0.02, min: 0.0]
    alpha: f32,
    /// Least cosine between the normals of a pixel and of the centre pixel (ACRSM gives none). Smaller: blur across
    /// creases. Larger: noise on curved surfaces. [default: 0.9, min: -1.0, max: 1.0]
    beta: f32,
}

var<uniform> settings: Settings;
var irradiance: texture_2d<f32>;
#if SEPARABLE
/// Averages along rows. [scratch]
var rows: texture_storage_2d<rgba32float, write>;
/// [reads: rows]
var averaged_rows: texture_2d<f32>;
#endif
var filtered: texture_storage_2d<rgba32float, write>;

/// Size of the window [px]; without interleaving, one pixel.
fn window_size() -> vec2<u32> {
    let interleave = vec2(settings.irradiance_interleave_x, settings.irradiance_interleave_y);
    let given = vec2(settings.width, settings.height);
    return max(select(given, interleave, given == vec2(0u)), vec2(1u));
}

/// Weight of an offset along one side of a window of this many pixels.
fn window_weight(offset: i32, window: u32) -> f32 {
    return select(1.0, 0.5, window % 2u == 0u && u32(abs(offset)) * 2u == window);
}

/// A coordinate moved back into the image by one period; still outside if the image is narrower.
fn inside(at: i32, size: u32, period: u32) -> i32 {
    return at + select(0, i32(period), at < 0) - select(0, i32(period), at >= i32(size));
}

/// The average over a window around a pixel.
fn average(values: texture_2d<f32>, pixel: vec2<u32>, window: vec2<u32>) -> vec4<f32> {
    let depth = textureLoad(view_depth, pixel, 0).x;
    if depth <= 0.0 {
        return vec4(0.0);
    }
    let normal = textureLoad(view_normal, pixel, 0).xyz;
    let around = surface_around(pixel, settings.view_size, depth, normal);
    let reach = vec2<i32>(window) / 2;
    var sum = vec4(0.0);
    var weights = 0.0;
    for (var y = -reach.y; y <= reach.y; y++) {
        let row = inside(i32(pixel.y) + y, settings.view_size.y, window.y);
        let row_weight = window_weight(y, window.y);
        for (var x = -reach.x; x <= reach.x; x++) {
            let column = inside(i32(pixel.x) + x, settings.view_size.x, window.x);
            // As unsigned numbers, negative ones are large.
            let other = vec2(u32(column), u32(row));
            if any(other >= settings.view_size) {
                continue;
            }
            if !is_same_surface(around, vec2(column, row), settings.alpha, settings.beta) {
                continue;
            }
            let weight = window_weight(x, window.x) * row_weight;
            sum += weight * textureLoad(values, other, 0);
            weights += weight;
        }
    }
    // A normal's computed length is 1 only up to rounding, so thresholds of 1 and 0 may reject even the pixel itself.
    let alone = textureLoad(values, pixel, 0);
    return select(alone, sum / weights, weights > 0.0);
}

#if SEPARABLE
@compute @workgroup_size(8, 8)
fn blur_rows(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < settings.view_size) {
        textureStore(rows, id.xy, average(irradiance, id.xy, vec2(window_size().x, 1u)));
    }
}

@compute @workgroup_size(8, 8)
fn blur_columns(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < settings.view_size) {
        textureStore(filtered, id.xy, average(averaged_rows, id.xy, vec2(1u, window_size().y)));
    }
}
#else
@compute @workgroup_size(8, 8)
fn blur(@builtin(global_invocation_id) id: vec3<u32>) {
    if all(id.xy < settings.view_size) {
        textureStore(filtered, id.xy, average(irradiance, id.xy, window_size()));
    }
}
#endif
