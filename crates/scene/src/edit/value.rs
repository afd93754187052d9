//! The values that an edit writes: whether they differ from what a file has, and how they are written.

use data_file::grammar::{Node, Number, Shape};
use glam::{DVec3, Vec3};

use super::patches::Patches;
use crate::origin::{kept, local, written};

/// The value of a field.
#[derive(Clone, Copy, Debug)]
pub(super) enum Value {
    Number(f32),
    Vector(Vec3),
    /// One coordinate of a place.
    Coordinate {
        value: f32,
        origin: f64,
    },
    /// A place relative to an origin; the file has it in the world.
    Place {
        value: Vec3,
        origin: DVec3,
    },
    /// A vector of which only the direction matters.
    Direction(Vec3),
    /// In radians; written in degrees, at most `most`.
    Angle {
        radians: f32,
        most: f32,
    },
}

/// A field and its value; without one, the field is to be left out.
pub(super) type Field = (&'static str, Option<Value>);

impl Value {
    /// Writes the value over that of the file, if it is another one: only the numbers that differ.
    pub(super) fn write(self, node: Node<'_>, patches: &mut Patches<'_>) {
        if self.is(node) {
            return;
        }
        let is_tuple = node.shape() == Shape::Form(None);
        match self {
            Value::Vector(value) | Value::Direction(value) if is_tuple => {
                for (item, value) in node.items().into_iter().zip(value.to_array()) {
                    Value::Number(value).write(item, patches);
                }
            }
            Value::Place { value, origin } if is_tuple => {
                for (item, (value, origin)) in node.items().into_iter().zip(coordinates(value, origin)) {
                    Value::Coordinate { value, origin }.write(item, patches);
                }
            }
            _ => patches.replace(node, self.text()),
        }
    }

    /// Returns whether the file has this value.
    fn is(self, node: Node<'_>) -> bool {
        match self {
            Value::Number(value) => number(node) == Some(value),
            Value::Vector(value) => vector(node) == Some(value),
            Value::Coordinate { value, origin } => {
                node.number().is_some_and(|number| local(number, origin) == kept(value, origin))
            }
            Value::Place { value, origin } => numbers(node).is_some_and(|numbers| {
                let mut pairs = numbers.into_iter().zip(coordinates(value, origin));
                pairs.all(|(number, (value, origin))| local(number, origin) == kept(value, origin))
            }),
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
            Value::Coordinate { value, origin } => written(value, origin),
            Value::Place { value, origin } => {
                let [x, y, z] = coordinates(value, origin).map(|(value, origin)| written(value, origin));
                format!("({x}, {y}, {z})")
            }
            Value::Angle { radians, most } => format!("{:?}", degrees(radians).min(most)),
        }
    }
}

/// Returns the coordinates of a place, each with that of the origin.
fn coordinates(place: Vec3, origin: DVec3) -> [(f32, f64); 3] {
    std::array::from_fn(|axis| (place[axis], origin[axis]))
}

/// Returns the number of a node, as the grammar reads it.
pub(super) fn number(node: Node<'_>) -> Option<f32> {
    node.number().map(|number| local(number, 0.0))
}

/// Returns the numbers of `(x, y, z)`.
fn numbers(node: Node<'_>) -> Option<[Number; 3]> {
    let [x, y, z] = node.items()[..] else { return None };
    Some([x.number()?, y.number()?, z.number()?])
}

fn vector(node: Node<'_>) -> Option<Vec3> {
    numbers(node).map(|numbers| numbers.map(|number| local(number, 0.0)).into())
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
