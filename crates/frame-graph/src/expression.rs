//! The expressions of `when:`, of settings and of sizes: over parameters, and in switches also over traits of the
//! scene.

mod formula;
mod parse;

pub use formula::{Formula, FormulaError, NameError};
pub(crate) use parse::{parse, parse_scale};

use crate::codes;
use data_file::{Code, Name, Place, Value, nearest};
use std::cmp::Ordering;
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
    /// `$NAME` or `NAME`; its value, and where that was given, once they are known.
    Parameter(Name, Option<(Value, Place)>),
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
    Add,
    Subtract,
    Multiply,
    Divide,
    Remainder,
    Min,
    Max,
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
    /// Returns the value of a trait of the scene.
    fn scene(&self, name: &str) -> Option<&Value>;
    /// Returns the traits there are.
    fn scene_names(&self) -> Vec<String>;
}

/// What the names of a setting's or size's expression stand for, beside parameters: nothing.
impl Env for () {
    fn scene(&self, _: &str) -> Option<&Value> {
        None
    }

    fn scene_names(&self) -> Vec<String> {
        Vec::new()
    }
}

/// A value while it is worked out.
enum Term {
    Whole(i64),
    Real(f64),
    Other(Value),
}

impl Term {
    fn of(value: &Value) -> Term {
        match value {
            Value::U32(n) => Term::Whole(i64::from(*n)),
            Value::I32(n) => Term::Whole(i64::from(*n)),
            Value::F32(x) => Term::Real(f64::from(*x)),
            other => Term::Other(other.clone()),
        }
    }

    fn real(&self) -> Option<f64> {
        match self {
            Term::Whole(n) => Some(*n as f64),
            Term::Real(x) => Some(*x),
            Term::Other(_) => None,
        }
    }

    fn is_true(&self) -> bool {
        matches!(self, Term::Other(Value::Bool(true)))
    }

    /// Returns the order of two terms; `None` where they have none, or are different and no numbers.
    fn order(&self, other: &Term) -> Option<Ordering> {
        match (self, other) {
            (Term::Whole(l), Term::Whole(r)) => Some(l.cmp(r)),
            (Term::Other(l), Term::Other(r)) => (l == r).then_some(Ordering::Equal),
            _ => self.real()?.partial_cmp(&other.real()?),
        }
    }

