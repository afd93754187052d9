//! Points: evenness of all and of every part, area by area.

mod cpu_reference;
mod evenness;
mod gpu;

use scene_points::PASS;

pass_test::shaders_are_valid!(PASS);
