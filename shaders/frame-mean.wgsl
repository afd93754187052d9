// A mean over frames that follows what pixels show. [Nehab et al. 2007; Salvi 2016]

#import "color.wgsl"
#import "reprojection.wgsl"

var reprojection_place: texture_2d<f32>;
var reprojection_texels: texture_2d<u32>;
var past_value: texture_2d<f32>;
var past_frames: texture_2d<f32>;

/// A mean over frames.
struct FrameMean {
    value: vec4<f32>,
    /// 0 where there is none.
    frames: f32,
    /// Of the luminance of the frames.
    variance: f32,
}

/// The least weight of texels that count as a mean.
const LEAST_WEIGHT: f32 = 0.01;

/// The weights of four texels in a row, by how far the place is from the second to the third. [Keys 1981, a = -1/2]
fn cubic_weights(share: f32) -> vec4<f32> {
    let s = share;
    let r = 1.0 - share;
    return vec4(-0.5 * s * r * r, 1.0 + s * s * (1.5 * s - 2.5), 1.0 + r * r * (1.5 * r - 2.5), -0.5 * r * s * s);
}

/// The mean before at a pixel. It is interpolated among the texels that show the pixel's surface, by a cubic where all do.
fn mean_before(pixel: vec2<u32>) -> FrameMean {
    let texels = textureLoad(reprojection_texels, pixel, 0).x;
    let place = textureLoad(reprojection_place, pixel, 0).xy;
    let first = vec2<i32>(floor(place - 0.5));
    let share = place - 0.5 - vec2<f32>(first);
    var linear = vec4(0.0);
    var frames = vec2(0.0);
    var weights = 0.0;
    var least = vec4(FAR);
    var most = vec4(-FAR);
    for (var t = 0u; t < 4u; t++) {
        let at = vec2(t & 1u, t >> 1u);
        let by_side = select(1.0 - share, share, at == vec2(1u));
        let weight = by_side.x * by_side.y;
        if (texels & (1u << t)) == 0u || weight <= 0.0 {
            continue;
        }
        let texel = first + vec2<i32>(at);
        let found = textureLoad(past_value, texel, 0);
        linear += weight * found;
        frames += weight * textureLoad(past_frames, texel, 0).xy;
        weights += weight;
        least = min(least, found);
        most = max(most, found);
    }
    if weights < LEAST_WEIGHT {
        return FrameMean(vec4(0.0), 0.0, 0.0);
    }
    let size = vec2<i32>(textureDimensions(past_value));
    frames /= weights;
    if (texels & ALL_TEXELS) != ALL_TEXELS || all(share == vec2(0.0)) || any(first < vec2(1)) || any(first + 2 >= size) {
        return FrameMean(linear / weights, frames.x, frames.y);
    }
    let columns = cubic_weights(share.x);
    let rows = cubic_weights(share.y);
    var cubic = vec4(0.0);
    for (var y = 0; y < 4; y++) {
        for (var x = 0; x < 4; x++) {
            cubic += columns[x] * rows[y] * textureLoad(past_value, first + vec2(x - 1, y - 1), 0);
        }
    }
    // A cubic overshoots at edges.
    return FrameMean(clamp(cubic, least, most), frames.x, frames.y);
}

const FAR: f32 = 3e38;

/// Whether neither camera nor lights nor geometry have moved since the frame before.
fn stands_still() -> bool {
    return (textureLoad(reprojection_texels, vec2(0u), 0).x & STANDS_STILL) != 0u;
}

/// A mean of earlier frames, moved to within so many standard deviations of the mean of the nine pixels around one.
fn near_frame(before: vec4<f32>, frame: texture_2d<f32>, pixel: vec2<u32>, deviations: f32) -> vec4<f32> {
    let last = vec2<i32>(textureDimensions(frame)) - 1;
    let centre = textureLoad(frame, pixel, 0);
    var sum = vec4(0.0);
    var squares = vec4(0.0);
    for (var i = 0; i < 9; i++) {
        let other = clamp(vec2<i32>(pixel) + vec2(i % 3 - 1, i / 3 - 1), vec2(0), last);
        let away = textureLoad(frame, other, 0) - centre;
        sum += away;
        squares += away * away;
    }
    let mean = sum / 9.0;
    let spread = deviations * sqrt(max(squares / 9.0 - mean * mean, vec4(0.0)));
    return clamp(before, centre + mean - spread, centre + mean + spread);
}

/// The mean of at most so many frames, with one frame more. [Welford 1962]
fn with_frame(before: FrameMean, now: vec4<f32>, most: u32) -> FrameMean {
    let frames = min(before.frames + 1.0, f32(most));
    let away = luminance(now.rgb - before.value.rgb);
    let variance = (1.0 - 1.0 / frames) * (before.variance + away * away / frames);
    return FrameMean(before.value + (now - before.value) / frames, frames, variance);
}
