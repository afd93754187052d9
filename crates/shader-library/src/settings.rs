//! Settings declared in the doc comments of `struct Settings`:
//!
//! ```wgsl
//! struct Settings {
//!     /// Brightness. [default: 1.0, min: 0.0, max: 4.0, unit: "EV"]
//!     exposure: f32,
//! }
//! ```

use crate::codes;
use crate::composed::Composed;
use crate::doc_reader::{Literal, Problem, Reader};
use crate::layout::StructLayout;
use crate::scan::{FoundMember, find_struct};
use data_file::{Diagnostic, Diagnostics, Setting, Value, ValueType, nearest};
use std::collections::BTreeMap;
use std::ops::Range;

const KEYS: [&str; 6] = ["default", "min", "max", "unit", "one_of", "bool"];

/// The most settings of a shader: each is a control of the window and a row of the reference.
const MAX_SETTINGS: usize = 256;

/// The struct whose members can be settings.
pub(crate) const STRUCT: &str = "Settings";

/// Returns the name of the setting that a member is: a name that WGSL reserves has an underscore behind it.
pub fn setting_name(member: &str) -> &str {
    member.trim_end_matches('_')
}

/// Reads the declarations of `struct Settings`. Where its layout is not known, types are as they are written.
pub(crate) fn read(composed: &Composed, layout: Option<&StructLayout>) -> Result<Vec<Setting>, Diagnostics> {
    let Some(found) = find_struct(&composed.text, STRUCT) else { return Ok(Vec::new()) };
    let mut declared = Vec::new();
    let mut errors: Vec<Diagnostic> = Vec::new();
    let types = |layout: &'_ StructLayout| -> BTreeMap<String, String> {
        layout.members.iter().map(|member| (member.name.clone(), member.ty.clone())).collect()
    };
    let types = layout.map(types);
    for member in &found.members {
        let ty = types.as_ref().map_or(Some(&member.ty), |types| types.get(&member.name));
        let Some(ty) = ty.map(String::as_str) else { continue };
        if declared.len() + errors.len() >= MAX_SETTINGS {
            let message = format!("there are more than {MAX_SETTINGS} settings");
            let place = member.range.start as u32..member.range.end as u32;
            errors.push(composed.diagnostic(&codes::EXTENT, message, [(place, String::new())], []));
            break;
        }
        match declaration(member, ty) {
            Ok(setting) => declared.extend(setting.map(|setting| {
                let place = composed.map.span(member.range.start as u32..member.range.end as u32);
                Setting { declared: place.map_or_else(String::new, |place| place.to_string()), ..setting }
            })),
            Err(problem) => {
                let place = if problem.range.is_empty() {
                    member.range.start as u32..member.range.end as u32
                } else {
                    member.doc.place(problem.range)
                };
                let message = format!("the setting `{}`: {}", member.name, problem.message);
                errors.push(composed.diagnostic(
                    &codes::SETTING,
                    message,
                    [(place, String::new())],
                    problem.note,
                ));
            }
        }
    }
    if errors.is_empty() { Ok(declared) } else { Err(Diagnostics(errors)) }
}

/// Whether a bracket is a declaration and not prose such as `[0, 1)` or `[px]`: it begins with `key:`, or
/// with what is nearly one of the longer keys.
fn declares(inside: &str) -> bool {
    let inside = inside.trim_start();
    let len = inside.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(inside.len());
    let (word, rest) = inside.split_at(len);
    // Short words of prose are parts of the keys, such as `one`.
    let known = KEYS.contains(&word) || (word.len() > 4 && nearest(word, ["default", "one_of"]).is_some());
    !word.is_empty() && (known || rest.trim_start().starts_with(':'))
}

