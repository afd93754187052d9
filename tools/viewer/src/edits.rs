//! What the user changed: the settings of pipelines, camera, lights and keys, and which of it is in no file.

use crate::app::App;
use crate::engine::{Command, SideId};
use frame_graph::{Overrides, Value};
use scene::{Camera, Light, SceneKeys};

/// A side, its pipeline, and the values that are set in it.
pub(crate) type Settings = (SideId, String, Overrides);

/// Everything that the user changed.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Edits {
    /// The pipelines that can be edited.
    pub(crate) settings: Vec<Settings>,
    /// The user's camera; `None` for the scene's own.
    pub(crate) camera: Option<Camera>,
    /// The user's lights; `None` for the scene's own.
    pub(crate) lights: Option<Vec<Light>>,
    /// The keys, where they are edited.
    pub(crate) keys: Option<SceneKeys>,
}

/// What has been written into files since it was changed.
#[derive(Debug, Default)]
pub(crate) struct Saved {
    /// The values of each pipeline that are saved, or were given when the program was started.
    settings: Vec<(String, Overrides)>,
    /// The lights that are saved.
    lights: Option<Vec<Light>>,
}

impl Saved {
    /// Takes note that the values of a pipeline are saved.
    pub(crate) fn take_settings(&mut self, name: &str, overrides: &Overrides) {
        self.settings.retain(|(known, _)| known != name);
        self.settings.push((name.to_owned(), overrides.clone()));
    }

    /// Takes note that lights are saved.
    pub(crate) fn take_lights(&mut self, lights: Option<Vec<Light>>) {
        self.lights = lights;
    }

    /// Returns the paths of the values of a pipeline that differ from the saved ones.
    fn changed(&self, name: &str, now: &Overrides) -> Vec<String> {
        let nothing = Overrides::default();
        let saved =
            self.settings.iter().find(|(known, _)| known == name).map_or(&nothing, |(_, saved)| saved);
        changed_paths(saved, now)
    }
}

/// Returns the paths whose values differ.
pub(crate) fn changed_paths(before: &Overrides, now: &Overrides) -> Vec<String> {
    let value = |all: &Overrides, path: &str| {
        let mut found = all.0.iter().rev().filter(|(known, _)| known == path);
        found.next().map(|(_, value)| value.clone())
    };
    let mut paths: Vec<String> = Vec::new();
    for (path, _) in now.0.iter().chain(&before.0) {
        if value(before, path) != value(now, path) && !paths.contains(path) {
            paths.push(path.clone());
        }
    }
    paths
}

/// Returns the same values by path: two orders are no change.
fn sorted(overrides: &Overrides) -> Overrides {
    let mut values = overrides.0.clone();
    // The last of a path wins, and stays the last.
    values.sort_by(|a, b| a.0.cmp(&b.0));
    Overrides(values)
}

/// Returns a list of names in words, of which only the first are written out.
fn listed(names: &[String]) -> String {
    const WRITTEN: usize = 4;
    match names.len().checked_sub(WRITTEN).filter(|more| *more > 0) {
        Some(more) => format!("{} and {more} more", names[..WRITTEN].join(", ")),
        None => names.join(", "),
    }
}

/// Returns a count with its noun.
pub(crate) fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

impl App {
    /// Returns what the user has changed, as far as it was asked for: the engine may not have followed yet.
    pub(crate) fn edits(&self) -> Edits {
        let of_user = self.settings.iter().filter(|(side, ..)| *side != SideId::Reference);
        Edits {
            settings: of_user
                .map(|(side, name, overrides)| (*side, name.clone(), sorted(overrides)))
                .collect(),
            camera: self.pilot.camera(),
            lights: self.pilot.lights.clone(),
            keys: self.scene_panel.edited_keys(),
        }
    }

    /// Takes over the settings as the engine has them, once it has carried out all commands.
    pub(crate) fn take_settings(&mut self) {
        if self.engine.sent() == self.now.executed && self.now.executed > 0 {
            self.settings.clone_from(&self.now.settings);
        }
    }

    /// Sets the value of a parameter or setting.
    pub(crate) fn set_value(&mut self, side: SideId, path: &str, value: Value) {
        if let Some((.., overrides)) = self.settings.iter_mut().find(|(known, ..)| *known == side) {
            overrides.0.retain(|(known, _)| known != path);
            overrides.0.push((path.to_owned(), value.clone()));
        }
        self.engine.send(Command::Value(side, path.to_owned(), value));
    }

