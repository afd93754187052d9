//! Settings by name.

use crate::{PassTypeError, Settings, Value};

/// Reads the settings of a use by name.
pub trait ReadSettings {
    /// Returns a setting that is a `u32`.
    ///
    /// # Errors
    /// Where there is no such setting of that type; so for the others.
    fn u32(&self, name: &str) -> Result<u32, PassTypeError>;
    /// Returns a setting that is an `f32`.
    ///
    /// # Errors
    /// As [`ReadSettings::u32`].
    fn f32(&self, name: &str) -> Result<f32, PassTypeError>;
    /// Returns a setting that is a truth value.
    ///
    /// # Errors
    /// As [`ReadSettings::u32`].
    fn bool(&self, name: &str) -> Result<bool, PassTypeError>;
    /// Returns a setting that is one of several words.
    ///
    /// # Errors
    /// As [`ReadSettings::u32`].
    fn text(&self, name: &str) -> Result<&str, PassTypeError>;
}

impl ReadSettings for Settings {
    fn u32(&self, name: &str) -> Result<u32, PassTypeError> {
        self.get(name).and_then(Value::as_u32).ok_or_else(|| missing(self, name, "a u32"))
    }

    fn f32(&self, name: &str) -> Result<f32, PassTypeError> {
        self.get(name).and_then(Value::as_f32).ok_or_else(|| missing(self, name, "an f32"))
    }

    fn bool(&self, name: &str) -> Result<bool, PassTypeError> {
        self.get(name).and_then(Value::as_bool).ok_or_else(|| missing(self, name, "a bool"))
    }

    fn text(&self, name: &str) -> Result<&str, PassTypeError> {
        self.get(name).and_then(Value::as_text).ok_or_else(|| missing(self, name, "text"))
    }
}

/// The error that there is no such setting.
fn missing(settings: &Settings, name: &str, ty: &str) -> PassTypeError {
    let error = PassTypeError::new(format!("the pass reads the setting `{name}`, which is not {ty}"));
    match frame_graph::nearest(name, settings.0.keys().map(String::as_str)) {
        Some(near) if near != name => error.help(format!("did you mean `{near}`?")),
        _ => error,
    }
}
