//! The steps of a pass: dispatches and draws as plain data.

use crate::UseContext;
use crate::reflected::{Known, MainShader};
use frame_graph::{
    Fact, FactValue, Facts, Interface, Module, Name, PassTypeError, ResourceDesc, Settings, TextureDesc,
    Traits, Use, Value,
};
use shader_library::{Define, Library, Request};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

/// The context in which a pass records its steps: everything but the contents of resources.
#[derive(Clone, Copy)]
pub struct RecordContext<'a> {
    /// Name of the pass in the flattened pipeline.
    pub name: &'a str,
    /// The use.
    pub use_: Use<'a>,
    /// Settings, complete.
    pub settings: &'a Settings,
    /// The connected inputs.
    pub inputs: &'a [PortDesc],
    /// Outputs and scratch.
    pub outputs: &'a [PortDesc],
    /// Size of the frame in pixels.
    pub frame: (u32, u32),
    /// The traits of the scene: what it contains.
    pub traits: &'a Traits,
    /// All WGSL.
    pub shaders: &'a Library,
    /// All interfaces.
    pub interfaces: &'a [Interface],
    /// The main shader of the use; `None` where there is none.
    pub main: Option<&'a MainShader>,
}

/// A port with the descriptions of its resources.
#[derive(Clone, Debug)]
pub struct PortDesc {
    /// The port.
    pub name: Name,
    /// Interface of what is linked; empty for scratch.
    pub interface: Name,
    /// Member name and description.
    pub members: Vec<(Name, ResourceDesc)>,
    /// Facts of the producer's port.
    pub facts: Arc<Facts>,
    /// For an output: whether anything reads it.
    pub connected: bool,
    /// For an input: whether it reads a history buffer.
    pub past: bool,
}

/// Returns how many texels of a row of a texture lie in a pixel of the frame: 1, or more in a supersampled view.
pub(crate) fn supersampling(texture: &TextureDesc<(u32, u32)>, frame: (u32, u32)) -> u32 {
    (texture.size.0 / frame.0.max(1)).max(1)
}

