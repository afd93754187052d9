// Where searches for the triangle of a point begin and end.

#import "algorithms/guide.wgsl"
#import "amplification.wgsl"

struct Settings {
    /// Binary logarithm of the number of entries.
    guide_bits: u32,
}

var<uniform> settings: Settings;
var<storage, read_write> points: Amplification;

fn interval_start(triangle: u32) -> u32 {
    return points.starts[triangle];
}

fn guide_bits() -> u32 {
    return settings.guide_bits;
}

fn number_bits() -> u32 {
    return 31u;
}

fn guide_store(i: u32, triangle: u32) {
    points.starts[scene_info.triangles + 1u + i] = triangle;
}
