// A module of a port Visibility that weights the four nearest texels after the test.

#import "atlas-lookup.wgsl"

struct VisibilityFacts {
    atlas: AtlasFacts,
}

var<uniform> visibility_facts: VisibilityFacts;

fn visibility_by_map(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    let lookup = atlas_lookup(light, at, normal);
    if lookup.behind {
        return 0.0;
    }
    let origin = origin_in_atlas(index);
    let last = vec2(f32(visibility_facts.atlas.tile - 1u));
    let corner = floor(lookup.position - 0.5);
    let weight = lookup.position - 0.5 - corner;
    let low = vec2<u32>(clamp(corner, vec2(0.0), last));
    let high = vec2<u32>(clamp(corner + 1.0, vec2(0.0), last));
    var seen = array<f32, 4>();
    for (var i = 0u; i < 4u; i++) {
        let texel = select(low, high, vec2(i % 2u, i / 2u) == vec2(1u));
        seen[i] = seen_past(lookup, origin, texel);
    }
    let rows = mix(vec2(seen[0], seen[2]), vec2(seen[1], seen[3]), weight.x);
    return mix(rows.x, rows.y, weight.y);
}
