// Sums an importance map for the inverse transform method: along the rows of all maps, along the last column of each map, and over
// the maps. [TCAS §4.2; ISM §4]
//
// A workgroup sums a segment. This file sums rows, and totals.wgsl the rest.

#input rsm: ReflectiveShadowMap // The texels.
#input importance: Importance like rsm // What is summed.
#output sums: ImportanceSums(size: like(rsm)) // Its cumulative sums.

#import "algorithms/segmented-scan.wgsl"
#import interface "importance"

var sums_rows: texture_storage_2d_array<r32float, write>;
/// By row: its sum, whose exponent is the unit in which the next stage counts. [scratch, count: rsm.height * rsm.layers]
var<storage, read_write> row_totals: array<Scaled>;

fn segment_length() -> u32 {
    return textureDimensions(sums_rows).x;
}

fn segment_weight(segment: vec3<u32>, i: u32) -> Scaled {
    return Scaled(weight_of(importance(segment.z, vec2(i, segment.y))), 0);
}

fn segment_store(segment: vec3<u32>, i: u32, sum: f32) {
    textureStore(sums_rows, vec2(i, segment.y), segment.z, vec4(sum));
}

fn segment_total(segment: vec3<u32>, sum: Scaled) {
    row_totals[segment.z * textureDimensions(sums_rows).y + segment.y] = sum;
}
