// Sums the totals of segments: those of rows along the last column of each map, and then those of maps.

#import "algorithms/segmented-scan.wgsl"

struct Settings {
    segment_length: u32,
    /// The element of `sums_totals` at which the sums begin.
    first: u32,
}

var<uniform> settings: Settings;
var<storage, read> parts: array<Scaled>;
/// [count: (rsm.height + 1) * rsm.layers]
var<storage, read_write> sums_totals: array<f32>;
/// By segment: its sum, whose exponent is the unit in which the next stage counts.
var<storage, read_write> totals: array<Scaled>;

fn segment_length() -> u32 {
    return settings.segment_length;
}

fn segment_weight(segment: vec3<u32>, i: u32) -> Scaled {
    return parts[segment.y * settings.segment_length + i];
}

fn segment_store(segment: vec3<u32>, i: u32, sum: f32) {
    sums_totals[settings.first + segment.y * settings.segment_length + i] = sum;
}

fn segment_total(segment: vec3<u32>, sum: Scaled) {
    totals[segment.y] = sum;
}
