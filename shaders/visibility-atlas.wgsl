// Visibility by an atlas of paraboloid maps of the distance, one tile a virtual light: one texel is looked up.

#import "paraboloid.wgsl"
#import "paraboloid-lookup.wgsl"
#import "virtual-lights.wgsl"
#import "visibility-shared.wgsl"

struct VisibilityFacts {
    /// Side of a map [px].
    tile: u32,
    /// Maps in a row of a layer.
    columns: u32,
    /// Rows of maps in a layer.
    rows: u32,
    /// Bias of the depth test, in widths of a texel at the receiver.
    depth_bias: f32,
    /// The same, times the slope of the receiver's plane.
    slope_bias: f32,
}

var<uniform> visibility_facts: VisibilityFacts;
var visibility_atlas: texture_2d_array<f32>;

fn visibility_by_map(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    let tile = visibility_facts.tile;
    let facts = visibility_facts;
    let lookup = paraboloid_lookup(light, at, normal, tile, facts.depth_bias, facts.slope_bias);
    if lookup.behind {
        return 0.0;
    }
    let origin = tile_origin(index, facts.columns, facts.rows, tile);
    let texel = texel_in_map(lookup.position, tile);
    let stored = textureLoad(visibility_atlas, origin.xy + texel, origin.z, 0).x;
    return select(0.0, 1.0, is_seen(lookup, texel, tile, stored));
}
