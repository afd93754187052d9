// Cumulative sums of what texels reflect, one workgroup per segment: first along the curve through each map, then over the maps.

#option TEXELS true internal // whether segments are maps; otherwise their sums are one

#import "algorithms/segmented-scan.wgsl"

struct Settings {
    segment_length: u32,
}

var<uniform> settings: Settings;
#if TEXELS
var<storage, read> weights: array<f32>;
#else
var<storage, read> parts: array<Scaled>;
#endif
var<storage, read_write> cdf: array<f32>;
/// By segment: its sum, whose exponent is the unit in which the next stage counts.
var<storage, read_write> totals: array<Scaled>;

fn segment_length() -> u32 {
    return settings.segment_length;
}

fn segment_weight(segment: vec3<u32>, i: u32) -> Scaled {
    let place = segment.y * settings.segment_length + i;
#if TEXELS
    return Scaled(weights[place], 0);
#else
    return parts[place];
#endif
}

fn segment_store(segment: vec3<u32>, i: u32, sum: f32) {
    cdf[segment.y * settings.segment_length + i] = sum;
}

fn segment_total(segment: vec3<u32>, sum: Scaled) {
    totals[segment.y] = sum;
}
