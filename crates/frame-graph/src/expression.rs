//! The closed expressions of `when:`: over traits of the scene, parameters, and whether an input is linked.

use crate::codes::{self, Code};
use crate::diagnostic::nearest;
use crate::value::Value;
use data_file::Name;
use std::fmt;

/// Deepest nesting of an expression.
const MAX_DEPTH: u32 = 64;

/// An expression, with the bytes of the text that it covers.
#[derive(Clone, Debug)]
pub(crate) struct Expr {
    pub(crate) start: u32,
    pub(crate) end: u32,
    pub(crate) kind: ExprKind,
}

#[derive(Clone, Debug)]
pub(crate) enum ExprKind {
    Value(Value),
    /// `scene.NAME`
    Trait(Name),
    /// `$NAME` or `NAME`; its value once it is known.
    Parameter(Name, Option<Value>),
    /// `connected(PORT)`
    Connected(Name),
    Not(Box<Expr>),
    Binary(Op, Box<Expr>, Box<Expr>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Op {
    Or,
    And,
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
}

/// The types of expressions: all numbers are one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ty {
    Bool,
    Number,
    Text,
    Vector,
}

/// What is wrong with an expression, and at which bytes of it.
#[derive(Debug)]
pub(crate) struct ExprError {
    pub(crate) code: &'static Code,
    pub(crate) start: u32,
    pub(crate) end: u32,
    pub(crate) message: String,
    pub(crate) notes: Vec<String>,
}

/// What the names of an expression stand for.
pub(crate) trait Env {
    /// The value of a trait of the scene.
    fn scene(&self, name: &str) -> Option<&Value>;
    /// The traits there are.
    fn scene_names(&self) -> Vec<String>;
    /// Whether the pass links an input of that name to something that is on; `None` where it has none.
    fn connected(&self, port: &str) -> Option<bool>;
    /// The inputs there are.
    fn ports(&self) -> Vec<String>;
}

impl Op {
    fn text(self) -> &'static str {
        match self {
            Op::Or => "||",
            Op::And => "&&",
            Op::Equal => "==",
            Op::NotEqual => "!=",
            Op::Less => "<",
            Op::LessEqual => "<=",
            Op::Greater => ">",
            Op::GreaterEqual => ">=",
        }
    }
}

impl Ty {
    fn of(value: &Value) -> Ty {
        match value {
            Value::Bool(_) => Ty::Bool,
            Value::U32(_) | Value::I32(_) | Value::F32(_) => Ty::Number,
            Value::Text(_) => Ty::Text,
            Value::Vector(_) => Ty::Vector,
        }
    }
}

impl fmt::Display for Ty {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Ty::Bool => "a truth value",
            Ty::Number => "a number",
            Ty::Text => "text",
            Ty::Vector => "a vector",
        })
    }
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
}

/// Reads an expression.
pub(crate) fn parse(text: &str) -> Result<Expr, ExprError> {
    let mut parser = Parser { text, at: 0 };
    let expr = parser.or(0)?;
    parser.blanks();
    if parser.at < text.len() {
        return Err(parser.error(parser.at, "expected `&&`, `||`, a comparison, or the end"));
    }
    Ok(expr)
}

