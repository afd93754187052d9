//! The actions of the user: the one table from which keys, palette and help are made.

use eframe::egui::{Key, KeyboardShortcut, Modifiers};

/// Declares an enum whose values the user chooses among, each with its name in the interface.
macro_rules! choices {
    ($(#[$about:meta])* $vis:vis enum $name:ident { $($(#[$each:meta])* $value:ident = $text:literal,)+ }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        $vis enum $name {
            $($(#[$each])* $value,)+
        }

        impl $name {
            /// All of them, in the order of the interface.
            $vis const ALL: &[$name] = &[$($name::$value),+];

            /// Returns the name in the interface, in letters that its font has.
            $vis fn name(self) -> &'static str {
                match self {
                    $($name::$value => $text,)+
                }
            }
        }
    };
}
pub(crate) use choices;

choices! {
    /// The ways to show two pictures.
    #[derive(serde::Serialize, serde::Deserialize)]
    pub(crate) enum View {
        /// Side A alone.
        #[default]
        One = "one",
        /// A beside B.
        Beside = "side by side",
        /// A on the left of a line that can be dragged, B on the right.
        Split = "split",
        /// A or B, changed by a key.
        Flicker = "flicker",
        /// The absolute difference.
        Difference = "difference",
        /// ꟻLIP's map of errors.
        Flip = "FLIP",
    }
}

choices! {
    /// The panels on the right.
    #[derive(serde::Serialize, serde::Deserialize)]
    pub(crate) enum Tab {
        /// Times of passes.
        #[default]
        Time = "Time",
        /// The graph of passes.
        Graph = "Graph",
        /// The content of a resource.
        Look = "Look",
        /// Camera, lights and keys.
        Scene = "Scene",
        /// Comparison and reference.
        Compare = "Compare",
        /// Files to write.
        Write = "Write",
        /// Messages.
        Log = "Log",
    }
}

/// Something that the user can do by a key or in the palette.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Action {
    /// Shows the keys.
    Help,
    /// Opens the palette.
    Palette,
    /// Goes a step forward again.
    Redo,
    /// Goes a step back.
    Undo,
    /// Exchanges A and B.
    Swap,
    /// Shows the other of A and B.
    Flick,
    /// Shows pictures in this way.
    Show(View),
    /// Opens a panel.
    Open(Tab),
    /// Shows or hides the settings.
    Settings,
    /// Shows or hides all panels.
    Bare,
    /// Starts or stops the animation.
    Play,
    /// Goes to the start of the animation.
    Rewind,
    /// Gives the camera back to the scene.
    SceneCamera,
    /// Gives the lights back to the scene.
    SceneLights,
    /// Opens the dialog for a pipeline.
    OpenPipeline,
    /// Opens the dialog for a scene.
    OpenScene,
    /// Keeps the picture, to compare with it.
    Snapshot,
    /// Shows the picture that was kept, or again what is rendered.
    FlickSnapshot,
    /// Keeps the camera, to go back to it.
    Bookmark,
    /// Records a key of the camera at the time shown.
    Key,
    /// Writes camera, lights and keys into the scene's file.
    SaveScene,
    /// Writes a variant of the pipeline.
    SaveVariant,
    /// Writes the picture of side A.
    Screenshot,
    /// Shows or hides the virtual lights.
    VirtualLights,
    /// Shows or hides the handles of lights.
    Handles,
    /// Starts or ends the reference.
    Reference,
    /// Light or dark.
    Theme,
    /// Ends the program.
    Quit,
}

/// An action with a line about it, and its key.
pub(crate) struct Entry {
    /// The action.
    pub(crate) action: Action,
    /// Describes it in one line.
    pub(crate) about: &'static str,
    /// Its key, if it has one.
    pub(crate) key: Option<KeyboardShortcut>,
}

const fn plain(key: Key) -> Option<KeyboardShortcut> {
    Some(KeyboardShortcut::new(Modifiers::NONE, key))
}

const fn ctrl(key: Key) -> Option<KeyboardShortcut> {
    Some(KeyboardShortcut::new(Modifiers::COMMAND, key))
}

