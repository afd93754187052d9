//! Values of parameters and settings, from Python and to Python.

use frame_graph::{Overrides, Value};
use pyo3::exceptions::{PyOverflowError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyFloat, PyInt, PyString};

/// A value that Python gives to a parameter or a setting.
pub(crate) struct Given(Value);

impl<'py> FromPyObject<'_, 'py> for Given {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Given> {
        let value = if let Ok(truth) = object.extract::<bool>() {
            Value::Bool(truth)
        } else if object.cast::<PyString>().is_ok() {
            Value::Text(object.extract()?)
        } else if object.cast::<PyInt>().is_ok() || object.hasattr("__index__")? {
            integer(object.extract::<i64>()?)?
        } else if let Ok(number) = object.extract::<f32>() {
            Value::F32(number)
        } else if let Ok(numbers) = object.extract::<Vec<f32>>() {
            match numbers.len() {
                2..=4 => Value::Vector(numbers),
                count => return Err(unknown(&object, &format!(" of {count} numbers"))),
            }
        } else {
            return Err(unknown(&object, ""));
        };
        Ok(Given(value))
    }
}

fn integer(number: i64) -> PyResult<Value> {
    let value = u32::try_from(number).map(Value::U32).or_else(|_| i32::try_from(number).map(Value::I32));
    value.map_err(|_| PyOverflowError::new_err(format!("{number}: a setting takes integers of 32 bits")))
}

fn unknown(object: &Bound<'_, PyAny>, more: &str) -> PyErr {
    let class = object.get_type().name().map_or_else(|_| "?".to_owned(), |name| name.to_string());
    let expected = "expected a bool, an int, a float, a str, or 2 to 4 numbers";
    PyTypeError::new_err(format!("a setting cannot be a `{class}`{more}: {expected}"))
}

impl Given {
    /// Returns the value itself.
    pub(crate) fn value(self) -> Value {
        self.0
    }
}

/// Returns values by their paths, as a pipeline takes them.
pub(crate) fn overrides(given: Vec<(String, Given)>) -> Overrides {
    Overrides(given.into_iter().map(|(path, value)| (path, value.0)).collect())
}

/// Returns a value as an object of Python.
pub(crate) fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::Bool(truth) => PyBool::new(py, *truth).to_owned().into_any(),
        Value::U32(number) => number.into_pyobject(py)?.into_any(),
        Value::I32(number) => number.into_pyobject(py)?.into_any(),
        // By the shortest decimal of a 32-bit number, so that 0.05 is 0.05.
        Value::F32(number) => {
            let decimal: f64 = number.to_string().parse().unwrap_or(f64::from(*number));
            PyFloat::new(py, decimal).into_any()
        }
        Value::Text(text) => PyString::new(py, text).into_any(),
        Value::Vector(numbers) => {
            let numbers: Vec<f64> = numbers.iter().map(|number| f64::from(*number)).collect();
            pyo3::types::PyTuple::new(py, numbers)?.into_any()
        }
    })
}
