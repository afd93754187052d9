// Where a receiver falls in the paraboloid map of a virtual light, and the distance that it is tested with.

#import "paraboloid.wgsl"
#import "virtual-lights.wgsl"

/// A lookup of a map.
struct ParaboloidLookup {
    /// The receiver is behind the light's plane, where there is no map.
    behind: bool,
    /// Position in the map [px].
    position: vec2<f32>,
    /// Distance of the receiver, less the bias [m]: it is lit where what is stored is no nearer.
    nearest: f32,
}

/// The lookup for a receiver at `at` [m] with the unit `normal`, in a map with `tile` texels along a side. `bias` is that
/// of the depth test, in widths of a texel along the receiver's plane.
fn paraboloid_lookup(
    light: VirtualLight,
    at: vec3<f32>,
    normal: vec3<f32>,
    tile: u32,
    bias: f32,
) -> ParaboloidLookup {
    let offset = at - light.position;
    let local = offset * frame_from_normal(light.normal);
    let distance = length(local);
    if local.z <= 0.0 {
        return ParaboloidLookup(true, vec2(0.0), 0.0);
    }
    // A texel holds one distance for all it covers. Along the receiver's plane the distance changes by the
    // texel's width [m] times the slope, the tangent to the cosine height / distance. Slopes end at 4 (76°):
    // beyond, the cosine leaves little light to lose, and walls would leak. The constant tenth is for receivers that
    // bend within a texel.
    // The width is distance · √(density · area); with z = (1 - r²) / (1 + r²) that is:
    let width = (distance + local.z) * (2.0 / f32(tile));
    let height = -dot(normal, offset);
    let slope = sqrt(max(distance * distance - height * height, 0.0)) / max(height, 0.25 * distance);
    let nearest = distance - bias * width * (0.1 + slope);

    // paraboloid_from_direction, with the division by the distance left out.
    return ParaboloidLookup(false, tile_position(local.xy / (distance + local.z), tile), nearest);
}
