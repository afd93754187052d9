// Visibility by an atlas of paraboloid maps of the distance, one tile a virtual light: one texel is looked up.

#import "atlas-lookup.wgsl"

struct VisibilityFacts {
    atlas: AtlasFacts,
}

var<uniform> visibility_facts: VisibilityFacts;

/// Returns 1 where the light of that index is seen from `at` [m] with the unit `normal`, by one texel of its map; else 0.
fn visibility_by_map(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    let lookup = atlas_lookup(light, at, normal);
    if lookup.behind {
        return 0.0;
    }
    return seen_once(lookup, index);
}
