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

use crate::codes;
use data_file::grammar::{self, Node};
use data_file::{Diagnostic, Diagnostics, Source, Span};
use glam::{DVec3, Vec3};

use crate::camera::Camera;
use crate::description::parse;
use crate::error::SceneError;
use crate::light::Light;
use crate::scene::Scene;
use patches::Patches;

/// Changes of a scene file. Values that it does not name stay.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneEdit {
    /// The camera. Where the file leaves `near` to be derived from the scene's extent, it still does; a file without
    /// a camera gets it whole, without `near` if that is 0.
    pub camera: Option<Camera>,
    /// Lights of the file, by name: those that changed. Of several with one name, the first stands for the first in the
    /// file, and so on. A light of another kind is written anew; only its comments remain.
    pub lights: Vec<Light>,
    /// Lights that the file does not have yet, behind all others. One that it has by then is edited.
    pub added: Vec<Light>,
    /// The names of the lights of the file that are removed: of several with one name, the first.
    pub removed: Vec<String>,
    /// The keys of the camera, all of them, by rising times.
    pub camera_keys: Option<Vec<CameraKey>>,
    /// The keys of lights, by name: all of each light that is named, by rising times.
    pub light_keys: BTreeMap<String, Vec<LightKey>>,
    /// The [`Scene::origin`] of the scene that the file makes. All places of the edit are relative to it, and those that
    /// are written are in the world of the file.
    pub origin: DVec3,
}

/// A key of the camera; `None` is not keyed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CameraKey {
    /// Time \[s\], ≥ 0.
    pub time: f32,
    /// [`Camera::position`].
    pub position: Option<Vec3>,
    /// [`Camera::target`].
    pub target: Option<Vec3>,
}

/// A key of a light; `None` is not keyed.
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
/// All errors of the file; a light that is not in its `lights`, because it belongs to a glTF file; values that no scene
/// file can have, as keys of a light that is removed.
pub fn edited(source: &Arc<Source>, edit: &SceneEdit) -> Result<String, Diagnostics> {
    parse(source, None, edit.origin)?;
    let text = patched(source, edit)?;
    check(&source.name, &text, edit)?;
    Ok(text)
}

/// Returns the text of a valid scene file after an edit.
fn patched(source: &Arc<Source>, edit: &SceneEdit) -> Result<String, Diagnostics> {
    grammar::parse(source, 0, |reader, tree| {
        let mut patches = Patches::new(&source.text, tree);
        tree::edit(reader, tree, &mut patches, edit);
        Some(patches.apply())
    })
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
    let stays = |light: &&Light| !edit.removed.contains(&light.name);
    let lights = scene.lights.iter().filter(stays).enumerate().map(|(i, light)| {
        let before =
            scene.lights.iter().filter(stays).take(i).filter(|before| before.name == light.name).count();
        let edited = edit.lights.iter().filter(|edited| edited.name == light.name).nth(before);
        format!("        {},\n", tree::light_text(edited.unwrap_or(light), origin))
    });
    let added = edit.added.iter().map(|light| format!("        {},\n", tree::light_text(light, origin)));
    let lights = lights.chain(added);
    let camera = edit.camera.unwrap_or(scene.camera);
    let mut text = String::from("Scene(\n");
    if !scene.about.is_empty() {
        text.push_str(&format!("    about: {:?},\n", scene.about));
    }
    text.push_str(&format!("    geometry: File({geometry:?}),\n"));
    text.push_str(&format!("    camera: {},\n", tree::camera_text(&camera, origin)));
    text.push_str(&format!("    lights: [\n{}    ],\n", lights.collect::<String>()));
    text.push_str("    lights_from_file: false,\n");
    if let Some(keyframes) = tree::keyframes(&Patches::new("", Node::root("")), edit, "    ") {
        text.push_str(&format!("    {keyframes},\n"));
    }
    text.push_str(")\n");
    check("the new scene file", &text, edit)?;
    Ok(text)
}

/// Reads a text that was edited: it must be valid, and the same edit again must change nothing.
fn check(name: &str, text: &str, edit: &SceneEdit) -> Result<(), Diagnostics> {
    let source = Source::new(name, text);
    parse(&source, None, edit.origin).map_err(|Diagnostics(errors)| {
        let note = "this is what would have been written; nothing is";
        Diagnostics(errors.into_iter().map(|error| error.note(note)).collect())
    })?;
    // What is gone cannot be removed again.
    let again = SceneEdit { removed: Vec::new(), ..edit.clone() };
    if patched(&source, &again)? == text {
        return Ok(());
    }
    let whole = Span { source, start: 0, end: 0 };
    let error = Diagnostic::new(&codes::CONFLICT, "the values would not be read as they were set");
    Err(error.label(whole, "nothing is written").into())
}