impl<'a> RecordContext<'a> {
    /// Returns a port by name: inputs, outputs and scratch have distinct names.
    pub fn port(&self, name: &str) -> Option<&'a PortDesc> {
        self.inputs.iter().chain(self.outputs).find(|port| port.name == name)
    }

    /// Returns whether an input is linked, or an output is read.
    pub fn connected(&self, name: &str) -> bool {
        self.port(name).is_some_and(|port| port.connected)
    }

    /// Returns the size of the first texture of a port, in texels; `(1, 1)` where it has none.
    pub fn size(&self, port: &str) -> (u32, u32) {
        self.texture(port).map_or((1, 1), |texture| texture.size)
    }

    /// Returns the layers of the first texture of a port; 1 where it has none.
    pub fn layers(&self, port: &str) -> u32 {
        self.texture(port).map_or(1, |texture| texture.layers)
    }

    /// Returns whether a port has a member; the producer decides which optional members it has.
    pub fn has_member(&self, port: &str, member: &str) -> bool {
        self.port(port).is_some_and(|port| port.members.iter().any(|(name, _)| name == member))
    }

    fn texture(&self, port: &str) -> Option<&'a TextureDesc<(u32, u32)>> {
        self.port(port)?.members.iter().find_map(|(_, desc)| desc.texture())
    }

    /// Returns a fact of a port.
    ///
    /// # Errors
    /// Where the port is not connected, or its producer gives no such fact.
    pub fn fact<T: FactValue>(&self, port: &str, fact: Fact<T>) -> Result<T, PassTypeError> {
        let found = self.port(port).and_then(|port| fact.of(&port.facts));
        found.ok_or_else(|| PassTypeError::no_fact(port, fact.name))
    }

    /// Returns the use and what it may depend on.
    pub fn use_context(&self) -> UseContext<'a> {
        UseContext { use_: self.use_, shaders: self.shaders, interfaces: self.interfaces }
    }

    /// Returns a count of the scene: `light_layers`, `triangles`. 0 where there is none.
    pub fn trait_u32(&self, name: &str) -> u32 {
        self.traits.values.get(name).and_then(Value::as_u32).unwrap_or(0)
    }

    /// Returns whether the scene has a property: `textured`, `glossy`. False where it is unknown.
    pub fn trait_bool(&self, name: &str) -> bool {
        self.traits.values.get(name).and_then(Value::as_bool).unwrap_or(false)
    }

    /// Returns the request for a shader with these defines, and with the modules of the connected inputs: the module of
    /// an input is what `#import interface "PORT"` imports, and its options have the values that its producer gave
    /// them.
    pub fn shader(&self, path: &str, defines: &[(&str, Define)]) -> Request {
        self.with_modules(request(path, defines))
    }

    /// Returns the request for a file of the pass's folder, with its options as their names decide (see
    /// [`reflected`](crate::reflected)) and the modules of the connected inputs. [`Request::define`] gives values to
    /// options that are internal to the pass.
    pub fn file(&self, name: &str) -> Request {
        let folder = self.main.and_then(|main| main.folder.as_deref()).unwrap_or_default();
        self.variant(request(&format!("{folder}/{name}"), &[]))
    }

    /// The request with the modules of the connected inputs, and with the options of the shader and of these modules.
    pub(crate) fn variant(&self, request: Request) -> Request {
        let request = self.with_modules(request);
        let declared =
            self.main.and_then(|main| self.shaders.outline(&main.request).ok()).unwrap_or_default();
        self.with_known(|known| known.select(self.shaders, request, &declared))
    }

    /// Calls `f` with what decides the options of the pass's shaders.
    pub(crate) fn with_known<T>(&self, f: impl FnOnce(&Known<'_>) -> T) -> T {
        let input = |name: &str| self.inputs.iter().find(|input| input.name == name);
        f(&Known {
            settings: self.settings,
            traits: Some(self.traits),
            linked: &|port| input(port).is_some_and(|input| input.connected),
            read: &|port| self.connected(port),
            member: &|port, member| Some(input(port)?.members.iter().any(|(name, _)| name == member)),
            of_module: &|option| {
                let value = |input: &PortDesc| input.facts.module()?.options.get(option).cloned();
                Define::try_from(&self.inputs.iter().rev().find_map(value)?).ok()
            },
        })
    }

    /// The request with the modules of the connected inputs, and values for the modules' options.
    pub(crate) fn with_modules(&self, mut request: Request) -> Request {
        let mut offered = Vec::new();
        for input in self.inputs {
            let Some(module) = input.facts.module() else { continue };
            request.modules.insert(input.name.to_string(), module.path.clone());
            offered.extend(options(module).filter(|(name, _)| !request.defines.contains_key(*name)));
        }
        if !offered.is_empty() {
            // Not every shader of a pass imports the module. Errors come when the shader itself is loaded.
            let declared = self.shaders.outline(&request).unwrap_or_default();
            for (name, value) in offered {
                if declared.options.iter().any(|option| option.name == *name) {
                    request.defines.insert(name.to_owned(), value);
                }
            }
        }
        request
    }
}

/// The values of a module's options.
fn options(module: &Module) -> impl Iterator<Item = (&str, Define)> {
    module.options.iter().filter_map(|(name, value)| Some((name.as_str(), Define::try_from(value).ok()?)))
}

/// Returns the request for a module by itself, without a consumer.
pub fn request_of_module(module: &Module) -> Request {
    request(&module.path, &options(module).collect::<Vec<_>>())
}

/// Returns a request for a shader without modules.
pub fn request(path: &str, defines: &[(&str, Define)]) -> Request {
    Request {
        path: path.to_owned(),
        defines: defines.iter().map(|(name, define)| ((*name).to_owned(), define.clone())).collect(),
        modules: BTreeMap::new(),
    }
}

/// The steps of a pass, in order.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// The steps.
    pub steps: Vec<Step>,
}

/// The alignment of the first byte of a window of a buffer, on every adapter: WebGPU's default of
/// `minStorageBufferOffsetAlignment`.
pub const WINDOW_ALIGNMENT: u64 = 256;

/// The bytes of a buffer that every adapter can bind: WebGPU's default of `maxStorageBufferBindingSize`.
pub const LARGEST_WINDOW: u64 = 128 << 20;

/// A dispatch or a draw.
///
/// The uniform `settings` of its shader is filled member by member, from the first of these that has the
/// name: `values` of the step; the settings of the pass; `seed` (u32, a hash of the run's seed and the pass's
/// name, and of the sample that the frame is); `sample` (u32, the number of that sample, 0 where a picture is no mean over frames), where
/// `seed` is the same in all samples; `PORT_size` (`vec2<u32>`, texels of the port's first texture), `PORT_layers`,
/// `PORT_supersampling` (texels of a row of it in a pixel of the frame, at least 1), `PORT_FACT` for each
/// fact, which is 0 where it is optional and left out; and for an input that is a history buffer `PORT_age` (frames, 0 where there is no history) and `PORT_reset`.
/// A member that is a struct is filled member by member, with values named `MEMBER.NAME`.
///
/// A uniform `PORT_facts`, which a module declares, is filled from the input of that name alone: its facts, `size`,
/// `layers` and `supersampling` of its first texture, `age` and `reset` where it is a history buffer, and the pass's `seed`. Members of a
/// struct within it are named as its own.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// A dispatch.
    Compute(Compute),
    /// A draw.
    Raster(Raster),
}

