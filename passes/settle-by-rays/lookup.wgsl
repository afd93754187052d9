// Visibility by an atlas of maps of the distance where they are sure, and by rays elsewhere.

#import "atlas-lookup.wgsl"
#import "light-ray.wgsl"

struct VisibilityFacts {
    atlas: AtlasFacts,
    /// How far behind what is stored a receiver is hidden for sure, in widths of a texel.
    doubt: f32,
}

var<uniform> visibility_facts: VisibilityFacts;

fn visibility_by_map(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    let lookup = atlas_lookup(light, at, normal);
    if lookup.behind {
        return 0.0;
    }
    let tile = visibility_facts.atlas.tile;
    let texel = texel_in_map(lookup.position, tile);
    let stored = stored_in_atlas(origin_in_atlas(index), texel);
    let own = own_distance(lookup, texel, tile);
    let doubt = max(visibility_facts.doubt * lookup.width, lookup.bias);
    if own - doubt > stored {
        return 0.0;
    }
    if abs(own - stored) <= lookup.bias {
        return 1.0;
    }
    let reach = select(FAR, doubt, stored < own);
    return select(0.0, 1.0, is_free(light, at, normal, reach));
}
