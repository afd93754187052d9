// Renders what the camera sees: depth, normal and material at each pixel.

#output view: GBuffer(size: frame * supersampling) // What the camera sees.
#exact pixels: reference(filter: 'centre', supersampling: supersampling) // The mean over each pixel.

#option NORMALS half one_of [half, full] // The format of normals. half: 8 bytes, to a thousandth. full: 16 bytes, to ten
    // millionths; a glossy scene is drawn once more.
#option GLOSSY false // whether the G-buffer has the member `specular`
#option NORMAL_MAPPED false // whether the G-buffer has the member `geometric`
#option EMISSIVE false // whether the G-buffer has the member `emission`

#import "camera.wgsl"
#import "octahedron.wgsl"
#import "surface-fragment.wgsl"

struct Settings {
    view_size: vec2<u32>,
    /// Samples of each pixel along either side, in a grid: the G-buffer has so many times as many rows and columns as the
    /// frame. Larger: smoother edges; time and memory grow with its square. [default: 1, one_of: [1, 2, 3, 4]]
    supersampling: u32,
}

var<uniform> settings: Settings;

struct Seen {
    @builtin(position) @invariant clip: vec4<f32>,
    /// Relative to the camera, in world space [m]: small numbers, so that their differences between pixels are exact.
    @location(0) offset: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) @interpolate(flat) material: u32,
}

struct Texel {
    @location(0) view_depth: f32,
    @location(1) view_normal: vec4<f32>,
    @location(2) view_albedo: vec4<f32>,
#if NORMAL_MAPPED
    @location(3) view_geometric: vec2<f32>,
#endif
#if GLOSSY && NORMALS == half && NORMAL_MAPPED
    @location(4) view_specular: vec4<f32>,
#elif GLOSSY && NORMALS == half
    @location(3) view_specular: vec4<f32>,
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
    let at = fragment_surface(seen.material, seen.uv, change);
    let normals = normals_of(seen, change);
    var texel: Texel;
    texel.view_depth = depth_at_centre(seen, change, normals.towards);
    texel.view_normal = vec4(normals.shading, 0.0);
    texel.view_albedo = vec4(normals.share * at.albedo, 1.0);
#if NORMAL_MAPPED
    texel.view_geometric = octahedron_from_direction(normals.unbent);
#endif
#if GLOSSY && NORMALS == half
    texel.view_specular = vec4(normals.share * at.specular, at.roughness);
#endif
    return texel;
}

#if GLOSSY && NORMALS == full
/// Rendered in a draw of its own: WebGPU guarantees 32 bytes per pixel for the targets of one draw, and those of
/// `geometry` take up to 32 with normals of 16.
@fragment
fn view_specular(seen: Seen) -> @location(0) vec4<f32> {
    let change = change_of(seen);
    let at = fragment_surface(seen.material, seen.uv, change);
    return vec4(normals_of(seen, change).share * at.specular, at.roughness);
}
#endif

#if EMISSIVE
/// Rendered in a draw of its own, for the same reason: the targets of `geometry` take up to 32 bytes per pixel.
@fragment
fn view_emission(seen: Seen) -> @location(0) vec4<f32> {
    let change = change_of(seen);
    let at = fragment_surface(seen.material, seen.uv, change);
    return vec4(at.emission, 1.0);
}
#endif

/// The depth at which the ray through the pixel's centre meets the triangle's plane [m].
///
/// Adapters move vertices to a grid of some hundredth of a pixel and interpolate over the triangle so moved: `offset` lies on
/// the plane, but not on that ray. At its own depth on the ray, a point would lie off the surface, and rays from there would
/// meet it.
fn depth_at_centre(seen: Seen, change: Change, normal: vec3<f32>) -> f32 {
    let backward = camera.world_from_view[2].xyz;
    let ray = pixel_ray(seen.clip.xy - 0.5, settings.view_size);
    let depth = -dot(seen.offset, backward);
    let correction = dot(seen.offset - ray * depth, normal) / dot(ray, normal);
    // The coarsest grid that Vulkan allows is a sixteenth of a pixel. A plane seen on edge has no depth of its own.
    let most = (abs(dot(change.position_x, backward)) + abs(dot(change.position_y, backward))) / 16.0;
    return depth + select(0.0, correction, abs(correction) <= most);
}

struct Normals {
    /// Of the triangle, on the camera's side, of any length.
    towards: vec3<f32>,
    /// Interpolated, unit.
    unbent: vec3<f32>,
    /// The mean of the normals in the pixel that face the camera, unit.
    shading: vec3<f32>,
    /// Its length before: their share in the light that falls on the pixel.
    share: f32,
}

fn normals_of(seen: Seen, change: Change) -> Normals {
    // The cross product of one pixel down and one pixel right points to the camera, whatever the surface; but not where the
    // next pixel is beyond the plane's horizon, as in frames of few pixels.
    let towards = facing(cross(change.position_y, change.position_x), -seen.offset);
    let unbent = smooth_normal(seen.normal, towards);
    let mean = mean_shading_normal(seen.material, unbent, seen.uv, change);
    // Those that turn away reflect nothing to the camera, and light that falls on the others is none of theirs.
    let facing = mean_facing(mean, -unit(seen.offset));
    let share = min(length(facing), 1.0);
    return Normals(towards, unbent, unit(select(mean, facing, share > 1e-3)), share);
}

fn change_of(seen: Seen) -> Change {
    return Change(dpdx(seen.offset), dpdy(seen.offset), dpdx(seen.uv), dpdy(seen.uv));
}
