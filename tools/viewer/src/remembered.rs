//! The state of the window that is kept from one start to the next.

use crate::action::{Tab, View};
use crate::panel::scene::Bookmark;
use scene::Camera;
use serde::{Deserialize, Serialize};

/// The state that the next start restores.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Remembered {
    /// The pipeline of side A.
    pub(crate) pipeline: String,
    /// The pipeline of side B; empty where there was none.
    pub(crate) other: String,
    /// The scene.
    pub(crate) scene: String,
    /// The way in which pictures are shown.
    pub(crate) view: View,
    /// The open panel.
    pub(crate) tab: Tab,
    /// Whether the settings are open.
    pub(crate) settings: bool,
    /// Whether the panels on the right are open.
    pub(crate) panels: bool,
    /// Pixels of a frame per pixel of the screen, in each direction; 0 where the adapter decides.
    pub(crate) resolution: f32,
    /// The place of the split, as a share of the width.
    pub(crate) split: f32,
    /// Factor of differences.
    pub(crate) gain: f32,
    /// Whether errors are computed.
    pub(crate) errors: bool,
    /// Whether handles of lights are drawn.
    pub(crate) handles: bool,
    /// Whether the theme is dark; `None` as the system has it.
    pub(crate) dark: Option<bool>,
    /// The camera, where the user moved it, in the scene named above.
    pub(crate) camera: Option<Camera>,
    /// The files of pipelines that were opened lately, the newest first.
    pub(crate) recent_pipelines: Vec<String>,
    /// The same of scenes.
    pub(crate) recent_scenes: Vec<String>,
    /// The size of pictures that are written; `None` as they are shown.
    pub(crate) written_size: Option<(u32, u32)>,
    /// Cameras that the user goes back to.
    pub(crate) bookmarks: Vec<Bookmark>,
}

impl Default for Remembered {
    fn default() -> Remembered {
        Remembered {
            pipeline: "ism-invtm".to_owned(),
            other: String::new(),
            scene: "cornell-box".to_owned(),
            view: View::One,
            tab: Tab::Time,
            settings: true,
            panels: true,
            resolution: 0.0,
            split: 0.5,
            gain: 4.0,
            errors: true,
            handles: true,
            dark: None,
            camera: None,
            recent_pipelines: Vec::new(),
            recent_scenes: Vec::new(),
            written_size: None,
            bookmarks: Vec::new(),
        }
    }
}

/// The key under which it is stored.
const STORED: &str = "lightloom";

impl Remembered {
    /// Reads what was stored; the defaults where nothing was, or where it cannot be read.
    pub(crate) fn load(storage: Option<&dyn eframe::Storage>) -> Remembered {
        let text = storage.and_then(|storage| storage.get_string(STORED));
        text.and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default()
    }

    /// Stores it.
    pub(crate) fn save(&self, storage: &mut dyn eframe::Storage) {
        // Plain data always has a form in JSON.
        storage.set_string(STORED, serde_json::to_string(self).unwrap_or_default());
    }
}
