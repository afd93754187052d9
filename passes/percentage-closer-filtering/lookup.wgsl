// Visibility by an atlas of paraboloid distance maps, filtered after the depth test: the mean of taps × taps lookups
// one texel apart, each of them bilinear. [Reeves, Salesin & Cook 1987]
//
// Neighbouring taps share texels, so (taps + 1)² are loaded. Texels at the edge of the window count in part, so that
// visibility changes continuously as the receiver moves.

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
    /// Depth bias, in widths of a texel at the receiver.
    depth_bias: f32,
    /// The same, times the slope of the receiver's plane.
    slope_bias: f32,
    /// Taps along each side of the window.
    taps: u32,
}

var<uniform> visibility_facts: VisibilityFacts;
var visibility_atlas: texture_2d_array<f32>;

fn visibility_by_map(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    let tile = visibility_facts.tile;
    let taps = visibility_facts.taps;
    let facts = visibility_facts;
    let lookup = paraboloid_lookup(light, at, normal, tile, facts.depth_bias, facts.slope_bias);
    if lookup.behind {
        return 0.0;
    }
    let origin = tile_origin(index, facts.columns, facts.rows, tile);
    let start = lookup.position - 0.5 * f32(taps);
    let corner = floor(start);
    let weight = start - corner;
    var sum = 0.0;
    var above = 0.0;
    for (var y = 0u; y <= taps; y++) {
        var row = 0.0;
        var left = 0.0;
        for (var x = 0u; x <= taps; x++) {
            let texel = texel_in_map(corner + vec2(f32(x), f32(y)), tile);
            let stored = textureLoad(visibility_atlas, origin.xy + texel, origin.z, 0).x;
            let seen = select(0.0, 1.0, is_seen(lookup, texel, tile, stored));
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
