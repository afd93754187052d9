//! The inverse transform method: sums, distribution, flux, extremes.

mod choices;
mod cpu_reference;
mod distribution;
mod gpu;

use sample_inverse_transform::PASS;

#[test]
fn all_variants_of_the_shaders_are_valid() {
    pass_test::assert_shaders_are_valid(PASS);
}
