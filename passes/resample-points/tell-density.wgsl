// The density of the points that are chosen: that of all points, times how much more likely a point is chosen than another.

#import "counters.wgsl"
#import "dispatch.wgsl"
#import "surface-points.wgsl"
#import "weights.wgsl"

struct Settings {
    count: u32,
}

var<uniform> settings: Settings;
var<storage, read> density: array<f32>;
var<storage, read> weights: array<Scaled>;
var<storage, read> threshold: Scaled;
/// How many points there are to choose from.
var<storage, read> present: u32;
/// The points that are chosen.
var<storage, read> indices: array<u32>;
var<storage, read> counters: Counters;
var<storage, read_write> resampled_density: array<f32>;

@compute @workgroup_size(64)
fn tell(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let place = row_index(group, groups, local, 64u);
    if place >= settings.count {
        return;
    }
    var told = 0.0;
    if place < counters.produced {
        let weight = weights[indices[place]];
        var probability = 1.0;
        if !is_certain(weight, threshold) {
            let unit = magnitude(threshold);
            probability = in_units(weight, unit) / in_units(threshold, unit);
        }
        told = weight_of(density[indices[place]] * probability * (f32(present) / f32(counters.produced)));
    }
    resampled_density[place] = told;
}
