// The sum of all weights.

#import "algorithms/sum-f32.wgsl"
#import "weights.wgsl"

struct Settings {
    /// Least tessellation level of edges and inside, with the rule `tessellation` (ACRSM Alg. 5.2). Larger: more points
    /// on small triangles, and so on all. [default: 5, min: 1, max: 64]
    min_factor: u32,
    /// Greatest tessellation level of edges and inside, with the rule `tessellation` (ACRSM Alg. 5.2). The number of
    /// points on large triangles rises with its square. [default: 64, min: 1, max: 64]
    max_factor: u32,
}

var<uniform> settings: Settings;
var<storage, read_write> total_weight: f32;

fn reduce_length() -> u32 {
    return scene_info.triangles;
}

fn reduce_element(i: u32) -> f32 {
    return weight_of_triangle(i);
}

fn reduce_store(result: f32) {
    total_weight = result;
}
