// The sum of a buffer of weights.

#option SCALED false // whether the sum may leave the range of f32

#if SCALED
#import "algorithms/sum-scaled.wgsl"
#else
#import "algorithms/sum-f32.wgsl"
#endif

var<storage, read> count: array<u32>;
var<storage, read> weights: array<f32>;
var<storage, read_write> sum: array<Reduced>;

fn reduce_length() -> u32 {
    return count[0];
}

#if SCALED
fn reduce_element(i: u32) -> Scaled {
    return Scaled(weight_of(weights[i]), 0);
}
#else
fn reduce_element(i: u32) -> f32 {
    return weights[i];
}
#endif

fn reduce_store(result: Reduced) {
    sum[0] = result;
}
