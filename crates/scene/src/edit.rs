//! Writes camera, lights and keys back to a scene file, of which everything else stays as it is written.

mod keys;
mod patches;
mod tree;
mod value;

pub use keys::{SceneKeys, keys_of};

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::Arc;

use data_file::codes::scene as codes;
use data_file::reader::{self, Form, Node};
use data_file::{Diagnostic, Diagnostics, Source, Span};
use glam::{DVec3, Vec3};

use crate::camera::Camera;
use crate::description::{Description, Keys, parse};
use crate::error::SceneError;
use crate::light::{Light, LightKind};
use crate::origin::kept;
use crate::scene::Scene;
use patches::Patches;

/// What is to be changed in a scene file. What it does not name stays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneEdit {
    /// The camera. Where the file leaves `near` to be derived from the scene's extent, it still does; a file without
    /// a camera gets it whole, without `near` if that is 0.
    pub camera: Option<Camera>,
    /// Lights of the file, by name and of the same kind: those that changed. Of several with one name, the first
    /// stands for the first in the file, and so on.
    pub lights: Vec<Light>,
    /// The keys of the camera, all of them, by rising times.
    pub camera_keys: Option<Vec<CameraKey>>,
    /// The keys of lights, by name: all of each light that is named, by rising times.
    pub light_keys: BTreeMap<String, Vec<LightKey>>,
    /// The [`Scene::origin`] of the scene that the file makes. All places of the edit are relative to it, and those that
    /// are written are in the world of the file.
    pub origin: DVec3,
}

/// A key of the camera. What it leaves out is not keyed there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CameraKey {
    /// Time \[s\], ≥ 0.
    pub time: f32,
    /// [`Camera::position`].
    pub position: Option<Vec3>,
    /// [`Camera::target`].
    pub target: Option<Vec3>,
}

/// A key of a light. What it leaves out is not keyed there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightKey {
    /// Time \[s\], ≥ 0.
    pub time: f32,
    /// [`Light::position`].
    pub position: Option<Vec3>,
    /// [`Light::direction`].
    pub direction: Option<Vec3>,
    /// [`Light::intensity`].
    pub intensity: Option<Vec3>,
}

/// Returns the text of a scene file after an edit: comments, order, spacing and all values that did not change are
/// as they were, byte for byte. What is missing is added in the style of its neighbours. The comments of a key that
/// is removed remain.
///
/// The result is read again, and has the values of the edit: as `f32`, directions but for their length, and angles,
/// which are written in degrees, to the nearest that can be read from degrees. Places far from the world's origin are
/// as precise as `f64` is there.
///
/// # Errors
/// All errors of the file; a light that is not in its `lights`, because it belongs to a glTF file, or is of another
/// kind there; values that no scene file can have.
pub fn edited(source: &Arc<Source>, edit: &SceneEdit) -> Result<String, Diagnostics> {
    parse(source, None, edit.origin)?;
    let text = reader::parse(source, |reader, tree| {
        let mut patches = Patches::new(&source.text, tree);
        tree::edit(reader, tree, &mut patches, edit);
        Some(patches.apply())
    })?;
    check(&source.name, &text, edit)?;
    Ok(text)
}

/// Applies an edit to a scene file on disk, as [`edited`] does. The file is replaced as a whole, with the same
/// permissions, or not at all; if nothing changes, it is not touched.
///
/// # Errors
/// [`SceneError::Description`] for those of [`edited`], [`SceneError::Unreadable`], [`SceneError::Unwritable`].
pub fn save(path: &Path, edit: &SceneEdit) -> Result<(), SceneError> {
    let unreadable = |error| SceneError::Unreadable { path: path.into(), error };
    let unwritable = |error| SceneError::Unwritable { path: path.into(), error };
    let source = Source::new(path.display().to_string(), fs::read_to_string(path).map_err(unreadable)?);
    let text = edited(&source, edit)?;
    if text == source.text {
        return Ok(());
    }
    whole_file::write(path, text).map_err(unwritable)
}

/// Returns a new scene file for a scene that is a bare glTF file, at the path `geometry` from the folder of the new
/// file: with the camera and the lights of the edit, those of the scene where it has none, and its keys. The file
/// takes the place of the glTF file's own camera and lights, so that those which its animation moves stand still. The
/// origin is that of the scene, whatever the edit has.
///
/// # Errors
/// Values that no scene file can have.
pub fn scene_file_for(scene: &Scene, geometry: &str, edit: &SceneEdit) -> Result<String, Diagnostics> {
    let origin = scene.origin;
    let edit = &SceneEdit { origin, ..edit.clone() };
    let lights = scene.lights.iter().enumerate().map(|(i, light)| {
        let before = scene.lights[..i].iter().filter(|before| before.name == light.name).count();
        let edited = edit.lights.iter().filter(|edited| edited.name == light.name).nth(before);
        format!("        {},\n", tree::light_text(edited.unwrap_or(light), origin))
    });
    let camera = edit.camera.unwrap_or(scene.camera);
    let mut text = String::from("Scene(\n");
    if !scene.about.is_empty() {
        text.push_str(&format!("    about: {:?},\n", scene.about));
    }
    text.push_str(&format!("    geometry: File({geometry:?}),\n"));
    text.push_str(&format!("    camera: {},\n", tree::camera_text(&camera, origin)));
    text.push_str(&format!("    lights: [\n{}    ],\n", lights.collect::<String>()));
    text.push_str("    lights_from_file: false,\n");
    let nothing = Node { start: 0, end: 0, form: Form::Bad };
    if let Some(keyframes) = tree::keyframes(&Patches::new("", &nothing), edit, "    ") {
        text.push_str(&format!("    {keyframes},\n"));
    }
    text.push_str(")\n");
    check("the new scene file", &text, edit)?;
    Ok(text)
}

