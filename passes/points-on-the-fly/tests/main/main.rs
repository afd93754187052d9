//! Triangles amplified into points: shares by hand, the GPU against the CPU reference, evenness.

mod counts;
mod cpu_reference;
mod gpu;
mod places;
mod probe;

use points_on_the_fly::PASS;

pass_test::shaders_are_valid!(PASS);
