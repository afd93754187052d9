// Cumulative sums of TCAS §4.2, one workgroup per segment: first along the rows of all importance maps, then along the
// last column of each map, then over the maps.

#option ROWS true internal // whether segments are the rows of the importance map; otherwise runs of `parts`

#import "algorithms/segmented-scan.wgsl"

#if ROWS
#import interface "importance"

/// Sums along the rows of all maps. [scratch, size: like(rsm)]
var row_cdf: texture_storage_2d_array<r32float, write>;

fn segment_length() -> u32 {
    return textureDimensions(row_cdf).x;
}

fn number_of_segment(segment: vec3<u32>) -> u32 {
    return segment.z * textureDimensions(row_cdf).y + segment.y;
}

fn segment_weight(segment: vec3<u32>, i: u32) -> Scaled {
    return Scaled(weight_of(importance(segment.z, vec2(i, segment.y))), 0);
}

fn segment_store(segment: vec3<u32>, i: u32, sum: f32) {
    textureStore(row_cdf, vec2(i, segment.y), segment.z, vec4(sum));
}
#else
struct Settings {
    segment_length: u32,
}

var<uniform> settings: Settings;
var<storage, read> parts: array<Scaled>;
var<storage, read_write> cdf: array<f32>;

fn segment_length() -> u32 {
    return settings.segment_length;
}

fn number_of_segment(segment: vec3<u32>) -> u32 {
    return segment.y;
}

fn segment_weight(segment: vec3<u32>, i: u32) -> Scaled {
    return parts[segment.y * settings.segment_length + i];
}

fn segment_store(segment: vec3<u32>, i: u32, sum: f32) {
    cdf[segment.y * settings.segment_length + i] = sum;
}
#endif

/// By segment: its sum, whose exponent is the unit in which the next stage counts.
var<storage, read_write> totals: array<Scaled>;

fn segment_total(segment: vec3<u32>, sum: Scaled) {
    totals[number_of_segment(segment)] = sum;
}