fn declaration(member: &FoundMember, ty: &str) -> Result<Option<Setting>, Problem> {
    let text = &member.doc.text;
    let starts: Vec<usize> =
        text.match_indices('[').map(|(i, _)| i).filter(|&i| declares(&text[i + 1..])).collect();
    let Some(&start) = starts.first() else { return Ok(None) };
    let mut reader = Reader::new(text, start + 1);
    let fields = reader.fields()?;
    let end = reader.at;
    if let Some(&second) = starts.iter().find(|&&other| other >= end) {
        return Err(Problem::new(second..second + 1, "declared twice"));
    }
    let (before, after) = (text[..start].trim_end(), &text[end..]);
    // The full stop of a sentence may stand before the bracket, behind it, or both.
    let after = if before.ends_with('.') { after.strip_prefix('.').unwrap_or(after) } else { after };
    let doc = format!("{before}{after}").trim().to_owned();
    setting(setting_name(&member.name), ty, doc, fields, start..end).map(Some)
}

/// What stands in a bracket, with the places of the values.
#[derive(Default)]
struct Fields {
    default: Option<(Literal, Range<usize>)>,
    min: Option<(Literal, Range<usize>)>,
    max: Option<(Literal, Range<usize>)>,
    unit: Option<(Literal, Range<usize>)>,
    one_of: Option<(Literal, Range<usize>)>,
    is_bool: bool,
}

impl Reader<'_> {
    /// `key: value, …]`
    fn fields(&mut self) -> Result<Fields, Problem> {
        let mut fields = Fields::default();
        loop {
            let (key, range) = self.word();
            if key.is_empty() {
                return Err(Problem::new(self.here(), "expected default, min, max, unit, one_of or bool"));
            }
            let slot = match key.as_str() {
                "bool" => {
                    fields.is_bool = true;
                    None
                }
                "default" => Some(&mut fields.default),
                "min" => Some(&mut fields.min),
                "max" => Some(&mut fields.max),
                "unit" => Some(&mut fields.unit),
                "one_of" => Some(&mut fields.one_of),
                other => {
                    let problem = Problem::new(range, format!("there is no `{other}`"));
                    return Err(match nearest(other, KEYS) {
                        Some(near) => problem.note(format!("did you mean `{near}`?")),
                        None => problem.note(format!("there are {}", KEYS.join(", "))),
                    });
                }
            };
            if let Some(slot) = slot {
                if !self.accept(':') {
                    return Err(Problem::new(self.here(), format!("expected `:` after `{key}`")));
                }
                if slot.is_some() {
                    return Err(Problem::new(range, format!("`{key}` is given twice")));
                }
                *slot = Some(self.literal(0)?);
            }
            if self.accept(']') {
                return Ok(fields);
            }
            if !self.accept(',') {
                return Err(Problem::new(self.here(), "expected `,` or `]`"));
            }
        }
    }
}

