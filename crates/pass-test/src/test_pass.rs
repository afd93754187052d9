//! A pass type in one expression, and pass types for linking.

use frame_graph::port::PassTypes;
use pass::{
    Interface, Library, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    ResourceDesc, SceneBindings, Setting, Settings, Step, Use, UseContext, Value, ValueType,
};
use std::sync::Arc;

/// Records the steps of a pass.
type Record = Box<dyn Fn(&RecordContext<'_>) -> Vec<Step> + Send + Sync>;

/// A pass type of a test. Ports of one resource are of the interface `Buffer` or `Texture`.
pub struct TestPass {
    kind: &'static str,
    ports: Ports,
    settings: Vec<Setting>,
    outputs: Vec<OutputDesc>,
    record: Record,
}

impl TestPass {
    /// Creates a pass type without ports and steps.
    pub fn new(kind: &'static str) -> TestPass {
        TestPass {
            kind,
            ports: Ports::default(),
            settings: Vec::new(),
            outputs: Vec::new(),
            record: Box::new(|_| Vec::new()),
        }
    }

    /// Adds an input.
    pub fn input(mut self, name: &str, interface: &str) -> TestPass {
        self.ports.inputs.push(pass::input(name, interface, ""));
        self
    }

    /// Adds an input that may be left unlinked.
    pub fn optional(mut self, name: &str, interface: &str) -> TestPass {
        self.ports.inputs.push(pass::optional(name, interface, ""));
        self
    }

    /// Adds an output, or scratch.
    pub fn output(self, desc: OutputDesc) -> TestPass {
        let interface = match desc.members.first() {
            Some((_, ResourceDesc::Texture(_), _)) => "Texture",
            _ => "Buffer",
        };
        self.output_of(interface, desc)
    }

    /// Adds an output of an interface, or scratch.
    pub fn output_of(mut self, interface: &str, desc: OutputDesc) -> TestPass {
        if !desc.scratch {
            self.ports.outputs.push(pass::output(&desc.port, interface, ""));
        }
        self.outputs.push(desc);
        self
    }

    /// Adds a setting that is a number of at most `max`.
    pub fn number(mut self, name: &str, default: u32, max: u32) -> TestPass {
        self.settings.push(Setting {
            name: name.into(),
            ty: ValueType::U32,
            default: Value::U32(default),
            min: None,
            max: Some(f64::from(max)),
            one_of: Vec::new(),
            unit: String::new(),
            doc: String::new(),
            declared: String::new(),
        });
        self
    }

    /// Sets the scene bindings that the pass reads.
    pub fn reads(mut self, scene_bindings: SceneBindings) -> TestPass {
        self.ports.scene_bindings = scene_bindings;
        self
    }

    /// Sets the steps.
    pub fn steps(
        mut self,
        record: impl Fn(&RecordContext<'_>) -> Vec<Step> + Send + Sync + 'static,
    ) -> TestPass {
        self.record = Box::new(record);
        self
    }
}

impl Pass for TestPass {
    fn kind(&self) -> &'static str {
        self.kind
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(self.settings.clone())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(self.ports.clone())
    }

    fn outputs(&self, _: &UseContext<'_>, _: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        Ok(self.outputs.clone())
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        Ok(Recording { steps: (self.record)(cx) })
    }
}

/// The pass types of a pipeline, for linking.
pub struct TestPassTypes<'a> {
    /// The pass types.
    pub passes: Vec<&'a dyn Pass>,
    /// All WGSL.
    pub shaders: &'a Library,
    /// All interfaces.
    pub interfaces: &'a [Interface],
}

impl<'a> TestPassTypes<'a> {
    /// Returns the pass type of that name.
    ///
    /// # Errors
    /// Where there is none.
    pub fn find(&self, kind: &str) -> Result<&'a dyn Pass, PassTypeError> {
        let found = self.passes.iter().copied().find(|pass| pass.kind() == kind);
        found.ok_or_else(|| PassTypeError::new(format!("there is no pass type `{kind}`")))
    }

    fn context<'b>(&'b self, use_: Use<'b>) -> UseContext<'b> {
        UseContext { use_, shaders: self.shaders, interfaces: self.interfaces }
    }
}

impl PassTypes for TestPassTypes<'_> {
    fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = self.passes.iter().map(|pass| pass.kind().to_owned()).collect();
        names.sort();
        names
    }

    fn interfaces(&self) -> &[Interface] {
        self.interfaces
    }

    fn takes_shader(&self, kind: &str) -> Option<bool> {
        self.find(kind).ok().map(Pass::takes_shader)
    }

    fn settings(&self, use_: Use<'_>) -> Result<Arc<[Setting]>, PassTypeError> {
        Ok(self.find(use_.kind)?.settings(&self.context(use_))?.into())
    }

    fn ports(&self, use_: Use<'_>, settings: &Settings) -> Result<Arc<Ports>, PassTypeError> {
        self.find(use_.kind)?.ports(&self.context(use_), settings).map(Arc::new)
    }

    fn outputs(&self, context: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let mut outputs = self.find(context.use_.kind)?.outputs(&self.context(context.use_), context)?;
        pass::scene_bindings::find_of_modules(&mut outputs, self.shaders);
        Ok(outputs)
    }
}
