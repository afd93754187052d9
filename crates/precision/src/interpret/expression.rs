//! Values of expressions.

use super::{Fault, Frame, Interpreter, math, operator};
use crate::float::Float;
use crate::value::{Pointer, Scalar, Value, Vector};
use naga::{Expression, Handle, Literal, ScalarKind, Type, TypeInner};
use shader_library::naga;

impl<'a, F: Float> Interpreter<'a, F> {
    /// The value of an expression: what was computed where it was emitted, or for what is never emitted, its value.
    pub(super) fn value(&self, frame: &Frame<'a, F>, handle: Handle<Expression>) -> Result<Value<F>, Fault> {
        match &frame.values[handle.index()] {
            Some(value) => Ok(value.clone()),
            None => self.expression(frame, handle),
        }
    }

    pub(super) fn expression(
        &self,
        frame: &Frame<'a, F>,
        handle: Handle<Expression>,
    ) -> Result<Value<F>, Fault> {
        let value = |handle: Handle<Expression>| self.value(frame, handle);
        Ok(match &frame.function.expressions[handle] {
            Expression::Access { base, index } => {
                let index = match value(*index)? {
                    Value::Scalar(Scalar::U32(index)) => index,
                    Value::Scalar(Scalar::I32(index)) => {
                        u32::try_from(index).map_err(|_| Fault::new(format!("an index is {index}")))?
                    }
                    other => return Err(Fault::new(format!("{} is no index", other.type_name()))),
                };
                part(&value(*base)?, index)?
            }
            Expression::AccessIndex { base, index } => match &frame.values[base.index()] {
                // Without a copy of the whole.
                Some(base) => part(base, *index)?,
                None => part(&value(*base)?, *index)?,
            },
            Expression::Swizzle { size, vector, pattern } => match value(*vector)? {
                Value::Vector(vector) => {
                    let pattern = &pattern[..*size as usize];
                    let component =
                        |place: &naga::SwizzleComponent| vector.components().get(*place as usize).copied();
                    let components: Option<Vec<_>> = pattern.iter().map(component).collect();
                    Value::Vector(Vector::new(components.ok_or_else(|| Fault::new("no such component"))?))
                }
                other => return Err(Fault::new(format!("{} has no components", other.type_name()))),
            },
            Expression::FunctionArgument(index) => {
                let argument = frame.arguments.get(*index as usize).cloned();
                argument.ok_or_else(|| Fault::new("an argument is missing"))?
            }
            Expression::GlobalVariable(handle) => match self.globals.get(handle.index()) {
                Some(Some(place)) => Value::Pointer(Pointer::to(*place)),
                _ => {
                    let name = self.module.global_variables[*handle].name.as_deref().unwrap_or_default();
                    return Err(Fault::new(format!(
                        "the variable `{name}` has no value: only private variables and given uniforms have"
                    )));
                }
            },
            Expression::LocalVariable(handle) => {
                Value::Pointer(Pointer::to(frame.variables + handle.index()))
            }
            Expression::Load { pointer } => self.load(self.pointer(frame, *pointer)?)?,
            Expression::Unary { op, expr } => operator::unary(*op, &value(*expr)?)?,
            Expression::Binary { op, left, right } => operator::binary(*op, &value(*left)?, &value(*right)?)?,
            Expression::Select { condition, accept, reject } => {
                operator::select(&value(*condition)?, value(*accept)?, value(*reject)?)?
            }
            Expression::Relational { fun, argument } => operator::relational(*fun, &value(*argument)?)?,
            Expression::Math { fun, arg, arg1, arg2, arg3 } => {
                let mut arguments = vec![value(*arg)?];
                for argument in [arg1, arg2, arg3].into_iter().flatten() {
                    arguments.push(value(*argument)?);
                }
                math::call(*fun, &arguments)?
            }
            Expression::As { expr, kind, convert } => cast(&value(*expr)?, *kind, *convert)?,
            Expression::CallResult(_) => return Err(Fault::new("a call that returns nothing has no value")),
            other => self.constant(other, &value)?,
        })
    }

    /// Returns the value of an expression of the module: naga has evaluated all but its composition.
    pub(super) fn global_expression(&self, handle: Handle<Expression>) -> Result<Value<F>, Fault> {
        self.constant(&self.module.global_expressions[handle], &|handle| self.global_expression(handle))
    }

    /// Returns the value of an expression that may stand in the module and in functions.
    fn constant(
        &self,
        expression: &Expression,
        value: &dyn Fn(Handle<Expression>) -> Result<Value<F>, Fault>,
    ) -> Result<Value<F>, Fault> {
        Ok(match expression {
            Expression::Literal(literal) => of_literal(*literal)?,
            Expression::Constant(constant) => {
                self.global_expression(self.module.constants[*constant].init)?
            }
            Expression::ZeroValue(ty) => self.zero(*ty)?,
            Expression::Compose { ty, components } => {
                let values = components.iter().map(|component| value(*component));
                self.compose(*ty, values.collect::<Result<_, _>>()?)?
            }
            Expression::Splat { size, value: of } => splat(*size as usize, &value(*of)?)?,
            other => return Err(Fault::unknown(expression_name(other))),
        })
    }

