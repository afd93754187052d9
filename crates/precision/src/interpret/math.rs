//! Built-in functions, as WGSL defines them: what it inherits from other functions is computed by those.

use super::Fault;
use super::operator::{both, dot, each};
use crate::float::Float;
use crate::value::{Scalar, Value, Vector};
use half::f16;
use naga::MathFunction as Math;
use shader_library::naga;

pub(super) fn call<F: Float>(fun: Math, arguments: &[Value<F>]) -> Result<Value<F>, Fault> {
    match arguments {
        [a] => of_one(fun, a),
        [a, b] => of_two(fun, a, b),
        [a, b, c] => of_three(fun, a, b, c),
        _ => unknown(fun),
    }
}

fn unknown<T>(fun: Math) -> Result<T, Fault> {
    Err(Fault::unknown(format_args!("the function {fun:?}")))
}

fn number<F: Float>(x: F) -> Result<Scalar<F>, Fault> {
    Ok(Scalar::Float(x))
}

fn length<F: Float>(vector: &Vector<F>) -> Result<F, Fault> {
    match dot(vector.components(), vector.components())? {
        Scalar::Float(square) => Ok(square.sqrt()),
        other => Err(Fault::new(format!("the length of {}", other.type_name()))),
    }
}

fn of_one<F: Float>(fun: Math, a: &Value<F>) -> Result<Value<F>, Fault> {
    match (fun, a) {
        (Math::Length, Value::Scalar(_)) => of_one(Math::Abs, a),
        (Math::Length, Value::Vector(vector)) => Ok(Value::Scalar(Scalar::Float(length(vector)?))),
        (Math::Normalize, Value::Vector(vector)) => {
            let length = length(vector)?;
            each(a, &|scalar| match scalar {
                Scalar::Float(x) => number(x / length),
                other => Ok(other),
            })
        }
        (Math::Transpose, Value::Matrix(columns)) => {
            let rows = columns.first().map_or(0, |column| column.components().len());
            let row = |row: usize| {
                Vector::new(columns.iter().filter_map(|column| column.components().get(row)).copied())
            };
            Ok(Value::Matrix((0..rows).map(row).collect()))
        }
        (Math::Unpack2x16snorm, Value::Scalar(Scalar::U32(word))) => {
            let half =
                |bits: u32| Scalar::Float((F::of(f64::from(bits as i16)) / F::of(32767.0)).max(F::of(-1.0)));
            Ok(Value::Vector(Vector::new([half(word & 0xffff), half(word >> 16)])))
        }
        (Math::Unpack2x16float, Value::Scalar(Scalar::U32(word))) => {
            let half = |bits: u32| Scalar::Float(F::of(f16::from_bits(bits as u16).to_f64()));
            Ok(Value::Vector(Vector::new([half(word & 0xffff), half(word >> 16)])))
        }
        (Math::Pack2x16snorm, Value::Vector(vector)) => {
            Ok(packed(vector, |x| (0.5 + 32767.0 * x.clamp(-1.0, 1.0)).floor() as i32 as u32 & 0xffff))
        }
        (Math::Pack2x16float, Value::Vector(vector)) => {
            Ok(packed(vector, |x| u32::from(f16::from_f64(x).to_bits())))
        }
        _ => each(a, &|scalar| match scalar {
            Scalar::Float(x) => of_float(fun, x),
            Scalar::I32(x) => of_signed(fun, x),
            Scalar::U32(x) => of_bits(fun, x),
            Scalar::Bool(_) => unknown(fun),
        }),
    }
}

/// Two floats as one word, the first in its low half.
fn packed<F: Float>(vector: &Vector<F>, half: impl Fn(f64) -> u32) -> Value<F> {
    let bits = |scalar: &Scalar<F>| match scalar {
        Scalar::Float(x) => half(x.f64()),
        _ => 0,
    };
    let word = vector.components().iter().rev().fold(0, |word, x| word << 16 | bits(x));
    Value::Scalar(Scalar::U32(word))
}

fn of_float<F: Float>(fun: Math, x: F) -> Result<Scalar<F>, Fault> {
    let (zero, one) = (F::of(0.0), F::of(1.0));
    number(match fun {
        Math::Abs => x.abs(),
        Math::Saturate => x.max(zero).min(one),
        Math::Cos => x.cos(),
        Math::Cosh => x.cosh(),
        Math::Sin => x.sin(),
        Math::Sinh => x.sinh(),
        Math::Tan => x.tan(),
        Math::Tanh => x.tanh(),
        Math::Acos => x.acos(),
        Math::Asin => x.asin(),
        Math::Atan => x.atan(),
        Math::Asinh => x.asinh(),
        Math::Acosh => x.acosh(),
        Math::Atanh => x.atanh(),
        Math::Radians => x.to_radians(),
        Math::Degrees => x.to_degrees(),
        Math::Ceil => x.ceil(),
        Math::Floor => x.floor(),
        Math::Round => x.round_ties_even(),
        Math::Fract => x - x.floor(),
        Math::Trunc => x.trunc(),
        Math::Exp => x.exp(),
        Math::Exp2 => x.exp2(),
        Math::Log => x.ln(),
        Math::Log2 => x.log2(),
        Math::Sign if x > zero => one,
        Math::Sign if x < zero => -one,
        Math::Sign => zero,
        Math::Sqrt => x.sqrt(),
        Math::InverseSqrt => one / x.sqrt(),
        _ => return unknown(fun),
    })
}

