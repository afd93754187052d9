//! Importance: closed forms, the mixture with flux, extremes.

mod cpu_reference;
mod gpu;
mod measure;
mod reflectance;

use importance_map::PASS;

pass_test::shaders_are_valid!(PASS);
