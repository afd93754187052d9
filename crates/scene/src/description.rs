//! What a scene file says.

mod grammar;

use data_file::Place;
use glam::{EulerRot, Quat, Vec3};

use crate::camera::Camera;
use crate::light::Light;
use crate::model::Transform;

pub(crate) use grammar::parse;

/// A value with its place in the scene file.
#[derive(Clone, Debug)]
pub(crate) struct At<T> {
    pub(crate) value: T,
    pub(crate) place: Place,
}

/// A scene file whose every value is sound in itself.
#[derive(Clone, Debug)]
pub(crate) struct Description {
    /// What the scene shows, in a line.
    pub(crate) about: String,
    pub(crate) geometry: Geometry,
    /// Instead of the geometry's own; `near` is 0 where the file leaves it to the extent.
    pub(crate) camera: Option<Camera>,
    pub(crate) lights: Vec<Light>,
    /// Whether the geometry's own lights shine too.
    pub(crate) lights_from_file: bool,
    pub(crate) keyframes: Option<Keyframes>,
}

#[derive(Clone, Debug)]
pub(crate) enum Geometry {
    /// Made by code.
    BuiltIn(At<String>),
    /// A glTF file, from the folder of the scene file.
    File(At<String>),
    /// Several, each at its own place.
    Objects(Vec<Object>),
}

#[derive(Clone, Debug)]
pub(crate) struct Object {
    pub(crate) name: At<String>,
    pub(crate) geometry: Geometry,
    pub(crate) transform: Transform,
}

/// Movement. Positions, directions, targets and intensities run smoothly through their keys (Catmull-Rom);
/// turns and scales of objects run from key to key (slerp, linear). A key may leave out what it does not set.
#[derive(Clone, Debug)]
pub(crate) struct Keyframes {
    pub(crate) frames_per_second: f32,
    /// Whether all starts again after the last key; else the first and last keys hold.
    pub(crate) repeat: bool,
    /// The time of the last key of all \[s\].
    pub(crate) end: f32,
    pub(crate) camera: Option<At<CameraKeys>>,
    /// By the name of a light.
    pub(crate) lights: Vec<(At<String>, LightKeys)>,
    /// By the name of an object.
    pub(crate) objects: Vec<(At<String>, ObjectKeys)>,
}

/// The keys that set a value, at rising times \[s\].
pub(crate) type Keys<T> = Vec<(f32, T)>;

#[derive(Clone, Debug, Default)]
pub(crate) struct CameraKeys {
    pub(crate) position: Keys<Vec3>,
    pub(crate) target: Keys<Vec3>,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct LightKeys {
    pub(crate) position: Keys<Vec3>,
    pub(crate) direction: Keys<Vec3>,
    pub(crate) intensity: Keys<Vec3>,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct ObjectKeys {
    pub(crate) translate: Keys<Vec3>,
    pub(crate) rotate: Keys<Quat>,
    pub(crate) scale: Keys<Vec3>,
}

/// Returns a turn about x, then y, then z, by degrees.
fn rotation(degrees: Vec3) -> Quat {
    let [x, y, z] = degrees.to_array().map(f32::to_radians);
    Quat::from_euler(EulerRot::ZYX, z, y, x)
}