/// One dispatch.
#[derive(Clone, Debug, PartialEq)]
pub struct Compute {
    /// The shader.
    pub shader: Request,
    /// The entry point.
    pub entry: String,
    /// The number of threads.
    pub threads: Threads,
    /// Values for members of `settings`, before those of the pass.
    pub values: Vec<(String, Value)>,
    /// Globals that are not bound by their own name: `(global, port or port.member)`.
    pub bind: Vec<(String, String)>,
    /// Globals that see a part of their buffer: `(global, bytes)`. The first byte is a multiple of
    /// [`WINDOW_ALIGNMENT`].
    pub windows: Vec<(String, Range<u64>)>,
}

/// The number of threads of a dispatch. Workgroups are counted from the entry point's size.
#[derive(Clone, Debug, PartialEq)]
pub enum Threads {
    /// At least this many in each dimension.
    Grid([u32; 3]),
    /// At least this many in a row, folded into two dimensions where one cannot hold the workgroups: the
    /// shader finds its index with `index_in` of shaders/dispatch.wgsl.
    Row(u32),
    /// Reads the number of workgroups from a buffer on the GPU: three u32, one for each dimension. The buffer is one
    /// that an earlier step of the pass has written, or an input, which may be a history buffer. A number of 0
    /// dispatches nothing, as does one above the adapter's `max_compute_workgroups_per_dimension`: the shader that
    /// writes it has to respect that limit, which is at least 65,535.
    Indirect {
        /// `port` or `port.member`.
        buffer: String,
        /// Offset of the first number in bytes, a multiple of 4.
        offset: u64,
    },
}

/// One draw.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    /// The shader with both entry points.
    pub shader: Request,
    /// Vertex entry point.
    pub vertex: String,
    /// Fragment entry point; `None` writes depth alone.
    pub fragment: Option<String>,
    /// Color targets, in the order of `@location`.
    pub targets: Vec<Target>,
    /// Depth target.
    pub depth: Option<DepthTarget>,
    /// The geometry.
    pub draw: Draw,
    /// Values for members of `settings`, before those of the pass.
    pub values: Vec<(String, Value)>,
    /// Globals that are not bound by their own name: `(global, port or port.member)`.
    pub bind: Vec<(String, String)>,
    /// Globals that see a part of their buffer: `(global, bytes)`. The first byte is a multiple of
    /// [`WINDOW_ALIGNMENT`].
    pub windows: Vec<(String, Range<u64>)>,
}

/// A color target.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// `port` or `port.member` of an output or of scratch.
    pub resource: String,
    /// Layer of an array.
    pub layer: u32,
    /// The content of the target when the draw begins.
    pub load: Load,
}

/// The content of a target when a draw begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Load {
    /// This value in every texel.
    Clear([f64; 4]),
    /// The content that an earlier step of the same pass left.
    Keep,
}

/// A depth target, tested with *greater or equal*: z is reversed, so that what is nearer is greater.
#[derive(Clone, Debug, PartialEq)]
pub struct DepthTarget {
    /// `port` or `port.member` of an output or of scratch.
    pub resource: String,
    /// Layer of an array.
    pub layer: u32,
    /// Value to clear to.
    pub clear: f32,
}

/// The geometry of a draw. Nothing is culled by winding: scenes are two-sided.
#[derive(Clone, Debug, PartialEq)]
pub enum Draw {
    /// Three vertices: see shaders/fullscreen.wgsl.
    Fullscreen,
    /// All triangles of the scene, with the vertex attributes `@location(0) position: vec3<f32>`,
    /// `(1) normal: vec3<f32>`, `(2) uv: vec2<f32>`, `(3) material: u32`, `(4) instance: u32`.
    Scene,
    /// Draws triangles without attributes: this many vertices and instances.
    Vertices {
        /// Vertices.
        vertices: u32,
        /// Instances.
        instances: u32,
    },
    /// Draws triangles without attributes, as many as a buffer on the GPU says: four u32, which are the number of
    /// vertices, the number of instances, the first vertex and the first instance. The buffer is one that an earlier
    /// step of the pass has written, or an input, which may be a history buffer.
    Indirect {
        /// `port` or `port.member`.
        buffer: String,
        /// Offset of the first number in bytes, a multiple of 4.
        offset: u64,
    },
}

