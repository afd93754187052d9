//! Importance: closed forms, the mixture with flux, extremes.

mod cpu_reference;
mod gpu;
mod measure;
mod reflectance;

use importance_map::PASS;

#[test]
fn all_variants_of_the_shaders_are_valid() {
    pass_test::assert_shaders_are_valid(PASS);
}
