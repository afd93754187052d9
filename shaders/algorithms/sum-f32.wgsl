// The functions of reduce.wgsl for sums of f32 that are not negative.

#import "algorithms/reduce.wgsl"

alias Reduced = f32;

fn reduce_identity() -> f32 {
    return 0.0;
}

fn reduce_both(a: f32, b: f32) -> f32 {
    return a + b;
}

fn reduce_workgroup(thread: u32, own: f32) -> f32 {
    return prefix_sum(thread, own).y;
}
