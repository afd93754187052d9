// The functions of reduce.wgsl for four sums of f32 of either sign.

#import "algorithms/reduce.wgsl"

alias Reduced = vec4<f32>;

/// Returns what adding does not change.
fn reduce_identity() -> vec4<f32> {
    return vec4(0.0);
}

/// Returns the sum of two.
fn reduce_both(a: vec4<f32>, b: vec4<f32>) -> vec4<f32> {
    return a + b;
}

/// Returns the sum of what the threads of a workgroup bring; all of them call it.
fn reduce_workgroup(thread: u32, own: vec4<f32>) -> vec4<f32> {
    return workgroup_sum4(thread, own);
}
