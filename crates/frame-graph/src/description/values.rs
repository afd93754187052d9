//! Values: links, settings, colors, sizes.

use super::form::{At, Dim, Formula, SetValue, Size, Target, TextPlace, is_name};
use super::read::Grammar;
use crate::codes;
use crate::expression::{self, Expr, ExprError, ExprKind, parse_scale};
use crate::reader::{Form, Node, Number};
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
        self.target_of(node, text)
    }

    /// The target that the text of a node, or the end of it, names.
    pub(super) fn target_of(&mut self, node: &Node, text: &str) -> Option<At<Target>> {
        let place = self.place(node);
        let target = Target::parse(text);
        if target.is_none() {
            let error = self.error(&codes::BAD_NAME, place, format!("{text:?} cannot be read as a link"));
            error.notes.push("a link is \"pass\", \"pass.port\" or \"pass.port.member\"".into());
        }
        Some(At { value: target?, place })
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

    /// An expression that was read from the text of a node, or the error that it gave.
    pub(super) fn expression(
        &mut self,
        node: &Node,
        content: Option<u32>,
        parsed: Result<Expr, ExprError>,
    ) -> Option<Formula> {
        let text = TextPlace { place: self.place(node), content };
        match parsed {
            Ok(expr) => Some(Formula { expr, text }),
            Err(error) => {
                let at = text.within(error.start, error.end);
                self.error(error.code, at, error.message).notes = error.notes;
                None
            }
        }
    }

    /// An expression that may ask about parameters alone.
    fn formula(
        &mut self,
        node: &Node,
        content: Option<u32>,
        parsed: Result<Expr, ExprError>,
    ) -> Option<Formula> {
        let parsed = parsed.and_then(|expr| match expr.question() {
            None => Ok(expr),
            Some(question) => Err(ExprError {
                code: &codes::EXPRESSION_NAME,
                start: question.start,
                end: question.end,
                message: "only `when:` can ask about the scene and about inputs".into(),
                notes: vec!["a value is worked out from numbers and parameters".into()],
            }),
        });
        self.expression(node, content, parsed)
    }

    /// A value of a setting, or an expression that gives one.
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
            Form::Text(text, content) => match (plain(text), text.strip_prefix('$')) {
                (Some(text), _) => Value::Text(text),
                (None, Some(name)) if is_name(name) => {
                    return Some(SetValue::Parameter(Name::from(name), None));
                }
                (None, _) => {
                    let parsed = expression::parse(text).map_err(|mut error| {
                        error.notes.push(
                            "text with a `$` in it is an expression: in plain text, it is written `$$`"
                                .into(),
                        );
                        error
                    });
                    let formula = self.formula(node, *content, parsed)?;
                    return Some(SetValue::Formula(Box::new(formula), None));
                }
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
        match &node.form {
            Form::Text(text, content) if text.contains('$') => {
                let formula = self.formula(node, *content, expression::parse(text))?;
                return Some(Dim::Formula(Box::new(formula)));
            }
            _ => {}
        }
        let number = positive(node).map(Dim::Number);
        if number.is_none() {
            self.wrong(node, expected);
        }
        number
    }

    pub(super) fn size(&mut self, node: &Node) -> Option<At<Size>> {
        const EXPECTED: &str = "a size: \"frame\", \"frame / 4\", \"like(input) * 3 / 2\" or (width, height)";
        let place = self.place(node);
        let value = match &node.form {
            Form::Text(text, content) => {
                let Some((input, rest)) = base(text) else {
                    self.wrong(node, EXPECTED);
                    return None;
                };
                let (factor, divisor) = match parse_scale(text, rest) {
                    Ok((factor, divisor)) => (factor.map(Ok), divisor.map(Ok)),
                    Err(error) => (Some(Err(error)), None),
                };
                let mut dim = |part: Option<Result<Expr, ExprError>>| match part {
                    None => Some(Dim::Number(1)),
                    Some(Ok(Expr { kind: ExprKind::Value(Value::U32(n @ 1..)), .. })) => Some(Dim::Number(n)),
                    Some(parsed) => {
                        let formula = self.formula(node, *content, parsed)?;
                        Some(Dim::Formula(Box::new(formula)))
                    }
                };
                let (num, den) = (dim(factor)?, dim(divisor)?);
                match input {
                    None => Size::Frame(num, den),
                    Some(input) => Size::Like(input, num, den),
                }
            }
            Form::Tuple(None, items) if items.len() == 2 => {
                let side =
                    "a side in texels: a whole number above zero, or an expression such as \"$map * 2\"";
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

/// The text that is meant where it is no expression: `$$` stands for `$`. Text that begins with `$$` is never one.
fn plain(text: &str) -> Option<String> {
    if !text.contains('$') {
        return Some(text.to_owned());
    }
    let literal = text.starts_with("$$") || !text.replace("$$", "").contains('$');
    literal.then(|| text.replace("$$", "$"))
}

/// `frame` or `like(input)` at the beginning of a size, and where what follows begins.
fn base(text: &str) -> Option<(Option<Name>, usize)> {
    let start = text.trim_start();
    let at = |rest: &str| text.len() - rest.len();
    let Some(rest) = start.strip_prefix("like") else {
        return Some((None, at(start.strip_prefix("frame")?)));
    };
    let (input, rest) = rest.trim_start().strip_prefix('(')?.split_once(')')?;
    let input = input.trim().trim_matches(['\'', '"']);
    is_name(input).then(|| (Some(Name::from(input)), at(rest)))
}

/// The number that a node is, where it is whole and above 0.
pub(super) fn positive(node: &Node) -> Option<u32> {
    let Form::Number(Number::Integer(n)) = node.form else { return None };
    u32::try_from(n).ok().filter(|n| *n > 0)
}
