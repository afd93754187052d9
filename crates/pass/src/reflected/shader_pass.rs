//! A pass type whose uses name their WGSL.

use super::MainShader;
use crate::{About, Files, Library, Pass, PassTypeError, Request, Use};
use shader_library::Stage;

/// A pass type whose uses name a WGSL file that declares all the rest: the entry points of one stage, in the order of the
/// text.
#[derive(Debug)]
pub struct ShaderPass {
    /// The name in RON.
    pub kind: &'static str,
    /// The documentation.
    pub about: &'static str,
    /// The WGSL that the program carries with it.
    pub files: Files,
    /// The stage of the entry points.
    pub stage: Stage,
    /// Returns the shader that is run for a user's file: the file itself, or one that imports it.
    pub request: fn(&str) -> Request,
    /// A use as an example, for those that name no file.
    pub example: &'static str,
}

impl Pass for ShaderPass {
    fn kind(&self) -> &'static str {
        self.kind
    }

    fn files(&self) -> Files {
        self.files
    }

    fn about(&self, library: &Library) -> About {
        let folder = library.folder(&format!("passes/{}", self.kind));
        let shaders = folder.iter().map(|file| file.path.clone()).collect();
        About { about: self.about.to_owned(), shaders, ..About::default() }
    }

    fn takes_shader(&self) -> bool {
        true
    }

    fn main_shader(&self, use_: &Use<'_>) -> Result<MainShader, PassTypeError> {
        let path = use_.shader.ok_or_else(|| {
            PassTypeError::new("the use names no shader").help(format!("say which: {}", self.example))
        })?;
        let request = (self.request)(path);
        Ok(MainShader { path: path.to_owned(), request, stage: Some(self.stage), folder: None })
    }
}
