//! What a pass type declares to the graph: interfaces, ports, and the trait through which the graph queries them.

use crate::interface::{Fact, FactValue, Interface};
use crate::resource::{Clear, Extent, ResourceDesc};
use data_file::{Setting, Settings, Traits, Value};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Metadata of a port that is known before anything runs: values such as the count of virtual lights or the side of a
/// tile, and perhaps a module. A consumer may compute its sizes from them and select shader variants.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facts {
    values: BTreeMap<String, Value>,
    module: Option<Module>,
}

impl Facts {
    /// Returns the value of that name.
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.values.get(name)
    }

    /// Adds a value, or replaces it.
    pub fn insert(&mut self, name: impl Into<String>, value: Value) {
        self.values.insert(name.into(), value);
    }

    /// Returns the values with their names, in the order of the names.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (&str, &Value)> {
        self.values.iter().map(|(name, value)| (name.as_str(), value))
    }

    /// Returns the module of the port, if it has one.
    pub fn module(&self) -> Option<&Module> {
        self.module.as_ref()
    }

    /// Returns the module, mutably.
    pub fn module_mut(&mut self) -> Option<&mut Module> {
        self.module.as_mut()
    }

    /// Sets or replaces the module of the port.
    pub fn set_module(&mut self, module: Module) {
        self.module = Some(module);
    }

    /// Returns whether there is neither a value nor a module.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty() && self.module.is_none()
    }
}

impl<N: Into<String>> FromIterator<(N, Value)> for Facts {
    fn from_iter<I: IntoIterator<Item = (N, Value)>>(values: I) -> Facts {
        let values = values.into_iter().map(|(name, value)| (name.into(), value)).collect();
        Facts { values, module: None }
    }
}

/// A module: a WGSL file with the functions of an output, which the shaders of its readers import.
///
/// A function that each producer implements differently is passed along in this way: a consumer with a port
/// `visibility` writes `#import interface "visibility"` and calls the functions that the interface specifies. The file
/// declares all that it needs: the resources of the port, scene bindings, and a uniform `<port>_facts` that is filled
/// with the facts of the port.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Module {
    /// The path of the file: `shaders/visibility-atlas.wgsl`.
    pub path: String,
    /// Values of the options that the file declares.
    pub options: BTreeMap<String, Value>,
    /// Facts that its functions alone read, from the uniform `<port>_facts`, beside those that the interface declares.
    pub facts: BTreeMap<String, Value>,
    /// The scene bindings that its functions read. They are found by reflection of the file; a pass that reads the port
    /// then depends on them too.
    pub scene_bindings: SceneBindings,
}

impl Module {
    /// Returns the module in that file, with its options at their defaults.
    pub fn new(path: impl Into<String>) -> Module {
        Module { path: path.into(), ..Module::default() }
    }

    /// Returns the same module with the value of an option.
    pub fn option(mut self, name: impl Into<String>, value: Value) -> Module {
        self.options.insert(name.into(), value);
        self
    }

    /// Returns the same module with the value of a fact that its functions read.
    pub fn fact(mut self, name: impl Into<String>, value: impl Into<Value>) -> Module {
        self.facts.insert(name.into(), value.into());
        self
    }
}

/// An input of a pass.
#[derive(Clone, Debug, PartialEq)]
pub struct InputPort {
    /// The name, as in RON.
    pub name: String,
    /// Name of an [`Interface`], or `"Texture"` or `"Buffer"`, which accept any single resource of that sort. `"Any"`
    /// accepts every link (for pass types that read their ports from a shader).
    pub interface: String,
    /// Whether it may be left unconnected.
    pub optional: bool,
    /// What the pass uses it for.
    pub doc: String,
}

/// An output of a pass.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputPort {
    /// The name, as in RON.
    pub name: String,
    /// Name of an [`Interface`], or `"Texture"` or `"Buffer"`.
    pub interface: String,
    /// What it holds.
    pub doc: String,
}

/// The scene bindings that a pass reads, as bits: inputs of every pipeline that need no link. A pass runs again when
/// one that it reads has changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct SceneBindings(pub u8);

