//! Operators, `select`, `all` and `any`.

use super::Fault;
use crate::float::Float;
use crate::value::{Scalar, Value, Vector};
use naga::{BinaryOperator as Binary, RelationalFunction, UnaryOperator as Unary};
use shader_library::naga;

pub(super) fn unary<F: Float>(op: Unary, value: &Value<F>) -> Result<Value<F>, Fault> {
    each(value, &|scalar| {
        Ok(match (op, scalar) {
            (Unary::Negate, Scalar::Float(x)) => Scalar::Float(-x),
            (Unary::Negate, Scalar::I32(x)) => Scalar::I32(x.wrapping_neg()),
            (Unary::LogicalNot, Scalar::Bool(on)) => Scalar::Bool(!on),
            (Unary::BitwiseNot, Scalar::I32(x)) => Scalar::I32(!x),
            (Unary::BitwiseNot, Scalar::U32(x)) => Scalar::U32(!x),
            (op, scalar) => return Err(Fault::new(format!("{op:?} of {}", scalar.type_name()))),
        })
    })
}

/// Applies a function to each component.
pub(super) fn each<F: Float>(
    value: &Value<F>,
    one: &dyn Fn(Scalar<F>) -> Result<Scalar<F>, Fault>,
) -> Result<Value<F>, Fault> {
    let vector = |vector: &Vector<F>| {
        let mut out = *vector;
        for component in out.components_mut() {
            *component = one(*component)?;
        }
        Ok::<_, Fault>(out)
    };
    Ok(match value {
        Value::Scalar(scalar) => Value::Scalar(one(*scalar)?),
        Value::Vector(of) => Value::Vector(vector(of)?),
        Value::Matrix(columns) => Value::Matrix(columns.iter().map(vector).collect::<Result<_, _>>()?),
        other => return Err(Fault::new(format!("{} has no arithmetic", other.type_name()))),
    })
}

/// Applies a function to the components of two values, of which one may be a scalar for all components of the other.
pub(super) fn both<F: Float>(
    a: &Value<F>,
    b: &Value<F>,
    one: &dyn Fn(Scalar<F>, Scalar<F>) -> Result<Scalar<F>, Fault>,
) -> Result<Value<F>, Fault> {
    let vectors = |a: &Vector<F>, b: &Vector<F>| {
        let pairs = a.components().iter().zip(b.components());
        pairs.map(|(a, b)| one(*a, *b)).collect::<Result<Vec<_>, _>>().map(Vector::new)
    };
    Ok(match (a, b) {
        (Value::Scalar(a), Value::Scalar(b)) => Value::Scalar(one(*a, *b)?),
        (Value::Vector(a), Value::Vector(b)) => Value::Vector(vectors(a, b)?),
        (Value::Scalar(a), b @ (Value::Vector(_) | Value::Matrix(_))) => each(b, &|b| one(*a, b))?,
        (a @ (Value::Vector(_) | Value::Matrix(_)), Value::Scalar(b)) => each(a, &|a| one(a, *b))?,
        (Value::Matrix(a), Value::Matrix(b)) => {
            let columns = a.iter().zip(b).map(|(a, b)| vectors(a, b));
            Value::Matrix(columns.collect::<Result<_, _>>()?)
        }
        (a, b) => {
            return Err(Fault::new(format!("{} with {} has no arithmetic", a.type_name(), b.type_name())));
        }
    })
}

pub(super) fn binary<F: Float>(op: Binary, a: &Value<F>, b: &Value<F>) -> Result<Value<F>, Fault> {
    if op == Binary::Multiply {
        match (a, b) {
            (Value::Matrix(columns), Value::Vector(vector)) => {
                return Ok(Value::Vector(times(columns, vector)?));
            }
            (Value::Vector(vector), Value::Matrix(columns)) => {
                let dots = columns.iter().map(|column| dot(vector.components(), column.components()));
                return Ok(Value::Vector(Vector::new(dots.collect::<Result<Vec<_>, _>>()?)));
            }
            (Value::Matrix(a), Value::Matrix(b)) => {
                return Ok(Value::Matrix(b.iter().map(|column| times(a, column)).collect::<Result<_, _>>()?));
            }
            _ => {}
        }
    }
    both(a, b, &|a, b| of_scalars(op, a, b))
}

/// A matrix times a vector.
fn times<F: Float>(columns: &[Vector<F>], vector: &Vector<F>) -> Result<Vector<F>, Fault> {
    let rows = columns.first().map_or(0, |column| column.components().len());
    let mut out = Vec::with_capacity(rows);
    for row in 0..rows {
        let across: Vec<_> =
            columns.iter().filter_map(|column| column.components().get(row)).copied().collect();
        out.push(dot(&across, vector.components())?);
    }
    Ok(Vector::new(out))
}

/// The products of two rows of scalars, summed from the first on.
pub(super) fn dot<F: Float>(a: &[Scalar<F>], b: &[Scalar<F>]) -> Result<Scalar<F>, Fault> {
    let mut sum: Option<Scalar<F>> = None;
    for (a, b) in a.iter().zip(b) {
        let product = of_scalars(Binary::Multiply, *a, *b)?;
        sum = Some(match sum {
            Some(sum) => of_scalars(Binary::Add, sum, product)?,
            None => product,
        });
    }
    sum.ok_or_else(|| Fault::new("a product of nothing"))
}

