//! The plan of one pass with its inputs, and its run.

use crate::{IntoValue, Outputs, gpu, scene, shaders};
use executor::{Executor, ExecutorError, FrameOptions, Gpu};
use frame_graph::plan::{
    Allocation, AllocationId, Memory, PassId, Plan, PlanId, PlannedInput, PlannedPass, PlannedPort,
    PlannedResource, ResourceId,
};
use frame_graph::port::{InputDesc, OutputOverride};
use frame_graph::{
    Change, Clear, Extent, Externals, Facts, Name, OutputContext, ResourceDesc, Setting, Settings,
    TextureDesc, Traits, Usage, Use, Value,
};
use pass::{Library, LinkedStep, Pass, UseContext};
use scene::{Camera, Scene};
use scene_upload::{Frame, Host};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A pass with what it is given.
pub struct Stand<'a> {
    pass: &'a dyn Pass,
    shader: Option<&'a str>,
    overrides: BTreeMap<String, OutputOverride>,
    set: BTreeMap<String, Value>,
    frame: (u32, u32),
    inputs: Vec<Input>,
    scene: Option<Scene>,
    camera: Option<Camera>,
    time: f32,
    traits: BTreeMap<String, Value>,
    seed: u32,
    poison: bool,
}

struct Input {
    port: String,
    interface: String,
    facts: Arc<Facts>,
    members: Vec<(String, ResourceDesc, Vec<u8>)>,
}

