//! Importance warping: the distribution of seeds, how even they stay, the shader against its CPU reference, extremes.

mod cpu_reference;
mod distribution;
mod gpu;
mod maps;
mod states;

use warp_clusters::PASS;

#[test]
fn all_variants_of_the_shaders_are_valid() {
    pass_test::assert_shaders_are_valid(PASS);
}
