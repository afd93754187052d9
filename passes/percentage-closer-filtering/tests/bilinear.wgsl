// A module of a port Visibility that weights the four nearest texels after the test, of an atlas with one map a layer.

#import "paraboloid.wgsl"
#import "paraboloid-lookup.wgsl"
#import "virtual-lights.wgsl"
#import "visibility-shared.wgsl"

struct VisibilityFacts {
    /// Side of a map [px].
    tile: u32,
    /// Depth bias, in widths of a texel at the receiver.
    depth_bias: f32,
    /// The same, times the slope of the receiver's plane.
    slope_bias: f32,
}

var<uniform> visibility_facts: VisibilityFacts;
var visibility_atlas: texture_2d_array<f32>;

fn visibility_by_map(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    let facts = visibility_facts;
    let tile = facts.tile;
    let lookup = paraboloid_lookup(light, at, normal, tile, facts.depth_bias, facts.slope_bias);
    if lookup.behind {
        return 0.0;
    }
    let origin = tile_origin(index, 1u, 1u, tile);
    let last = vec2(f32(tile - 1u));
    let corner = floor(lookup.position - 0.5);
    let weight = lookup.position - 0.5 - corner;
    let low = vec2<u32>(clamp(corner, vec2(0.0), last));
    let high = vec2<u32>(clamp(corner + 1.0, vec2(0.0), last));
    var seen = array<f32, 4>();
    for (var i = 0u; i < 4u; i++) {
        let texel = select(low, high, vec2(i % 2u, i / 2u) == vec2(1u));
        let stored = textureLoad(visibility_atlas, origin.xy + texel, origin.z, 0).x;
        seen[i] = select(0.0, 1.0, is_seen(lookup, texel, tile, stored));
    }
    let rows = mix(vec2(seen[0], seen[2]), vec2(seen[1], seen[3]), weight.x);
    return mix(rows.x, rows.y, weight.y);
}
