// The comparison metric δ of each cluster, in one workgroup. [ACRSM Eq. 4.6]

#import "algorithms/scaled.wgsl"
#import "centre.wgsl"

struct Settings {
    clusters_count: u32,
}

var<uniform> settings: Settings;
var<storage, read> clusters: Clusters;
var<storage, read_write> centres: array<Centre>;
var<storage, read_write> fates: array<u32>;
var<storage, read_write> outcome: Outcome;

/// δ of a cluster, given the greatest area.
fn delta_of(cluster: Cluster, greatest: f32) -> f32 {
    if !takes_part(cluster) || greatest == 0.0 {
        return 0.0;
    }
    // A quotient may be rounded to more than 1.
    return min(weight_of(cluster.area) / greatest, 1.0) * weight_of(cluster.importance);
}

@compute @workgroup_size(GROUP_SIZE)
fn measure(@builtin(local_invocation_index) thread: u32) {
    var greatest = 0.0;
    for (var i = thread; i < settings.clusters_count; i += GROUP_SIZE) {
        if takes_part(clusters.clusters[i]) {
            greatest = max(greatest, weight_of(clusters.clusters[i].area));
        }
    }
    greatest = workgroup_max(thread, greatest);
    var greatest_delta = 0.0;
    for (var i = thread; i < settings.clusters_count; i += GROUP_SIZE) {
        greatest_delta = max(greatest_delta, delta_of(clusters.clusters[i], greatest));
    }
    let unit = magnitude(Scaled(workgroup_max(thread, greatest_delta), 0));
    for (var i = thread; i < settings.clusters_count; i += GROUP_SIZE) {
        let cluster = clusters.clusters[i];
        let layer = select(NO_LAYER, cluster.layer, takes_part(cluster));
        centres[i] = Centre(cluster.uv, layer, in_units(Scaled(delta_of(cluster, greatest), 0), unit));
        fates[i] = 0u;
    }
    if thread == 0u {
        outcome.unit = unit;
    }
}
