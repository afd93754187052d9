//! Pipelines of small passes, through the real linking and compiling, on the one device of the process.

use executor::{Executor, ExecutorError, FrameOptions, FrameReport, Gpu, LoadReport};
use frame_graph::plan::{PassId, ResourceId};
use frame_graph::{
    Change, CompileOptions, LinkContext, Overrides, Plan, ResetCause, Traits, compile, link, resolve,
};
use pass::{Extent, Format, Library, LinkedSteps, Pass, Request, ResourceDesc, SceneBindings};
use pass_test::TestPassTypes;
pub(crate) use pass_test::{TestPass, gpu};
use shader_library::MemoryFiles;
use std::sync::Arc;

/// A plan with its linked steps, made without a GPU.
pub(crate) type Linked = (Arc<Plan>, Vec<LinkedSteps>);

/// The pass types and shaders of a test.
pub(crate) struct Workshop {
    kinds: Vec<TestPass>,
    shaders: Library,
    pub(crate) frame: (u32, u32),
    pub(crate) options: CompileOptions,
}

impl Workshop {
    /// Creates one of these kinds and of WGSL files by their names.
    pub(crate) fn new(kinds: Vec<TestPass>, shaders: &[(&str, &str)]) -> Workshop {
        let files = MemoryFiles::new(shaders.iter().map(|(path, text)| (*path, *text)));
        let shaders = Library::new(Arc::new(files)).with_roots([""]);
        Workshop { kinds, shaders, frame: (8, 4), options: CompileOptions::default() }
    }

    /// Adds a type of pass.
    pub(crate) fn with(mut self, kind: TestPass) -> Workshop {
        self.kinds.push(kind);
        self
    }

    /// Links and compiles a pipeline: `passes` and `outputs` as in RON.
    ///
    /// # Errors
    /// The text of what is wrong with the steps.
    pub(crate) fn link(&self, passes: &str, outputs: &str) -> Result<Linked, String> {
        let text = format!("Pipeline(passes: {{ {passes} }}, outputs: {{ {outputs} }})");
        let passes = self.kinds.iter().map(|kind| kind as &dyn Pass).collect();
        let kinds = TestPassTypes { passes, shaders: &self.shaders, interfaces: &[] };
        let pipelines = MemoryFiles::new([("test.ron", text.as_str())]);
        let resolved = resolve("test.ron", &pipelines, &Overrides::default());
        let resolved = resolved.unwrap_or_else(|errors| panic!("{errors}"));
        let context = LinkContext { frame: self.frame, ..LinkContext::default() };
        let graph = link(&resolved, &kinds, &context).unwrap_or_else(|errors| panic!("{errors}"));
        let plan = compile(&graph, &self.options).unwrap_or_else(|errors| panic!("{errors}"));
        let steps = plan.passes.iter().enumerate().map(|(index, pass)| {
            let kind = kinds.find(&pass.kind).unwrap_or_else(|error| panic!("{}", error.message));
            let id = PassId(index as u32);
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
        self.frame_with(
            &Change::default(),
            FrameOptions { poison: Some(FrameOptions::NAN), ..FrameOptions::default() },
        )
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

/// Returns the pass type with the frame's number among its scene bindings, so that its passes run in every frame.
pub(crate) fn every_frame(kind: TestPass) -> TestPass {
    kind.reads(SceneBindings::FRAME)
}
