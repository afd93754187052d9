// Visibility by an atlas of paraboloid distance maps, filtered after the depth test: the mean of taps × taps lookups
// one texel apart, each of them bilinear. [Reeves, Salesin & Cook 1987]
//
// Neighbouring taps share texels, so (taps + 1)² are loaded. Texels at the edge of the window count in part, so that
// visibility changes continuously as the receiver moves.

#import "atlas-lookup.wgsl"

struct VisibilityFacts {
    atlas: AtlasFacts,
    /// Taps along each side of the window.
    taps: u32,
}

var<uniform> visibility_facts: VisibilityFacts;

fn visibility_by_map(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    let taps = visibility_facts.taps;
    let lookup = atlas_lookup(light, at, normal);
    if lookup.behind {
        return 0.0;
    }
    let origin = origin_in_atlas(index);
    let start = lookup.position - 0.5 * f32(taps);
    let corner = floor(start);
    let weight = start - corner;
    var sum = 0.0;
    var above = 0.0;
    for (var y = 0u; y <= taps; y++) {
        var row = 0.0;
        var left = 0.0;
        for (var x = 0u; x <= taps; x++) {
            let texel = texel_in_map(corner + vec2(f32(x), f32(y)), visibility_facts.atlas.tile);
            let seen = seen_past(lookup, origin, texel);
            if x > 0u {
                row += mix(left, seen, weight.x);
            }
            left = seen;
        }
        if y > 0u {
            sum += mix(above, row, weight.y);
        }
        above = row;
    }
    return sum / f32(taps * taps);
}