impl Parser<'_> {
    fn error(&self, start: usize, message: impl Into<String>) -> ExprError {
        let end = self.text[start..].chars().next().map_or(start, |c| start + c.len_utf8());
        ExprError {
            code: &codes::EXPRESSION,
            start: start as u32,
            end: end.max(self.at) as u32,
            message: message.into(),
            notes: Vec::new(),
        }
    }

    fn rest(&self) -> &str {
        &self.text[self.at..]
    }

    fn blanks(&mut self) {
        let rest = self.rest();
        self.at += rest.len() - rest.trim_start().len();
    }

    fn eat(&mut self, text: &str) -> bool {
        self.blanks();
        let found = self.rest().starts_with(text);
        if found {
            self.at += text.len();
        }
        found
    }

    fn binary(op: Op, left: Expr, right: Expr) -> Expr {
        let (start, end) = (left.start, right.end);
        Expr { start, end, kind: ExprKind::Binary(op, Box::new(left), Box::new(right)) }
    }

    fn or(&mut self, depth: u32) -> Result<Expr, ExprError> {
        let mut left = self.and(depth)?;
        let mut length = depth;
        while self.eat("||") {
            length = self.deeper(length)?;
            left = Self::binary(Op::Or, left, self.and(depth)?);
        }
        Ok(left)
    }

    fn and(&mut self, depth: u32) -> Result<Expr, ExprError> {
        let mut left = self.comparison(depth)?;
        let mut length = depth;
        while self.eat("&&") {
            length = self.deeper(length)?;
            left = Self::binary(Op::And, left, self.comparison(depth)?);
        }
        Ok(left)
    }

    fn comparison(&mut self, depth: u32) -> Result<Expr, ExprError> {
        let left = self.unary(depth)?;
        let ops = [Op::Equal, Op::NotEqual, Op::LessEqual, Op::GreaterEqual, Op::Less, Op::Greater];
        for op in ops {
            if self.eat(op.text()) {
                return Ok(Self::binary(op, left, self.unary(depth)?));
            }
        }
        Ok(left)
    }

    fn deeper(&self, depth: u32) -> Result<u32, ExprError> {
        if depth >= MAX_DEPTH {
            let message = format!("this expression is nested more than {MAX_DEPTH} deep");
            return Err(ExprError {
                code: &codes::NESTING,
                ..self.error(self.at.min(self.text.len()), message)
            });
        }
        Ok(depth + 1)
    }

    fn unary(&mut self, depth: u32) -> Result<Expr, ExprError> {
        self.blanks();
        let start = self.at;
        if !self.rest().starts_with("!=") && self.eat("!") {
            let inner = self.unary(self.deeper(depth)?)?;
            return Ok(Expr { start: start as u32, end: inner.end, kind: ExprKind::Not(Box::new(inner)) });
        }
        if self.eat("(") {
            let inner = self.or(self.deeper(depth)?)?;
            if !self.eat(")") {
                return Err(self.error(self.at, "expected `)`"));
            }
            return Ok(inner);
        }
        let kind = self.atom(start)?;
        Ok(Expr { start: start as u32, end: self.at as u32, kind })
    }

    fn name(&mut self) -> &str {
        let start = self.at;
        let rest = self.rest();
        let len = rest.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == '-')).unwrap_or(rest.len());
        self.at += len;
        &self.text[start..self.at]
    }

    fn atom(&mut self, start: usize) -> Result<ExprKind, ExprError> {
        let first = self.rest().chars().next();
        match first {
            Some(quote @ ('"' | '\'')) => {
                let Some(len) = self.rest()[1..].find(quote) else {
                    return Err(self.error(start, "this text is not closed"));
                };
                let text = self.rest()[1..1 + len].to_owned();
                self.at += len + 2;
                Ok(ExprKind::Value(Value::Text(text)))
            }
            Some('0'..='9' | '-' | '.' | '+') => {
                let rest = self.rest();
                let is_number = |(i, c): (usize, char)| {
                    c.is_ascii_alphanumeric()
                        || matches!(c, '.' | '_')
                        || matches!(c, '-' | '+') && (i == 0 || rest[..i].ends_with(['e', 'E']))
                };
                let len = rest.char_indices().find(|x| !is_number(*x)).map_or(rest.len(), |(i, _)| i);
                let digits = rest[..len].replace('_', "");
                self.at += len;
                let value = if let Ok(n) = digits.parse() {
                    Value::U32(n)
                } else if let Ok(n) = digits.parse() {
                    Value::I32(n)
                } else if let Some(x) = digits.parse().ok().filter(|x: &f32| x.is_finite()) {
                    Value::F32(x)
                } else {
                    return Err(self.error(start, format!("`{digits}` is not a number")));
                };
                Ok(ExprKind::Value(value))
            }
            Some('$') => {
                self.at += 1;
                let name = Name::from(self.name());
                if name.is_empty() {
                    return Err(self.error(start, "expected the name of a parameter after `$`"));
                }
                Ok(ExprKind::Parameter(name, None))
            }
            Some(c) if c.is_alphabetic() || c == '_' => {
                let word = self.name().to_owned();
                match word.as_str() {
                    "true" => Ok(ExprKind::Value(Value::Bool(true))),
                    "false" => Ok(ExprKind::Value(Value::Bool(false))),
                    "scene" if self.rest().starts_with('.') => {
                        self.at += 1;
                        let name = Name::from(self.name());
                        if name.is_empty() {
                            return Err(self.error(self.at, "expected the name of a trait after `scene.`"));
                        }
                        Ok(ExprKind::Trait(name))
                    }
                    _ if self.eat("(") => {
                        if word != "connected" {
                            let mut error = self.error(start, format!("there is no function `{word}`"));
                            error.code = &codes::EXPRESSION_NAME;
                            error.notes.push("the only function is `connected(input)`".into());
                            return Err(error);
                        }
                        self.blanks();
                        let quoted = self.eat("'") || self.eat("\"");
                        let port = Name::from(self.name());
                        let closed = (!quoted || self.eat("'") || self.eat("\"")) && self.eat(")");
                        if port.is_empty() || !closed {
                            return Err(self.error(self.at, "expected the name of an input and `)`"));
                        }
                        Ok(ExprKind::Connected(port))
                    }
                    _ => Ok(ExprKind::Parameter(Name::from(word), None)),
                }
            }
            Some(_) => Err(self.error(start, "expected a name, a value, `!` or `(`")),
            None => Err(self.error(start, "expected a name or a value before the end")),
        }
    }
}

