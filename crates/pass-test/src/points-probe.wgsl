// Writes the samples of a port Points, one thread per sample.

#input points: Points // What the module reads.
#output samples: Buffer(count: settings.threads) // The samples of all maps.

#import "dispatch.wgsl"
#import "surface-sample.wgsl"
#import interface "points"

struct Settings {
    wanted: SamplesWanted,
    /// Maps. [default: 1]
    maps: u32,
    /// Samples of each. [default: 1]
    per_map: u32,
    /// Samples of all, with the maps that fill the last block. [default: 1]
    threads: u32,
}

var<uniform> settings: Settings;
var<storage, read_write> samples: array<SurfaceSample>;

@compute @workgroup_size(64)
fn points_probe(row: Row) {
    let index = index_in(row, 64u);
    if index < arrayLength(&samples) {
        samples[index] = surface_sample(settings.wanted, index);
    }
}