    /// Takes a value back to what the pipeline's files say.
    pub(crate) fn reset_value(&mut self, side: SideId, path: &str) {
        if let Some((.., overrides)) = self.settings.iter_mut().find(|(known, ..)| *known == side) {
            overrides.0.retain(|(known, _)| known != path);
        }
        self.engine.send(Command::Reset(side, path.to_owned()));
    }

    /// Describes the settings that would be lost if these sides were closed: each with its side. Nothing is lost that
    /// another side still has.
    pub(crate) fn unsaved_settings(&self, closed: &[SideId]) -> Vec<(SideId, String)> {
        let edits = self.edits();
        let mut lost: Vec<(SideId, String)> = Vec::new();
        for (at, (side, name, overrides)) in edits.settings.iter().enumerate() {
            let same = |other: &&Settings| other.1 == *name && changed_paths(&other.2, overrides).is_empty();
            let kept = edits.settings.iter().filter(|(other, ..)| !closed.contains(other)).any(|o| same(&o));
            let listed_already = edits.settings[..at].iter().any(|other| same(&other));
            let changed = self.saved.changed(name, overrides);
            if closed.contains(side) && !kept && !listed_already && !changed.is_empty() {
                let count = counted(changed.len(), "changed setting");
                lost.push((*side, format!("{count} of {name} ({}): {}", side.name(), listed(&changed))));
            }
        }
        lost
    }

    /// Describes what would be lost with the scene: lights and keys. The camera is remembered, or soon found again.
    pub(crate) fn unsaved_scene(&self) -> Vec<String> {
        let own = self.now.scene.as_ref().map_or(&[][..], |view| &view.scene.lights);
        let lights = self.pilot.lights.as_ref().filter(|lights| Some(*lights) != self.saved.lights.as_ref());
        let mut lost = Vec::new();
        if let Some(lights) = lights.filter(|lights| lights.as_slice() != own) {
            let differs = |light: &&Light| own.iter().all(|own| own != *light);
            let names: Vec<String> = lights.iter().filter(differs).map(|light| light.name.clone()).collect();
            lost.push(match names.len() {
                0 => "removed lights".to_owned(),
                n => format!("{}: {}", counted(n, "changed light"), listed(&names)),
            });
        }
        if self.scene_panel.has_unsaved_keys() {
            lost.push("recorded or removed keys".to_owned());
        }
        lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(all: &[(&str, u32)]) -> Overrides {
        Overrides(all.iter().map(|(path, value)| ((*path).to_owned(), Value::U32(*value))).collect())
    }

    #[test]
    fn values_are_compared_by_path_in_any_order() {
        let (a, b) = (values(&[("x", 1), ("y", 2)]), values(&[("y", 2), ("x", 1)]));
        assert!(changed_paths(&a, &b).is_empty());
        assert_eq!(changed_paths(&a, &values(&[("x", 3)])), ["x", "y"]);
        // A later value of the same path wins.
        assert!(changed_paths(&values(&[("x", 5), ("x", 1)]), &values(&[("x", 1)])).is_empty());
    }

    #[test]
    fn what_is_saved_is_not_changed() {
        let mut saved = Saved::default();
        assert_eq!(saved.changed("ism", &values(&[("x", 1)])), ["x"]);
        saved.take_settings("ism", &values(&[("x", 1)]));
        assert!(saved.changed("ism", &values(&[("x", 1)])).is_empty());
        // The way back from what is saved is a change too.
        assert_eq!(saved.changed("ism", &values(&[])), ["x"]);
        assert_eq!(saved.changed("tcas", &values(&[("x", 1)])), ["x"]);
    }

    #[test]
    fn long_lists_are_cut() {
        let names: Vec<String> = ["a", "b", "c", "d", "e", "f"].map(str::to_owned).to_vec();
        assert_eq!(listed(&names), "a, b, c, d and 2 more");
        assert_eq!(listed(&names[..4]), "a, b, c, d");
        assert_eq!((counted(1, "light"), counted(0, "light")), ("1 light".to_owned(), "0 lights".to_owned()));
    }
}
