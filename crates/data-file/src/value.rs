//! Values, the settings that take them, and the traits of a scene that switches ask about.

use std::collections::BTreeMap;
use std::fmt;

/// A value of a parameter, a setting or a fact.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// `true` or `false`.
    Bool(bool),
    /// An integer, not negative.
    U32(u32),
    /// An integer.
    I32(i32),
    /// A real number. An integer is accepted where one is expected.
    F32(f32),
    /// Text, and also the name of a choice.
    Text(String),
    /// Two, three or four real numbers.
    Vector(Vec<f32>),
}

/// The type of a [`Value`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ValueType {
    /// [`Value::Bool`]
    Bool,
    /// [`Value::U32`]
    U32,
    /// [`Value::I32`]
    I32,
    /// [`Value::F32`]
    F32,
    /// [`Value::Text`]
    Text,
    /// [`Value::Vector`] of this many components.
    Vector(u8),
}

/// What a pass type says of one of its settings: the one declaration from which the RON check, `--set`,
/// the controls, the axes of a study and the reference are made.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The name, as in RON.
    pub name: String,
    /// The type of its values.
    pub ty: ValueType,
    /// The value where none is given: the paper's, where a paper gives one.
    pub default: Value,
    /// The least value, where there is one; for numbers.
    pub min: Option<f64>,
    /// The greatest value, where there is one; for numbers.
    pub max: Option<f64>,
    /// The only values it may take; empty where any in range will do.
    pub one_of: Vec<Value>,
    /// The unit, such as `px` or `m`; empty for a plain number.
    pub unit: String,
    /// What it does, and what rises and falls with it.
    pub doc: String,
    /// Where it is declared, `passes/splat/src/lib.rs:40` or `FILE:LINE:COLUMN`; empty for a parameter of a pipeline,
    /// whose place is known there.
    pub declared: String,
}

/// Why a [`Setting`] does not take a value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Misfit {
    /// It is of another type.
    Type(String),
    /// It is out of range, or none of the choices.
    Range(String),
}

impl Setting {
    /// Returns the value as this setting's type, if it is of that type, in range, and one of the choices.
    ///
    /// # Errors
    /// What was expected instead.
    pub fn check(&self, value: Value) -> Result<Value, Misfit> {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        let shown = value.to_string();
        let Some(value) = value.convert(self.ty) else {
            return Err(Misfit::Type(format!(
                "`{}` is {}, and {shown} is not",
                self.name,
                self.ty.with_article()
            )));
        };
        let out = |x: f64| self.min.is_some_and(|min| x < min) || self.max.is_some_and(|max| x > max);
        // The end of a range as the value has it: 0.01 in single precision is less than 0.01 in double precision.
        let out_of_single =
            |x: f32| self.min.is_some_and(|min| x < min as f32) || self.max.is_some_and(|max| x > max as f32);
        let outside = match &value {
            Value::U32(n) => out(f64::from(*n)),
            Value::I32(n) => out(f64::from(*n)),
            Value::F32(x) => out_of_single(*x),
            Value::Vector(v) => v.iter().any(|x| out_of_single(*x)),
            Value::Bool(_) | Value::Text(_) => false,
        };
        if outside {
            let range = match (self.min, self.max) {
                (Some(min), Some(max)) => format!("from {min} to {max}{unit}"),
                (Some(min), None) => format!("at least {min}{unit}"),
                (None, max) => format!("at most {}{unit}", max.unwrap_or(f64::INFINITY)),
            };
            return Err(Misfit::Range(format!("`{}` is {range}, and {shown} is not", self.name)));
        }
        let choice = |v: &Value| v.clone().convert(self.ty).is_some_and(|v| v == value);
        if !self.one_of.is_empty() && !self.one_of.iter().any(choice) {
            let choices: Vec<String> = self.one_of.iter().map(Value::to_string).collect();
            return Err(Misfit::Range(format!(
                "`{}` is one of {}, and {shown} is not",
                self.name,
                choices.join(", ")
            )));
        }
        Ok(value)
    }
}

/// All settings of one use of a pass, with defaults filled in.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings(pub BTreeMap<String, Value>);

impl Settings {
    /// Returns the defaults of a pass type.
    pub fn defaults(schema: &[Setting]) -> Settings {
        Settings(schema.iter().map(|setting| (setting.name.clone(), setting.default.clone())).collect())
    }
}

/// What a scene holds, as far as a pipeline may ask: `glossy`, `point_lights`, and so on.
///
/// Switches read them as `scene.NAME`. The names and types are the scene's own; the core knows none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Traits {
    /// The traits by name.
    pub values: BTreeMap<String, Value>,
    /// The lights, in the scene's order, then the materials that emit: what a pass can be told to take alone.
    pub sources: Vec<LightSource>,
}

/// A source of light as a pipeline names it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LightSource {
    /// The name in the scene's file.
    pub name: String,
    /// The layers of its shadow maps; 0 for a material.
    pub layers: u32,
}

impl Traits {
    /// Returns the traits of these values, of a scene whose lights have no names.
    pub fn new(values: BTreeMap<String, Value>) -> Traits {
        Traits { values, sources: Vec::new() }
    }
}

