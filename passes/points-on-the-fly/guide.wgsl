// The guide table: where searches for the triangle of a point begin and end (Chen & Asau 1974).

#import "amplification.wgsl"
#import "dispatch.wgsl"
#import "scene.wgsl"
#import "triangle-samples.wgsl"

struct Settings {
    /// Binary logarithm of the number of entries.
    guide_bits: u32,
}

var<uniform> settings: Settings;
var<storage, read_write> points: Amplification;

fn interval_start(triangle: u32) -> u32 {
    return points.starts[triangle];
}

@compute @workgroup_size(256)
fn guide(row: Row) {
    let index = index_in(row, 256u);
    let entries = 1u << settings.guide_bits;
    if index > entries || scene_info.triangles == 0u {
        return;
    }
    let last = scene_info.triangles - 1u;
    var triangle = last;
    if index < entries {
        triangle = triangle_at(index << (31u - settings.guide_bits), 0u, last);
    }
    points.starts[scene_info.triangles + 1u + index] = triangle;
}
