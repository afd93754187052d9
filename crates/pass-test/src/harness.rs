//! A test of one pass: its inputs, its pipeline, and its frames.

use crate::given::{Given, GivenMember};
use crate::{Outputs, TestPass, TestPassTypes, buffer, gpu, library, scene};
use executor::{Executor, ExecutorError, FrameOptions, Gpu};
use frame_graph::plan::{PassId, Plan};
use frame_graph::port::{OutputOverride, PassTypes};
use frame_graph::resolve::Overrides;
use frame_graph::{
    Change, CompileOptions, Diagnostics, Facts, LinkContext, Module, ResetCause, ResourceDesc, Settings,
    Traits, Use, Value,
};
use interfaces::INTERFACES;
use interfaces::virtual_lights::{self, VirtualLight};
use pass::{Library, LinkedSteps, Pass, Step};
use scene::{Camera, Scene};
use scene_upload::{Frame, SceneView};
use shader_library::MemoryFiles;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::sync::Arc;

/// The order of threads in which every pass runs once more.
const OTHER_ORDER: u32 = 2;

/// The byte with which what a pass writes is filled when it runs once more: of [`FrameOptions::NAN`] alone, a sum of
/// integers that was not cleared would be one too small.
pub(crate) const OTHER_POISON: u8 = 0x5a;

/// The test harness of a pass: runs it alone, in a pipeline of its own, with given inputs.
///
/// The pipeline is linked and compiled as any other, so values out of range, inputs of another interface and names that
/// cannot be bound are refused with the same messages that a user reads. What the pass writes is filled with NaN before
/// it runs. A pass that dispatches runs twice, the second time with its threads in another order, and both must write
/// the same bits.
pub struct Harness<'a> {
    pass: &'a dyn Pass,
    shader: Option<&'a str>,
    overrides: BTreeMap<String, OutputOverride>,
    set: BTreeMap<String, Value>,
    pub(crate) size: (u32, u32),
    given: Vec<Given>,
    /// Inputs that read the past of an output of the pass: input and output.
    feedback: Vec<(String, String)>,
    scene: Option<Scene>,
    camera: Option<Camera>,
    time: f32,
    time_step: f32,
    first_index: u32,
    frames: u32,
    /// Number of the frame, and what happens before it.
    events: Vec<(u32, ResetCause)>,
    traits: BTreeMap<String, Value>,
    seed: u32,
    sample: u32,
    any_order: bool,
}

