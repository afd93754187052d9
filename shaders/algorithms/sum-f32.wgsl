// The functions of reduce.wgsl for sums of f32 that are not negative.

#import "algorithms/reduce.wgsl"

alias Reduced = f32;

/// Returns what adding does not change.
fn reduce_identity() -> f32 {
    return 0.0;
}

/// Returns the sum of two.
fn reduce_both(a: f32, b: f32) -> f32 {
    return a + b;
}

/// Returns the sum of what the threads of a workgroup bring; all of them call it.
fn reduce_workgroup(thread: u32, own: f32) -> f32 {
    return prefix_sum(thread, own).y;
}
