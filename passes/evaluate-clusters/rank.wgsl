// Decides which clusters are merged and which are split, and numbers both in the order in which they are looked at: in one
// workgroup, by prefix sums. [ACRSM Eq. 4.8, §5.3.1]

#import "algorithms/scaled.wgsl"
#import "mean.wgsl"
#import "shuffle.wgsl"

struct Settings {
    clusters_count: u32,
    /// One in so many clusters is looked at in a frame, in a random order. Fewer at a time: clusters settle before they are
    /// looked at again, but a distribution that is out of balance stays so for longer. [default: 3, min: 1, max: 65536]
    subset: u32,
    /// A cluster is merged that is smaller than its neighbours' mean by more than this; ACRSM: 0.35 to 0.5. Smaller: more
    /// clusters move in each frame. [default: 0.4, min: 0.0]
    merge: f32,
    /// A cluster is split, as long as there are merged ones to put there, that is greater than its neighbours' mean by more
    /// than this; ACRSM: 0.1 to 0.2. Greater: more of the merged clusters go back to where the importance is. [default:
    /// 0.15, min: 0.0]
    split: f32,
    /// How a cluster is smaller or greater. absolute: by δ - mean (Eq. 4.8). relative: by δ / mean - 1, as the text has it:
    /// it does not depend on the greatest cluster of all. [default: "absolute", one_of: ["absolute", "relative"]]
    difference: u32,
    seed: u32,
}

const RELATIVE: u32 = 1u;

var<uniform> settings: Settings;
var<storage, read> clusters: Clusters;
/// 1 + number of the merge of a cluster; 0 of those that stay.
var<storage, read_write> fates: array<u32>;
/// The clusters that are to be split, in order.
var<storage, read_write> splits: array<u32>;
var<storage, read_write> outcome: Outcome;

/// By how much a cluster is greater than its neighbours; 0 if it takes no part.
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
        let sums = prefix_sum_u32(thread, own);
        let before = sums.x - own;
        if merges {
            fates[cluster] = 1u + merged + before % 0x10000u;
        }
        if splits_here {
            splits[split + before / 0x10000u] = cluster;
        }
        merged += sums.y % 0x10000u;
        split += sums.y / 0x10000u;
    }
    if thread == 0u {
        outcome.merged = merged;
        outcome.split = min(merged, split);
    }
}