impl<'a> Harness<'a> {
    /// Creates the harness of a pass, with every setting at its default, one frame of 16×16 and the scene `empty`.
    pub fn new(pass: &'a dyn Pass) -> Harness<'a> {
        Harness {
            pass,
            shader: None,
            overrides: BTreeMap::new(),
            set: BTreeMap::new(),
            size: (16, 16),
            given: Vec::new(),
            feedback: Vec::new(),
            scene: None,
            camera: None,
            time: 0.0,
            time_step: 0.0,
            first_index: 0,
            frames: 1,
            events: Vec::new(),
            traits: BTreeMap::new(),
            seed: 0,
            sample: 0,
            any_order: true,
        }
    }

    /// Gives a setting a value.
    pub fn set(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.set.insert(name.to_owned(), value.into());
        self
    }

    /// Sets the WGSL file, for a pass type that takes one.
    pub fn shader(mut self, path: &'a str) -> Self {
        self.shader = Some(path);
        self
    }

    /// Sets the `out:` declaration of an output, for a pass type that takes a shader.
    pub fn out(mut self, port: &str, said: OutputOverride) -> Self {
        self.overrides.insert(port.to_owned(), said);
        self
    }

    /// Sets the size of the frame in pixels.
    pub fn frame(mut self, width: u32, height: u32) -> Self {
        self.size = (width, height);
        self
    }

    /// Sets the scene, by name or path.
    ///
    /// # Panics
    /// Where it cannot be loaded.
    pub fn scene(self, spec: &str) -> Self {
        self.with_scene(scene(spec))
    }

    /// Sets the scene.
    pub fn with_scene(mut self, scene: Scene) -> Self {
        self.scene = Some(scene);
        self
    }

    /// Sets a camera that replaces the scene's.
    pub fn camera(mut self, camera: Camera) -> Self {
        self.camera = Some(camera);
        self
    }

    /// Sets the time of the first frame \[s\]; 0 by default.
    pub fn time(mut self, time: f32) -> Self {
        self.time = time;
        self
    }

    /// Sets the time between frames \[s\]; 0 by default.
    pub fn time_step(mut self, step: f32) -> Self {
        self.time_step = step;
        self
    }

    /// Sets the number of the first frame; 0 by default.
    pub fn frame_index(mut self, index: u32) -> Self {
        self.first_index = index;
        self
    }

    /// Sets how many frames run; 1 by default. The outputs are those of the last.
    pub fn frames(mut self, count: u32) -> Self {
        self.frames = count;
        self
    }

    /// Adds an event, such as a cut, before frame `frame`, counted from 0 for the first: it may reset history buffers.
    pub fn event(mut self, frame: u32, cause: ResetCause) -> Self {
        self.events.push((frame, cause));
        self
    }

    /// Sets a trait of the scene, in place of the scene's own.
    pub fn scene_trait(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.traits.insert(name.to_owned(), value.into());
        self
    }

    /// Sets the run's seed; 0 gives plain sequences.
    pub fn seed(mut self, seed: u32) -> Self {
        self.seed = seed;
        self
    }

    /// Sets which sample of a picture the frames are.
    pub fn sample(mut self, number: u32) -> Self {
        self.sample = number;
        self
    }

    /// Adds an input port: interface, facts, and each member's name, description and bytes (rows and layers without
    /// padding; fewer bytes leave the rest zero). Members that the interface requires and that are left out hold NaN.
    pub fn input(
        mut self,
        port: &str,
        interface: &str,
        facts: &[(&str, u32)],
        members: Vec<(&str, ResourceDesc, Vec<u8>)>,
    ) -> Self {
        let facts = facts.iter().map(|(name, value)| (*name, Value::U32(*value))).collect();
        self.give(port, interface, facts, members, None);
        self
    }

    /// Gives the input port `lights`. Its buffer has room for one light even where there is none.
    pub fn lights(self, lights: &[VirtualLight]) -> Self {
        let room = virtual_lights::to_bytes(&vec![VirtualLight::default(); lights.len().max(1)]).len();
        let members = vec![("", buffer(room as u64), virtual_lights::to_bytes(lights))];
        self.input("lights", "VirtualLights", &[("count", lights.len() as u32)], members)
    }

    /// Adds an input port that reads a history buffer of the age `age`: this many frames run before those that
    /// [`Harness::frames`] counts. At 0 there is no history, and the pass reads zeros.
    pub fn past(
        mut self,
        port: &str,
        interface: &str,
        age: u32,
        members: Vec<(&str, ResourceDesc, Vec<u8>)>,
    ) -> Self {
        self.give(port, interface, Facts::default(), members, Some(age));
        self
    }

    /// Links an input port to the history buffer of the pass's own output: what it wrote in the frame before.
    pub fn feedback(mut self, input: &str, output: &str) -> Self {
        self.feedback.push((input.to_owned(), output.to_owned()));
        self
    }

    fn give(
        &mut self,
        port: &str,
        interface: &str,
        facts: Facts,
        members: Vec<(&str, ResourceDesc, Vec<u8>)>,
        age: Option<u32>,
    ) {
        let members = members
            .into_iter()
            .map(|(name, desc, bytes)| GivenMember { name: name.to_owned(), desc, bytes })
            .collect();
        let (port, interface) = (port.to_owned(), interface.to_owned());
        let mut given = Given { port, interface, facts, members, age };
        given.add_required_members();
        self.given.push(given);
    }

    /// Adds a fact to the input added last.
    pub fn fact(mut self, name: &str, value: impl Into<Value>) -> Self {
        if let Some(input) = self.given.last_mut() {
            input.facts.insert(name, value.into());
        }
        self
    }

    /// Runs the pass, which must be refused, and returns the message; `None` without an adapter.
    ///
    /// # Panics
    /// Where it runs.
    pub fn refusal(self) -> Option<String> {
        gpu()?;
        let run = std::panic::AssertUnwindSafe(|| self.run().is_some());
        let refused = std::panic::catch_unwind(run).expect_err("the pass is refused");
        Some(refused.downcast_ref::<String>().cloned().unwrap_or_default())
    }

    /// Sets the module of the input added last to that file.
    pub fn module(mut self, path: &str) -> Self {
        if let Some(input) = self.given.last_mut() {
            input.facts.set_module(Module::new(path));
        }
        self
    }

    /// Gives an option of the module of the input added last a value.
    pub fn module_option(mut self, name: &str, value: impl Into<Value>) -> Self {
        if let Some(module) = self.given.last_mut().and_then(|input| input.facts.module_mut()) {
            module.options.insert(name.to_owned(), value.into());
        }
        self
    }

    /// Disables the second run with another order of threads, because the outputs depend on it: `reason` says why they
    /// may.
    ///
    /// # Panics
    /// Where there is no reason.
    pub fn depends_on_thread_order(mut self, reason: &str) -> Self {
        assert!(!reason.trim().is_empty(), "a pass whose bits depend on the order of threads needs a reason");
        self.any_order = false;
        self
    }

    /// Runs the frames, and once more with threads in another order and with other bits in what was not written before.
    /// Returns the outputs of the last frame; `None` where there is no adapter.
    ///
    /// # Panics
    /// Where the graph, the pass, its shaders or the GPU report an error: the test fails with their message. Also where
    /// the bits depend on either.
    pub fn run(self) -> Option<Outputs> {
        let gpu = gpu()?;
        let run = |order, poison| {
            self.try_run(gpu.clone(), order, poison).unwrap_or_else(|error| panic!("{error}"))
        };
        let outputs = run(None, FrameOptions::NAN);
        if self.any_order && outputs.dispatches {
            outputs.assert_same_bits(&run(Some(OTHER_ORDER), OTHER_POISON));
        }
        Some(outputs)
    }

    fn try_run(&self, gpu: Gpu, order: Option<u32>, poison: u8) -> Result<Outputs, ExecutorError> {
        let described;
        let scene = match &self.scene {
            Some(scene) => scene,
            None => {
                described = scene("empty");
                &described
            }
        };
        let mut traits = scene.traits();
        traits.values.extend(self.traits.clone());
        let (plan, steps) = self.compile(traits, library(order)).map_err(ExecutorError::Shader)?;
        let dispatches = steps.iter().flatten().any(|step| matches!(step.step, Step::Compute(_)));
        let mut executor = Executor::new(gpu);
        let mut view = SceneView::upload(&mut executor, scene);
        view.provide(&mut executor, scene, steps.iter().flatten().flat_map(|step| step.scene_bindings()))?;
        executor.set_sample(self.seed, self.sample);
        executor.load(Arc::clone(&plan), steps)?;
        let past = self.given.iter().filter_map(|given| given.age).max().unwrap_or(0);
        for frame in 0..past + self.frames {
            self.write_given(&executor, &plan);
            let time = self.time + self.time_step * frame as f32;
            let mut pose = scene.at(time);
            if let Some(camera) = self.camera {
                pose.camera = camera;
            }
            let index = self.first_index + frame;
            let info = Frame { index, time, step: self.time_step, pad: 0.0 };
            let events = self.events.iter().filter(|(at, _)| *at == frame).map(|(_, cause)| *cause);
            let mut change = Change { all: true, events: events.collect(), ..Change::default() };
            view.update(&mut executor, scene, &pose, self.size, info, &mut change)?;
            executor.frame(&change, FrameOptions { poison: Some(poison), ..FrameOptions::default() })?;
        }
        Ok(Outputs { executor, plan, pass: self.pass.kind(), dispatches })
    }

    fn write_given(&self, executor: &Executor, plan: &Plan) {
        for given in &self.given {
            for member in given.members.iter().filter(|member| !member.bytes.is_empty()) {
                let resource = plan.resource(&given.resource(&member.name));
                executor.write(resource.expect("a pass that is read is in the plan"), &member.bytes);
            }
        }
    }

    /// Links and compiles the pipeline, as a renderer does, and links the steps of the pass.
    fn compile(
        &self,
        traits: Traits,
        library: &Library,
    ) -> Result<(Arc<Plan>, Vec<LinkedSteps>), Diagnostics> {
        let kind = self.pass.kind();
        let given: Vec<TestPass> = self.given.iter().map(Given::pass_type).collect();
        let passes = given.iter().map(|given| given as &dyn Pass).chain([self.pass]).collect();
        let kinds = TestPassTypes { passes, shaders: library, interfaces: INTERFACES };
        let pipeline = self.pipeline(&self.output_ports(&kinds));
        let pipelines = MemoryFiles::new([("test.ron", pipeline.as_str())]);
        let set = self.set.iter().map(|(name, value)| (format!("{kind}.{name}"), value.clone()));
        let resolved = frame_graph::resolve("test.ron", &pipelines, &Overrides(set.collect()))?;
        let context = LinkContext { frame: self.size, traits };
        let graph = frame_graph::link(&resolved, &kinds, &context)?;
        let options = CompileOptions { sharing: false, ..CompileOptions::default() };
        let plan = frame_graph::compile(&graph, &options)?;
        let mut steps = Vec::with_capacity(plan.passes.len());
        for (index, pass) in plan.passes.iter().enumerate() {
            // Inputs of a test have no steps: their bytes are written before each frame.
            steps.push(if pass.kind.as_str() == kind {
                let id = PassId(index as u32);
                pass::link_steps(&plan, id, self.pass, &context.traits, library, INTERFACES)?
            } else {
                Vec::new()
            });
        }
        for step in steps.iter().flatten() {
            step.shader.check_layout(&scene_upload::layouts(), "the harness")?;
        }
        Ok((Arc::new(plan), steps))
    }

    /// The output ports of the pass; none where it refuses its use, which linking reports with a better message.
    fn output_ports(&self, kinds: &TestPassTypes<'_>) -> Vec<String> {
        let given = self.given.iter().map(|given| given.port.clone());
        let inputs: Vec<String> = given.chain(self.feedback.iter().map(|(input, _)| input.clone())).collect();
        let kind = self.pass.kind();
        let use_ = Use { kind, shader: self.shader, inputs: &inputs, outputs: &self.overrides };
        let Ok(schema) = kinds.settings(use_) else { return Vec::new() };
        let mut settings = Settings::defaults(&schema);
        settings.0.extend(self.set.clone());
        let ports = kinds.ports(use_, &settings);
        ports
            .map_or_else(|_| Vec::new(), |ports| ports.outputs.iter().map(|port| port.name.clone()).collect())
    }

    /// The description: a pass for each input that is given, the pass under test, and all of its outputs.
    fn pipeline(&self, outputs: &[String]) -> String {
        let kind = self.pass.kind();
        let mut text = String::from("Pipeline(\n    passes: {\n");
        for given in &self.given {
            let _ = writeln!(text, "        {0:?}: Pass(kind: {0:?}),", given.pass());
        }
        let _ = write!(text, "        {kind:?}: Pass(kind: {kind:?}");
        if let Some(shader) = self.shader {
            let _ = write!(text, ", shader: {shader:?}");
        }
        let given = self.given.iter().map(|given| {
            let prev = if given.age.is_some() { "prev " } else { "" };
            (&given.port, format!("{:?}", format!("{prev}{}.{}", given.pass(), given.port)))
        });
        let feedback = self.feedback.iter().map(|(input, output)| {
            let link = format!("{:?}", format!("prev {kind}.{output}"));
            (input, link)
        });
        let links: Vec<String> =
            given.chain(feedback).map(|(port, link)| format!("{port:?}: {link}")).collect();
        let outs: Vec<String> =
            self.overrides.iter().map(|(port, said)| format!("{port:?}: {}", out(said))).collect();
        for (field, entries) in [("in", links), ("out", outs)] {
            if !entries.is_empty() {
                let _ = write!(text, ", {field}: {{ {} }}", entries.join(", "));
            }
        }
        text.push_str("),\n    },\n    outputs: {\n");
        for output in outputs {
            let _ = writeln!(text, "        {output:?}: {:?},", format!("{kind}.{output}"));
        }
        text.push_str("    },\n)\n");
        text
    }
}

/// Writes an `out:` declaration as RON.
fn out(said: &OutputOverride) -> String {
    let mut fields = Vec::new();
    if let Some(interface) = &said.interface {
        fields.push(format!("interface: {interface:?}"));
    }
    if let Some(format) = said.format {
        fields.push(format!("format: {:?}", format.name()));
    }
    match &said.size {
        Some(size @ frame_graph::Extent::Fixed(..)) => fields.push(format!("size: {size}")),
        Some(size) => fields.push(format!("size: {:?}", size.to_string())),
        None => {}
    }
    if let Some(count) = said.count {
        fields.push(format!("count: {count}"));
    }
    if !said.facts.is_empty() {
        let told = |value: &Option<Value>| value.as_ref().map_or("None".to_owned(), ToString::to_string);
        let facts = said.facts.iter().map(|(name, value)| format!("{name:?}: {}", told(value)));
        fields.push(format!("facts: {{ {} }}", facts.collect::<Vec<_>>().join(", ")));
    }
    format!("Out({})", fields.join(", "))
}
