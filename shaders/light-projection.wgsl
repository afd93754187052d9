// How a virtual light sees the scene: a square of rays. The map of a light on a surface is a paraboloid map of its hemisphere; that
// of a light infinitely far is an orthographic one, of the sphere about the scene's bounds.
//
// In a light's frame the normal is z, and its position the origin.

#import "paraboloid.wgsl"
#import "scene.wgsl"
#import "virtual-lights.wgsl"

/// Half the side of the square of a light infinitely far [m]; as far before the middle of the scene lies its position.
fn far_reach() -> f32 {
    return max(0.505 * scene_info.extent, 1e-30);
}

/// A ray of a map, in the light's frame.
struct MapRay {
    /// [m]
    origin: vec3<f32>,
    direction: vec3<f32>,
    /// Of the direction.
    length: f32,
    /// Homogeneous coordinates of its image: see map_homogeneous.
    image: vec3<f32>,
}

/// The ray through a point of the square.
fn map_ray(kind: u32, at: vec2<f32>) -> MapRay {
    if kind == INFINITELY_FAR {
        let across = far_reach() * at;
        return MapRay(vec3(across, 0.0), vec3(0.0, 0.0, 1.0), 1.0, vec3(across, 1.0));
    }
    // Not of length 1: see direction_from_paraboloid.
    let r2 = dot(at, at);
    let direction = vec3(2.0 * at, 1.0 - r2);
    return MapRay(vec3(0.0), direction, 1.0 + r2, direction);
}

/// The distance beyond which a ray of a map is above the horizon [lengths of its direction]; negative where it never is.
fn rise_above_horizon(ray: MapRay) -> f32 {
    let rising = ray.direction.z - HORIZON_SLOPE * ray.length;
    return select(HORIZON_HEIGHT * scene_info.extent / rising, -1.0, rising <= 0.0);
}

/// Homogeneous coordinates of the image of a point [m]: a ray passes on one side of an edge if its own have a positive product
/// with the cross product of those of the edge's ends.
fn map_homogeneous(kind: u32, local: vec3<f32>) -> vec3<f32> {
    return select(local, vec3(local.xy, 1.0), kind == INFINITELY_FAR);
}

/// The distance of a point [m] along its ray.
fn map_distance(kind: u32, local: vec3<f32>) -> f32 {
    return select(length(local), local.z, kind == INFINITELY_FAR);
}

/// The point of the square whose ray meets a point at this distance [m].
fn map_position(kind: u32, local: vec3<f32>, distance: f32) -> vec2<f32> {
    // paraboloid_from_direction, with the division by the distance left out.
    return local.xy / select(distance + local.z, far_reach(), kind == INFINITELY_FAR);
}

/// Width of a texel at a point at this distance [m], across its ray, in a map with `tile` texels along a side.
fn map_texel_width(kind: u32, local: vec3<f32>, distance: f32, tile: u32) -> f32 {
    // Of a paraboloid map: distance · √(density · area), with z = (1 - r²) / (1 + r²).
    return select(distance + local.z, far_reach(), kind == INFINITELY_FAR) * (2.0 / f32(tile));
}

/// The direction of the ray to a point at this distance [m], unit.
fn map_direction(kind: u32, local: vec3<f32>, distance: f32) -> vec3<f32> {
    return select(local / distance, vec3(0.0, 0.0, 1.0), kind == INFINITELY_FAR);
}
