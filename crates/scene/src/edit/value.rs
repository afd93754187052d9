//! The values that an edit writes: whether they differ from what a file has, and how they are written.

use data_file::reader::{Form, Node, Number};
use glam::Vec3;

use super::patches::Patches;

/// The value of a field.
#[derive(Clone, Copy, Debug)]
pub(super) enum Value {
    Number(f32),
    Vector(Vec3),
    /// A vector of which only the direction matters.
    Direction(Vec3),
    /// In radians, written in degrees, of which there are at most so many.
    Angle {
        radians: f32,
        most: f32,
    },
}

/// A field and its value; without one, the field is to be left out.
pub(super) type Field = (&'static str, Option<Value>);

impl Value {
    /// Writes the value over that of the file, if it is another one: only the numbers that differ.
    pub(super) fn write(self, node: &Node, patches: &mut Patches<'_>) {
        if self.is(node) {
            return;
        }
        match (self, &node.form) {
            (Value::Vector(value) | Value::Direction(value), Form::Tuple(None, items)) => {
                for (item, value) in items.iter().zip(value.to_array()) {
                    Value::Number(value).write(item, patches);
                }
            }
            _ => patches.replace(node, self.text()),
        }
    }

    /// Returns whether the file has this value.
    fn is(self, node: &Node) -> bool {
        match self {
            Value::Number(value) => number(node) == Some(value),
            Value::Vector(value) => vector(node) == Some(value),
            Value::Direction(value) => {
                vector(node).is_some_and(|known| known == value || known.normalize_or_zero() == value)
            }
            Value::Angle { radians, most } => {
                number(node).is_some_and(|known| known.to_radians() == radians && known <= most)
            }
        }
    }

    /// Returns the value as a new field has it.
    pub(super) fn text(self) -> String {
        match self {
            Value::Number(value) => format!("{value:?}"),
            Value::Vector(Vec3 { x, y, z }) | Value::Direction(Vec3 { x, y, z }) => {
                format!("({x:?}, {y:?}, {z:?})")
            }
            Value::Angle { radians, most } => format!("{:?}", degrees(radians).min(most)),
        }
    }
}

/// Returns the number of a node, as the grammar reads it.
pub(super) fn number(node: &Node) -> Option<f32> {
    match node.form {
        Form::Number(Number::Integer(n)) => Some(n as f32),
        Form::Number(Number::Float(x)) => Some(x as f32),
        _ => None,
    }
}

fn vector(node: &Node) -> Option<Vec3> {
    let Form::Tuple(None, items) = &node.form else { return None };
    let [x, y, z] = items.as_slice() else { return None };
    Some(Vec3::new(number(x)?, number(y)?, number(z)?))
}

/// Returns the degrees that are read as an angle \[rad\], with as few digits as possible. Not every angle can be
/// read from degrees: then those that are read as the nearest.
pub(super) fn degrees(radians: f32) -> f32 {
    let near = radians.to_degrees();
    let up = std::iter::successors(Some(near), |x| Some(x.next_up())).take(4);
    let down = std::iter::successors(Some(near.next_down()), |x| Some(x.next_down())).take(3);
    let error = |degrees: f32| (degrees.to_radians() - radians).abs();
    let digits = |degrees: f32| format!("{degrees:?}").len();
    let better = |a: &f32, b: &f32| error(*a).total_cmp(&error(*b)).then(digits(*a).cmp(&digits(*b)));
    up.chain(down).min_by(better).unwrap_or(near)
}

/// Returns a form with those of the fields that have a value.
pub(super) fn form(name: &str, fields: &[Field]) -> String {
    let given = fields.iter().filter_map(|(name, value)| Some(format!("{name}: {}", (*value)?.text())));
    format!("{name}({})", given.collect::<Vec<_>>().join(", "))
}
