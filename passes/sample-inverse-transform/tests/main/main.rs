//! The inverse transform method: sums, distribution, flux, extremes.

mod choices;
mod cpu_reference;
mod distribution;
mod gpu;

use sample_inverse_transform::PASS;

pass_test::shaders_are_valid!(PASS);
