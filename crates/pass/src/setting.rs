//! Settings that Rust reads, declared once: from one declaration [`settings!`](crate::settings) generates the schema
//! that users see and the struct that a pass reads, so that a misspelt name does not compile.
//!
//! ```
//! use pass::{Settings, choice, settings};
//!
//! choice! {
//!     /// What a splat stores.
//!     pub enum Kernel {
//!         /// One distance.
//!         Box = "box",
//!         /// The distance of the tangent plane.
//!         Surfel = "surfel",
//!     }
//! }
//!
//! settings! {
//!     /// Settings of a pass.
//!     pub struct MySettings {
//!         /// Side of a map. Error falls and time grows with it.
//!         size: u32 = 512, min: 1, max: 8192, unit: "px";
//!         /// What a splat stores.
//!         kernel: Kernel = Kernel::Box;
//!     }
//! }
//!
//! let schema = MySettings::schema();
//! assert_eq!(schema[0].max, Some(8192.0));
//! assert_eq!(schema[1].one_of.len(), 2);
//! let read = MySettings::read(&Settings::default());
//! assert_eq!((read.size, read.kernel, MySettings::kernel), (512, Kernel::Box, "kernel"));
//! ```
//!
//! Settings that only WGSL reads are declared there, by a bracket in the doc comment of a member of `struct Settings`;
//! [`of_shader`] returns these, and [`of_options`] the `#option`s that users set.

use crate::{Library, PassTypeError, request};
use frame_graph::{Setting, Settings, Value};
use shader_library::ShaderOption;

/// A Rust type for the value of a setting.
pub trait SettingValue: Clone {
    /// Returns the value in the type that the graph uses.
    fn to_value(&self) -> Value;

    /// Reads a value of the graph; `None` where it is of another type.
    fn from_value(value: &Value) -> Option<Self>;

    /// Returns all values of the type; empty where there are too many to list.
    fn all() -> Vec<Value> {
        Vec::new()
    }
}

impl SettingValue for u32 {
    fn to_value(&self) -> Value {
        Value::U32(*self)
    }

    fn from_value(value: &Value) -> Option<u32> {
        value.as_u32()
    }
}

impl SettingValue for f32 {
    fn to_value(&self) -> Value {
        Value::F32(*self)
    }

    fn from_value(value: &Value) -> Option<f32> {
        value.as_f32()
    }
}

impl SettingValue for bool {
    fn to_value(&self) -> Value {
        Value::Bool(*self)
    }

    fn from_value(value: &Value) -> Option<bool> {
        value.as_bool()
    }
}

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

/// Creates a setting with its type's choices, without bounds and unit. `doc` holds the lines of a doc comment,
/// `declared` the place.
pub fn new<T: SettingValue>(name: &str, default: &T, doc: &[&str], declared: &str) -> Setting {
    let lines: Vec<&str> = doc.iter().map(|line| line.trim()).filter(|line| !line.is_empty()).collect();
    let default = default.to_value();
    Setting {
        name: name.into(),
        ty: default.ty(),
        default,
        min: None,
        max: None,
        one_of: T::all(),
        unit: String::new(),
        doc: lines.join(" "),
        declared: declared.into(),
    }
}

/// Reads a setting of a use; the default where a test gives none. The graph gives all settings.
pub fn read<T: SettingValue>(settings: &Settings, name: &str, default: T) -> T {
    settings.get(name).and_then(T::from_value).unwrap_or(default)
}

/// Returns the settings that doc comments of `struct Settings` declare in a shader and its imports, with every option
/// at its default. Modules of interfaces are left out.
///
/// # Errors
/// A shader that does not exist or cannot be composed, and declarations that cannot be read.
pub fn of_shader(library: &Library, path: &str) -> Result<Vec<Setting>, PassTypeError> {
    library.settings(&request(path, &[])).map_err(|errors| PassTypeError::new(errors.to_string()))
}

/// Returns the settings that are options of a shader: each of `names` is an `#option` in capitals and a setting in
/// small letters. [`RecordContext::shader`](crate::RecordContext::shader) gives the options their values.
///
/// # Errors
/// A shader that does not exist or cannot be composed, and options that it does not declare.
pub fn of_options(library: &Library, path: &str, names: &[&str]) -> Result<Vec<Setting>, PassTypeError> {
    let outline =
        library.outline(&request(path, &[])).map_err(|errors| PassTypeError::new(errors.to_string()))?;
    let named = |name: &&str| {
        let found = outline.options.iter().find(|option| option.name == **name);
        found.map(ShaderOption::setting).ok_or_else(|| {
            let known: Vec<&str> = outline.options.iter().map(|option| option.name.as_str()).collect();
            PassTypeError::new(format!("{path} declares no `#option {name}`: it has {}", known.join(", ")))
        })
    };
    names.iter().map(named).collect()
}