pub(super) fn of_scalars<F: Float>(op: Binary, a: Scalar<F>, b: Scalar<F>) -> Result<Scalar<F>, Fault> {
    match (a, b) {
        (Scalar::Float(a), Scalar::Float(b)) => of_floats(op, a, b),
        // The number of places of a shift is unsigned, whatever is shifted.
        (Scalar::I32(a), Scalar::U32(b)) if op == Binary::ShiftLeft => Some(Scalar::I32(a.wrapping_shl(b))),
        (Scalar::I32(a), Scalar::U32(b)) if op == Binary::ShiftRight => Some(Scalar::I32(a.wrapping_shr(b))),
        (Scalar::U32(a), Scalar::U32(b)) if op == Binary::ShiftLeft => Some(Scalar::U32(a.wrapping_shl(b))),
        (Scalar::U32(a), Scalar::U32(b)) if op == Binary::ShiftRight => Some(Scalar::U32(a.wrapping_shr(b))),
        (Scalar::I32(a), Scalar::I32(b)) => of_signed(op, a, b),
        (Scalar::U32(a), Scalar::U32(b)) => of_unsigned(op, a, b),
        (Scalar::Bool(a), Scalar::Bool(b)) => match op {
            Binary::LogicalAnd | Binary::And => Some(Scalar::Bool(a && b)),
            Binary::LogicalOr | Binary::InclusiveOr => Some(Scalar::Bool(a || b)),
            Binary::ExclusiveOr | Binary::NotEqual => Some(Scalar::Bool(a != b)),
            Binary::Equal => Some(Scalar::Bool(a == b)),
            _ => None,
        },
        _ => None,
    }
    .ok_or_else(|| Fault::new(format!("{op:?} of {} and {}", a.type_name(), b.type_name())))
}

fn compared<F, T: PartialOrd>(op: Binary, a: T, b: T) -> Option<Scalar<F>> {
    Some(Scalar::Bool(match op {
        Binary::Equal => a == b,
        Binary::NotEqual => a != b,
        Binary::Less => a < b,
        Binary::LessEqual => a <= b,
        Binary::Greater => a > b,
        Binary::GreaterEqual => a >= b,
        _ => return None,
    }))
}

fn of_floats<F: Float>(op: Binary, a: F, b: F) -> Option<Scalar<F>> {
    Some(Scalar::Float(match op {
        Binary::Add => a + b,
        Binary::Subtract => a - b,
        Binary::Multiply => a * b,
        Binary::Divide => a / b,
        Binary::Modulo => a % b,
        _ => return compared(op, a, b),
    }))
}

/// Defines an operation of two integers of a type.
macro_rules! of_integers {
    ($name:ident $type:ident $scalar:ident) => {
        fn $name<F: Float>(op: Binary, a: $type, b: $type) -> Option<Scalar<F>> {
            Some(Scalar::$scalar(match op {
                Binary::Add => a.wrapping_add(b),
                Binary::Subtract => a.wrapping_sub(b),
                Binary::Multiply => a.wrapping_mul(b),
                // [WGSL §8.7: division by zero gives the dividend, and no remainder]
                Binary::Divide => a.checked_div(b).unwrap_or(a),
                Binary::Modulo => a.checked_rem(b).unwrap_or(0),
                Binary::And => a & b,
                Binary::InclusiveOr => a | b,
                Binary::ExclusiveOr => a ^ b,
                _ => return compared(op, a, b),
            }))
        }
    };
}

of_integers!(of_signed i32 I32);
of_integers!(of_unsigned u32 U32);

pub(super) fn select<F: Float>(
    condition: &Value<F>,
    accept: Value<F>,
    reject: Value<F>,
) -> Result<Value<F>, Fault> {
    match (condition, accept, reject) {
        (Value::Scalar(Scalar::Bool(on)), accept, reject) => Ok(if *on { accept } else { reject }),
        (Value::Vector(which), Value::Vector(accept), Value::Vector(reject)) => {
            let sides = accept.components().iter().zip(reject.components());
            let chosen = which.components().iter().zip(sides);
            Ok(Value::Vector(Vector::new(
                chosen
                    .map(|(on, (accept, reject))| if *on == Scalar::Bool(true) { *accept } else { *reject }),
            )))
        }
        (other, ..) => Err(Fault::new(format!("{} is no condition", other.type_name()))),
    }
}

pub(super) fn relational<F: Float>(fun: RelationalFunction, value: &Value<F>) -> Result<Value<F>, Fault> {
    let mut truths = Vec::new();
    value.each_scalar(&mut |scalar| truths.push(scalar == Scalar::Bool(true)));
    Ok(Value::Scalar(Scalar::Bool(match fun {
        RelationalFunction::All => truths.iter().all(|on| *on),
        RelationalFunction::Any => truths.iter().any(|on| *on),
        RelationalFunction::IsNan | RelationalFunction::IsInf => {
            return Err(Fault::unknown(format_args!("{fun:?}")));
        }
    })))
}
