//! Errors as Python's `lightloom.Error`.

use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;

/// Returns the exception for an error: its text with carets, and for each error of a file code, message and place.
pub(crate) fn raise(py: Python<'_>, error: &anyhow::Error) -> PyErr {
    let errors = command_line::errors(error).to_string();
    let text = command_line::text(error);
    // An exception says by its name that it is an error.
    let text = text.strip_prefix("error: ").unwrap_or(&text);
    exception(py, text, &errors).unwrap_or_else(|failed| failed)
}

fn exception(py: Python<'_>, text: &str, errors: &str) -> PyResult<PyErr> {
    static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let class = CLASS.import(py, "lightloom._errors", "Error")?;
    Ok(PyErr::from_value(class.call1((text, errors))?))
}