/// Returns all actions, in the order of the help.
pub(crate) fn table() -> Vec<Entry> {
    use Action as A;
    let entry = |action, about, key| Entry { action, about, key };
    vec![
        entry(A::Help, "Show or hide the keys", plain(Key::F1)),
        entry(A::Palette, "Palette: any command, pipeline, scene or pass", ctrl(Key::P)),
        entry(A::Settings, "Show or hide the settings", plain(Key::F2)),
        entry(A::Bare, "Show the picture alone", plain(Key::F11)),
        // The key of one is part of that of the other, which is taken first.
        entry(
            A::Redo,
            "Redo",
            Some(KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z)),
        ),
        entry(A::Undo, "Undo a change of settings, camera, lights or keys", ctrl(Key::Z)),
        entry(A::Swap, "Exchange pipelines A and B", plain(Key::X)),
        entry(A::Flick, "Flicker between A and B", plain(Key::Space)),
        entry(A::Show(View::One), "Show A alone", plain(Key::Num1)),
        entry(A::Show(View::Beside), "Show A beside B", plain(Key::Num2)),
        entry(A::Show(View::Split), "Split the picture between A and B", plain(Key::Num3)),
        entry(A::Show(View::Flicker), "Show A or B in the same place", plain(Key::Num4)),
        entry(A::Show(View::Difference), "Show the difference", plain(Key::Num5)),
        entry(A::Show(View::Flip), "Show FLIP's map of errors", plain(Key::Num6)),
        entry(A::Reference, "Start or end the path-traced reference", plain(Key::R)),
        entry(A::Play, "Play or stop the animation", plain(Key::P)),
        entry(A::Rewind, "Go to the start of the animation", plain(Key::Home)),
        entry(A::Key, "Record a key of the camera at the time shown", plain(Key::K)),
        entry(
            A::OpenScene,
            "Open a scene from a file",
            Some(KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::O)),
        ),
        entry(A::OpenPipeline, "Open a pipeline from a file", ctrl(Key::O)),
        entry(A::Snapshot, "Keep the picture as a snapshot", plain(Key::N)),
        entry(A::FlickSnapshot, "Flicker between the picture and the snapshot", plain(Key::G)),
        entry(A::Bookmark, "Keep the camera as a bookmark", ctrl(Key::B)),
        entry(A::SceneCamera, "Give the camera back to the scene", plain(Key::C)),
        entry(A::SceneLights, "Give the lights back to the scene", plain(Key::B)),
        entry(A::Handles, "Show or hide the handles of lights", plain(Key::H)),
        entry(A::VirtualLights, "Show or hide the virtual lights", plain(Key::V)),
        entry(A::Open(Tab::Time), "Open the times of passes", plain(Key::F3)),
        entry(A::Open(Tab::Graph), "Open the graph", plain(Key::F4)),
        entry(A::Open(Tab::Look), "Open the content of a resource", plain(Key::F5)),
        entry(A::Open(Tab::Scene), "Open camera, lights and keys", plain(Key::F6)),
        entry(A::Open(Tab::Compare), "Open the comparison", plain(Key::F7)),
        entry(A::Open(Tab::Write), "Open the files to write", plain(Key::F8)),
        entry(A::Open(Tab::Log), "Open the log", plain(Key::F9)),
        entry(A::Screenshot, "Write the picture", plain(Key::F12)),
        entry(A::SaveVariant, "Save the settings as a variant", ctrl(Key::S)),
        entry(A::SaveScene, "Save camera, lights and keys into the scene's file", ctrl(Key::E)),
        entry(A::Theme, "Light or dark", ctrl(Key::T)),
        entry(A::Quit, "Quit", ctrl(Key::Q)),
    ]
}

/// The effects of the mouse and of keys in the picture, for the help.
pub(crate) const IN_THE_PICTURE: [(&str, &str); 8] = [
    ("W A S D, Q E", "Fly; with Shift faster, with Alt slower"),
    ("Right drag", "Look around"),
    ("Left drag", "Orbit around what lies in the middle"),
    ("Middle drag", "Shift sideways"),
    ("Wheel", "Go nearer or farther"),
    ("Double click", "Go to a point of the scene"),
    ("Drag a light", "Move it across the view; its arrow turns it"),
    ("Drag the line", "Move the split"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_key_stands_for_two_actions() {
        let all = table();
        for (i, a) in all.iter().enumerate() {
            for b in &all[i + 1..] {
                assert!(a.key.is_none() || a.key != b.key, "{} and {}", a.about, b.about);
                assert!(a.action != b.action, "{} is there twice", a.about);
            }
        }
    }

    #[test]
    fn every_view_and_tab_has_an_action() {
        let all = table();
        assert!(View::ALL.iter().all(|view| all.iter().any(|entry| entry.action == Action::Show(*view))));
        assert!(Tab::ALL.iter().all(|tab| all.iter().any(|entry| entry.action == Action::Open(*tab))));
    }
}
