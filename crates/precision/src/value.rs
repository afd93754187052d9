//! Values of WGSL, with floats of either type.

use crate::float::Float;

/// A number or a truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scalar<F> {
    /// `bool`.
    Bool(bool),
    /// `i32`.
    I32(i32),
    /// `u32`.
    U32(u32),
    /// `f32`, in the type in which it is computed.
    Float(F),
}

impl<F: Float> Scalar<F> {
    /// The WGSL type, for errors.
    pub(crate) fn type_name(self) -> &'static str {
        match self {
            Scalar::Bool(_) => "bool",
            Scalar::I32(_) => "i32",
            Scalar::U32(_) => "u32",
            Scalar::Float(_) => "f32",
        }
    }
}

/// A vector of two to four components.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector<F> {
    components: [Scalar<F>; 4],
    length: u8,
}

impl<F: Float> Vector<F> {
    /// Creates a vector of these components, of which those after the fourth are left out.
    pub fn new(components: impl IntoIterator<Item = Scalar<F>>) -> Self {
        let mut vector = Vector { components: [Scalar::Bool(false); 4], length: 0 };
        for component in components.into_iter().take(4) {
            vector.components[usize::from(vector.length)] = component;
            vector.length += 1;
        }
        vector
    }

    /// Returns the components.
    pub fn components(&self) -> &[Scalar<F>] {
        &self.components[..usize::from(self.length)]
    }

    pub(crate) fn components_mut(&mut self) -> &mut [Scalar<F>] {
        &mut self.components[..usize::from(self.length)]
    }
}

/// The longest way into a variable: through structs, arrays, a matrix and a vector.
pub(crate) const MOST_STEPS: usize = 8;

/// A place in a variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pointer {
    /// The index of the variable in memory.
    pub(crate) variable: usize,
    steps: [u32; MOST_STEPS],
    depth: u8,
}

impl Pointer {
    pub(crate) fn to(variable: usize) -> Self {
        Pointer { variable, steps: [0; MOST_STEPS], depth: 0 }
    }

    /// The place of a part of what this points to; `None` beyond [`MOST_STEPS`].
    pub(crate) fn part(mut self, index: u32) -> Option<Self> {
        *self.steps.get_mut(usize::from(self.depth))? = index;
        self.depth += 1;
        Some(self)
    }

    pub(crate) fn steps(&self) -> &[u32] {
        &self.steps[..usize::from(self.depth)]
    }
}

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub enum Value<F> {
    /// A number or a truth.
    Scalar(Scalar<F>),
    /// A vector.
    Vector(Vector<F>),
    /// The columns of a matrix.
    Matrix(Vec<Vector<F>>),
    /// The members of a struct or the elements of an array.
    Composite(Vec<Value<F>>),
    /// A place in a variable.
    Pointer(Pointer),
}

impl<F: Float> Value<F> {
    /// Returns a float.
    pub fn float(x: f64) -> Self {
        Value::Scalar(Scalar::Float(F::of(x)))
    }

    /// Returns a vector of floats.
    pub fn floats<const N: usize>(components: [f64; N]) -> Self {
        Value::Vector(Vector::new(components.map(|x| Scalar::Float(F::of(x)))))
    }

    /// Returns all floats in it, in order, as `f64`.
    pub fn to_f64s(&self) -> Vec<f64> {
        let mut out = Vec::new();
        self.each_scalar(&mut |scalar| {
            if let Scalar::Float(x) = scalar {
                out.push(x.f64());
            }
        });
        out
    }

    pub(crate) fn each_scalar(&self, visit: &mut dyn FnMut(Scalar<F>)) {
        match self {
            Value::Scalar(scalar) => visit(*scalar),
            Value::Vector(vector) => vector.components().iter().copied().for_each(visit),
            Value::Matrix(columns) => {
                columns.iter().flat_map(Vector::components).copied().for_each(visit);
            }
            Value::Composite(parts) => parts.iter().for_each(|part| part.each_scalar(visit)),
            Value::Pointer(_) => {}
        }
    }

    /// Returns the same value with floats of another type, each changed by `change`.
    pub fn map_floats<G: Float>(&self, change: &mut dyn FnMut(F) -> G) -> Value<G> {
        let mut scalar = |value: Scalar<F>| match value {
            Scalar::Bool(on) => Scalar::Bool(on),
            Scalar::I32(x) => Scalar::I32(x),
            Scalar::U32(x) => Scalar::U32(x),
            Scalar::Float(x) => Scalar::Float(change(x)),
        };
        let mut vector = |of: &Vector<F>| Vector::new(of.components().iter().map(|value| scalar(*value)));
        match self {
            Value::Scalar(value) => Value::Scalar(scalar(*value)),
            Value::Vector(of) => Value::Vector(vector(of)),
            Value::Matrix(columns) => Value::Matrix(columns.iter().map(vector).collect()),
            Value::Composite(parts) => {
                Value::Composite(parts.iter().map(|part| part.map_floats(change)).collect())
            }
            Value::Pointer(pointer) => Value::Pointer(*pointer),
        }
    }

    /// Returns a description for errors.
    pub(crate) fn type_name(&self) -> &'static str {
        match self {
            Value::Scalar(scalar) => scalar.type_name(),
            Value::Vector(_) => "a vector",
            Value::Matrix(_) => "a matrix",
            Value::Composite(_) => "a struct or an array",
            Value::Pointer(_) => "a pointer",
        }
    }

    /// The part at an index; `None` beyond the last, and where there are no parts.
    pub(crate) fn part(&self, index: usize) -> Option<Value<F>> {
        match self {
            Value::Vector(vector) => {
                vector.components().get(index).map(|component| Value::Scalar(*component))
            }
            Value::Matrix(columns) => columns.get(index).map(|column| Value::Vector(*column)),
            Value::Composite(parts) => parts.get(index).cloned(),
            Value::Scalar(_) | Value::Pointer(_) => None,
        }
    }

    /// The part at the end of `steps`.
    pub(crate) fn at(&self, steps: &[u32]) -> Option<Value<F>> {
        match (self, steps) {
            (_, []) => Some(self.clone()),
            (Value::Composite(parts), [first, rest @ ..]) => parts.get(*first as usize)?.at(rest),
            (_, [first, rest @ ..]) => self.part(*first as usize)?.at(rest),
        }
    }

    /// Replaces the part at the end of `steps`; whether there is one, and it has that shape.
    pub(crate) fn set(&mut self, steps: &[u32], value: Value<F>) -> bool {
        match (self, steps, value) {
            (whole, [], value) => {
                *whole = value;
                true
            }
            (Value::Composite(parts), [first, rest @ ..], value) => {
                parts.get_mut(*first as usize).is_some_and(|part| part.set(rest, value))
            }
            (Value::Matrix(columns), [column], Value::Vector(value)) => {
                columns.get_mut(*column as usize).map(|column| *column = value).is_some()
            }
            (Value::Matrix(columns), [column, row], Value::Scalar(value)) => {
                let column = columns.get_mut(*column as usize);
                set_component(column, *row, value)
            }
            (Value::Vector(vector), [index], Value::Scalar(value)) => {
                set_component(Some(vector), *index, value)
            }
            _ => false,
        }
    }
}

fn set_component<F: Float>(vector: Option<&mut Vector<F>>, index: u32, value: Scalar<F>) -> bool {
    let component = vector.and_then(|vector| vector.components_mut().get_mut(index as usize));
    component.map(|component| *component = value).is_some()
}