impl SceneBindings {
    /// Nothing.
    pub const NONE: SceneBindings = SceneBindings(0);
    /// Geometry, materials and textures.
    pub const SCENE: SceneBindings = SceneBindings(1);
    /// The camera.
    pub const CAMERA: SceneBindings = SceneBindings(2);
    /// The lights of the scene.
    pub const LIGHTS: SceneBindings = SceneBindings(4);
    /// The number of the frame and its time: a pass that reads it runs in every frame.
    pub const FRAME: SceneBindings = SceneBindings(8);
    /// The sample that a frame is: the seed of random numbers, and the place within each pixel. A plan with a pass that
    /// reads it has another sample in every frame.
    pub const SAMPLE: SceneBindings = SceneBindings(16);
    /// Where moving geometry was in the frame before.
    pub const PREVIOUS: SceneBindings = SceneBindings(32);
    /// The seed of random numbers. It changes where the plan has another sample in every frame.
    pub const SEED: SceneBindings = SceneBindings(64);

    /// Returns the union of both.
    pub const fn and(self, other: SceneBindings) -> SceneBindings {
        SceneBindings(self.0 | other.0)
    }

    /// Returns whether `other` is a subset.
    pub const fn contains(self, other: SceneBindings) -> bool {
        self.0 & other.0 == other.0
    }
}

/// The ports of one use of a pass: known from its settings alone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ports {
    /// Inputs, in the order of the documentation.
    pub inputs: Vec<InputPort>,
    /// Outputs, in the order of the documentation.
    pub outputs: Vec<OutputPort>,
    /// The scene bindings that the pass reads.
    pub scene_bindings: SceneBindings,
}

/// One use of a pass type, as written in the file: all that its ports may depend on.
#[derive(Clone, Copy, Debug)]
pub struct Use<'a> {
    /// The pass type's name.
    pub kind: &'a str,
    /// The WGSL file that the use names with `shader:`, for pass types that take one.
    pub shader: Option<&'a str>,
    /// Names of the inputs that the use links, in order.
    pub inputs: &'a [String],
    /// The `out:` declarations of the use, by port.
    pub outputs: &'a BTreeMap<String, OutputOverride>,
}

/// An `out:` declaration: interface, format, size or facts of an output of a pass type that takes its ports from a
/// shader.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OutputOverride {
    /// The interface of the output.
    pub interface: Option<String>,
    /// The format of the texture.
    pub format: Option<crate::resource::Format>,
    /// The size of the texture.
    pub size: Option<Extent>,
    /// Number of elements, for a buffer.
    pub count: Option<u32>,
    /// Facts of the output, by name; `None` for one that it is not to have.
    pub facts: BTreeMap<String, Option<Value>>,
}

/// What is known about a linked input when the sizes of the outputs are computed.
#[derive(Clone, Debug)]
pub struct InputDesc {
    /// The port.
    pub name: String,
    /// The interface of what is linked to it.
    pub interface: String,
    /// Its resources: member name, and description with known size. A member that the producer left out is absent.
    pub members: Vec<(String, ResourceDesc)>,
    /// Facts of the producer's port.
    pub facts: Arc<Facts>,
}

impl InputDesc {
    /// Returns the resource of that member; `""` for the only one.
    pub fn member(&self, name: &str) -> Option<&ResourceDesc> {
        self.members.iter().find(|(n, _)| n == name).map(|(_, desc)| desc)
    }

    /// Returns the size of the first texture, in texels.
    pub fn size(&self) -> Option<(u32, u32)> {
        self.members.iter().find_map(|(_, desc)| desc.texture().map(|t| t.size))
    }
}

/// Everything that the resources of a pass's outputs may depend on.
#[derive(Clone, Copy, Debug)]
pub struct OutputContext<'a> {
    /// The use.
    pub use_: Use<'a>,
    /// Settings, complete.
    pub settings: &'a Settings,
    /// The connected inputs.
    pub inputs: &'a [InputDesc],
    /// Size of the frame in pixels.
    pub frame: (u32, u32),
    /// The traits of the scene: what it contains.
    pub traits: &'a Traits,
}

impl<'a> OutputContext<'a> {
    /// Returns the input of that name, where it is connected.
    pub fn input(&self, name: &str) -> Option<&'a InputDesc> {
        self.inputs.iter().find(|input| input.name == name)
    }

    /// Returns a fact of a connected input.
    ///
    /// # Errors
    /// Where the input is not connected, or its producer gives no such fact.
    pub fn fact<T: FactValue>(&self, input: &str, fact: Fact<T>) -> Result<T, PassTypeError> {
        let found = self.input(input).and_then(|input| fact.of(&input.facts));
        found.ok_or_else(|| PassTypeError::no_fact(input, fact.name))
    }
}

