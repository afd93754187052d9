// Takes the mean of a picture over frames, each of which is another sample of it. [Haeberli & Akeley 1990]
//
// mean_radiance and image: rgba32float. Once there are as many frames as are wanted, they stay.

#input radiance: Radiance // The picture of a frame.
#input past: RadianceMean optional // The mean so far: `prev` of the output `mean`. Without it each frame begins again.
#output image: Radiance // The mean of all frames so far.
#output mean: RadianceMean // The same, and how many frames there were.

#option PAST false // whether there is a mean of earlier frames

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
var mean_radiance: texture_storage_2d<rgba32float, write>;
var<storage, read_write> mean_progress: Progress;
var image: texture_storage_2d<rgba32float, write>;

/// Adds the frame to the mean. [sampled]
@compute @workgroup_size(8, 8)
fn accumulate(@builtin(global_invocation_id) id: vec3<u32>) {
    var before: Progress;
    var mean = vec4(0.0);
#if PAST
    before = past_progress;
#endif
    let frames = before.step + steps_of_frame(before, 1u, settings.frames);
    if all(id.xy == vec2(0u)) {
        mean_progress = Progress(frames, settings.frames, 0.0, select(0u, 1u, frames >= settings.frames));
    }
    if any(id.xy >= settings.radiance_size) {
        return;
    }
#if PAST
    mean = textureLoad(past_radiance, id.xy, 0);
#endif
    if frames > before.step {
        // A sum of equal frames would round all of them to the same side.
        mean += (textureLoad(radiance, id.xy, 0) - mean) / f32(frames);
    }
    textureStore(mean_radiance, id.xy, mean);
    textureStore(image, id.xy, mean);
}