/// Returns the value of the setting that [`of_options`] created from the option `name`; empty text if there is no such
/// setting, which is reported when the shader is loaded.
pub fn value_of_option(settings: &Settings, name: &str) -> Value {
    settings.get(&name.to_lowercase()).cloned().unwrap_or_else(|| Value::Text(String::new()))
}

/// Declares the settings that a pass reads in Rust: a struct with a public field for each, `schema()`, which gives
/// their [`Setting`]s, and `read(&Settings)`. Each name is also a constant of the struct, for errors about a
/// setting: `PassTypeError::setting(MySettings::size, …)`. See [the module](crate::setting).
///
/// A field is `name: type = default`, then any of `min:`, `max:` (numbers), `one_of:` (values) and `unit:`.
#[macro_export]
macro_rules! settings {
    (
        $(#[$attribute:meta])*
        $visibility:vis struct $Name:ident {
            $(
                $(#[doc = $doc:literal])*
                $field:ident : $type:ty = $default:expr $(, $key:ident : $value:expr)*;
            )*
        }
    ) => {
        $(#[$attribute])*
        #[derive(Clone, Debug, PartialEq)]
        $visibility struct $Name {
            $($(#[doc = $doc])* pub $field: $type,)*
        }

        #[allow(non_upper_case_globals, reason = "each is named as the setting whose name it is")]
        impl $Name {
            $(#[doc = concat!("The name of the setting `", stringify!($field), "`.")]
            pub const $field: &'static str = stringify!($field);)*

            /// Returns what users see of the settings.
            pub fn schema() -> ::std::vec::Vec<$crate::Setting> {
                ::std::vec![$({
                    let default: $type = $default;
                    #[allow(unused_mut, reason = "a setting may have nothing but a default")]
                    let mut setting = $crate::setting::new(
                        stringify!($field),
                        &default,
                        &[$($doc),*],
                        concat!(file!(), ":", line!()),
                    );
                    $($crate::settings!(@ setting $type, $key, $value);)*
                    setting
                }),*]
            }

            /// Reads the settings of a use.
            pub fn read(settings: &$crate::Settings) -> Self {
                Self { $($field: $crate::setting::read(settings, stringify!($field), $default),)* }
            }
        }
    };
    (@ $setting:ident $type:ty, min, $value:expr) => { $setting.min = Some(f64::from($value)) };
    (@ $setting:ident $type:ty, max, $value:expr) => { $setting.max = Some(f64::from($value)) };
    (@ $setting:ident $type:ty, unit, $value:expr) => { $setting.unit = $value.into() };
    (@ $setting:ident $type:ty, one_of, $value:expr) => {
        $setting.one_of = <[$type]>::iter(&$value).map($crate::setting::SettingValue::to_value).collect()
    };
}

/// Declares an enum whose variants are the words of a setting: see [the module](crate::setting). It converts to the
/// value of a shader's option.
#[macro_export]
macro_rules! choice {
    (
        $(#[$attribute:meta])*
        $visibility:vis enum $Name:ident {
            $($(#[$of_variant:meta])* $Variant:ident = $word:literal),* $(,)?
        }
    ) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        $visibility enum $Name {
            $($(#[$of_variant])* $Variant,)*
        }

        impl $Name {
            /// Returns the word of the setting.
            pub fn word(self) -> &'static str {
                match self {
                    $($Name::$Variant => $word,)*
                }
            }
        }

        impl $crate::setting::SettingValue for $Name {
            fn to_value(&self) -> $crate::Value {
                $crate::Value::Text(self.word().into())
            }

            fn from_value(value: &$crate::Value) -> Option<Self> {
                match value.as_text()? {
                    $($word => Some($Name::$Variant),)*
                    _ => None,
                }
            }

            fn all() -> ::std::vec::Vec<$crate::Value> {
                ::std::vec![$($crate::Value::Text($word.into())),*]
            }
        }

        impl From<$Name> for $crate::Define {
            fn from(choice: $Name) -> $crate::Define {
                $crate::Define::from(choice.word())
            }
        }
    };
}
