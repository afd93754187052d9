// What the camera sees at each pixel: depth, normal and material.

#option SPECULAR false // whether the G-buffer has the member `specular`

#import "camera.wgsl"
#import "surface.wgsl"

struct Seen {
    @builtin(position) @invariant clip: vec4<f32>,
    /// Relative to the camera, in world space [m]: small numbers, so that their differences between pixels are exact.
    @location(0) offset: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) @interpolate(flat) material: u32,
}

struct Texel {
    @location(0) depth: f32,
    @location(1) normal: vec4<f32>,
    @location(2) albedo: vec4<f32>,
#if SPECULAR
    @location(3) specular: vec4<f32>,
#endif
}

@vertex
fn project(vertex: Attributes) -> Seen {
    let clip = camera.clip_from_world * vec4(vertex.position, 1.0);
    return Seen(clip, vertex.position - camera.position, vertex.normal, vertex.uv, vertex.material);
}

@fragment
fn geometry(seen: Seen) -> Texel {
    let change = change_of(seen);
    let at = surface(seen.material, seen.uv, change.uv_x, change.uv_y);
    if !surface_exists(seen.material, at.coverage) {
        discard;
    }
    // The cross product of one pixel down and one pixel right points to the camera, whatever the surface; but not where the
    // next pixel is beyond the plane's horizon, as in frames of few pixels.
    let towards = facing(cross(change.position_y, change.position_x), -seen.offset);
    var texel: Texel;
    texel.depth = depth_at_centre(seen, change, towards);
    texel.normal = vec4(shading_normal(seen.material, seen.normal, towards, seen.uv, change), 0.0);
    texel.albedo = vec4(at.albedo, 1.0);
#if SPECULAR
    texel.specular = vec4(at.specular, at.roughness);
#endif
    return texel;
}

/// What `geometry` writes as `specular`, for a draw of its own.
@fragment
fn specular(seen: Seen) -> @location(0) vec4<f32> {
    let change = change_of(seen);
    let at = surface(seen.material, seen.uv, change.uv_x, change.uv_y);
    if !surface_exists(seen.material, at.coverage) {
        discard;
    }
    return vec4(at.specular, at.roughness);
}

/// Rendered in a draw of its own: WebGPU guarantees 32 bytes per pixel for the targets of one draw, and those of
/// `geometry` take 28.
@fragment
fn emission(seen: Seen) -> @location(0) vec4<f32> {
    let change = change_of(seen);
    let at = surface(seen.material, seen.uv, change.uv_x, change.uv_y);
    if !surface_exists(seen.material, at.coverage) {
        discard;
    }
    return vec4(at.emission, 1.0);
}

/// The depth at which the ray through the pixel's centre meets the triangle's plane [m].
///
/// Adapters move vertices to a grid of some hundredth of a pixel and interpolate over the triangle so moved: `offset` lies on
/// the plane, but not on that ray. At its own depth on the ray, a point would lie off the surface, and rays from there would
/// meet it.
fn depth_at_centre(seen: Seen, change: Change, normal: vec3<f32>) -> f32 {
    let backward = camera.world_from_view[2].xyz;
    let ray = view_ray(seen.clip.xy);
    let depth = -dot(seen.offset, backward);
    let correction = dot(seen.offset - ray * depth, normal) / dot(ray, normal);
    // The coarsest grid that Vulkan allows is a sixteenth of a pixel. A plane seen on edge has no depth of its own.
    let most = (abs(dot(change.position_x, backward)) + abs(dot(change.position_y, backward))) / 16.0;
    return depth + select(0.0, correction, abs(correction) <= most);
}

fn change_of(seen: Seen) -> Change {
    return Change(dpdx(seen.offset), dpdy(seen.offset), dpdx(seen.uv), dpdy(seen.uv));
}
