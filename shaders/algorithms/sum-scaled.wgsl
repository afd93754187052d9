// The functions of reduce.wgsl for sums of weights whose sum may leave the range of f32.

#import "algorithms/reduce.wgsl"
#import "algorithms/scaled.wgsl"

alias Reduced = Scaled;

/// Returns what adding does not change.
fn reduce_identity() -> Scaled {
    return Scaled(0.0, 0);
}

/// Returns the sum of two.
fn reduce_both(a: Scaled, b: Scaled) -> Scaled {
    return add_scaled(a, b);
}

/// Returns the sum of what the threads of a workgroup bring; all of them call it.
fn reduce_workgroup(thread: u32, own: Scaled) -> Scaled {
    return workgroup_sum(thread, own);
}
