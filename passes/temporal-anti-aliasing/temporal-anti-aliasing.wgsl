// Smooths edges over frames with other places within the pixels, along the motion of what pixels show. [Karis 2014; Salvi 2016]

#input radiance: Radiance // The picture of a frame.
#input reprojection: Reprojection like radiance // Where what each pixel shows was.
#input still: Progress optional // Frames since lights or geometry have moved. Without it, none ever has.
#input past: FrameMean optional // The mean so far: `prev` of the output `mean`. Without it each frame begins again.
#output image: Radiance // The mean of the frames so far.
#output mean: FrameMean // The same, and of how many frames it is the mean at each pixel.

#option PAST false // whether there is a mean of earlier frames
#option STILL false // whether `still` is linked

#if PAST
#import "frame-mean.wgsl"
#endif
#import "progress.wgsl"

struct Settings {
    radiance_size: vec2<u32>,
#if PAST && STILL
    past_age: u32,
#endif
    /// The most frames that a mean is of where nothing moves. More: smoother edges. [default: 64, min: 1, max: 65536]
    frames: u32,
    /// The same where anything moves. More: smoother edges, but less sharp. [default: 4, min: 1, max: 65536]
    moving_frames: u32,
    /// How far the mean may be from what the new frame has around a pixel where anything moves, in standard deviations. More:
    /// smoother edges, but more of what is no longer there. [default: 1.0, min: 0.0, max: 1000.0]
    deviations: f32,
}

var<uniform> settings: Settings;
var radiance: texture_2d<f32>;
#if PAST && STILL
var<storage, read> still: Progress;
#endif
var mean_value: texture_storage_2d<rgba32float, write>;
var mean_frames: texture_storage_2d<rg32float, write>;
var image: texture_storage_2d<rgba32float, write>;

#if PAST
/// Whether anything moves, or has while frames before are still a part of the mean.
fn moves() -> bool {
#if STILL
    return !stands_still() || still.step < min(settings.past_age, 2u * settings.moving_frames);
#else
    return !stands_still();
#endif
}
#endif

/// Adds the frame to the mean. [sampled]
@compute @workgroup_size(8, 8)
fn accumulate(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= settings.radiance_size) {
        return;
    }
    let now = textureLoad(radiance, id.xy, 0);
    var mean = now;
    var frames = 1.0;
    var variance = 0.0;
#if PAST
    // Where there is no history, it is of no frames.
    var before = mean_before(id.xy);
    if before.frames > 0.0 {
        var most = settings.frames;
        if moves() {
            most = min(most, settings.moving_frames);
            before.value = near_frame(before.value, radiance, id.xy, settings.deviations);
        }
        let with_now = with_frame(before, now, most);
        mean = with_now.value;
        frames = with_now.frames;
        variance = with_now.variance;
    }
#endif
    textureStore(mean_value, id.xy, mean);
    textureStore(mean_frames, id.xy, vec4(frames, variance, 0.0, 0.0));
    textureStore(image, id.xy, mean);
}
