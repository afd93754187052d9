// Averages irradiance over a window of pixels that see the same surface. [ISM §4; ACRSM §5.3.3]
//
// The window has the size of the interleaving, so it holds each subset of the lights exactly once. A window of even
// size has no centre pixel: it takes one pixel more, and its two outermost rows and columns, which have the same
// subsets, have half the weight each. Where the window crosses the edge of the image, it continues one period further
// inside, at pixels of the same subset.
//
// filtered: rgba32float [W/m²]; all four channels are averaged alike. If separable, this runs twice: over a window of
// one row, then over a window of one column.

#import "surface-around.wgsl"

struct Settings {
    view_size: vec2<u32>,
    /// Size of the window [px].
    width: u32,
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
var filtered: texture_storage_2d<rgba32float, write>;

/// Weight of an offset along one side of a window of this many pixels.
fn window_weight(offset: i32, window: u32) -> f32 {
    return select(1.0, 0.5, window % 2u == 0u && u32(abs(offset)) * 2u == window);
}

/// A coordinate moved back into the image by one period; still outside if the image is narrower.
fn inside(at: i32, size: u32, period: u32) -> i32 {
    return at + select(0, i32(period), at < 0) - select(0, i32(period), at >= i32(size));
}

@compute @workgroup_size(8, 8)
fn blur(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = id.xy;
    if any(pixel >= settings.view_size) {
        return;
    }
    let depth = textureLoad(view_depth, pixel, 0).x;
    if depth <= 0.0 {
        textureStore(filtered, pixel, vec4(0.0));
        return;
    }
    let normal = textureLoad(view_normal, pixel, 0).xyz;
    let around = surface_around(pixel, settings.view_size, depth, normal);
    let reach = vec2(i32(settings.width), i32(settings.height)) / 2;
    var sum = vec4(0.0);
    var weights = 0.0;
    for (var y = -reach.y; y <= reach.y; y++) {
        let row = inside(i32(pixel.y) + y, settings.view_size.y, settings.height);
        let row_weight = window_weight(y, settings.height);
        for (var x = -reach.x; x <= reach.x; x++) {
            let column = inside(i32(pixel.x) + x, settings.view_size.x, settings.width);
            // As unsigned numbers, negative ones are large.
            let other = vec2(u32(column), u32(row));
            if any(other >= settings.view_size) {
                continue;
            }
            let other_depth = textureLoad(view_depth, other, 0).x;
            let off = off_plane(around, vec2(column, row), other_depth);
            let along = dot(normal, textureLoad(view_normal, other, 0).xyz);
            if other_depth <= 0.0 || off > settings.alpha || along < settings.beta {
                continue;
            }
            let weight = window_weight(x, settings.width) * row_weight;
            sum += weight * textureLoad(irradiance, other, 0);
            weights += weight;
        }
    }
    // A normal's computed length is 1 only up to rounding, so thresholds of 1 and 0 may reject even the pixel itself.
    let alone = textureLoad(irradiance, pixel, 0);
    textureStore(filtered, pixel, select(alone, sum / weights, weights > 0.0));
}