fn of_signed<F: Float>(fun: Math, x: i32) -> Result<Scalar<F>, Fault> {
    match fun {
        Math::Abs => Ok(Scalar::I32(x.wrapping_abs())),
        Math::Sign => Ok(Scalar::I32(x.signum())),
        // The highest bit that differs from the sign.
        Math::FirstLeadingBit => {
            Ok(Scalar::I32(if x < 0 { highest(!x as u32) } else { highest(x as u32) } as i32))
        }
        _ => match of_bits::<F>(fun, x as u32)? {
            Scalar::U32(bits) => Ok(Scalar::I32(bits as i32)),
            other => Ok(other),
        },
    }
}

fn highest(x: u32) -> u32 {
    x.checked_ilog2().unwrap_or(u32::MAX)
}

fn of_bits<F: Float>(fun: Math, x: u32) -> Result<Scalar<F>, Fault> {
    Ok(Scalar::U32(match fun {
        Math::Abs => x,
        Math::CountOneBits => x.count_ones(),
        Math::CountLeadingZeros => x.leading_zeros(),
        Math::CountTrailingZeros => x.trailing_zeros(),
        Math::ReverseBits => x.reverse_bits(),
        Math::FirstLeadingBit => highest(x),
        Math::FirstTrailingBit if x == 0 => u32::MAX,
        Math::FirstTrailingBit => x.trailing_zeros(),
        _ => return unknown(fun),
    }))
}

fn of_two<F: Float>(fun: Math, a: &Value<F>, b: &Value<F>) -> Result<Value<F>, Fault> {
    match (fun, a, b) {
        (Math::Dot, Value::Vector(a), Value::Vector(b)) => {
            Ok(Value::Scalar(dot(a.components(), b.components())?))
        }
        (Math::Cross, Value::Vector(a), Value::Vector(b)) => cross(a, b),
        (Math::Distance, ..) => of_one(Math::Length, &minus(a, b)?),
        (Math::Reflect, ..) => {
            let along = of_two(Math::Dot, a, b)?;
            let twice = both(&along, b, &|along, b| match (along, b) {
                (Scalar::Float(along), Scalar::Float(b)) => number(F::of(2.0) * along * b),
                (_, b) => Ok(b),
            })?;
            minus(a, &twice)
        }
        (Math::Ldexp, ..) => both(a, b, &|a, b| match (a, b) {
            (Scalar::Float(x), Scalar::I32(power)) => {
                number(F::of(x.f64() * f64::from(power.clamp(-1000, 1000)).exp2()))
            }
            _ => unknown(fun),
        }),
        _ => both(a, b, &|a, b| match (fun, a, b) {
            (Math::Min, Scalar::Float(a), Scalar::Float(b)) => number(a.min(b)),
            (Math::Max, Scalar::Float(a), Scalar::Float(b)) => number(a.max(b)),
            (Math::Pow, Scalar::Float(a), Scalar::Float(b)) => number(a.powf(b)),
            (Math::Atan2, Scalar::Float(a), Scalar::Float(b)) => number(a.atan2(b)),
            (Math::Step, Scalar::Float(a), Scalar::Float(b)) => number(F::of(f64::from(u8::from(a <= b)))),
            (Math::Min, Scalar::I32(a), Scalar::I32(b)) => Ok(Scalar::I32(a.min(b))),
            (Math::Max, Scalar::I32(a), Scalar::I32(b)) => Ok(Scalar::I32(a.max(b))),
            (Math::Min, Scalar::U32(a), Scalar::U32(b)) => Ok(Scalar::U32(a.min(b))),
            (Math::Max, Scalar::U32(a), Scalar::U32(b)) => Ok(Scalar::U32(a.max(b))),
            _ => unknown(fun),
        }),
    }
}

fn minus<F: Float>(a: &Value<F>, b: &Value<F>) -> Result<Value<F>, Fault> {
    super::operator::binary(naga::BinaryOperator::Subtract, a, b)
}

fn cross<F: Float>(a: &Vector<F>, b: &Vector<F>) -> Result<Value<F>, Fault> {
    let (
        &[Scalar::Float(ax), Scalar::Float(ay), Scalar::Float(az)],
        &[Scalar::Float(bx), Scalar::Float(by), Scalar::Float(bz)],
    ) = (a.components(), b.components())
    else {
        return Err(Fault::new("a cross product of other than two vec3<f32>"));
    };
    let components = [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx];
    Ok(Value::Vector(Vector::new(components.map(Scalar::Float))))
}

fn of_three<F: Float>(fun: Math, a: &Value<F>, b: &Value<F>, c: &Value<F>) -> Result<Value<F>, Fault> {
    if fun == Math::Clamp {
        return of_two(Math::Min, &of_two(Math::Max, a, b)?, c);
    }
    let one = |a: F, b: F, c: F| {
        Ok(match fun {
            Math::Fma => a.mul_add(b, c),
            Math::Mix => a * (F::of(1.0) - c) + b * c,
            Math::SmoothStep => {
                let t = ((c - a) / (b - a)).max(F::of(0.0)).min(F::of(1.0));
                t * t * (F::of(3.0) - F::of(2.0) * t)
            }
            _ => return unknown(fun),
        })
    };
    let component = |value: &Value<F>, i: usize| match value {
        Value::Scalar(Scalar::Float(x)) => Ok(*x),
        Value::Vector(vector) => match vector.components().get(i) {
            Some(Scalar::Float(x)) => Ok(*x),
            _ => unknown(fun),
        },
        _ => unknown(fun),
    };
    let at = |i: usize| number(one(component(a, i)?, component(b, i)?, component(c, i)?)?);
    match a {
        Value::Vector(vector) => {
            let components = (0..vector.components().len()).map(at).collect::<Result<Vec<_>, _>>()?;
            Ok(Value::Vector(Vector::new(components)))
        }
        _ => Ok(Value::Scalar(at(0)?)),
    }
}
