// Takes the mean of irradiance over frames, along the motion of surfaces. [Nehab et al. 2007; Schied et al. 2017]
//
// Each frame has other virtual lights and another place within the pixels. The mean begins again where a surface comes into
// view.

#input irradiance: Irradiance // The irradiance of a frame.
#input reprojection: Reprojection like irradiance // Where the surface of each pixel was.
#input still: Progress optional // Frames since lights or geometry have moved. Without it, none ever has.
#input past: FrameMean optional // The mean so far: `prev` of the output `mean`. Without it each frame begins again.
#output accumulated: Irradiance // The mean of the frames so far.
#output mean: FrameMean // The same, and of how many frames it is the mean at each pixel.

#option PAST false // whether there is a mean of earlier frames
#option STILL false // whether `still` is linked

#if PAST
#import "frame-mean.wgsl"
#endif
#import "progress.wgsl"

struct Settings {
    irradiance_size: vec2<u32>,
#if PAST && STILL
    past_age: u32,
#endif
    /// The most frames that a mean is of. More: less noise, but less detail while the camera moves. [default: 64, min: 1,
    /// max: 65536]
    frames: u32,
    /// The same in a frame in which lights or geometry have moved. More: less noise, but light follows later. [default: 2,
    /// min: 1, max: 65536]
    changed_frames: u32,
    /// How far the mean may be from what the new frame has around a pixel, in a frame in which lights or geometry have moved, in
    /// standard deviations. More: less noise, but light follows later. [default: 1.0, min: 0.0, max: 1000.0]
    deviations: f32,
}

var<uniform> settings: Settings;
var irradiance: texture_2d<f32>;
#if PAST && STILL
var<storage, read> still: Progress;
#endif
var mean_value: texture_storage_2d<rgba32float, write>;
var mean_frames: texture_storage_2d<rg32float, write>;
var accumulated: texture_storage_2d<rgba32float, write>;

/// Adds the frame to the mean. [sampled]
@compute @workgroup_size(8, 8)
fn accumulate(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= settings.irradiance_size) {
        return;
    }
    let now = textureLoad(irradiance, id.xy, 0);
    var mean = now;
    var frames = 1.0;
    var variance = 0.0;
#if PAST
    // Where there is no history, it is of no frames.
    var before = mean_before(id.xy);
    if before.frames > 0.0 {
        var most = settings.frames;
#if STILL
        // What is left of the light before goes with the square of the number of frames.
        if still.step < settings.past_age {
            most = min(most, settings.changed_frames + still.step / 2u);
        }
        if still.step == 0u {
            before.value = near_frame(before.value, irradiance, id.xy, settings.deviations);
        }
#endif
        let with_now = with_frame(before, now, most);
        mean = with_now.value;
        frames = with_now.frames;
        variance = with_now.variance;
    }
#endif
    textureStore(mean_value, id.xy, mean);
    textureStore(mean_frames, id.xy, vec4(frames, variance, 0.0, 0.0));
    textureStore(accumulated, id.xy, mean);
}