/// The setting that a bracket at `bracket` declares.
fn setting(
    name: &str,
    ty: &str,
    doc: String,
    fields: Fields,
    bracket: Range<usize>,
) -> Result<Setting, Problem> {
    let words = |literal: &Literal| matches!(literal, Literal::List(items) if matches!(items.first(), Some((Literal::Text(_), _))));
    let choice = fields.one_of.as_ref().is_some_and(|(literal, _)| words(literal));
    let value_type = match ty {
        "u32" if fields.is_bool => ValueType::Bool,
        "u32" if choice => ValueType::Text,
        "u32" => ValueType::U32,
        "i32" => ValueType::I32,
        "f32" => ValueType::F32,
        "vec2<f32>" => ValueType::Vector(2),
        "vec3<f32>" => ValueType::Vector(3),
        "vec4<f32>" => ValueType::Vector(4),
        other => {
            return Err(Problem::new(0..0, format!("a setting cannot be of type `{other}`"))
                .note("it can be f32, i32, u32, u32 with `bool`, or vec2, vec3, vec4 of f32"));
        }
    };
    if fields.is_bool && value_type != ValueType::Bool {
        return Err(Problem::new(bracket, format!("`bool` wants a u32; this is `{ty}`")));
    }
    let typed = |(literal, range): &(Literal, Range<usize>)| {
        value(literal, value_type)
            .ok_or_else(|| Problem::new(range.clone(), format!("not a value of type {value_type}")))
    };
    let number = |field: &Option<(Literal, Range<usize>)>| match field {
        None => Ok(None),
        Some((Literal::Number(number), range))
            if !matches!(value_type, ValueType::Bool | ValueType::Text) =>
        {
            number.parse().map(Some).map_err(|_| Problem::new(range.clone(), "not a number"))
        }
        Some((_, range)) => {
            Err(Problem::new(range.clone(), format!("not a bound of a value of type {value_type}")))
        }
    };
    let (min, max) = (number(&fields.min)?, number(&fields.max)?);
    if let (Some(min), Some(max), Some((_, range))) = (min, max, &fields.max)
        && min > max
    {
        return Err(Problem::new(range.clone(), "the greatest value is below the least"));
    }
    let one_of = match &fields.one_of {
        None => Vec::new(),
        Some((Literal::List(items), _)) if !items.is_empty() && value_type != ValueType::Bool => {
            items.iter().map(typed).collect::<Result<_, _>>()?
        }
        Some((_, range)) => {
            return Err(Problem::new(range.clone(), "expected a list of values, as in `[1, 2, 4]`"));
        }
    };
    let unit = match fields.unit {
        None => String::new(),
        Some((Literal::Text(unit), _)) => unit,
        Some((_, range)) => return Err(Problem::new(range, "a unit is text: \"px\"")),
    };
    let Some(default) = &fields.default else {
        return Err(Problem::new(bracket, "no default").note("every setting has one: `[default: 1.0]`"));
    };
    let default_range = default.1.clone();
    let default = typed(default)?;
    let components: Vec<f64> = match &default {
        Value::Vector(components) => components.iter().map(|x| f64::from(*x)).collect(),
        Value::U32(n) => vec![f64::from(*n)],
        Value::I32(n) => vec![f64::from(*n)],
        // Bounds are written in decimal, as the default is: 0.1 is not below 0.1 because an f32 is.
        Value::F32(_) => match &fields.default {
            Some((Literal::Number(number), _)) => number.parse().into_iter().collect(),
            _ => Vec::new(),
        },
        Value::Bool(_) | Value::Text(_) => Vec::new(),
    };
    let outside = |x: &f64| min.is_some_and(|min| *x < min) || max.is_some_and(|max| *x > max);
    if components.iter().any(outside) {
        return Err(Problem::new(default_range, "the default is out of range"));
    }
    if !one_of.is_empty() && !one_of.contains(&default) {
        return Err(Problem::new(default_range, "the default is not in `one_of`"));
    }
    Ok(Setting {
        name: name.to_owned(),
        ty: value_type,
        default,
        min,
        max,
        one_of,
        unit,
        doc,
        declared: String::new(),
    })
}

/// A literal as a value of a type; `None` where it is none.
fn value(literal: &Literal, ty: ValueType) -> Option<Value> {
    match (ty, literal) {
        (ValueType::Bool, Literal::Bool(b)) => Some(Value::Bool(*b)),
        (ValueType::U32, Literal::Number(n)) => n.parse().ok().map(Value::U32),
        (ValueType::I32, Literal::Number(n)) => n.parse().ok().map(Value::I32),
        (ValueType::F32, Literal::Number(n)) => {
            n.parse().ok().filter(|x: &f32| x.is_finite()).map(Value::F32)
        }
        (ValueType::Text, Literal::Text(text)) => Some(Value::Text(text.clone())),
        (ValueType::Vector(count), Literal::List(items)) if items.len() == usize::from(count) => {
            let component = |(item, _): &(Literal, Range<usize>)| value(item, ValueType::F32)?.as_f32();
            items.iter().map(component).collect::<Option<Vec<f32>>>().map(Value::Vector)
        }
        _ => None,
    }
}
