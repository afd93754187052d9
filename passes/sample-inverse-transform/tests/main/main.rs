//! The inverse transform method: sums, distribution, flux, extremes.

mod distribution;
mod gpu;
mod random;
mod sums;

use sample_inverse_transform::PASS;

#[test]
fn all_variants_of_the_shaders_are_valid() {
    let library = pass_test::shaders();
    for path in PASS.info().shaders {
        for request in library.variants(&pass::request(path, &[])).unwrap_or_else(|e| panic!("{e:#?}")) {
            library.load(&request).unwrap_or_else(|e| panic!("{request:?}: {e:#?}"));
        }
    }
}
