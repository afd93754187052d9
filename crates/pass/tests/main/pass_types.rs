//! A few pass types as a catalog offers them, and a pipeline of them linked.

use frame_graph::plan::{PassId, Plan};
use frame_graph::port::{PassTypes, Use};
use frame_graph::{CompileOptions, Content, Fact, Format, Interface, LinkContext, Member, Overrides};
use pass::{
    Library, LinkedSteps, OutputContext, OutputDesc, Pass, PassTypeError, Ports, Setting, Settings, Traits,
    UseContext,
};
use shader_library::MemoryFiles;
use std::sync::Arc;

pub(crate) struct TestPassTypes<'a> {
    pub(crate) passes: &'a [&'a dyn Pass],
    pub(crate) library: Library,
}

impl TestPassTypes<'_> {
    fn find(&self, kind: &str) -> &dyn Pass {
        *self.passes.iter().find(|pass| pass.kind() == kind).expect("pipelines of tests name what there is")
    }

    /// The plan of a pipeline, or why it does not link.
    pub(crate) fn plan(&self, pipeline: &str) -> Result<Plan, String> {
        let pipelines = MemoryFiles::new([("p.ron", pipeline)]);
        let resolved = frame_graph::resolve("p.ron", &pipelines, &Overrides::default()).expect("it is read");
        let context = LinkContext { frame: (8, 8), traits: Traits::default() };
        let graph = frame_graph::link(&resolved, self, &context).map_err(|errors| errors.to_string())?;
        Ok(frame_graph::compile(&graph, &CompileOptions::default()).expect("it is compiled"))
    }

    /// The plan of a pipeline, and the steps of its only pass of a type, or what is wrong with them.
    pub(crate) fn linked(&self, pipeline: &str, kind: &str) -> (Plan, Result<LinkedSteps, String>) {
        self.linked_for(pipeline, kind, &Traits::default())
    }

    /// As [`TestPassTypes::linked`], for a scene.
    pub(crate) fn linked_for(
        &self,
        pipeline: &str,
        kind: &str,
        traits: &Traits,
    ) -> (Plan, Result<LinkedSteps, String>) {
        let plan = self.plan(pipeline).unwrap_or_else(|error| panic!("{error}"));
        let id = PassId(plan.passes.iter().position(|pass| pass.kind == kind).expect("it is needed") as u32);
        let steps = pass::link_steps(&plan, id, self.find(kind), traits, &self.library, INTERFACES);
        (plan, steps.map_err(|error| error.to_string()))
    }
}

/// A fact that a module's uniform reads.
pub(crate) const TILE: Fact<u32> = Fact::optional("tile", "");
/// Another fact.
pub(crate) const TILES: Fact<u32> = Fact::optional("tiles", "");

/// A fact that every producer gives.
const SIDE: Fact<u32> = Fact::required("side", "the side of a map");
/// A fact with a fraction.
const BOUND: Fact<f32> = Fact::optional("bound", "");

static INTERFACES: &[Interface] = &[
    Interface::new("Answer", "", &[Member::required("", Content::Buffer, "")])
        .with_facts(&[TILE.decl(), TILES.decl()])
        .with_stand_in("answer.wgsl"),
    Interface::new("Maps", "", &[Member::required("", Content::Texture(Format::R32Float), "")])
        .with_facts(&[SIDE.decl(), TILES.decl(), BOUND.decl()]),
    Interface::new("Numbers", "", &[Member::required("", Content::Buffer, "f32")])
        .with_facts(&[COUNT.decl(), SCALE.decl()]),
];

/// The number of numbers.
const COUNT: Fact<u32> = Fact::required("count", "");
/// Their factor.
const SCALE: Fact<f32> = Fact::optional("scale", "");

impl PassTypes for TestPassTypes<'_> {
    fn names(&self) -> Vec<String> {
        self.passes.iter().map(|pass| pass.kind().into()).collect()
    }

    fn interfaces(&self) -> &[Interface] {
        INTERFACES
    }

    fn takes_shader(&self, kind: &str) -> Option<bool> {
        Some(self.find(kind).takes_shader())
    }

    fn settings(&self, use_: Use<'_>) -> Result<Arc<[Setting]>, PassTypeError> {
        Ok(self
            .find(use_.kind)
            .settings(&UseContext { use_, shaders: &self.library, interfaces: INTERFACES })?
            .into())
    }

    fn ports(&self, use_: Use<'_>, settings: &Settings) -> Result<Arc<Ports>, PassTypeError> {
        self.find(use_.kind)
            .ports(&UseContext { use_, shaders: &self.library, interfaces: INTERFACES }, settings)
            .map(Arc::new)
    }

    fn outputs(&self, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let context = UseContext { use_: cx.use_, shaders: &self.library, interfaces: INTERFACES };
        let mut outputs = self.find(cx.use_.kind).outputs(&context, cx)?;
        pass::scene_bindings::find_of_modules(&mut outputs, &self.library);
        Ok(outputs)
    }
}
