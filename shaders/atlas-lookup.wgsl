// Lookups in an atlas of paraboloid maps, for the modules of the interface Visibility that read one.
//
// The module that imports this file declares
//   struct VisibilityFacts { atlas: AtlasFacts, … }
//   var<uniform> visibility_facts: VisibilityFacts;

#import "paraboloid.wgsl"
#import "paraboloid-lookup.wgsl"
#import "virtual-lights.wgsl"
#import "visibility-shared.wgsl"

/// The facts that all atlases have.
struct AtlasFacts {
    /// Side of a map [px].
    tile: u32,
    /// Maps in a row of a layer.
    columns: u32,
    /// Rows of maps in a layer.
    rows: u32,
    /// Depth bias, in widths of a texel at the receiver.
    depth_bias: f32,
    /// The same, times the slope of the receiver's plane. The size is what a uniform wants.
    @size(16) slope_bias: f32,
}

var visibility_atlas: texture_2d_array<f32>;

/// The lookup for a receiver at `at` [m] with the unit `normal`, in the map of a light.
fn atlas_lookup(light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> ParaboloidLookup {
    let atlas = visibility_facts.atlas;
    return paraboloid_lookup(light, at, normal, atlas.tile, atlas.depth_bias, atlas.slope_bias);
}

/// The same in the frame of a light on a surface: `local` [m] is the receiver, and `plane_normal` its unit normal.
fn atlas_lookup_in_frame(local: vec3<f32>, plane_normal: vec3<f32>) -> ParaboloidLookup {
    let atlas = visibility_facts.atlas;
    return paraboloid_lookup_in_frame(ON_SURFACE, local, plane_normal, atlas.tile, atlas.depth_bias, atlas.slope_bias);
}

/// Where the map of a light begins: texel and layer.
fn origin_in_atlas(index: u32) -> vec3<u32> {
    return tile_origin(index, visibility_facts.atlas.columns, visibility_facts.atlas.rows, visibility_facts.atlas.tile);
}

/// Returns what a texel of the map at `origin` stores.
fn stored_in_atlas(origin: vec3<u32>, texel: vec2<u32>) -> f32 {
    return textureLoad(visibility_atlas, origin.xy + texel, origin.z, 0).x;
}

/// 1 where the receiver is seen past a texel of the map at `origin`, else 0.
fn seen_past(lookup: ParaboloidLookup, origin: vec3<u32>, texel: vec2<u32>) -> f32 {
    return select(0.0, 1.0, is_seen(lookup, texel, visibility_facts.atlas.tile, stored_in_atlas(origin, texel)));
}

/// 1 where the receiver is seen past the texel of the lookup's position, else 0.
fn seen_once(lookup: ParaboloidLookup, index: u32) -> f32 {
    return seen_past(lookup, origin_in_atlas(index), texel_in_map(lookup.position, visibility_facts.atlas.tile));
}