    fn compose(&self, ty: Handle<Type>, parts: Vec<Value<F>>) -> Result<Value<F>, Fault> {
        match &self.module.types[ty].inner {
            TypeInner::Vector { .. } => Ok(Value::Vector(vector_of(&parts))),
            TypeInner::Matrix { rows, .. } => {
                let mut scalars = Vec::new();
                parts.iter().for_each(|part| part.each_scalar(&mut |scalar| scalars.push(scalar)));
                let columns = scalars.chunks(*rows as usize);
                Ok(Value::Matrix(columns.map(|column| Vector::new(column.iter().copied())).collect()))
            }
            _ => Ok(Value::Composite(parts)),
        }
    }
}

fn vector_of<F: Float>(parts: &[Value<F>]) -> Vector<F> {
    let mut components = Vec::with_capacity(4);
    parts.iter().for_each(|part| part.each_scalar(&mut |scalar| components.push(scalar)));
    Vector::new(components)
}

fn splat<F: Float>(size: usize, value: &Value<F>) -> Result<Value<F>, Fault> {
    match value {
        Value::Scalar(scalar) => Ok(Value::Vector(Vector::new(std::iter::repeat_n(*scalar, size)))),
        other => Err(Fault::new(format!("{} is no component", other.type_name()))),
    }
}

/// A part of a value; or the place of a part of a variable.
fn part<F: Float>(base: &Value<F>, index: u32) -> Result<Value<F>, Fault> {
    if let Value::Pointer(pointer) = base {
        let place = pointer.part(index).map(Value::Pointer);
        return place.ok_or_else(|| Fault::new("a place lies too deep in a variable for the interpreter"));
    }
    let found = base.part(index as usize);
    found.ok_or_else(|| Fault::new(format!("{} has nothing at the index {index}", base.type_name())))
}

fn of_literal<F: Float>(literal: Literal) -> Result<Value<F>, Fault> {
    Ok(Value::Scalar(match literal {
        Literal::F32(x) => Scalar::Float(F::of(f64::from(x))),
        Literal::U32(x) => Scalar::U32(x),
        Literal::I32(x) => Scalar::I32(x),
        Literal::Bool(on) => Scalar::Bool(on),
        other => return Err(Fault::unknown(format_args!("the number {other:?}"))),
    }))
}

/// Converts to a scalar type of `width` bytes; bitcasts if `width` is `None`.
fn cast<F: Float>(value: &Value<F>, kind: ScalarKind, width: Option<naga::Bytes>) -> Result<Value<F>, Fault> {
    if let Some(width) = width
        && width != 4
        && kind != ScalarKind::Bool
    {
        return Err(Fault::unknown(format_args!("a number of {width} bytes")));
    }
    let one =
        |scalar: Scalar<F>| if width.is_some() { converted(scalar, kind) } else { same_bits(scalar, kind) };
    match value {
        Value::Scalar(_) | Value::Vector(_) => operator::each(value, &one),
        // A conversion of a matrix of f32 can only be to f32.
        other => Ok(other.clone()),
    }
}

fn converted<F: Float>(scalar: Scalar<F>, kind: ScalarKind) -> Result<Scalar<F>, Fault> {
    let number = match scalar {
        Scalar::Bool(on) => f64::from(u8::from(on)),
        Scalar::I32(x) => f64::from(x),
        Scalar::U32(x) => f64::from(x),
        Scalar::Float(x) => x.f64(),
    };
    Ok(match (kind, scalar) {
        (ScalarKind::Bool, _) => Scalar::Bool(number != 0.0),
        // Between whole numbers, bits are kept; floats are brought into the range.
        (ScalarKind::Sint, Scalar::U32(x)) => Scalar::I32(x as i32),
        (ScalarKind::Uint, Scalar::I32(x)) => Scalar::U32(x as u32),
        (ScalarKind::Sint, _) => Scalar::I32(number as i32),
        (ScalarKind::Uint, _) => Scalar::U32(number as u32),
        (ScalarKind::Float, _) => Scalar::Float(F::of(number)),
        _ => return Err(Fault::unknown("an abstract number")),
    })
}

fn same_bits<F: Float>(scalar: Scalar<F>, kind: ScalarKind) -> Result<Scalar<F>, Fault> {
    // A float that stays one keeps the digits that f32 has not.
    if let (Scalar::Float(_), ScalarKind::Float) = (scalar, kind) {
        return Ok(scalar);
    }
    let bits = match scalar {
        Scalar::Bool(on) => u32::from(on),
        Scalar::I32(x) => x as u32,
        Scalar::U32(x) => x,
        Scalar::Float(x) => x.f32().to_bits(),
    };
    Ok(match kind {
        ScalarKind::Sint => Scalar::I32(bits as i32),
        ScalarKind::Uint => Scalar::U32(bits),
        ScalarKind::Float => Scalar::Float(F::of(f64::from(f32::from_bits(bits)))),
        _ => return Err(Fault::unknown("a bitcast to this type")),
    })
}

fn expression_name(expression: &Expression) -> &'static str {
    match expression {
        Expression::ImageSample { .. } => "sampling a texture",
        Expression::ImageLoad { .. } => "`textureLoad`",
        Expression::ImageQuery { .. } => "a query of a texture",
        Expression::Derivative { .. } => "a derivative",
        Expression::Override(_) => "an `override`",
        Expression::ArrayLength(_) => "`arrayLength`",
        Expression::AtomicResult { .. } => "an atomic operation",
        Expression::RayQueryProceedResult | Expression::RayQueryGetIntersection { .. } => "a ray query",
        Expression::SubgroupBallotResult | Expression::SubgroupOperationResult { .. } => {
            "a subgroup operation"
        }
        _ => "an expression",
    }
}
