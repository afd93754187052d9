//! One extreme.

use crate::long::Steady;
use serde::Deserialize;

/// The indirect light that is expected of a case.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub enum Expect {
    /// The light of the plain scene by the same pipeline, times a factor: only units or the place differ.
    Plain(f64),
    /// The light of the path tracer, as nearly as in the plain scene.
    Truth,
    /// No light.
    Black,
    /// A finite picture without negative values: nothing else is known.
    Finite,
    /// No picture: the program reports the reason.
    Refused,
    /// A long run that neither drifts nor grows.
    #[serde(skip)]
    Steady(Steady),
}

/// One extreme: a scene, how it is rendered, and the expectation.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// A name in kebab-case, unique in the table; the name of its scene file.
    pub name: String,
    /// The quantity that is extreme, as a heading.
    pub group: String,
    /// A description, in a sentence.
    pub about: String,
    /// The text of its scene file.
    pub scene: String,
    /// Files that the scene names: name and content.
    pub files: Vec<(String, String)>,
    /// The size of frames in pixels; `None` for that of the run.
    pub size: Option<(u32, u32)>,
    /// Number of frames; the last is evaluated.
    pub frames: u32,
    /// Values of parameters and settings. Those that a pipeline does not have are left out of it.
    pub set: Vec<(String, String)>,
    /// The expectation.
    pub expect: Expect,
}

impl Case {
    /// Creates a case of the plain scene, of one frame.
    pub(crate) fn new(group: &str, name: &str, about: String, expect: Expect) -> Case {
        Case {
            name: name.to_owned(),
            group: group.to_owned(),
            about,
            scene: crate::room::Room::default().text(),
            files: Vec::new(),
            size: None,
            frames: 1,
            set: Vec::new(),
            expect,
        }
    }
}
