// Where each pixel's surface was in the frame before, minus where it is [px]. The scene is assumed to stand still.

#import "camera.wgsl"
#import "fullscreen.wgsl"

var view_depth: texture_2d<f32>;

@fragment
fn motion(@builtin(position) at: vec4<f32>) -> @location(0) vec2<f32> {
    let pixel = vec2<u32>(at.xy);
    let depth = textureLoad(view_depth, pixel, 0).x;
    if depth == 0.0 {
        return vec2(0.0);
    }
    let clip = camera.previous_clip_from_world * vec4(position_from_depth(pixel, depth), 1.0);
    // A point behind the previous camera was nowhere in its frame: the motion is larger than the frame.
    if clip.w <= 0.0 {
        return 2.0 * camera.size;
    }
    let before = (clip.xy / clip.w * vec2(0.5, -0.5) + 0.5) * camera.size;
    return before - at.xy;
}
