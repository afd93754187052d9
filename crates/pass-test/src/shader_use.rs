//! Reads of a user's WGSL by a pass type, without a GPU.

use crate::{library_of, root};
use frame_graph::port::{InputDesc, OutputOverride};
use interfaces::INTERFACES;
use pass::{
    Library, OutputContext, OutputDesc, Pass, PassTypeError, PortDesc, Ports, RecordContext, Recording,
    Setting, Settings, Traits, Use, UseContext, Value,
};
use shader_library::{DiskFiles, MemoryFiles, Overlay};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A use of a pass type that takes its ports from a shader: the shader's text, its links, and what it says with `out:`.
/// The frame has 64×48 pixels.
pub struct ShaderUse<'a> {
    pass: &'a dyn Pass,
    library: Library,
    inputs: Vec<String>,
    overrides: BTreeMap<String, OutputOverride>,
}

const FRAME: (u32, u32) = (64, 48);

impl<'a> ShaderUse<'a> {
    /// Creates a use of the shader `own.wgsl` with links to these inputs.
    pub fn new(pass: &'a dyn Pass, wgsl: &str, inputs: &[&str]) -> Self {
        let own = MemoryFiles::new([("own.wgsl", wgsl)]);
        let files = Overlay(vec![Arc::new(own), Arc::new(DiskFiles::new(root()))]);
        ShaderUse {
            pass,
            library: library_of(files),
            inputs: inputs.iter().map(ToString::to_string).collect(),
            overrides: BTreeMap::new(),
        }
    }

    /// Says something of an output.
    pub fn out(mut self, port: &str, said: OutputOverride) -> Self {
        self.overrides.insert(port.into(), said);
        self
    }

    fn cx(&self) -> UseContext<'_> {
        let use_ = Use {
            kind: self.pass.kind(),
            shader: Some("own.wgsl"),
            inputs: &self.inputs,
            outputs: &self.overrides,
        };
        UseContext { use_, shaders: &self.library, interfaces: INTERFACES }
    }

    /// Returns all WGSL of the tree, and its own.
    pub fn library(&self) -> &Library {
        &self.library
    }

    /// Returns the settings that it has.
    pub fn schema(&self) -> Result<Vec<Setting>, PassTypeError> {
        self.pass.settings(&self.cx())
    }

    /// Returns every setting but `set` at its default.
    fn settings(&self, set: &[(&str, Value)]) -> Result<Settings, PassTypeError> {
        let defaults = self.schema()?.into_iter().map(|setting| (setting.name, setting.default));
        let set = set.iter().map(|(name, value)| ((*name).to_owned(), value.clone()));
        Ok(Settings(defaults.chain(set).collect()))
    }

    /// Returns its ports with these settings.
    pub fn ports(&self, set: &[(&str, Value)]) -> Result<Ports, PassTypeError> {
        self.pass.ports(&self.cx(), &self.settings(set)?)
    }

    /// Returns what it writes where these inputs are linked.
    pub fn outputs(&self, inputs: &[InputDesc]) -> Result<Vec<OutputDesc>, PassTypeError> {
        let (settings, traits) = (self.settings(&[])?, Traits::default());
        let use_ = self.cx().use_;
        let cx = OutputContext { use_, settings: &settings, inputs, frame: FRAME, traits: &traits };
        self.pass.outputs(&self.cx(), &cx)
    }

    /// Returns what it records with these outputs, settings and traits of the scene.
    pub fn record(
        &self,
        outputs: &[PortDesc],
        set: &[(&str, Value)],
        traits: &Traits,
    ) -> Result<Recording, PassTypeError> {
        let main = self.pass.main_shader(&self.cx().use_)?;
        self.pass.record(&RecordContext {
            main: Some(&main),
            name: "own",
            use_: self.cx().use_,
            settings: &self.settings(set)?,
            inputs: &[],
            outputs,
            frame: FRAME,
            traits,
            shaders: &self.library,
            interfaces: INTERFACES,
        })
    }

    /// Returns by which words its settings, ports or outputs are refused: input, message and help.
    ///
    /// # Panics
    /// Where they are not.
    pub fn refusal(&self) -> String {
        let asked = self.ports(&[]).and_then(|_| self.outputs(&[]));
        let error = asked.err().unwrap_or_else(|| panic!("the shader is refused"));
        let (input, help) = (error.input.unwrap_or_default(), error.help.unwrap_or_default());
        format!("{input} | {} | {help}", error.message)
    }
}