impl From<bool> for Value {
    fn from(value: bool) -> Value {
        Value::Bool(value)
    }
}

impl From<u32> for Value {
    fn from(value: u32) -> Value {
        Value::U32(value)
    }
}

impl From<f32> for Value {
    fn from(value: f32) -> Value {
        Value::F32(value)
    }
}

impl From<&str> for Value {
    fn from(value: &str) -> Value {
        Value::Text(value.to_owned())
    }
}

impl Value {
    /// Returns the type of this value.
    pub fn ty(&self) -> ValueType {
        match self {
            Value::Bool(_) => ValueType::Bool,
            Value::U32(_) => ValueType::U32,
            Value::I32(_) => ValueType::I32,
            Value::F32(_) => ValueType::F32,
            Value::Text(_) => ValueType::Text,
            Value::Vector(v) => ValueType::Vector(v.len() as u8),
        }
    }

    /// Returns the same value as this type, where it is one: integers convert to real ones, and to each other
    /// where they fit. A real number that is not finite is of no type.
    pub fn convert(self, ty: ValueType) -> Option<Value> {
        match ty {
            ValueType::U32 => self.as_u32().map(Value::U32),
            ValueType::I32 => match self {
                Value::U32(n) => i32::try_from(n).ok().map(Value::I32),
                Value::I32(_) => Some(self),
                _ => None,
            },
            ValueType::F32 => self.as_f32().filter(|x| x.is_finite()).map(Value::F32),
            ValueType::Vector(_) => match &self {
                Value::Vector(v) if v.iter().all(|x| x.is_finite()) && self.ty() == ty => Some(self),
                _ => None,
            },
            ValueType::Bool | ValueType::Text => (self.ty() == ty).then_some(self),
        }
    }

    /// Returns it as a truth value; `None` for other types.
    pub fn as_bool(&self) -> Option<bool> {
        if let Value::Bool(b) = self { Some(*b) } else { None }
    }

    /// Returns it as an integer that is not negative.
    pub fn as_u32(&self) -> Option<u32> {
        match self {
            Value::U32(n) => Some(*n),
            Value::I32(n) => u32::try_from(*n).ok(),
            _ => None,
        }
    }

    /// Returns it as a real number; integers convert.
    pub fn as_f32(&self) -> Option<f32> {
        match self {
            Value::F32(x) => Some(*x),
            Value::U32(n) => Some(*n as f32),
            Value::I32(n) => Some(*n as f32),
            _ => None,
        }
    }

    /// Returns it as text.
    pub fn as_text(&self) -> Option<&str> {
        if let Value::Text(t) = self { Some(t) } else { None }
    }
}

impl Value {
    /// Returns the value as it is typed on a command line: as RON writes it, but text without quotation marks.
    pub fn to_argument(&self) -> String {
        match self {
            Value::Text(text) => text.clone(),
            other => other.to_string(),
        }
    }
}

impl fmt::Display for Value {
    /// Writes the value as RON does.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Bool(b) => write!(f, "{b}"),
            Value::U32(n) => write!(f, "{n}"),
            Value::I32(n) => write!(f, "{n}"),
            Value::F32(x) => write!(f, "{x:?}"),
            Value::Text(t) => write!(f, "{t:?}"),
            Value::Vector(v) => {
                f.write_str("(")?;
                for (i, x) in v.iter().enumerate() {
                    write!(f, "{}{x:?}", if i == 0 { "" } else { ", " })?;
                }
                f.write_str(")")
            }
        }
    }
}

impl fmt::Display for ValueType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ValueType::Bool => f.write_str("bool"),
            ValueType::U32 => f.write_str("u32"),
            ValueType::I32 => f.write_str("i32"),
            ValueType::F32 => f.write_str("f32"),
            ValueType::Text => f.write_str("text"),
            ValueType::Vector(n) => write!(f, "vec{n}"),
        }
    }
}

impl ValueType {
    /// Returns the value of this type that is false, zero or empty.
    pub fn zero(self) -> Value {
        match self {
            ValueType::Bool => Value::Bool(false),
            ValueType::U32 => Value::U32(0),
            ValueType::I32 => Value::I32(0),
            ValueType::F32 => Value::F32(0.0),
            ValueType::Text => Value::Text(String::new()),
            ValueType::Vector(n) => Value::Vector(vec![0.0; usize::from(n)]),
        }
    }

    /// Returns the form that declares a parameter of this type.
    pub fn form(self) -> &'static str {
        match self {
            ValueType::Bool => "Bool",
            ValueType::U32 => "U32",
            ValueType::I32 => "I32",
            ValueType::F32 => "F32",
            ValueType::Text | ValueType::Vector(_) => "Text",
        }
    }

    /// Returns the type with its article: `a u32`, `an f32`, `text`.
    pub fn with_article(self) -> String {
        match self {
            ValueType::Text => "text".to_owned(),
            ValueType::I32 | ValueType::F32 => format!("an {self}"),
            _ => format!("a {self}"),
        }
    }
}

impl Settings {
    /// Returns the value of `name`, if there is such a setting.
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.0.get(name)
    }
}
