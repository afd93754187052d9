// Takes clusters from where they are too small to where they are too large. [ACRSM §4.8, Eq. 4.6-4.8]
//
// `measure` computes the comparison metric δ of each cluster (Eq. 4.6), `compare` its mean over the neighbours (Eq. 4.7), `rank`
// decides which clusters are merged and which are split (Eq. 4.8, §5.3.1), and `move_clusters` moves them.

#input clusters: Clusters // The clusters of the frame before: a link with `prev`.
#output evaluated: Clusters(count: clusters.count) // The same. Some are placed within others, some wait to be seeded.

#import "algorithms/scaled.wgsl"
#import "clusters.wgsl"
#import "dispatch.wgsl"
#import "random.wgsl"
#import "shuffle.wgsl"

struct Settings {
    clusters_count: u32,
    /// Half the side of the square in which other centres are neighbours; 0: all of the layer are. Larger: a cluster is
    /// compared with what is farther away, and less with what it shares a surface with. [default: 128, unit: "px"]
    window: u32,
    /// Every n-th cluster of a random order is looked at in a frame. Fewer at a time: clusters settle before they are
    /// looked at again, but a distribution that is out of balance stays so for longer. [default: 3, min: 1, max: 65536]
    subset: u32,
    /// A cluster is merged that is smaller than its neighbours' mean by more than this; ACRSM: 0.35 to 0.5. Smaller: more
    /// clusters move in each frame. [default: 0.4, min: 0.0]
    merge: f32,
    /// A cluster is split, as long as there are merged ones to put there, that is greater than its neighbours' mean by more
    /// than this; ACRSM: 0.1 to 0.2. Greater: more of the merged clusters go back to where the importance is. [default:
    /// 0.15, min: 0.0]
    split: f32,
    /// The measure by which a cluster is smaller or greater. absolute: by δ - mean (Eq. 4.8). relative: by δ / mean - 1, as the text has it:
    /// it does not depend on the greatest cluster of all. [default: "absolute", one_of: ["absolute", "relative"]]
    difference: u32,
    seed: u32,
    /// The neighbours that a dispatch of `compare` takes: `begin` to `end`.
    begin: u32,
    end: u32,
}

const RELATIVE: u32 = 1u;
const PI: f32 = 3.14159265;

/// The layer of a cluster that takes no part, and is nobody's neighbour.
const NO_LAYER: u32 = 0xffffffffu;

/// A cluster as its neighbours see it.
struct Centre {
    /// [texels]
    uv: vec2<f32>,
    layer: u32,
    /// δ in units of the outcome.
    delta: f32,
}

struct Outcome {
    /// Exponent of the greatest δ: in units of 2 to the power of it, neither squares nor sums leave the range of f32.
    unit: i32,
    merged: u32,
    /// The number of those that were split: not more than were merged.
    split: u32,
}

var<uniform> settings: Settings;
var<storage, read> clusters: Clusters;
var<storage, read_write> evaluated: Clusters;
/// [scratch, count: clusters.count]
var<storage, read_write> centres: array<Centre>;
/// Σδ² and Σδ over the neighbours of each cluster, in units of the outcome. [scratch, count: clusters.count]
var<storage, read_write> sums: array<vec2<f32>>;
/// 1 + number of the merge of a cluster; 0 of those that stay. [scratch, count: clusters.count]
var<storage, read_write> fates: array<u32>;
/// The clusters that are to be split, in order. [scratch, count: clusters.count]
var<storage, read_write> splits: array<u32>;
/// [scratch]
var<storage, read_write> outcome: Outcome;

/// Returns whether a cluster is evaluated: those without texels have no area, and wait to be seeded.
fn takes_part(cluster: Cluster) -> bool {
    return cluster.state == CLUSTER_ALIVE && cluster.texels > 0u;
}

/// Returns δ of a cluster, given the greatest area. [ACRSM Eq. 4.6]
fn delta_of(cluster: Cluster, greatest: f32) -> f32 {
    if !takes_part(cluster) || greatest == 0.0 {
        return 0.0;
    }
    // A quotient may be rounded to more than 1.
    return min(weight_of(cluster.area) / greatest, 1.0) * weight_of(cluster.importance);
}

/// Measures all clusters in one workgroup. [threads: 1]
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

/// Sums over the neighbours of each cluster, of which it is one itself. [threads: clusters.count, items: clusters.count]
@compute @workgroup_size(64)
fn compare(row: Row) {
    let index = index_in(row, 64u);
    if index >= settings.clusters_count {
        return;
    }
    var sum = vec2(0.0);
    if settings.begin > 0u {
        sum = sums[index];
    }
    let own = centres[index];
    if own.layer == NO_LAYER {
        sums[index] = sum;
        return;
    }
    let reach = f32(settings.window);
    for (var i = settings.begin; i < min(settings.end, settings.clusters_count); i++) {
        let other = centres[i];
        let near = settings.window == 0u || all(abs(other.uv - own.uv) <= vec2(reach));
        if other.layer == own.layer && near {
            sum += vec2(other.delta * other.delta, other.delta);
        }
    }
    sums[index] = sum;
}

