//! Densities.

#[test]
fn every_variant_of_the_shaders_is_valid() {
    pass_test::assert_shaders_are_valid(view_points::PASS);
}
