// The number of clusters of an input `clusters`.

#import "clusters.wgsl"

var<storage, read> clusters: Clusters;

/// The number of clusters that the header says and the buffer holds.
fn cluster_count() -> u32 {
    return min(clusters.header.count, arrayLength(&clusters.clusters));
}
