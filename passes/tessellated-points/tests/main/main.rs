//! Points on lattices of triangles: numbers by hand, the GPU against Alg. 5.2 as it is printed, areas, and the splat factor.

mod algorithm;
mod gpu;

use tessellated_points::PASS;

pass_test::shaders_are_valid!(PASS);
