// Visibility by two atlases of maps of the distance: a few lights have a map in the second, and the rest in the first.

#import "atlas-lookup.wgsl"
#import "owners.wgsl"

struct VisibilityFacts {
    atlas: AtlasFacts,
    /// Of the second atlas, as in the first.
    exact_tile: u32,
    exact_columns: u32,
    exact_rows: u32,
    exact_depth_bias: f32,
    exact_slope_bias: f32,
}

var<uniform> visibility_facts: VisibilityFacts;
var visibility_exact: texture_2d_array<f32>;
/// For each light, its map in the second atlas.
var<storage, read> visibility_exact_places: array<u32>;

fn visibility_by_map(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    let facts = visibility_facts;
    let place = visibility_exact_places[index];
    if place == NO_OWNER {
        let lookup = atlas_lookup(light, at, normal);
        if lookup.behind {
            return 0.0;
        }
        return seen_once(lookup, index);
    }
    let tile = facts.exact_tile;
    let lookup = paraboloid_lookup(light, at, normal, tile, facts.exact_depth_bias, facts.exact_slope_bias);
    if lookup.behind {
        return 0.0;
    }
    let origin = tile_origin(place, facts.exact_columns, facts.exact_rows, tile);
    let texel = texel_in_map(lookup.position, tile);
    let stored = textureLoad(visibility_exact, origin.xy + texel, origin.z, 0).x;
    return select(0.0, 1.0, is_seen(lookup, texel, tile, stored));
}
