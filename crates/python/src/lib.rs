//! The Python package's part in Rust: the module `lightloom._lightloom`, on which the classes of `lightloom` are built.
//!
//! What has a structure of its own, such as a plan or the errors of a file, crosses the border as JSON; pictures and buffers as
//! NumPy arrays, which own what was read back from the device.

mod arrays;
mod error;
mod files;
mod pictures;
mod renderer;
mod session;
mod value;

#[pyo3::pymodule]
mod _lightloom {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::files::{diff, lay_over, pipelines, plan, resolve, root, scenes, set_root};
    #[pymodule_export]
    use crate::pictures::{compare, flip, png, read, write};
    #[pymodule_export]
    use crate::renderer::Renderer;
    #[pymodule_export]
    use crate::session::adapters;

    /// Runs a command of the command line, and returns its exit code. `program` starts this program: an executable file, and what
    /// comes before the arguments of a command.
    #[pyfunction]
    fn run(py: Python<'_>, program: Vec<String>, arguments: Vec<std::ffi::OsString>) -> u8 {
        // Ctrl-C ends the process at once, as it does for a program without an interpreter.
        py.detach(|| command_line::run(program, arguments))
    }

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
