//! Pipelines of small passes, through the real linking and compiling, on the one device of the process.

use executor::{Executor, ExecutorError, FrameOptions, FrameReport, Gpu, LoadReport};
use frame_graph::plan::{PassId, ResourceId};
use frame_graph::port::PassTypes;
use frame_graph::resolve::Files;
use frame_graph::{
    Change, CompileOptions, Interface, LinkContext, Overrides, Plan, ResetCause, Source, Traits, compile,
    link, resolve,
};
use pass::{
    Extent, Format, Info, InputPort, Library, LinkedSteps, OutputContext, OutputDesc, OutputPort, Pass,
    PassTypeError, Ports, RecordContext, Recording, Request, ResourceDesc, SceneBindings, Setting, Settings,
    Step, Use, UseContext,
};
use shader_library::MemoryFiles;
use std::sync::{Arc, OnceLock};

/// Records the steps of a pass.
type Record = Box<dyn Fn(&RecordContext<'_>) -> Vec<Step> + Send + Sync>;

/// A type of pass, said in one expression.
pub(crate) struct Kind {
    name: &'static str,
    ports: Ports,
    settings: Vec<Setting>,
    outputs: Vec<OutputDesc>,
    record: Record,
}

impl Kind {
    pub(crate) fn new(name: &'static str) -> Kind {
        Kind {
            name,
            ports: Ports::default(),
            settings: Vec::new(),
            outputs: Vec::new(),
            record: Box::new(|_| Vec::new()),
        }
    }

    /// Adds an input of any resource, which need not be linked.
    pub(crate) fn input(mut self, name: &str, interface: &str) -> Kind {
        let (name, interface) = (name.to_owned(), interface.to_owned());
        self.ports.inputs.push(InputPort { name, interface, optional: true, doc: String::new() });
        self
    }

    /// Adds an output, or scratch.
    pub(crate) fn output(mut self, desc: OutputDesc) -> Kind {
        if !desc.scratch {
            let interface = match desc.members[0].1 {
                ResourceDesc::Buffer(_) => "Buffer",
                ResourceDesc::Texture(_) => "Texture",
            };
            self.ports.outputs.push(OutputPort {
                name: desc.port.clone(),
                interface: interface.to_owned(),
                doc: String::new(),
            });
        }
        self.outputs.push(desc);
        self
    }

    pub(crate) fn setting(mut self, setting: Setting) -> Kind {
        self.settings.push(setting);
        self
    }

    /// Adds an output of one resource that hands on an input.
    pub(crate) fn handing(mut self, port: &str, interface: &str, input: &str) -> Kind {
        let (name, interface) = (port.to_owned(), interface.to_owned());
        self.ports.outputs.push(OutputPort { name, interface, doc: String::new() });
        self.outputs.push(OutputDesc::hand_on(port, input));
        self
    }

    pub(crate) fn steps(
        mut self,
        record: impl Fn(&RecordContext<'_>) -> Vec<Step> + Send + Sync + 'static,
    ) -> Kind {
        self.record = Box::new(record);
        self
    }
}

impl Pass for Kind {
    fn info(&self) -> Info {
        Info { kind: self.name, about: "", paper: "", shaders: &[] }
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

/// The kinds of a test, for linking.
struct TestPassTypes<'a> {
    kinds: &'a [Kind],
    shaders: &'a Library,
}

impl TestPassTypes<'_> {
    fn find(&self, kind: &str) -> &Kind {
        self.kinds.iter().find(|found| found.name == kind).unwrap_or_else(|| panic!("no pass type `{kind}`"))
    }

    fn cx<'a>(&'a self, use_: Use<'a>) -> UseContext<'a> {
        UseContext { use_, shaders: self.shaders, interfaces: &[] }
    }
}

impl PassTypes for TestPassTypes<'_> {
    fn names(&self) -> Vec<String> {
        self.kinds.iter().map(|kind| kind.name.to_owned()).collect()
    }

    fn interfaces(&self) -> &[Interface] {
        &[]
    }

    fn takes_shader(&self, kind: &str) -> Option<bool> {
        self.kinds.iter().any(|found| found.name == kind).then_some(false)
    }

    fn settings(&self, use_: Use<'_>) -> Result<Arc<[Setting]>, PassTypeError> {
        Ok(self.find(use_.kind).settings(&self.cx(use_))?.into())
    }

    fn ports(&self, use_: Use<'_>, settings: &Settings) -> Result<Arc<Ports>, PassTypeError> {
        self.find(use_.kind).ports(&self.cx(use_), settings).map(Arc::new)
    }

    fn outputs(&self, context: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        self.find(context.use_.kind).outputs(&self.cx(context.use_), context)
    }
}

/// The file of the pipeline.
struct Text<'a>(&'a str);

impl Files for Text<'_> {
    fn read(&self, path: &str) -> Option<Arc<Source>> {
        Some(Source::new(path, self.0))
    }

    fn list(&self) -> Vec<String> {
        Vec::new()
    }
}

/// The one device of the process; `None`, said on stderr, where there is no adapter.
pub(crate) fn gpu() -> Option<Gpu> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    let open = || Gpu::open().inspect_err(|error| eprintln!("skipped: {error}")).ok();
    GPU.get_or_init(open).clone()
}

/// A plan with its linked steps, made without a GPU.
pub(crate) type Linked = (Arc<Plan>, Vec<LinkedSteps>);

