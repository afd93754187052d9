// Visibility by an atlas of paraboloid maps of the distance, one tile a virtual light: one texel is looked up.

#import "paraboloid.wgsl"
#import "paraboloid-lookup.wgsl"
#import "virtual-lights.wgsl"

struct VisibilityFacts {
    /// Side of a map [px].
    tile: u32,
    /// Maps in a row of a layer.
    columns: u32,
    /// Rows of maps in a layer.
    rows: u32,
    /// Bias of the depth test, in widths of a texel along the receiver's plane.
    depth_bias: f32,
}

var<uniform> visibility_facts: VisibilityFacts;
var visibility_atlas: texture_2d_array<f32>;

/// Part of a virtual light that is seen from a point: 0 behind the light's plane and in shadow, 1 in the light.
/// `index` is the light's, `at` [m] and the unit `normal` are the receiver's.
fn visibility(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    let tile = visibility_facts.tile;
    let lookup = paraboloid_lookup(light, at, normal, tile, visibility_facts.depth_bias);
    if lookup.behind {
        return 0.0;
    }
    let origin = tile_origin(index, visibility_facts.columns, visibility_facts.rows, tile);
    let texel = vec2<u32>(clamp(lookup.position, vec2(0.0), vec2(f32(tile - 1u))));
    return select(0.0, 1.0, lookup.nearest <= textureLoad(visibility_atlas, origin.xy + texel, origin.z, 0).x);
}
