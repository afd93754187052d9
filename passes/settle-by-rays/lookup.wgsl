// Visibility by an atlas of maps of the distance where they are sure, and by rays elsewhere.

#option LIT all one_of [believed, edges, all] // Which answers of a texel a ray decides of. believed: none but what lies little behind
    // it. edges: also those that a texel beside it answers otherwise. all: also those of receivers that are lit, but whose own surface
    // is not in their texel.
#option DEFERS false internal // whether readers ask `visibility_at_once` first; the pass sets it

#import "atlas-lookup.wgsl"
#import "light-ray.wgsl"

struct VisibilityFacts {
    atlas: AtlasFacts,
    /// How far behind what is stored a receiver is hidden for sure, in widths of a texel.
    doubt: f32,
}

var<uniform> visibility_facts: VisibilityFacts;

/// The share of the depth bias to which what a texel stores is the receiver's own surface. What is farther before it, a ray finds.
const SAME_SURFACE: f32 = 0.05;

const NEIGHBOURS = array(vec2(-1, 0), vec2(1, 0), vec2(0, -1), vec2(0, 1));

/// Whether the four texels beside this one hide the receiver's plane, or whether none of them does. Texels are believed without
/// being compared where LIT says so.
fn answer_alike(lookup: ParaboloidLookup, index: u32, texel: vec2<u32>, hide: bool) -> bool {
    var alike = true;
#if LIT != believed
    let tile = visibility_facts.atlas.tile;
    let origin = origin_in_atlas(index);
    var neighbours = NEIGHBOURS;
    for (var n = 0u; n < 4u; n++) {
        let other = vec2<u32>(clamp(vec2<i32>(texel) + neighbours[n], vec2(0), vec2(i32(tile) - 1)));
        alike &= is_seen(lookup, other, tile, stored_in_atlas(origin, other)) != hide;
    }
#endif
    return alike;
}

/// 1 where the map is sure that the receiver is lit, and 0 where that it is hidden; else the length of the ray that decides [m],
/// negative.
fn verdict_of_map(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32 {
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
        return select(-FAR, 0.0, answer_alike(lookup, index, texel, true));
    }
    if own - SAME_SURFACE * lookup.bias > stored {
        return -doubt;
    }
#if LIT == all
    if stored - own > SAME_SURFACE * lookup.bias {
        return -FAR;
    }
#endif
    return select(-FAR, 1.0, answer_alike(lookup, index, texel, false));
}

fn visibility_by_map(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    let verdict = verdict_of_map(index, light, at, normal);
    if verdict >= 0.0 {
        return verdict;
    }
    return select(0.0, 1.0, is_free(light, at, normal, -verdict));
}

/// The visibility where the map is sure, and a negative number where a ray decides.
fn visibility_at_once(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    let own = map_of(index, light);
    return verdict_of_map(own.index, own.light, at, normal);
}