impl Expr {
    /// Calls `f` with every parameter: its place, its name, and where its value goes.
    pub(crate) fn parameters(&mut self, f: &mut impl FnMut((u32, u32), &Name, &mut Option<Value>)) {
        match &mut self.kind {
            ExprKind::Parameter(name, value) => f((self.start, self.end), name, value),
            ExprKind::Not(inner) => inner.parameters(f),
            ExprKind::Binary(_, left, right) => {
                left.parameters(f);
                right.parameters(f);
            }
            ExprKind::Value(_) | ExprKind::Trait(_) | ExprKind::Connected(_) => {}
        }
    }

    /// The inputs that it asks about.
    pub(crate) fn connected<'e>(&'e self, out: &mut Vec<&'e Name>) {
        match &self.kind {
            ExprKind::Connected(port) => out.push(port),
            ExprKind::Not(inner) => inner.connected(out),
            ExprKind::Binary(_, left, right) => {
                left.connected(out);
                right.connected(out);
            }
            ExprKind::Value(_) | ExprKind::Trait(_) | ExprKind::Parameter(..) => {}
        }
    }

    /// Checks that every name is known and every operation fits its operands.
    pub(crate) fn check(&self, env: &dyn Env, wanted: Ty) -> Result<(), ExprError> {
        let found = self.ty(env)?;
        if found == wanted {
            return Ok(());
        }
        Err(self.error(&codes::EXPRESSION_TYPE, format!("expected {wanted}, found {found}")))
    }

    fn error(&self, code: &'static Code, message: String) -> ExprError {
        ExprError { code, start: self.start, end: self.end, message, notes: Vec::new() }
    }

    fn ty(&self, env: &dyn Env) -> Result<Ty, ExprError> {
        let unknown = |message: String, name: &str, what: &str, known: Vec<String>| {
            let mut error = self.error(&codes::EXPRESSION_NAME, message);
            if let Some(near) = nearest(name, known.iter().map(String::as_str)) {
                error.notes.push(format!("did you mean `{near}`?"));
            }
            error.notes.push(format!("{what}: {}", known.join(", ")));
            error
        };
        match &self.kind {
            ExprKind::Value(value) => Ok(Ty::of(value)),
            ExprKind::Parameter(name, value) => match value {
                Some(value) => Ok(Ty::of(value)),
                None => Err(self.error(&codes::UNKNOWN_PARAMETER, format!("there is no parameter `{name}`"))),
            },
            ExprKind::Trait(name) => env.scene(name).map(Ty::of).ok_or_else(|| {
                let message = format!("scenes have no trait `{name}`");
                unknown(message, name, "traits of a scene", env.scene_names())
            }),
            ExprKind::Connected(port) => env
                .connected(port)
                .map(|_| Ty::Bool)
                .ok_or_else(|| unknown(format!("there is no input `{port}`"), port, "inputs", env.ports())),
            ExprKind::Not(inner) => inner.check(env, Ty::Bool).map(|()| Ty::Bool),
            ExprKind::Binary(Op::And | Op::Or, left, right) => {
                left.check(env, Ty::Bool)?;
                right.check(env, Ty::Bool)?;
                Ok(Ty::Bool)
            }
            ExprKind::Binary(op, left, right) => {
                let (l, r) = (left.ty(env)?, right.ty(env)?);
                let ordered = !matches!(op, Op::Equal | Op::NotEqual);
                if l != r || (ordered && l != Ty::Number) {
                    let message = format!("`{}` cannot compare {l} with {r}", op.text());
                    return Err(self.error(&codes::EXPRESSION_TYPE, message));
                }
                Ok(Ty::Bool)
            }
        }
    }

    /// Whether it holds; the expression must have passed [`Expr::check`].
    pub(crate) fn holds(&self, env: &dyn Env) -> bool {
        self.value(env).as_bool().unwrap_or(false)
    }

    fn value(&self, env: &dyn Env) -> Value {
        match &self.kind {
            ExprKind::Value(value) => value.clone(),
            ExprKind::Parameter(_, value) => value.clone().unwrap_or(Value::Bool(false)),
            ExprKind::Trait(name) => env.scene(name).cloned().unwrap_or(Value::Bool(false)),
            ExprKind::Connected(port) => Value::Bool(env.connected(port).unwrap_or(false)),
            ExprKind::Not(inner) => Value::Bool(!inner.holds(env)),
            ExprKind::Binary(Op::And, left, right) => Value::Bool(left.holds(env) && right.holds(env)),
            ExprKind::Binary(Op::Or, left, right) => Value::Bool(left.holds(env) || right.holds(env)),
            ExprKind::Binary(op, left, right) => {
                let (l, r) = (left.value(env), right.value(env));
                let order = match (number(&l), number(&r)) {
                    (Some(l), Some(r)) => l.partial_cmp(&r),
                    _ => (l == r).then_some(std::cmp::Ordering::Equal),
                };
                Value::Bool(match op {
                    Op::Equal => order.is_some_and(|o| o.is_eq()),
                    Op::NotEqual => !order.is_some_and(|o| o.is_eq()),
                    Op::Less => order.is_some_and(|o| o.is_lt()),
                    Op::LessEqual => order.is_some_and(|o| o.is_le()),
                    Op::Greater => order.is_some_and(|o| o.is_gt()),
                    Op::GreaterEqual => order.is_some_and(|o| o.is_ge()),
                    Op::And | Op::Or => unreachable!("matched above"),
                })
            }
        }
    }

    /// The values of all its names, as `name = value`.
    pub(crate) fn facts(&self, env: &dyn Env, out: &mut Vec<String>) {
        let fact = match &self.kind {
            ExprKind::Value(_) => return,
            ExprKind::Parameter(name, value) => value.as_ref().map(|value| format!("{name} = {value}")),
            ExprKind::Trait(name) => env.scene(name).map(|value| format!("scene.{name} = {value}")),
            ExprKind::Connected(port) => env.connected(port).map(|is| format!("connected({port}) = {is}")),
            ExprKind::Not(inner) => return inner.facts(env, out),
            ExprKind::Binary(_, left, right) => {
                left.facts(env, out);
                return right.facts(env, out);
            }
        };
        out.extend(fact.filter(|fact| !out.contains(fact)));
    }

    /// The expression as text: parameters by name, or by value where `values` is set.
    pub(crate) fn text(&self, values: bool) -> String {
        let nested = |inner: &Expr| match inner.kind {
            ExprKind::Binary(..) => format!("({})", inner.text(values)),
            _ => inner.text(values),
        };
        match &self.kind {
            ExprKind::Value(value) => literal(value),
            ExprKind::Parameter(_, Some(value)) if values => literal(value),
            ExprKind::Parameter(name, _) => format!("${name}"),
            ExprKind::Trait(name) => format!("scene.{name}"),
            ExprKind::Connected(port) => format!("connected({port})"),
            ExprKind::Not(inner) => format!("!{}", nested(inner)),
            ExprKind::Binary(op, left, right) => format!("{} {} {}", nested(left), op.text(), nested(right)),
        }
    }
}

/// Numbers compare as real ones, whatever their types.
fn number(value: &Value) -> Option<f64> {
    match value {
        Value::U32(n) => Some(f64::from(*n)),
        Value::I32(n) => Some(f64::from(*n)),
        Value::F32(x) => Some(f64::from(*x)),
        _ => None,
    }
}

/// Text in single quotes, so that it stands within RON text as it is.
fn literal(value: &Value) -> String {
    match value {
        Value::Text(text) if !text.contains('\'') => format!("'{text}'"),
        other => other.to_string(),
    }
}