    /// Returns the number that an arithmetic operator makes; `None` where there is none.
    fn join(op: Op, left: &Term, right: &Term) -> Option<Term> {
        if let (Term::Whole(l), Term::Whole(r)) = (left, right) {
            return match op {
                Op::Add => l.checked_add(*r),
                Op::Subtract => l.checked_sub(*r),
                Op::Multiply => l.checked_mul(*r),
                Op::Divide => l.checked_div(*r),
                Op::Remainder => l.checked_rem(*r),
                Op::Min => Some(*l.min(r)),
                Op::Max => Some(*l.max(r)),
                _ => None,
            }
            .map(Term::Whole);
        }
        let (l, r) = (left.real()?, right.real()?);
        let real = match op {
            Op::Add => l + r,
            Op::Subtract => l - r,
            Op::Multiply => l * r,
            Op::Divide => l / r,
            Op::Remainder => l % r,
            Op::Min => l.min(r),
            Op::Max => l.max(r),
            _ => return None,
        };
        real.is_finite().then_some(Term::Real(real))
    }
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
            Op::Add => "+",
            Op::Subtract => "-",
            Op::Multiply => "*",
            Op::Divide => "/",
            Op::Remainder => "%",
            Op::Min => "min",
            Op::Max => "max",
        }
    }

    /// Returns whether it makes a number of two.
    fn is_arithmetic(self) -> bool {
        use Op::{Add, Divide, Max, Min, Multiply, Remainder, Subtract};
        matches!(self, Add | Subtract | Multiply | Divide | Remainder | Min | Max)
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

impl Expr {
    /// Calls `f` with every parameter: its place, its name, and where its value goes.
    pub(crate) fn parameters(&mut self, f: &mut impl FnMut((u32, u32), &Name, &mut Option<(Value, Place)>)) {
        match &mut self.kind {
            ExprKind::Parameter(name, value) => f((self.start, self.end), name, value),
            ExprKind::Not(inner) => inner.parameters(f),
            ExprKind::Binary(_, left, right) => {
                left.parameters(f);
                right.parameters(f);
            }
            ExprKind::Value(_) | ExprKind::Trait(_) => {}
        }
    }

    /// Returns the first part that asks about the scene.
    pub(crate) fn question(&self) -> Option<&Expr> {
        match &self.kind {
            ExprKind::Trait(_) => Some(self),
            ExprKind::Not(inner) => inner.question(),
            ExprKind::Binary(_, left, right) => left.question().or_else(|| right.question()),
            ExprKind::Value(_) | ExprKind::Parameter(..) => None,
        }
    }

    /// Where the values of its parameters were given.
    pub(crate) fn origins(&self, out: &mut Vec<(Name, Value, Place)>) {
        match &self.kind {
            ExprKind::Parameter(name, Some((value, place))) => {
                if !out.iter().any(|(known, _, _)| known == name) {
                    out.push((name.clone(), value.clone(), *place));
                }
            }
            ExprKind::Not(inner) => inner.origins(out),
            ExprKind::Binary(_, left, right) => {
                left.origins(out);
                right.origins(out);
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
        match &self.kind {
            ExprKind::Value(value) => Ok(Ty::of(value)),
            ExprKind::Parameter(name, value) => match value {
                Some((value, _)) => Ok(Ty::of(value)),
                None => Err(self.error(&codes::UNKNOWN_PARAMETER, format!("there is no parameter `{name}`"))),
            },
            ExprKind::Trait(name) => env.scene(name).map(Ty::of).ok_or_else(|| {
                let known = env.scene_names();
                let message = format!("scenes have no trait `{name}`");
                let mut error = self.error(&codes::EXPRESSION_NAME, message);
                if let Some(near) = nearest(name, known.iter().map(String::as_str)) {
                    error.notes.push(format!("did you mean `{near}`?"));
                }
                error.notes.push(format!("traits of a scene: {}", known.join(", ")));
                error
            }),
            ExprKind::Not(inner) => inner.check(env, Ty::Bool).map(|()| Ty::Bool),
            ExprKind::Binary(Op::And | Op::Or, left, right) => {
                left.check(env, Ty::Bool)?;
                right.check(env, Ty::Bool)?;
                Ok(Ty::Bool)
            }
            ExprKind::Binary(op, left, right) if op.is_arithmetic() => {
                left.check(env, Ty::Number)?;
                right.check(env, Ty::Number)?;
                Ok(Ty::Number)
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

    /// Returns whether it holds; the expression must have passed [`Expr::check`].
    pub(crate) fn holds(&self, env: &dyn Env) -> Result<bool, ExprError> {
        Ok(self.term(env)?.is_true())
    }

    /// Returns the value of an expression that asks about parameters alone: whole where all its numbers are.
    pub(crate) fn value(&self) -> Result<Value, ExprError> {
        self.ty(&())?;
        let out = |found: &dyn fmt::Display| {
            let message = format!("{} is {found}, which no value can hold", self.explained(&()));
            self.error(&codes::ARITHMETIC, message)
        };
        match self.term(&())? {
            Term::Whole(n) => {
                let whole = u32::try_from(n).map(Value::U32).or_else(|_| i32::try_from(n).map(Value::I32));
                whole.map_err(|_| out(&n))
            }
            Term::Real(x) if (x as f32).is_finite() => Ok(Value::F32(x as f32)),
            Term::Real(x) => Err(out(&x)),
            Term::Other(value) => Ok(value),
        }
    }

    fn term(&self, env: &dyn Env) -> Result<Term, ExprError> {
        let truth = |is| Term::Other(Value::Bool(is));
        Ok(match &self.kind {
            ExprKind::Value(value) | ExprKind::Parameter(_, Some((value, _))) => Term::of(value),
            ExprKind::Parameter(_, None) => truth(false),
            ExprKind::Trait(name) => env.scene(name).map_or(truth(false), Term::of),
            ExprKind::Not(inner) => truth(!inner.holds(env)?),
            ExprKind::Binary(Op::And, left, right) => truth(left.holds(env)? && right.holds(env)?),
            ExprKind::Binary(Op::Or, left, right) => truth(left.holds(env)? || right.holds(env)?),
            ExprKind::Binary(op, left, right) => {
                let (l, r) = (left.term(env)?, right.term(env)?);
                let order = l.order(&r);
                match op {
                    Op::Equal => truth(order.is_some_and(Ordering::is_eq)),
                    Op::NotEqual => truth(!order.is_some_and(Ordering::is_eq)),
                    Op::Less => truth(order.is_some_and(Ordering::is_lt)),
                    Op::LessEqual => truth(order.is_some_and(Ordering::is_le)),
                    Op::Greater => truth(order.is_some_and(Ordering::is_gt)),
                    Op::GreaterEqual => truth(order.is_some_and(Ordering::is_ge)),
                    // By zero, nothing is divided, not even a real number.
                    Op::Divide | Op::Remainder if r.real() == Some(0.0) => {
                        let message = format!("{} divides by zero", self.explained(env));
                        return Err(self.error(&codes::ARITHMETIC, message));
                    }
                    op => Term::join(*op, &l, &r).ok_or_else(|| {
                        let message = format!("{} is too large for any number", self.explained(env));
                        self.error(&codes::ARITHMETIC, message)
                    })?,
                }
            }
        })
    }

    /// Returns the expression and the values of its names: `` `$a * 2` (a = 3) ``.
    pub(crate) fn explained(&self, env: &dyn Env) -> String {
        let mut facts = Vec::new();
        self.facts(env, &mut facts);
        let text = self.text(false);
        if facts.is_empty() { format!("`{text}`") } else { format!("`{text}` ({})", facts.join(", ")) }
    }

    /// The values of all its names, as `name = value`.
    pub(crate) fn facts(&self, env: &dyn Env, out: &mut Vec<String>) {
        let fact = match &self.kind {
            ExprKind::Value(_) => return,
            ExprKind::Parameter(name, value) => value.as_ref().map(|(value, _)| format!("{name} = {value}")),
            ExprKind::Trait(name) => env.scene(name).map(|value| format!("scene.{name} = {value}")),
            ExprKind::Not(inner) => return inner.facts(env, out),
            ExprKind::Binary(_, left, right) => {
                left.facts(env, out);
                return right.facts(env, out);
            }
        };
        out.extend(fact.filter(|fact| !out.contains(fact)));
    }

    /// Returns the expression as text: parameters by name, or by value where `values` is set.
    pub(crate) fn text(&self, values: bool) -> String {
        let nested = |inner: &Expr| match inner.kind {
            ExprKind::Binary(op, ..) if !matches!(op, Op::Min | Op::Max) => {
                format!("({})", inner.text(values))
            }
            _ => inner.text(values),
        };
        match &self.kind {
            ExprKind::Value(value) => literal(value),
            ExprKind::Parameter(_, Some((value, _))) if values => literal(value),
            ExprKind::Parameter(name, _) => format!("${name}"),
            ExprKind::Trait(name) => format!("scene.{name}"),
            ExprKind::Not(inner) => format!("!{}", nested(inner)),
            ExprKind::Binary(op @ (Op::Min | Op::Max), left, right) => {
                format!("{}({}, {})", op.text(), left.text(values), right.text(values))
            }
            ExprKind::Binary(op, left, right) => format!("{} {} {}", nested(left), op.text(), nested(right)),
        }
    }
}

/// Text in single quotes, so that it stands within RON text as it is.
fn literal(value: &Value) -> String {
    match value {
        Value::Text(text) if !text.contains('\'') => format!("'{text}'"),
        other => other.to_string(),
    }
}
