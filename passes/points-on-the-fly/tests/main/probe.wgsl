// Writes the samples of a port Points, one thread per sample.

#import "dispatch.wgsl"
#import "surface-sample.wgsl"
#import interface "points"

struct Settings {
    samples: SamplesWanted,
}

var<uniform> settings: Settings;
var<storage, read_write> samples: array<SurfaceSample>;

@compute @workgroup_size(64)
fn probe(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = row_index(group, groups, local, 64u);
    if index < arrayLength(&samples) {
        samples[index] = surface_sample(settings.samples, index);
    }
}
