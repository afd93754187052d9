// Where what each pixel shows was in the frame before.

#option MOTION false // Whether the G-buffer has the member `motion`: takes one more draw over the frame, or of a scene whose
    // geometry moves.
#option MOVING_GEOMETRY false // whether any geometry of the scene moves

#if MOTION
#import "camera.wgsl"
#if MOVING_GEOMETRY
#import "scene.wgsl"
#import "surface-fragment.wgsl"
#else
#import "fullscreen.wgsl"
#endif

struct Settings {
    view_size: vec2<u32>,
}

var<uniform> settings: Settings;
var view_depth: texture_2d<f32>;

/// The position of a pixel's surface in the frame before, minus its position now [px]; `way` is how far the surface itself was
/// from where it is [m].
fn motion(pixel: vec2<u32>, way: vec3<f32>) -> vec2<f32> {
    let depth = textureLoad(view_depth, pixel, 0).x;
    if depth == 0.0 {
        return vec2(0.0);
    }
    let clip = camera.previous_clip_from_world * vec4(position_from_depth(pixel, settings.view_size, depth) + way, 1.0);
    let size = vec2<f32>(settings.view_size);
    // A point behind the previous camera was nowhere in its frame: the motion is larger than the frame.
    if clip.w <= 0.0 {
        return 2.0 * size;
    }
    let before = (clip.xy / clip.w * vec2(0.5, -0.5) + 0.5) * size;
    return before - (vec2<f32>(pixel) + 0.5);
}

#if MOVING_GEOMETRY
struct Moved {
    @builtin(position) @invariant clip: vec4<f32>,
    /// From where it is to where it was [m].
    @location(0) way: vec3<f32>,
    /// Relative to the camera [m].
    @location(1) offset: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) @interpolate(flat) material: u32,
}

@vertex
fn project_moved(vertex: Attributes, @builtin(vertex_index) index: u32) -> Moved {
    let before = vec3(
        scene_previous_positions[3u * index],
        scene_previous_positions[3u * index + 1u],
        scene_previous_positions[3u * index + 2u],
    );
    let clip = camera.clip_from_world * vec4(vertex.position, 1.0);
    let offset = vertex.position - camera.position;
    return Moved(clip, before - vertex.position, offset, vertex.uv, vertex.material);
}

@fragment
fn view_motion(moved: Moved) -> @location(0) vec2<f32> {
    // Where the material is cut out, the fragment ends here.
    _ = fragment_surface(
        moved.material,
        moved.uv,
        Change(dpdx(moved.offset), dpdy(moved.offset), dpdx(moved.uv), dpdy(moved.uv)),
    );
    return motion(vec2<u32>(moved.clip.xy), moved.way);
}
#else
@fragment
fn view_motion(@builtin(position) at: vec4<f32>) -> @location(0) vec2<f32> {
    return motion(vec2<u32>(at.xy), vec3(0.0));
}
#endif
#endif
