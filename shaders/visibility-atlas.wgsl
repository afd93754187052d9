// Visibility by an atlas of paraboloid maps of the distance, one tile a virtual light.
//
// The uniform `settings` of the consumer, whose port is `visibility`, has these members:
//   visibility_tile: u32      fact of the port [px]
//   visibility_columns: u32   fact of the port
//   visibility_bias: f32      slack of the test, in widths of a texel along the receiver's plane; the fact `slack` of
//                             the port is what its maps need

#option VISIBILITY_FILTER single one_of [single, pcf] // one texel, or the four nearest weighted after the test

#import "paraboloid.wgsl"
#import "virtual-lights.wgsl"

var visibility_atlas: texture_2d<f32>;

/// Part of a virtual light that is seen from a point: 0 behind the light's plane and in shadow, 1 in the light.
/// `index` is the light's, `at` [m] and the unit `normal` are the receiver's.
fn visibility(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    let offset = at - light.position;
    let local = offset * frame_from_normal(light.normal);
    let distance = length(local);
    if local.z <= 0.0 {
        return 0.0;
    }
    let tile = settings.visibility_tile;
    // A texel holds one distance for all it covers. Along the receiver's plane the distance changes by the
    // texel's width [m] times the slope, the tangent to the cosine height / distance. Slopes end at 4 (76°):
    // beyond, the cosine leaves little light to lose, and walls would leak. The constant tenth is for receivers that
    // bend within a texel.
    // The width is distance · √(density · area); with z = (1 - r²) / (1 + r²) that is:
    let width = (distance + local.z) * (2.0 / f32(tile));
    let height = -dot(normal, offset);
    let slope = sqrt(max(distance * distance - height * height, 0.0)) / max(height, 0.25 * distance);
    let nearest = distance - settings.visibility_bias * width * (0.1 + slope);

    // paraboloid_from_direction, with the division by the distance left out.
    let position = tile_position(local.xy / (distance + local.z), tile);
    let origin = tile_origin(index, settings.visibility_columns, tile);
    let last = vec2(f32(tile - 1u));
#if VISIBILITY_FILTER == single
    let texel = vec2<u32>(clamp(position, vec2(0.0), last));
    return select(0.0, 1.0, nearest <= textureLoad(visibility_atlas, origin + texel, 0).x);
#else
    let corner = floor(position - 0.5);
    let weight = position - 0.5 - corner;
    let low = origin + vec2<u32>(clamp(corner, vec2(0.0), last));
    let high = origin + vec2<u32>(clamp(corner + 1.0, vec2(0.0), last));
    let stored = vec4(
        textureLoad(visibility_atlas, low, 0).x,
        textureLoad(visibility_atlas, vec2(high.x, low.y), 0).x,
        textureLoad(visibility_atlas, vec2(low.x, high.y), 0).x,
        textureLoad(visibility_atlas, high, 0).x,
    );
    let seen = select(vec4(0.0), vec4(1.0), vec4(nearest) <= stored);
    let rows = mix(seen.xz, seen.yw, weight.x);
    return mix(rows.x, rows.y, weight.y);
#endif
}
