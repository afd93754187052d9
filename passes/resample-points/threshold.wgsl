// Brings the threshold T nearer, at which systematic sampling cuts weights so that it takes no point twice: where the sum of
// min(w, T) is T times the number of points that are wanted.
//
// That sum is concave in T. Newton's method begins at the mean without a cut; each step comes nearer, and none goes too far.

#import "algorithms/reduce.wgsl"
#import "weights.wgsl"

struct Settings {
    points_count: u32,
    /// The number of points to choose.
    count: u32,
    /// 1 in the first step.
    first: u32,
}

var<uniform> settings: Settings;
var<storage, read> weights: array<Scaled>;
var<storage, read_write> threshold: Scaled;

struct Reduced {
    /// Sum of the weights below the threshold.
    below: Scaled,
    /// The numbers of weights that are not 0, and of those that are not below the threshold.
    weighted: u32,
    cut: u32,
}

fn reduce_length() -> u32 {
    return settings.points_count;
}

fn reduce_element(i: u32) -> Reduced {
    let weight = weights[i];
    if weight.value == 0.0 {
        return reduce_identity();
    }
    if settings.first == 0u && is_certain(weight, threshold) {
        return Reduced(Scaled(0.0, 0), 1u, 1u);
    }
    return Reduced(weight, 1u, 0u);
}

fn reduce_identity() -> Reduced {
    return Reduced(Scaled(0.0, 0), 0u, 0u);
}

fn reduce_both(a: Reduced, b: Reduced) -> Reduced {
    return Reduced(add_scaled(a.below, b.below), a.weighted + b.weighted, a.cut + b.cut);
}

fn reduce_workgroup(thread: u32, own: Reduced) -> Reduced {
    let below = workgroup_sum(thread, own.below);
    let weighted = prefix_sum_u32(thread, own.weighted).y;
    return Reduced(below, weighted, prefix_sum_u32(thread, own.cut).y);
}

fn reduce_store(result: Reduced) {
    if result.weighted <= settings.count {
        // All are taken.
        threshold = Scaled(0.0, 0);
    } else if result.cut < settings.count {
        threshold = quotient(result.below, Scaled(f32(settings.count - result.cut), 0));
    }
}
