//! One extreme.

use crate::long::Steady;

/// What is expected of the indirect light of a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Expect {
    /// That of the plain scene by the same pipeline, times a factor: only units or the place differ.
    Plain(f64),
    /// That of the path tracer, as nearly as in the plain scene.
    Truth,
    /// None at all.
    Black,
    /// A finite picture that is nowhere negative: nothing else is known.
    Finite,
    /// No picture: the program says why.
    Refused,
    /// A long run that neither drifts nor grows.
    Steady(Steady),
}

/// One extreme: a scene, how it is rendered, and what is expected.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// A name in kebab-case, unique in the table; the name of its scene file.
    pub name: String,
    /// What it is an extreme of, as a heading.
    pub group: &'static str,
    /// What it is, in a sentence.
    pub about: String,
    /// The text of its scene file.
    pub scene: String,
    /// Files that the scene names: name and content.
    pub files: Vec<(String, String)>,
    /// The size of frames in pixels; `None` for that of the run.
    pub size: Option<(u32, u32)>,
    /// How many frames are rendered; the last is judged.
    pub frames: u32,
    /// Values of parameters and settings. Those that a pipeline does not have are left out of it.
    pub set: Vec<(String, String)>,
    /// What is expected.
    pub expect: Expect,
}

impl Case {
    /// A case of the plain scene, of one frame.
    pub(crate) fn new(
        group: &'static str,
        name: impl Into<String>,
        about: impl Into<String>,
        expect: Expect,
    ) -> Case {
        Case {
            name: name.into(),
            group,
            about: about.into(),
            scene: crate::room::Room::default().text(),
            files: Vec::new(),
            size: None,
            frames: 1,
            set: Vec::new(),
            expect,
        }
    }

    pub(crate) fn scene(mut self, text: String) -> Case {
        self.scene = text;
        self
    }

    pub(crate) fn file(mut self, name: &str, text: String) -> Case {
        self.files.push((name.to_owned(), text));
        self
    }

    pub(crate) fn size(mut self, width: u32, height: u32) -> Case {
        self.size = Some((width, height));
        self
    }

    pub(crate) fn frames(mut self, frames: u32) -> Case {
        self.frames = frames;
        self
    }

    pub(crate) fn set(mut self, path: &str, value: impl ToString) -> Case {
        self.set.push((path.to_owned(), value.to_string()));
        self
    }
}
