// Sums of weights, from which points are drawn.

#import "algorithms/segmented-scan.wgsl"

struct Settings {
    points_count: u32,
}

var<uniform> settings: Settings;
var<storage, read> weights: array<Scaled>;
/// [points] Sum of the weights of a point and of those before it, in any unit.
var<storage, read_write> cumulated: array<f32>;
/// Sum of all weights.
var<storage, read_write> total: Scaled;

fn segment_length() -> u32 {
    return settings.points_count;
}

fn segment_weight(segment: vec3<u32>, i: u32) -> Scaled {
    return weights[i];
}

fn segment_store(segment: vec3<u32>, i: u32, sum: f32) {
    cumulated[i] = sum;
}

fn segment_total(segment: vec3<u32>, sum: Scaled) {
    total = sum;
}
