//! The balance of clusters: the metric, the free list, the shaders against their CPU reference, extremes.

mod cpu_reference;
mod gpu;
mod metric;
mod ranks;
mod some;

use evaluate_clusters::PASS;

#[test]
fn all_variants_of_the_shaders_are_valid() {
    pass_test::assert_shaders_are_valid(PASS);
}
