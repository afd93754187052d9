//! Settings, declared in one line each.
//!
//! ```
//! use pass::setting::{self, SettingExt};
//! let size = setting::u32("size", 512, "Side of a map. Error falls and time grows with it.").range(1.0, 8192.0).unit("px");
//! assert_eq!(size.max, Some(8192.0));
//! ```

use frame_graph::{Setting, Value};

fn new(name: &str, default: Value, doc: &str) -> Setting {
    Setting {
        name: name.into(),
        ty: default.ty(),
        default,
        min: None,
        max: None,
        one_of: Vec::new(),
        unit: String::new(),
        doc: doc.into(),
    }
}

/// A whole number that is not negative.
pub fn u32(name: &str, default: u32, doc: &str) -> Setting {
    new(name, Value::U32(default), doc)
}

/// A real number.
pub fn f32(name: &str, default: f32, doc: &str) -> Setting {
    new(name, Value::F32(default), doc)
}

/// On or off.
pub fn bool(name: &str, default: bool, doc: &str) -> Setting {
    new(name, Value::Bool(default), doc)
}

/// One of several names; the first is the default.
pub fn choice(name: &str, choices: &[&str], doc: &str) -> Setting {
    let values: Vec<Value> = choices.iter().map(|choice| Value::Text((*choice).into())).collect();
    Setting { one_of: values.clone(), ..new(name, values[0].clone(), doc) }
}

/// What can be added to a [`Setting`].
pub trait SettingExt {
    /// The least and the greatest value.
    fn range(self, min: f64, max: f64) -> Setting;
    /// The least value.
    fn at_least(self, min: f64) -> Setting;
    /// The unit.
    fn unit(self, unit: &str) -> Setting;
}

impl SettingExt for Setting {
    fn range(self, min: f64, max: f64) -> Setting {
        Setting { min: Some(min), max: Some(max), ..self }
    }

    fn at_least(self, min: f64) -> Setting {
        Setting { min: Some(min), ..self }
    }

    fn unit(self, unit: &str) -> Setting {
        Setting { unit: unit.into(), ..self }
    }
}
