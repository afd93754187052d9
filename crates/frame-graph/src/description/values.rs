//! Values: links, settings, colours, sizes.

use super::form::{At, Dim, SetValue, Size, Target, is_name};
use super::read::Grammar;
use crate::codes;
use crate::reader::{Form, Node, Number};
use crate::resource::Clear;
use crate::value::Value;
use data_file::Name;

impl Grammar<'_, '_> {
    /// Where the text of a link ends, if it can be pointed into.
    pub(super) fn content_end(node: &Node) -> Option<u32> {
        match &node.form {
            Form::Text(text, Some(content)) => Some(content + text.len() as u32),
            _ => None,
        }
    }

    pub(super) fn target(&mut self, node: &Node) -> Option<At<Target>> {
        let text = self.text(node, "a link: \"pass\", \"pass.port\" or \"pass.port.member\"")?;
        let place = self.place(node);
        let target = Target::parse(text);
        if target.is_none() {
            let error = self.error(&codes::BAD_NAME, place, format!("{text:?} cannot be read as a link"));
            error.notes.push("a link is \"pass\", \"pass.port\" or \"pass.port.member\"".into());
        }
        Some(At { value: target?, place })
    }

    pub(super) fn clear(&mut self, node: &Node, main: &str, others: &[&str]) -> Option<Clear> {
        match &node.form {
            Form::Word(word) if word == main || others.contains(&word.as_str()) => return Some(Clear::Zero),
            Form::Tuple(Some(name), items) if name.text == "Color" => {
                if let Some(Value::Vector(v)) = self.vector(items)
                    && let [r, g, b, a] = v[..]
                {
                    return Some(Clear::Color([r, g, b, a]));
                }
                self.wrong(node, "`Color(r, g, b, a)`, four numbers");
                return None;
            }
            _ => {}
        }
        self.wrong(node, &format!("`{main}` or `Color(r, g, b, a)`"));
        None
    }

    pub(super) fn vector(&self, items: &[Node]) -> Option<Value> {
        let number = |item: &Node| match item.form {
            Form::Number(Number::Integer(n)) => Some(n as f32),
            Form::Number(Number::Float(x)) => Some(x as f32).filter(|x| x.is_finite()),
            _ => None,
        };
        let numbers: Option<Vec<f32>> = items.iter().map(number).collect();
        numbers.filter(|v| (2..=4).contains(&v.len())).map(Value::Vector)
    }

    /// A value of a setting, or `"$parameter"`.
    pub(super) fn value(&mut self, node: &Node) -> Option<SetValue> {
        let value = match &node.form {
            Form::Bool(b) => Value::Bool(*b),
            Form::Number(Number::Integer(n)) => {
                if let Ok(n) = u32::try_from(*n) {
                    Value::U32(n)
                } else if let Ok(n) = i32::try_from(*n) {
                    Value::I32(n)
                } else {
                    Value::F32(*n as f32)
                }
            }
            Form::Number(Number::Float(x)) if (*x as f32).is_finite() => Value::F32(*x as f32),
            Form::Number(_) => {
                self.wrong(node, "a finite number");
                return None;
            }
            Form::Text(text, _) => match text.strip_prefix('$') {
                Some(rest) if rest.starts_with('$') => Value::Text(rest.to_owned()),
                Some(name) if is_name(name) => return Some(SetValue::Parameter(Name::from(name), None)),
                Some(_) => {
                    self.wrong(
                        node,
                        "the name of a parameter after `$` (plain text that starts so is written `$$`)",
                    );
                    return None;
                }
                None => Value::Text(text.clone()),
            },
            Form::Tuple(None, items) | Form::List(items) if self.vector(items).is_some() => {
                self.vector(items)?
            }
            _ => {
                self.wrong(
                    node,
                    "a value: true or false, a number, text, two to four numbers, or \"$parameter\"",
                );
                return None;
            }
        };
        Some(SetValue::Value(value))
    }

    pub(super) fn dim(&mut self, node: &Node, expected: &str) -> Option<Dim> {
        let dim = match &node.form {
            Form::Number(Number::Integer(n)) => u32::try_from(*n).ok().filter(|n| *n > 0).map(Dim::Number),
            Form::Text(text, _) => text
                .strip_prefix('$')
                .filter(|name| is_name(name))
                .map(|name| Dim::Parameter(Name::from(name))),
            _ => None,
        };
        if dim.is_none() {
            self.wrong(node, expected);
        }
        dim
    }

    pub(super) fn size(&mut self, node: &Node) -> Option<At<Size>> {
        const EXPECTED: &str = "a size: \"frame\", \"frame / 4\", \"like(input) * 3 / 2\" or (width, height)";
        let place = self.place(node);
        let value = match &node.form {
            Form::Text(text, _) => {
                let size = relation(text);
                if size.is_none() {
                    self.wrong(node, EXPECTED);
                }
                size?
            }
            Form::Tuple(None, items) if items.len() == 2 => {
                let side = "a side in texels: a whole number above zero, or \"$parameter\"";
                let (w, h) = (self.dim(&items[0], side), self.dim(&items[1], side));
                Size::Fixed(w?, h?)
            }
            _ => {
                self.wrong(node, EXPECTED);
                return None;
            }
        };
        Some(At { value, place })
    }
}

/// `frame`, `frame / 4`, `like(input) * 3 / 2`; numbers may be `$parameter`.
fn relation(text: &str) -> Option<Size> {
    let dim = |text: &str| match text.strip_prefix('$') {
        Some(name) => is_name(name).then(|| Dim::Parameter(Name::from(name))),
        None => text.parse().ok().filter(|n| *n > 0).map(Dim::Number),
    };
    let text = text.trim();
    let (base, rest) = match text.strip_prefix("like") {
        Some(rest) => {
            let (input, rest) = rest.trim_start().strip_prefix('(')?.split_once(')')?;
            let input = input.trim().trim_matches(['\'', '"']);
            (Some(Name::from(input)).filter(|n| is_name(n))?, rest)
        }
        None => (Name::EMPTY, text.strip_prefix("frame")?),
    };
    let rest = rest.trim();
    let (num, den) = match rest.split_once('/') {
        Some((num, den)) => (num.trim(), dim(den.trim())?),
        None => (rest, Dim::Number(1)),
    };
    let num = if num.is_empty() { Dim::Number(1) } else { dim(num.strip_prefix('*')?.trim())? };
    Some(if base.is_empty() { Size::Frame(num, den) } else { Size::Like(base, num, den) })
}
