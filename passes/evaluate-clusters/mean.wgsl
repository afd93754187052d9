// What a cluster differs from its neighbours by. [ACRSM Eq. 4.7, 4.8]

#import "centre.wgsl"

var<storage, read> centres: array<Centre>;
var<storage, read> sums: array<vec2<f32>>;

/// The mean of δ over the neighbours in units of the outcome, weighted by itself; 0 where all are 0.
fn mean_delta(index: u32) -> f32 {
    let sum = sums[index];
    return select(0.0, sum.x / sum.y, sum.y > 0.0);
}
