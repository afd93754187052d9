// The sum of all weights.

#import "algorithms/sum-f32.wgsl"
#import "weights.wgsl"

struct Settings {
    min_factor: u32,
    max_factor: u32,
}

var<uniform> settings: Settings;
/// [scratch]
var<storage, read_write> total_weight: f32;

fn reduce_length() -> u32 {
    return scene_info.triangles;
}

fn reduce_element(i: u32) -> f32 {
    return weight_of_triangle(i, vec2(settings.min_factor, settings.max_factor));
}

fn reduce_store(result: f32) {
    total_weight = result;
}
