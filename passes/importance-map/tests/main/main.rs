//! Importance: closed forms, the mixture with flux, extremes.

mod gpu;
mod measure;

use importance_map::PASS;

#[test]
fn all_variants_of_the_shaders_are_valid() {
    let library = pass_test::shaders();
    for path in PASS.info().shaders {
        for request in library.variants(&pass::request(path, &[])).unwrap_or_else(|e| panic!("{e:#?}")) {
            library.load(&request).unwrap_or_else(|e| panic!("{request:?}: {e:#?}"));
        }
    }
}
