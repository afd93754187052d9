//! Clusters are the means of their texels.

mod cpu_reference;
mod gpu;
mod means;
mod shapes;

use average_clusters::PASS;

#[test]
fn every_variant_of_the_shaders_is_valid() {
    pass_test::assert_shaders_are_valid(PASS);
}
