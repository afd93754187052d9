//! Shader functions in `f32` against the same functions in `f64`: the precision that is lost, and the part that is avoidable.
//!
//! A [`Probe`] is a WGSL file that calls functions of the library with inputs of one magnitude. [`measure`] computes it in
//! `f32`, by the [`Interpreted`] evaluator or by a [`Kernel`] on a GPU, and the same WGSL from the same inputs in `f64`, by the
//! [`Interpreter`]: nothing is written twice. The report compares the error with the unavoidable one, that of rounded inputs and a
//! rounded result; a function that exceeds it many times can be improved.
//!
//! This crate does not use the GPU.

mod float;
mod interpret;
mod kernel;
mod measure;
mod probe;
mod report;
mod value;

pub use float::Float;
pub use interpret::{Fault, Interpreter, MOST_STATEMENTS};
pub use kernel::{GROUP, Kernel};
pub use measure::{Errors, Evaluator, Interpreted, Measured, Options, Point, ROUNDING, measure};
pub use probe::{Compared, FOLDER, Probe, ProbeError, paths};
pub use report::{run, table};
pub use value::{Pointer, Scalar, Value, Vector};
