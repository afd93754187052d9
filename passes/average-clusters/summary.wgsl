// What is true of all clusters together, once each of them is averaged. One workgroup. [ACRSM §4.8]

#import "algorithms/workgroup.wgsl"
#import "clustering.wgsl"

var<storage, read> clusters: Clusters;
var<storage, read_write> averaged: Clusters;

/// What a cluster has of the sum over all that balancing evens out: its area times its importance.
fn share_of(cluster: Cluster) -> f32 {
    return cluster.area * cluster.importance;
}

@compute @workgroup_size(GROUP_SIZE)
fn summarise(@builtin(local_invocation_index) thread: u32) {
    let count = min(clusters.header.count, arrayLength(&clusters.clusters));
    // Number of those with texels, of those that lost theirs, and the sum of shares.
    var tally = vec4(0.0);
    var flux = vec4(0.0);
    var greatest_area = 0.0;
    for (var i = thread; i < count; i += GROUP_SIZE) {
        let now = averaged.clusters[i];
        if now.texels > 0u {
            tally += vec4(1.0, 0.0, share_of(now), 0.0);
            flux += vec4(now.flux, 0.0);
            greatest_area = max(greatest_area, now.area);
        } else if clusters.clusters[i].state == CLUSTER_ALIVE {
            tally.y += 1.0;
        }
    }
    tally = workgroup_sum4(thread, tally);
    flux = workgroup_sum4(thread, flux);
    greatest_area = workgroup_max(thread, greatest_area);
    let mean = tally.z / max(tally.x, 1.0);

    // The squares of small differences between large numbers: only a second round has their digits.
    var squares = vec4(0.0);
    for (var i = thread; i < count; i += GROUP_SIZE) {
        let now = averaged.clusters[i];
        if now.texels > 0u {
            let difference = share_of(now) - mean;
            squares.x += difference * difference;
        }
    }
    squares = workgroup_sum4(thread, squares);
    if thread == 0u {
        var header = clusters.header;
        header.alive = u32(tally.x);
        header.vanished = u32(tally.y);
        header.iteration++;
        header.greatest_area = greatest_area;
        header.mean_share = mean;
        header.share_variance = squares.x / max(tally.x, 1.0);
        header.mapped_flux = flux_of(flux.rgb);
        // The flux of the map has a step of its own.
        header.map_flux = averaged.header.map_flux;
        averaged.header = header;
    }
}
