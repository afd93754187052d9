// Adds a frame's radiance to the sum over the frames before, and takes the mean.
//
// sum_radiance: rgba32float, sum over frames; image: rgba32float, the mean. Once there are as many frames as are wanted,
// both stay.

#option PAST false // whether there is a sum of earlier frames

#import "progress.wgsl"

struct Settings {
    radiance_size: vec2<u32>,
    /// Frames after which the picture is done. [default: 64, min: 1, max: 1048576]
    frames: u32,
}

var<uniform> settings: Settings;
var radiance: texture_2d<f32>;
#if PAST
var past_radiance: texture_2d<f32>;
var<storage, read> past_progress: Progress;
#endif
var sum_radiance: texture_storage_2d<rgba32float, write>;
var<storage, read_write> sum_progress: Progress;
var image: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn accumulate(@builtin(global_invocation_id) id: vec3<u32>) {
    var before: Progress;
    var sum = vec4(0.0);
#if PAST
    before = past_progress;
#endif
    let frames = before.step + steps_of_frame(before, 1u, settings.frames);
    if all(id.xy == vec2(0u)) {
        sum_progress = Progress(frames, settings.frames, 0.0, select(0u, 1u, frames >= settings.frames));
    }
    if any(id.xy >= settings.radiance_size) {
        return;
    }
#if PAST
    sum = textureLoad(past_radiance, id.xy, 0);
#endif
    if frames > before.step {
        sum += textureLoad(radiance, id.xy, 0);
    }
    textureStore(sum_radiance, id.xy, sum);
    textureStore(image, id.xy, sum / f32(max(frames, 1u)));
}