impl Step {
    /// Returns its entry point: of a draw, that of the fragments where it has one.
    pub(crate) fn entry(&self) -> &str {
        match self {
            Step::Compute(compute) => &compute.entry,
            Step::Raster(raster) => raster.fragment.as_ref().unwrap_or(&raster.vertex),
        }
    }

    /// Returns the buffer that holds the size of an indirect dispatch or draw: its name, the offset in bytes, and the
    /// bytes that are read from there.
    pub(crate) fn indirect(&self) -> Option<(&str, u64, u64)> {
        match self {
            Step::Compute(Compute { threads: Threads::Indirect { buffer, offset }, .. }) => {
                Some((buffer, *offset, 12))
            }
            Step::Raster(Raster { draw: Draw::Indirect { buffer, offset }, .. }) => {
                Some((buffer, *offset, 16))
            }
            _ => None,
        }
    }
}

impl Target {
    /// Returns the whole of a port's texture, cleared to zero first.
    pub fn clear(resource: &str) -> Target {
        Target { resource: resource.into(), layer: 0, load: Load::Clear([0.0; 4]) }
    }
}

impl Raster {
    /// Creates a draw without depth whose globals are bound by name.
    pub fn new(shader: Request, vertex: &str, fragment: &str, targets: Vec<Target>, draw: Draw) -> Raster {
        Raster {
            shader,
            vertex: vertex.into(),
            fragment: Some(fragment.into()),
            targets,
            depth: None,
            draw,
            values: Vec::new(),
            bind: Vec::new(),
            windows: Vec::new(),
        }
    }

    /// Tests depth against a resource of one layer, which is cleared to the farthest depth.
    pub fn depth(mut self, resource: &str) -> Raster {
        self.depth = Some(DepthTarget { resource: resource.into(), layer: 0, clear: 0.0 });
        self
    }

    /// Adds a value for a member of `settings`.
    pub fn value(mut self, name: &str, value: impl Into<Value>) -> Raster {
        self.values.push((name.into(), value.into()));
        self
    }
}

impl Compute {
    /// Creates a dispatch whose globals are bound by name.
    pub fn new(shader: Request, entry: &str, threads: Threads) -> Compute {
        Compute {
            shader,
            entry: entry.into(),
            threads,
            values: Vec::new(),
            bind: Vec::new(),
            windows: Vec::new(),
        }
    }

    /// Creates a dispatch of one thread for each texel of a size.
    pub fn per_texel(shader: Request, entry: &str, size: (u32, u32)) -> Compute {
        Compute::new(shader, entry, Threads::Grid([size.0, size.1, 1]))
    }

    /// Adds a value for a member of `settings`.
    pub fn value(mut self, name: &str, value: impl Into<Value>) -> Compute {
        self.values.push((name.into(), value.into()));
        self
    }

    /// Binds a global to a resource of another name.
    pub fn bind(mut self, global: &str, resource: &str) -> Compute {
        self.bind.push((global.into(), resource.into()));
        self
    }

    /// Lets a global see these bytes of its buffer alone: a shader can bind less than a buffer may hold.
    pub fn window(mut self, global: &str, bytes: Range<u64>) -> Compute {
        self.windows.push((global.into(), bytes));
        self
    }
}

impl Recording {
    /// Creates a recording of one dispatch.
    pub fn one(step: Compute) -> Recording {
        Recording { steps: vec![Step::Compute(step)] }
    }

    /// Creates a recording of dispatches in order.
    pub fn of(steps: impl IntoIterator<Item = Compute>) -> Recording {
        Recording { steps: steps.into_iter().map(Step::Compute).collect() }
    }

    /// Returns the same with each dispatch replaced.
    pub fn map(mut self, f: impl Fn(Compute) -> Compute) -> Recording {
        for step in &mut self.steps {
            if let Step::Compute(compute) = step {
                *compute = f(compute.clone());
            }
        }
        self
    }

    /// Adds dispatches.
    pub fn then_all(mut self, steps: impl IntoIterator<Item = Compute>) -> Recording {
        self.steps.extend(steps.into_iter().map(Step::Compute));
        self
    }

    /// Adds one more dispatch.
    pub fn then(mut self, step: Compute) -> Recording {
        self.steps.push(Step::Compute(step));
        self
    }
}
