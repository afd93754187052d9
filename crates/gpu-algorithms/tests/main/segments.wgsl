// Prefix sums of weights in segments.

#import "algorithms/segmented-scan.wgsl"

struct Settings {
    length: u32,
    rows: u32,
}

var<uniform> settings: Settings;
var<storage, read> weights: array<f32>;
var<storage, read_write> sums: array<f32>;
var<storage, read_write> totals: array<Scaled>;

fn segment_length() -> u32 {
    return settings.length;
}

fn number_of_segment(segment: vec3<u32>) -> u32 {
    return segment.z * settings.rows + segment.y;
}

fn segment_weight(segment: vec3<u32>, i: u32) -> Scaled {
    return Scaled(weight_of(weights[number_of_segment(segment) * settings.length + i]), 0);
}

fn segment_store(segment: vec3<u32>, i: u32, sum: f32) {
    sums[number_of_segment(segment) * settings.length + i] = sum;
}

fn segment_total(segment: vec3<u32>, sum: Scaled) {
    totals[number_of_segment(segment)] = sum;
}
