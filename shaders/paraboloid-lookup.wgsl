// Shadow-map lookups in the map of a virtual light: the position of a receiver, and its depth test.

#import "light-projection.wgsl"
#import "virtual-lights.wgsl"

/// A lookup of a map.
struct ParaboloidLookup {
    /// That of the light.
    kind: u32,
    /// The receiver is behind the light's plane, where there is no map.
    behind: bool,
    /// Position in the map [px].
    position: vec2<f32>,
    /// Distance of the receiver [m].
    distance: f32,
    /// The receiver's plane in the light's frame: its unit normal, and the light's distance from it along that [m].
    plane: vec4<f32>,
    /// Width of a texel at the receiver [m].
    width: f32,
    /// Depth bias [m].
    bias: f32,
}

/// The lookup for a receiver at `at` [m] in a plane with the unit `normal`, in a map with `tile` texels along a side.
/// `depth_bias` and `slope_bias` are in widths of a texel at the receiver; the second is multiplied by the slope of the
/// receiver's plane.
fn paraboloid_lookup(
    light: VirtualLight,
    at: vec3<f32>,
    normal: vec3<f32>,
    tile: u32,
    depth_bias: f32,
    slope_bias: f32,
) -> ParaboloidLookup {
    let frame = frame_from_normal(light.normal);
    let local = (at - light.position) * frame;
    return paraboloid_lookup_in_frame(light.kind, local, normal * frame, tile, depth_bias, slope_bias);
}

/// The same in the frame of a light of that kind: `local` [m] is the receiver, and `plane_normal` its unit normal.
fn paraboloid_lookup_in_frame(
    kind: u32,
    local: vec3<f32>,
    plane_normal: vec3<f32>,
    tile: u32,
    depth_bias: f32,
    slope_bias: f32,
) -> ParaboloidLookup {
    if local.z <= 0.0 {
        return ParaboloidLookup(kind, true, vec2(0.0), 0.0, vec4(0.0), 0.0, 0.0);
    }
    let distance = map_distance(kind, local);
    let height = dot(plane_normal, local);
    var bias = depth_bias;
    if slope_bias > 0.0 {
        // The slope is the tangent to the cosine towards the light. It ends at 4 (76°): beyond, the cosine leaves little
        // light to lose, and walls would leak. By the cross product, which does not cancel where the receiver faces the light.
        let direction = map_direction(kind, local, distance);
        bias += slope_bias * length(cross(plane_normal, direction)) / max(-dot(plane_normal, direction), 0.25);
    }
    let position = tile_position(map_position(kind, local, distance), tile);
    let width = map_texel_width(kind, local, distance, tile);
    return ParaboloidLookup(kind, false, position, distance, vec4(plane_normal, height), width, width * bias);
}

/// The texel of a map at a position in it [px]. Beyond the map's edge lies another map: the nearest texel at the edge is taken.
fn texel_in_map(position: vec2<f32>, tile: u32) -> vec2<u32> {
    return vec2<u32>(clamp(position, vec2(0.0), vec2(f32(tile - 1u))));
}

/// The distance [m] at which the ray through the centre of a texel meets the receiver's plane: that of its own surface.
fn own_distance(lookup: ParaboloidLookup, texel: vec2<u32>, tile: u32) -> f32 {
    let ray = map_ray(lookup.kind, texel_centre(texel, tile));
    let along = dot(lookup.plane.xyz, ray.direction);
    let height = lookup.plane.w - dot(lookup.plane.xyz, ray.origin);
    return select(lookup.distance, height * ray.length / along, along * height > 0.0);
}

/// Whether the receiver is seen past what a texel of the map stores: a distance [m] along the ray through its centre.
///
/// The receiver's own surface is met by that ray at another distance than the receiver's, which is known from its plane
/// (receiver-plane depth bias, Isidoro 2006). What is farther than the receiver hides nothing, so a plane that recedes
/// changes nothing; one that comes near is followed up to half the distance.
fn is_seen(lookup: ParaboloidLookup, texel: vec2<u32>, tile: u32, stored: f32) -> bool {
    let own = clamp(own_distance(lookup, texel, tile), 0.5 * lookup.distance, lookup.distance);
    return own - lookup.bias <= stored;
}