/// The pass types and shaders of a test.
pub(crate) struct Workshop {
    kinds: Vec<Kind>,
    shaders: Library,
    pub(crate) frame: (u32, u32),
    pub(crate) options: CompileOptions,
}

impl Workshop {
    /// Creates one of these kinds and of WGSL files by their names.
    pub(crate) fn new(kinds: Vec<Kind>, shaders: &[(&str, &str)]) -> Workshop {
        let files = MemoryFiles::new(shaders.iter().map(|(path, text)| (*path, *text)));
        let shaders = Library::new(Arc::new(files)).with_roots([""]);
        Workshop { kinds, shaders, frame: (8, 4), options: CompileOptions::default() }
    }

    /// Adds a type of pass.
    pub(crate) fn with(mut self, kind: Kind) -> Workshop {
        self.kinds.push(kind);
        self
    }

    /// Links and compiles a pipeline: `passes` and `outputs` as in RON.
    ///
    /// # Errors
    /// The text of what is wrong with the steps.
    pub(crate) fn link(&self, passes: &str, outputs: &str) -> Result<Linked, String> {
        let text = format!("Pipeline(passes: {{ {passes} }}, outputs: {{ {outputs} }})");
        let kinds = TestPassTypes { kinds: &self.kinds, shaders: &self.shaders };
        let resolved = resolve("test.ron", &Text(&text), &Overrides::default());
        let resolved = resolved.unwrap_or_else(|errors| panic!("{errors}"));
        let context = LinkContext { frame: self.frame, ..LinkContext::default() };
        let graph = link(&resolved, &kinds, &context).unwrap_or_else(|errors| panic!("{errors}"));
        let plan = compile(&graph, &self.options).unwrap_or_else(|errors| panic!("{errors}"));
        let steps = plan.passes.iter().enumerate().map(|(index, pass)| {
            let (id, kind) = (PassId(index as u32), kinds.find(&pass.kind));
            pass::link_steps(&plan, id, kind, &Traits::default(), &self.shaders, &[])
        });
        let steps = steps.collect::<Result<_, _>>().map_err(|errors| errors.to_string())?;
        Ok((Arc::new(plan), steps))
    }

    /// Links a pipeline and loads it; `None` where there is no adapter.
    pub(crate) fn start(&self, passes: &str, outputs: &str) -> Option<Running> {
        Some(self.start_on(gpu()?, passes, outputs))
    }

    /// Links a pipeline and loads it on a device.
    pub(crate) fn start_on(&self, gpu: Gpu, passes: &str, outputs: &str) -> Running {
        let mut running = Running(Executor::new(gpu));
        let linked = self.link(passes, outputs).unwrap_or_else(|error| panic!("{error}"));
        running.load(linked).unwrap_or_else(|error| panic!("{error}"));
        running
    }
}

/// An executor with a plan.
pub(crate) struct Running(pub(crate) Executor);

impl Running {
    pub(crate) fn load(&mut self, (plan, steps): Linked) -> Result<LoadReport, ExecutorError> {
        self.0.load(plan, steps)
    }

    /// Runs a frame in which nothing has changed but the frame's number.
    pub(crate) fn frame(&mut self) -> &FrameReport {
        self.frame_with(&Change::default(), FrameOptions::default())
    }

    /// Runs a frame that begins with an event.
    pub(crate) fn frame_after(&mut self, event: ResetCause) -> &FrameReport {
        self.frame_with(&Change { events: vec![event], ..Change::default() }, FrameOptions::default())
    }

    /// Runs a frame in which nothing has changed, and fills what passes write with NaN before they run.
    pub(crate) fn frame_with_poison(&mut self) -> &FrameReport {
        self.frame_with(&Change::default(), FrameOptions { poison: true, ..FrameOptions::default() })
    }

    /// Runs every pass.
    pub(crate) fn frame_of_all(&mut self, options: FrameOptions) -> &FrameReport {
        self.frame_with(&Change { all: true, ..Change::default() }, options)
    }

    pub(crate) fn frame_with(&mut self, change: &Change, options: FrameOptions) -> &FrameReport {
        self.0.frame(change, options).unwrap_or_else(|error| panic!("{error}"))
    }

    pub(crate) fn id(&self, name: &str) -> ResourceId {
        let plan = self.0.plan().unwrap();
        plan.resource(name).unwrap_or_else(|| panic!("no resource `{name}` in\n{}", plan.to_text()))
    }

    /// The words of a resource.
    pub(crate) fn read(&self, name: &str) -> Vec<u32> {
        let bytes = self.0.read(self.id(name)).unwrap_or_else(|error| panic!("{error}"));
        bytemuck::pod_collect_to_vec(&bytes)
    }

    pub(crate) fn read_floats(&self, name: &str) -> Vec<f32> {
        self.read(name).into_iter().map(f32::from_bits).collect()
    }
}

pub(crate) fn shader(path: &str) -> Request {
    pass::request(path, &[])
}

/// A buffer of this many words.
pub(crate) fn words(count: u64) -> ResourceDesc<Extent> {
    ResourceDesc::buffer(count * 4)
}

/// A texture of the frame's size.
pub(crate) fn texture(format: Format) -> ResourceDesc<Extent> {
    ResourceDesc::texture_2d(format, Extent::FRAME)
}

/// Reads the frame's number, so that its passes run in every frame.
pub(crate) fn every_frame(mut kind: Kind) -> Kind {
    kind.ports.scene_bindings = SceneBindings::FRAME;
    kind
}