/// Returns the mean of δ over the neighbours in units of the outcome, weighted by itself; 0 where all are 0. [ACRSM Eq. 4.7]
fn mean_delta(index: u32) -> f32 {
    let sum = sums[index];
    return select(0.0, sum.x / sum.y, sum.y > 0.0);
}

/// Returns by how much a cluster is greater than its neighbours; 0 if it takes no part. [ACRSM Eq. 4.8]
fn difference_of(index: u32) -> f32 {
    if !takes_part(clusters.clusters[index]) {
        return 0.0;
    }
    let mean = mean_delta(index);
    let difference = centres[index].delta - mean;
    if settings.difference == RELATIVE {
        // Where the mean is 0, so are all.
        return select(0.0, difference / mean, mean > 0.0);
    }
    return sign(difference) * times_power_of_two(abs(difference), outcome.unit);
}

/// Numbers the clusters that are merged and those that are split in the order in which they are looked at: in one workgroup, by
/// prefix sums. [threads: 1]
@compute @workgroup_size(GROUP_SIZE)
fn rank(@builtin(local_invocation_index) thread: u32) {
    let looked_at = (settings.clusters_count + settings.subset - 1u) / settings.subset;
    // DEVIATION(order): the paper's order is that of threads at two counters. This one is the same on every GPU, and depends
    // on how often there was a frame and not on the frame's number.
    let key = hash2(settings.seed, clusters.header.iteration);
    var merged = 0u;
    var split = 0u;
    for (var first = 0u; first < looked_at; first += GROUP_SIZE) {
        var cluster = 0u;
        var difference = 0.0;
        if first + thread < looked_at {
            cluster = shuffled(first + thread, settings.clusters_count, key);
            difference = difference_of(cluster);
        }
        let merges = difference < -settings.merge;
        let splits_here = difference > settings.split;
        // Both counts of a workgroup fit into one number.
        let own = select(0u, 1u, merges) + select(0u, 0x10000u, splits_here);
        let ranks = prefix_sum_u32(thread, own);
        let before = ranks.x - own;
        if merges {
            fates[cluster] = 1u + merged + before % 0x10000u;
        }
        if splits_here {
            splits[split + before / 0x10000u] = cluster;
        }
        merged += ranks.y % 0x10000u;
        split += ranks.y / 0x10000u;
    }
    if thread == 0u {
        outcome.merged = merged;
        outcome.split = min(merged, split);
    }
}

/// Returns a cluster that was merged, and so far is nowhere.
fn freed(generation: u32) -> Cluster {
    var cluster: Cluster;
    cluster.texel = NO_TEXEL;
    cluster.generation = generation;
    cluster.state = CLUSTER_TO_SEED;
    return cluster;
}

/// Returns a place within a cluster: uniform in the disc of as many texels as it has.
// DEVIATION(disc): the paper's offset is within the radius of the cluster, which is in metres and is that of its farthest
// texel; this one is on the map, and seldom beyond the cluster.
fn place_in(cluster: Cluster, key: u32) -> vec2<f32> {
    let distance = sqrt(f32(cluster.texels) / PI * unit_float(hash2(key, 0u)));
    let angle = 2.0 * PI * (unit_float(hash2(key, 1u)) - 0.5);
    return cluster.uv + distance * vec2(cos(angle), sin(angle));
}

/// Writes the clusters: those that were merged go to clusters that are split, and the rest of them back to be seeded. [threads:
/// clusters.count]
@compute @workgroup_size(64)
fn move_clusters(row: Row) {
    let index = index_in(row, 64u);
    if index >= settings.clusters_count {
        return;
    }
    var cluster = clusters.clusters[index];
    if takes_part(cluster) {
        cluster.delta = times_power_of_two(centres[index].delta, outcome.unit);
        cluster.mean_delta = times_power_of_two(mean_delta(index), outcome.unit);
    }
    let fate = fates[index];
    if fate > 0u {
        cluster = freed(cluster.generation);
        if fate <= outcome.split {
            let taken = clusters.clusters[splits[fate - 1u]];
            cluster.uv = place_in(taken, hash2(hash2(settings.seed, clusters.header.iteration), index));
            cluster.layer = taken.layer;
            cluster.state = CLUSTER_PLACED;
        }
    }
    evaluated.clusters[index] = cluster;
    if index > 0u {
        return;
    }
    evaluated.header = clusters.header;
    evaluated.header.merged = outcome.merged;
    evaluated.header.split = outcome.split;
}
