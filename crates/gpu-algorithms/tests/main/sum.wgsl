// The sum of a buffer of weights.

#option SUM f32 one_of [f32, vec4, scaled] // of what: scaled is for sums that may leave the range of f32

#if SUM == scaled
#import "algorithms/sum-scaled.wgsl"
#elif SUM == vec4
#import "algorithms/sum-vec4.wgsl"
#else
#import "algorithms/sum-f32.wgsl"
#endif

var<storage, read> count: array<u32>;
var<storage, read> weights: array<f32>;
var<storage, read_write> sum: array<Reduced>;

fn reduce_length() -> u32 {
    return count[0];
}

#if SUM == scaled
fn reduce_element(i: u32) -> Scaled {
    return Scaled(weight_of(weights[i]), 0);
}
#elif SUM == vec4
fn reduce_element(i: u32) -> vec4<f32> {
    return vec4(weights[i], -weights[i], 1.0, 0.0);
}
#else
fn reduce_element(i: u32) -> f32 {
    return weights[i];
}
#endif

fn reduce_store(result: Reduced) {
    sum[0] = result;
}
