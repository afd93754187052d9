// The functions of reduce.wgsl for sums of weights whose sum may leave the range of f32.

#import "algorithms/reduce.wgsl"
#import "algorithms/scaled.wgsl"

alias Reduced = Scaled;

fn reduce_identity() -> Scaled {
    return Scaled(0.0, 0);
}

fn reduce_both(a: Scaled, b: Scaled) -> Scaled {
    return add_scaled(a, b);
}

fn reduce_workgroup(thread: u32, own: Scaled) -> Scaled {
    return workgroup_sum(thread, own);
}
