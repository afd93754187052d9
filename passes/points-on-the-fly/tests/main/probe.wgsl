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
fn probe(row: Row) {
    let index = index_in(row, 64u);
    if index < arrayLength(&samples) {
        samples[index] = surface_sample(settings.samples, index);
    }
}
