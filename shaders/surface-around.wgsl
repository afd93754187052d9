// The similarity of two pixels of a view: the distance of one from the plane of the other, and their normals. For filters that
// stop at edges of the geometry.

#import "camera.wgsl"
#import "view-geometric.wgsl"

var view_depth: texture_2d<f32>;
var view_normal: texture_2d<f32>;

/// The surface at the centre pixel of a window.
struct SurfaceAround {
    pixel: vec2<i32>,
    /// Along the viewing axis [m]; 0 where nothing is seen.
    depth: f32,
    /// For shading; world space, unit.
    normal: vec3<f32>,
    /// Height of the centre's ray above the plane through the camera that is parallel to the surface, per depth, and how it
    /// changes from a pixel to the next on the right and below: rays change linearly over the image.
    slope: vec3<f32>,
}

/// Returns the surface at a pixel of a view of `size` pixels, at that depth [m] and with that unit normal.
fn surface_around(pixel: vec2<u32>, size: vec2<u32>, depth: f32, normal: vec3<f32>) -> SurfaceAround {
    let steps = pixel_ray_steps(size);
    let plane = plane_normal(pixel, normal);
    let slope = vec3(dot(plane, pixel_ray(vec2<f32>(pixel), size)), dot(plane, steps[0]), dot(plane, steps[1]));
    return SurfaceAround(vec2<i32>(pixel), depth, normal, slope);
}

/// Distance of what another pixel sees from the plane of the centre, as a fraction of the centre's depth. On a slanted
/// floor, depths themselves differ.
fn off_plane(around: SurfaceAround, other: vec2<i32>, other_depth: f32) -> f32 {
    let by = vec2<f32>(other - around.pixel);
    let height = other_depth * (around.slope.x + around.slope.y * by.x + around.slope.z * by.y);
    return abs(height - around.depth * around.slope.x) / around.depth;
}

/// The greatest distance from the plane, as a fraction of the depth, and the least cosine between normals, of two pixels that see one
/// surface.
const SAME_PLANE: f32 = 0.02;
const SAME_NORMAL: f32 = 0.9;

/// Whether another pixel sees the surface of the centre: is at most `plane` off its plane, as a fraction of the depth, with a normal
/// of which the cosine is at least `cosine`.
fn is_same_surface(around: SurfaceAround, other: vec2<i32>, plane: f32, cosine: f32) -> bool {
    let other_depth = textureLoad(view_depth, other, 0).x;
    let along = dot(around.normal, textureLoad(view_normal, other, 0).xyz);
    return other_depth > 0.0 && off_plane(around, other, other_depth) <= plane && along >= cosine;
}

/// How many pixels of a window of the interleaving around the centre see its surface, itself counted: those that
/// geometry-aware-blur takes the mean of. The view has `size` pixels.
fn alike_in_window(around: SurfaceAround, size: vec2<u32>, interleave: vec2<u32>) -> u32 {
    let reach = vec2<i32>(interleave) / 2;
    var alike = 0u;
    for (var y = -reach.y; y <= reach.y; y++) {
        for (var x = -reach.x; x <= reach.x; x++) {
            let other = around.pixel + vec2(x, y);
            // As unsigned numbers, negative ones are large.
            if all(vec2<u32>(other) < size) {
                alike += select(0u, 1u, is_same_surface(around, other, SAME_PLANE, SAME_NORMAL));
            }
        }
    }
    return alike;
}

/// Likeness in [0, 1] of what another pixel sees: falls with the distance from the centre's plane, in units of `plane` (a
/// fraction of the depth), and with the angle between normals, as a power of its cosine.
fn likeness(around: SurfaceAround, other: vec2<i32>, plane: f32, power: f32) -> f32 {
    let other_depth = textureLoad(view_depth, other, 0).x;
    if other_depth <= 0.0 {
        return 0.0;
    }
    let cosine = clamp(dot(around.normal, textureLoad(view_normal, other, 0).xyz), 0.0, 1.0);
    return exp(-off_plane(around, other, other_depth) / max(plane, 1e-6)) * pow(cosine, power);
}
