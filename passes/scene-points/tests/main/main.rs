//! Points: evenness of all and of every part, area by area.

mod cpu_reference;
mod evenness;
mod gpu;

use scene_points::PASS;

#[test]
fn all_variants_of_the_shaders_are_valid() {
    pass_test::assert_shaders_are_valid(PASS);
}