/// How a pass treats the previous content of a resource that it writes.
#[derive(Clone, Debug, PartialEq)]
pub enum Usage {
    /// The pass writes every bit of it before anything is read.
    Overwrites,
    /// It must be cleared before the pass runs.
    ClearFirst(Clear),
    /// It begins with the content of this member of an input, which must be of the same format and size: the pass
    /// writes only what differs. Where the input is the history buffer of the output itself and nothing else reads that history
    /// buffer, both are one object and nothing is copied; otherwise the content is copied before the pass runs. The
    /// version is new in both cases. The pass must not bind that member of the input: it finds its content in the
    /// output.
    Continue {
        /// The input port, which must be linked.
        input: String,
        /// Name of the member; `""` for the only one.
        member: String,
    },
}

/// The resources of one output port, or one resource that the pass needs only while it runs.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputDesc {
    /// The output port; for scratch, a name of its own.
    pub port: String,
    /// Whether it is scratch, which no other pass reads.
    pub scratch: bool,
    /// Its resources by member name (`""` for the only one), and whether they need clearing.
    pub members: Vec<(String, ResourceDesc<Extent>, Usage)>,
    /// Further members, which are resources of an input: see [`OutputDesc::hand_on`].
    pub handed: Vec<HandedOn>,
    /// Its facts.
    pub facts: Facts,
}

/// Members of an output that are resources of an input of the same pass, handed on without a copy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum HandedOn {
    /// Every member of the input that the interface of the output has.
    All {
        /// The input port.
        input: String,
    },
    /// One member.
    Member {
        /// Name of the member of the output.
        member: String,
        /// The input port.
        input: String,
        /// Name of the member of the input; `""` for the only one.
        from: String,
    },
}

impl OutputDesc {
    /// Describes a port with one resource, fully written by the pass.
    pub fn one(port: &str, desc: ResourceDesc<Extent>) -> OutputDesc {
        OutputDesc::of(port, vec![(String::new(), desc, Usage::Overwrites)])
    }

    /// Creates a port with these members: name, description, and how the pass treats what was in the resource.
    pub fn of(port: &str, members: Vec<(String, ResourceDesc<Extent>, Usage)>) -> OutputDesc {
        OutputDesc {
            port: port.to_owned(),
            scratch: false,
            members,
            handed: Vec::new(),
            facts: Facts::default(),
        }
    }

    /// Creates a port that hands on every member of an input that the interface of the port has: a reader of
    /// `port` reads the same resources as a reader of what is linked to `input`, with the facts of `port`. The
    /// pass writes nothing for it, and nothing is copied. Members may be added with [`OutputDesc::handed`] or
    /// to [`OutputDesc::members`]. The input must not be a `prev` link.
    pub fn hand_on(port: &str, input: &str) -> OutputDesc {
        let all = HandedOn::All { input: input.to_owned() };
        OutputDesc { handed: vec![all], ..OutputDesc::of(port, Vec::new()) }
    }

    /// Adds a member that is the member `from` of an input (`""` for its only one), handed on as by
    /// [`OutputDesc::hand_on`].
    pub fn handed(mut self, member: &str, input: &str, from: &str) -> OutputDesc {
        self.handed.push(HandedOn::Member { member: member.into(), input: input.into(), from: from.into() });
        self
    }

    /// Describes a scratch resource, which the pass needs only while it runs.
    pub fn scratch(name: &str, desc: ResourceDesc<Extent>) -> OutputDesc {
        OutputDesc { scratch: true, ..OutputDesc::one(name, desc) }
    }

    /// Describes a scratch buffer of this many `u32` or `f32`; at least one.
    pub fn scratch_u32(name: &str, count: u32) -> OutputDesc {
        OutputDesc::scratch(name, ResourceDesc::buffer(4 * u64::from(count.max(1))))
    }

    /// Makes every member begin with the content of the member of the same name of an input: see [`Usage::Continue`].
    pub fn continuing(mut self, input: &str) -> OutputDesc {
        for (member, _, usage) in &mut self.members {
            *usage = Usage::Continue { input: input.to_owned(), member: member.clone() };
        }
        self
    }

    /// Has every member cleared to zero before the pass runs.
    pub fn cleared(mut self) -> OutputDesc {
        for (_, _, usage) in &mut self.members {
            *usage = Usage::ClearFirst(Clear::Zero);
        }
        self
    }