impl<'a> Stand<'a> {
    /// With every setting at its default, a frame of 16×16 and the scene `empty`.
    pub fn new(pass: &'a dyn Pass) -> Stand<'a> {
        Stand {
            pass,
            shader: None,
            overrides: BTreeMap::new(),
            set: BTreeMap::new(),
            frame: (16, 16),
            inputs: Vec::new(),
            scene: None,
            camera: None,
            time: 0.0,
            traits: BTreeMap::new(),
            seed: 0,
            poison: true,
        }
    }

    /// A setting.
    pub fn set(mut self, name: &str, value: impl IntoValue) -> Self {
        self.set.insert(name.to_owned(), value.into_value());
        self
    }

    /// The WGSL file of a kind that takes one.
    pub fn shader(mut self, path: &'a str) -> Self {
        self.shader = Some(path);
        self
    }

    /// What the use says with `out:` of an output of a kind that takes a shader.
    pub fn out(mut self, port: &str, said: OutputOverride) -> Self {
        self.overrides.insert(port.to_owned(), said);
        self
    }

    /// Size of the frame in pixels.
    pub fn frame(mut self, width: u32, height: u32) -> Self {
        self.frame = (width, height);
        self
    }

    /// A scene by name or path.
    ///
    /// # Panics
    /// Where it cannot be loaded.
    pub fn scene(self, spec: &str) -> Self {
        self.with_scene(scene(spec))
    }

    /// A scene.
    pub fn with_scene(mut self, scene: Scene) -> Self {
        self.scene = Some(scene);
        self
    }

    /// A camera in place of the scene's.
    pub fn camera(mut self, camera: Camera) -> Self {
        self.camera = Some(camera);
        self
    }

    /// When the scene is seen \[s\], in place of 0.
    pub fn time(mut self, time: f32) -> Self {
        self.time = time;
        self
    }

    /// A trait of the scene, in place of the scene's own.
    pub fn scene_trait(mut self, name: &str, value: impl IntoValue) -> Self {
        self.traits.insert(name.to_owned(), value.into_value());
        self
    }

    /// The run's seed; 0 gives plain sequences.
    pub fn seed(mut self, seed: u32) -> Self {
        self.seed = seed;
        self
    }

    /// An input port: interface, facts, and each member's name, description and bytes (rows and layers without
    /// padding; fewer bytes leave the rest zero).
    pub fn input(
        mut self,
        port: &str,
        interface: &str,
        facts: &[(&str, u32)],
        members: Vec<(&str, ResourceDesc, Vec<u8>)>,
    ) -> Self {
        let facts = facts.iter().map(|(name, value)| ((*name).to_owned(), Value::U32(*value))).collect();
        let members = members.into_iter().map(|(name, desc, bytes)| (name.to_owned(), desc, bytes)).collect();
        self.inputs.push(Input {
            port: port.to_owned(),
            interface: interface.to_owned(),
            facts: Arc::new(facts),
            members,
        });
        self
    }

    /// Adds a fact that is a text to the input added last: `module`.
    pub fn text_fact(mut self, name: &str, text: &str) -> Self {
        if let Some(input) = self.inputs.last_mut() {
            Arc::make_mut(&mut input.facts).insert(name.to_owned(), Value::Text(text.to_owned()));
        }
        self
    }

    /// Runs the pass once. What it writes is filled with NaN before. `None` where there is no adapter.
    ///
    /// # Panics
    /// Where the pass, its shaders or the GPU refuse: the test fails with their words.
    pub fn run(self) -> Option<Outputs> {
        let gpu = gpu()?;
        Some(self.try_run(gpu).unwrap_or_else(|error| panic!("{error}")))
    }

    fn try_run(mut self, gpu: Gpu) -> Result<Outputs, ExecutorError> {
        let scene = self.scene.take().unwrap_or_else(|| scene("empty"));
        let mut traits = scene.traits();
        traits.0.append(&mut self.traits);
        let library = shaders();
        let plan = Arc::new(self.plan(&traits, &library));
        let steps = pass::link_steps(&plan, PassId(0), self.pass, &traits, &library)
            .map_err(ExecutorError::Shader)?;
        let mut executor = Executor::new(gpu);
        let mut host = Host::upload(&mut executor, &scene);
        host.provide(&mut executor, &scene, steps.iter().flat_map(LinkedStep::externals))?;
        executor.set_seed(self.seed);
        executor.load(Arc::clone(&plan), vec![steps])?;
        let members = self.inputs.iter().flat_map(|input| &input.members);
        for (id, (_, _, bytes)) in (0..).map(ResourceId).zip(members) {
            if !bytes.is_empty() {
                executor.write(id, bytes);
            }
        }
        let mut pose = scene.at(self.time);
        if let Some(camera) = self.camera {
            pose.camera = camera;
        }
        let frame = Frame { index: 0, time: self.time, step: 0.0, pad: 0.0 };
        let externals = host.update(&mut executor, &scene, &pose, self.frame, frame)?;
        let change = Change { externals, all: true, ..Change::default() };
        executor.frame(change, FrameOptions { timed: false, poison: self.poison })?;
        Ok(Outputs { executor, plan })
    }

    fn plan(&self, traits: &Traits, library: &Library) -> Plan {
        let kind = self.pass.info().kind;
        let names: Vec<String> = self.inputs.iter().map(|input| input.port.clone()).collect();
        let overrides = Arc::new(self.overrides.clone());
        let use_ = Use { kind, shader: self.shader, inputs: &names, outputs: &overrides };
        let cx = UseContext { use_, shaders: library };
        let refuse = |error: pass::KindError| -> ! { panic!("the pass refuses: {error:?}") };
        let schema: Vec<Setting> = self.pass.settings(&cx).unwrap_or_else(|error| refuse(error));
        let mut settings =
            Settings(schema.iter().map(|setting| (setting.name.clone(), setting.default.clone())).collect());
        for (name, value) in &self.set {
            assert!(settings.0.contains_key(name), "the pass has no setting `{name}`");
            settings.0.insert(name.clone(), value.clone());
        }
        let ports = self.pass.ports(&cx, &settings).unwrap_or_else(|error| refuse(error));
        let descs: Vec<InputDesc> = self.inputs.iter().map(input_desc).collect();
        let context = OutputContext { use_, settings: &settings, inputs: &descs, frame: self.frame, traits };
        let outputs = self.pass.outputs(&cx, &context).unwrap_or_else(|error| refuse(error));
        let mut resources: Vec<PlannedResource> = Vec::new();
        let mut clears: Vec<(ResourceId, Clear)> = Vec::new();
        let mut add = |name: String, desc: ResourceDesc, producer: Option<PassId>| {
            let id = ResourceId(resources.len() as u32);
            resources.push(PlannedResource {
                name: name.into(),
                desc,
                allocation: AllocationId(id.0),
                producer,
                readers: Vec::new(),
                lifetime: (0, 0),
                persistent: true,
                history: None,
                constant: None,
            });
            id
        };
        let planned_inputs = self
            .inputs
            .iter()
            .map(|input| PlannedInput {
                port: Name::from(&input.port),
                producer: None,
                producer_port: Name::EMPTY,
                interface: Name::from(&input.interface),
                members: input
                    .members
                    .iter()
                    .map(|(name, desc, _)| {
                        (Name::from(name), add(join(&input.port, name), desc.clone(), None))
                    })
                    .collect(),
                history: None,
                facts: Arc::clone(&input.facts),
            })
            .collect();
        let planned_outputs = outputs
            .iter()
            .map(|output| PlannedPort {
                port: Name::from(&output.port),
                interface: ports
                    .outputs
                    .iter()
                    .find(|port| port.name == output.port)
                    .map_or(Name::EMPTY, |port| Name::from(&port.interface)),
                members: output
                    .members
                    .iter()
                    .map(|(name, desc, usage)| {
                        let id =
                            add(join(&output.port, name), resolve(desc, self.frame, &descs), Some(PassId(0)));
                        if let Usage::ClearFirst(clear) = usage {
                            clears.push((id, *clear));
                        }
                        (Name::from(name), id)
                    })
                    .collect(),
                handed: Vec::new(),
                connected: !output.scratch,
                facts: Arc::new(output.facts.clone()),
            })
            .collect();
        let pass = PlannedPass {
            name: Name::from(kind),
            kind: Name::from(kind),
            shader: self.shader.map(Name::from),
            settings: Arc::new(settings),
            overrides,
            inputs: planned_inputs,
            outputs: planned_outputs,
            externals: ports.externals,
            depends_on: Externals(u8::MAX),
            remembers: false,
            clears,
            continues: Vec::new(),
        };
        let allocations = (0..)
            .map(ResourceId)
            .zip(&resources)
            .map(|(id, resource)| Allocation { desc: resource.desc.clone(), resources: vec![id] })
            .collect();
        Plan {
            id: PlanId(0),
            frame: self.frame,
            passes: vec![pass],
            resources,
            allocations,
            histories: Vec::new(),
            outputs: Vec::new(),
            fates: Vec::new(),
            memory: Memory::default(),
        }
    }
}

fn join(port: &str, member: &str) -> String {
    if member.is_empty() { port.to_owned() } else { format!("{port}.{member}") }
}

fn input_desc(input: &Input) -> InputDesc {
    InputDesc {
        name: input.port.clone(),
        interface: input.interface.clone(),
        members: input.members.iter().map(|(name, desc, _)| (name.clone(), desc.clone())).collect(),
        facts: Arc::clone(&input.facts),
    }
}

fn resolve(desc: &ResourceDesc<Extent>, frame: (u32, u32), inputs: &[InputDesc]) -> ResourceDesc {
    match desc {
        ResourceDesc::Buffer(buffer) => ResourceDesc::Buffer(buffer.clone()),
        ResourceDesc::Texture(texture) => {
            let scale = |n: u32, num: u32, den: u32| (n * num).div_ceil(den).max(1);
            let size = match &texture.size {
                Extent::Frame { num, den } => (scale(frame.0, *num, *den), scale(frame.1, *num, *den)),
                Extent::Like { input, num, den } => {
                    let like = inputs
                        .iter()
                        .find(|desc| desc.name == *input)
                        .and_then(InputDesc::size)
                        .unwrap_or((1, 1));
                    (scale(like.0, *num, *den), scale(like.1, *num, *den))
                }
                Extent::Fixed(width, height) => (*width, *height),
            };
            ResourceDesc::Texture(TextureDesc {
                format: texture.format,
                size,
                layers: texture.layers,
                array: texture.array,
            })
        }
    }
}