/// Reads a text that was edited, and compares it with the edit.
fn check(name: &str, text: &str, edit: &SceneEdit) -> Result<(), Diagnostics> {
    let source = Source::new(name, text);
    let description = parse(&source, None, edit.origin).map_err(|Diagnostics(errors)| {
        let note = "this is what would have been written; nothing is";
        Diagnostics(errors.into_iter().map(|error| error.note(note)).collect())
    })?;
    let Some(what) = difference(&description, edit) else { return Ok(()) };
    let whole = Span { source, start: 0, end: 0 };
    let error = Diagnostic::new(&codes::CONFLICT, format!("{what} would not be read as they were set"))
        .label(whole, "nothing is written");
    Err(error.into())
}

/// Returns what of a description is not as the edit has it.
fn difference(description: &Description, edit: &SceneEdit) -> Option<String> {
    let near = |a: f32, b: f32| (a - b).abs() <= 4.0 * f32::EPSILON * b.abs();
    let kept =
        |place: Vec3| Vec3::from_array(std::array::from_fn(|axis| kept(place[axis], edit.origin[axis])));
    let place = |(time, place): (f32, Option<Vec3>)| (time, place.map(kept));
    let aims = |a: Vec3, b: Vec3| a.normalize_or_zero().abs_diff_eq(b.normalize_or_zero(), 1e-5);
    if let Some(camera) = &edit.camera {
        let is = description.camera.as_ref().is_some_and(|known| {
            let (position, target) = (kept(camera.position), kept(camera.target));
            let same = (known.position, known.target, known.up) == (position, target, camera.up);
            let near_plane = known.near == 0.0 || known.near == camera.near || camera.near <= 0.0;
            same && near_plane && near(known.vertical_fov, camera.vertical_fov)
        });
        if !is {
            return Some("the values of the camera".to_owned());
        }
    }
    for (i, light) in edit.lights.iter().enumerate() {
        let count = edit.lights[..i].iter().filter(|before| before.name == light.name).count();
        let mut same_name = description.lights.iter().filter(|known| known.name == light.name);
        let is = same_name.nth(count).is_some_and(|known| {
            let kind = match (known.kind, light.kind) {
                (LightKind::Spot { inner: a, outer: b }, LightKind::Spot { inner, outer }) => {
                    near(a, inner) && near(b, outer)
                }
                (a, b) => a == b,
            };
            let place = light.kind == LightKind::Directional || known.position == kept(light.position);
            let aim = light.kind == LightKind::Point || aims(known.direction, light.direction);
            kind && place && aim && known.intensity == light.intensity
        });
        if !is {
            return Some(format!("the values of the light `{}`", light.name));
        }
    }
    let keyframes = description.keyframes.as_ref();
    if let Some(keys) = &edit.camera_keys {
        let known = keyframes.and_then(|k| k.camera.as_ref()).map(|k| k.value.clone()).unwrap_or_default();
        let is = known.position == channel(keys.iter().map(|key| place((key.time, key.position))))
            && known.target == channel(keys.iter().map(|key| place((key.time, key.target))));
        if !is {
            return Some("the keys of the camera".to_owned());
        }
    }
    for (name, keys) in &edit.light_keys {
        let lights = keyframes.map(|k| k.lights.as_slice()).unwrap_or_default();
        let known = lights.iter().find(|(known, _)| known.value == *name);
        let known = known.map(|(_, keys)| keys.clone()).unwrap_or_default();
        let directions = channel(keys.iter().map(|key| (key.time, key.direction)));
        let mut pairs = known.direction.iter().zip(&directions);
        let is = known.position == channel(keys.iter().map(|key| place((key.time, key.position))))
            && known.intensity == channel(keys.iter().map(|key| (key.time, key.intensity)))
            && known.direction.len() == directions.len()
            && pairs.all(|(known, key)| known.0 == key.0 && aims(known.1, key.1));
        if !is {
            return Some(format!("the keys of the light `{name}`"));
        }
    }
    None
}

fn channel(keys: impl Iterator<Item = (f32, Option<Vec3>)>) -> Keys<Vec3> {
    keys.filter_map(|(time, value)| Some((time, value?))).collect()
}