    /// Adds a fact.
    pub fn fact<T: FactValue>(mut self, fact: Fact<T>, value: T) -> OutputDesc {
        self.facts.insert(fact.name, value.into());
        self
    }

    /// Sets the module that the shaders of its readers import.
    pub fn module(mut self, module: Module) -> OutputDesc {
        self.facts.set_module(module);
        self
    }
}

/// An error of a pass type about one of its uses.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PassTypeError {
    /// What is wrong, and what was expected.
    pub message: String,
    /// The setting at fault, for the place in the file.
    pub setting: Option<Box<str>>,
    /// The input at fault, for the place in the file.
    pub input: Option<String>,
    /// The output whose `out:` declaration is at fault, for the place in the file.
    pub output: Option<Box<str>>,
    /// Whether the shader that the use names is at fault, for the place in the file.
    pub shader: bool,
    /// What to do about it.
    pub help: Option<String>,
    /// The fact that is too great, and up to which value it is taken.
    pub limit: Option<Box<Limit>>,
}

/// The most that a pass type takes of something that a fact of an input counts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limit {
    /// The input.
    pub input: String,
    /// The fact's name.
    pub fact: &'static str,
    /// The greatest value with which this pass type does not refuse the use.
    pub most: u32,
    /// What is counted, as a user calls it: `virtual lights`. Limits of several passes on the same things have the same
    /// text.
    pub what: &'static str,
}

impl PassTypeError {
    /// Creates an error of the use as a whole.
    pub fn new(message: impl Into<String>) -> PassTypeError {
        PassTypeError { message: message.into(), ..PassTypeError::default() }
    }

    /// Creates the error that the output linked to an input has no fact of that name.
    pub fn no_fact(input: &str, fact: &str) -> PassTypeError {
        PassTypeError::input(input, format!("what is linked to `{input}` has no fact `{fact}`"))
    }

    /// Creates an error of one setting.
    pub fn setting(name: &str, message: impl Into<String>) -> PassTypeError {
        PassTypeError { message: message.into(), setting: Some(name.into()), ..PassTypeError::default() }
    }

    /// Creates an error of one input.
    pub fn input(name: &str, message: impl Into<String>) -> PassTypeError {
        PassTypeError { message: message.into(), input: Some(name.to_owned()), ..PassTypeError::default() }
    }

    /// Creates the error that the shader which the use names is not there.
    pub fn shader(message: impl Into<String>) -> PassTypeError {
        PassTypeError { message: message.into(), shader: true, ..PassTypeError::default() }
    }

    /// Creates an error of what the use says of one output.
    pub fn output(name: &str, message: impl Into<String>) -> PassTypeError {
        PassTypeError { message: message.into(), output: Some(name.into()), ..PassTypeError::default() }
    }

    /// Adds advice to the message.
    pub fn help(mut self, help: impl Into<String>) -> PassTypeError {
        self.help = Some(help.into());
        self
    }

    /// Says that the use is refused because a fact of an input is above `most`, which counts `what`: `virtual lights`.
    /// Linking asks the passes that follow as well, and advises the greatest value that all of them take.
    pub fn limit(mut self, input: &str, fact: Fact<u32>, most: u64, what: &'static str) -> PassTypeError {
        let most = u32::try_from(most).unwrap_or(u32::MAX);
        self.limit = Some(Box::new(Limit { input: input.to_owned(), fact: fact.name, most, what }));
        self
    }
}

/// All pass types: through this trait the graph uses passes without depending on any.
///
/// All functions are pure: the same arguments give the same result.
pub trait PassTypes {
    /// Returns the names of all pass types, sorted: for errors that suggest the nearest.
    fn names(&self) -> Vec<String>;

    /// Returns all interfaces.
    fn interfaces(&self) -> &[Interface];

    /// Returns whether a use of the pass type names a shader with `shader:`; `None` where there is no such pass type.
    fn takes_shader(&self, kind: &str) -> Option<bool>;

    /// Returns the settings of this use.
    fn settings(&self, use_: Use<'_>) -> Result<Arc<[Setting]>, PassTypeError>;

    /// Returns its ports.
    fn ports(&self, use_: Use<'_>, settings: &Settings) -> Result<Arc<Ports>, PassTypeError>;

    /// Describes the resources of its outputs, and scratch.
    fn outputs(&self, context: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError>;
}
