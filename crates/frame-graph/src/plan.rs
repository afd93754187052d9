//! The compiled plan: a plain value that an executor runs, and that can be printed, hashed and drawn.

mod dot;
mod drawing;
pub(crate) mod json;
mod members;
mod svg;
mod text;
pub(crate) mod values;

use crate::port::{Facts, OutputOverride, SceneBindings};
use crate::resource::{Clear, ResourceDesc, human_bytes};
use data_file::{Name, Settings};
use smallvec::SmallVec;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

pub use drawing::{BoxKind, Drawing, DrawnBox, DrawnEdge};
pub use members::PlannedMembers;

/// A stable hash of a plan: equal for equal plans, on any machine.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PlanId(pub u128);

/// Index into [`Plan::passes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PassId(pub u32);

/// Index into [`Plan::resources`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ResourceId(pub u32);

/// Index into [`Plan::allocations`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct AllocationId(pub u32);

/// Index into [`Plan::histories`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct HistoryId(pub u32);

/// A plan: everything that is decided before a frame runs.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The stable hash of all fields below.
    pub id: PlanId,
    /// The stable hash of what objects depend on: passes and their types, links, resources, objects, history buffers.
    /// Plans that differ only in settings, facts, `reset:` lists or in which resources are outputs have the same one.
    pub structure: PlanId,
    /// Size of the frame in pixels.
    pub frame: (u32, u32),
    /// The passes, in the order in which they run.
    pub passes: Vec<PlannedPass>,
    /// Every resource of the passes.
    pub resources: Vec<PlannedResource>,
    /// The objects that hold the resources.
    pub allocations: Vec<Allocation>,
    /// The history buffers: resources whose version of the frame before is read.
    pub histories: Vec<History>,
    /// The outputs of the pipeline, in the order of its file.
    pub outputs: Vec<PlannedOutput>,
    /// Whether each pass of the description runs, and why, in the order of the file.
    pub fates: Vec<(Name, Fate)>,
    /// The memory that the plan needs, with and without sharing.
    pub memory: Memory,
}

/// One pass of a plan.
#[derive(Clone, Debug)]
pub struct PlannedPass {
    /// Name in the flattened description: `shadows/splat`.
    pub name: Name,
    /// The pass type.
    pub kind: Name,
    /// The WGSL file, for pass types that take one.
    pub shader: Option<Name>,
    /// Settings, complete.
    pub settings: Arc<Settings>,
    /// The `out:` declarations of the use, for [`crate::port::Use::outputs`].
    pub overrides: Arc<BTreeMap<String, OutputOverride>>,
    /// The inputs that are connected.
    pub inputs: Vec<PlannedInput>,
    /// Outputs and scratch.
    pub outputs: Vec<PlannedPort>,
    /// The scene bindings that it reads itself.
    pub scene_bindings: SceneBindings,
    /// What its result depends on, through all that it reads: where none of it has changed, it need not run.
    pub depends_on: SceneBindings,
    /// Whether it depends on a history buffer, and so on every frame before.
    pub remembers: bool,
    /// Resources to clear before it runs.
    pub clears: Vec<(ResourceId, Clear)>,
    /// Resources that begin with the content of another.
    pub continues: Vec<Continued>,
}

/// A resource of a pass that begins with the content of one of its inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Continued {
    /// The resource that the pass writes.
    pub resource: ResourceId,
    /// The input port that it continues.
    pub input: Name,
    /// The content that it begins with.
    pub from: Begins,
}

/// The initial content of a [`Continued`] resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Begins {
    /// Its own history buffer: the same object, so that nothing is copied.
    InPlace(HistoryId),
    /// A copy of a history buffer.
    CopyOfPast(HistoryId),
    /// A copy of a resource of this frame.
    Copy(ResourceId),
}

/// A connected input of a [`PlannedPass`].
#[derive(Clone, Debug)]
pub struct PlannedInput {
    /// The port.
    pub port: Name,
    /// The pass that the link names. It may hand on a resource of another pass.
    pub producer: PassId,
    /// The output port of that pass.
    pub producer_port: Name,
    /// The interface of the linked output.
    pub interface: Name,
    /// Member name and resource.
    pub members: PlannedMembers,
    /// The history buffers of those resources, where the link is a `prev` link: one entry per member.
    pub history: Option<Vec<HistoryId>>,
    /// Facts of the producer's port.
    pub facts: Arc<Facts>,
}

/// An output port or a scratch resource of a [`PlannedPass`].
#[derive(Clone, Debug)]
pub struct PlannedPort {
    /// The port.
    pub port: Name,
    /// The interface; empty for scratch.
    pub interface: Name,
    /// Name and resource of each member that the pass writes.
    pub members: PlannedMembers,
    /// Name and resource of each member that the pass hands on: a resource of one of its inputs.
    pub handed: Vec<(Name, ResourceId)>,
    /// Whether anything reads it. A pass may skip work for what nothing reads.
    pub connected: bool,
    /// Facts that go with it.
    pub facts: Arc<Facts>,
}

/// A resource of a plan.
#[derive(Clone, Debug)]
pub struct PlannedResource {
    /// `pass.port`, or `pass.port.member`.
    pub name: Name,
    /// The description, with known size.
    pub desc: ResourceDesc,
    /// The object that backs it; for a resource with a history buffer, the first of the two that swap.
    pub allocation: AllocationId,
    /// The pass that writes it.
    pub producer: PassId,
    /// The passes that read it in the same frame.
    pub readers: SmallVec<[PassId; 4]>,
    /// First and last position in the order at which it is alive.
    pub lifetime: (u32, u32),
    /// Set where it must outlive its last reader, and so shares no object: an output of the pipeline, a history buffer,
    /// or a resource that passes read in frames in which its producer does not run.
    pub persistent: bool,
    /// Its history buffer, if a `prev` link reads it.
    pub history: Option<HistoryId>,
}

/// An object on the GPU, which holds one resource, or several whose lifetimes do not overlap.
#[derive(Clone, Debug)]
pub struct Allocation {
    /// The description, which fits every resource in it.
    pub desc: ResourceDesc,
    /// The resources, in the order of their lifetimes.
    pub resources: Vec<ResourceId>,
}

/// A history buffer: a resource whose version of the frame before is read.
#[derive(Clone, Debug)]
pub struct History {
    /// The resource.
    pub resource: ResourceId,
    /// Its two objects. The executor writes them in turn. Twice the same one where `in_place` is set.
    pub copies: [AllocationId; 2],
    /// Set where the only reader is the pass that continues it: one object is enough.
    pub in_place: bool,
    /// The events that reset it.
    pub reset: Vec<crate::frame::ResetCause>,
    /// After how many frames in which nothing but history buffers changes the passes that follow from it stop, and the
    /// last of these frames stands; `None` where they go on for ever.
    pub rest: Option<u32>,
    /// Whether it is the same after frames that left it out: frames that only settle do.
    pub catches_up: bool,
}

/// An output of the pipeline.
#[derive(Clone, Debug)]
pub struct PlannedOutput {
    /// Name in the pipeline.
    pub name: Name,
    /// `pass.port`, or `pass.port.member`, that it comes from.
    pub from: Name,
    /// Interface of that port.
    pub interface: Name,
    /// Member name and resource.
    pub members: PlannedMembers,
}

/// Whether a pass runs, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fate {
    /// It runs: some output of the pipeline needs it. Holds the passes or outputs that read it.
    Kept {
        /// Names of what reads it.
        readers: Vec<Name>,
    },
    /// Nothing that an output needs reads any of its ports.
    Culled {
        /// Passes that would read it, themselves culled or off; empty where nothing does.
        readers: Vec<Name>,
    },
    /// Its switch is off.
    Off {
        /// The expression of `when:`, with the values that decided it.
        why: String,
        /// What takes its place: an input that is passed on, or another pass.
        instead: String,
    },
}

/// What sharing saves, in bytes of transient resources (histories apart).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Memory {
    /// Every resource in an object of its own.
    pub unshared: u64,
    /// With sharing, as planned.
    pub shared: u64,
    /// The lower bound for any plan with this order: the largest sum of resources alive at once.
    pub bound: u64,
    /// Number of objects as planned.
    pub objects: u32,
    /// History buffers and other resources that cannot share objects.
    pub persistent: u64,
}

impl fmt::Debug for PlanId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl fmt::Display for PlanId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

impl Plan {
    /// Returns the pass of this name.
    pub fn pass(&self, name: &str) -> Option<PassId> {
        self.passes.iter().position(|pass| pass.name == *name).map(|i| PassId(i as u32))
    }

    /// Returns the resource named `pass.port` or `pass.port.member`, which may be one that the pass hands on.
    pub fn resource(&self, name: &str) -> Option<ResourceId> {
        let made = self.resources.iter().position(|resource| resource.name == *name);
        made.map(|i| ResourceId(i as u32))
            .or_else(|| self.handed().find(|(handed, _)| handed == name).map(|(_, id)| id))
    }

    /// Returns every resource that a pass hands on, as `pass.port` or `pass.port.member` of that pass.
    pub fn handed(&self) -> impl Iterator<Item = (String, ResourceId)> + '_ {
        self.passes.iter().flat_map(|pass| {
            pass.outputs.iter().flat_map(move |port| {
                port.handed.iter().map(move |(member, id)| {
                    let dot = if member.is_empty() { "" } else { "." };
                    (format!("{}.{}{dot}{member}", pass.name, port.port), *id)
                })
            })
        })
    }

    /// Returns the output of this name.
    pub fn output(&self, name: &str) -> Option<&PlannedOutput> {
        self.outputs.iter().find(|output| output.name == *name)
    }

    /// Returns the pass that writes a resource.
    pub fn producer(&self, id: ResourceId) -> PassId {
        self.resources[id.0 as usize].producer
    }

    /// Returns for each pass whether an output depends on it, in the same frame or through history buffers. Of an output that
    /// the plan does not have, none.
    pub fn feeding(&self, output: &str) -> Vec<bool> {
        let members = self.output(output).map_or(&[][..], |output| &output.members[..]);
        self.upstream(members.iter().map(|(_, id)| self.producer(*id)))
    }

    /// Returns for each pass whether it is one of these, or one of them depends on it.
    pub fn upstream(&self, passes: impl IntoIterator<Item = PassId>) -> Vec<bool> {
        let mut found = vec![false; self.passes.len()];
        let mut open: Vec<PassId> = passes.into_iter().collect();
        while let Some(pass) = open.pop() {
            let at = pass.0 as usize;
            if std::mem::replace(&mut found[at], true) {
                continue;
            }
            for input in &self.passes[at].inputs {
                open.push(input.producer);
                open.extend(input.members.iter().map(|(_, id)| self.producer(*id)));
            }
        }
        found
    }

    /// Returns the plan as text: every pass in order with what it reads and writes, why the others do not run, and how
    /// much memory it needs.
    pub fn to_text(&self) -> String {
        text::text(self)
    }

    /// Returns the plan as a graph for Graphviz.
    pub fn to_dot(&self) -> String {
        dot::dot(self)
    }

    /// Returns the plan as JSON.
    pub fn to_json(&self) -> serde_json::Value {
        json::json(self)
    }

    /// Returns the plan as a drawing: a box for each pass and output, from left to right in the order of data. What does
    /// not run is below.
    pub fn drawing(&self) -> Drawing {
        drawing::drawing(self)
    }

    /// Returns the drawing of the plan as SVG, with boxes colored by whether they run.
    pub fn to_svg(&self) -> String {
        svg::svg(self)
    }

    /// Returns the links that are read by a pass: the producer, the port of the reader, what is
    /// read, and whether it is the past.
    fn links(&self, pass: &PlannedPass) -> Vec<DrawnLink> {
        let link = |input: &PlannedInput| {
            (!input.members.is_empty()).then(|| DrawnLink {
                producer: input.producer,
                input: input.port.clone(),
                port: input.producer_port.to_string(),
                past: input.history.is_some(),
            })
        };
        pass.inputs.iter().filter_map(link).collect()
    }

    /// Returns the pass whose port an output shows.
    fn shown_by(&self, output: &PlannedOutput) -> Option<PassId> {
        self.pass(output.from.split('.').next().unwrap_or(""))
    }
}

/// A link as drawn.
struct DrawnLink {
    producer: PassId,
    input: Name,
    port: String,
    past: bool,
}

impl fmt::Display for Fate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = |readers: &[Name]| readers.iter().map(Name::as_str).collect::<Vec<_>>().join(", ");
        match self {
            Fate::Kept { readers } if readers.is_empty() => f.write_str("kept: asked for"),
            Fate::Kept { readers } => write!(f, "kept: read by {}", names(readers)),
            Fate::Culled { readers } if readers.is_empty() => f.write_str("culled: nothing reads it"),
            Fate::Culled { readers } => {
                write!(f, "culled: no output needs what reads it ({})", names(readers))
            }
            Fate::Off { why, instead } => write!(f, "off: {why}; in its place: {instead}"),
        }
    }
}

impl fmt::Display for Memory {
    /// One line: unshared, shared, bound, persistent.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "transient {} in {} objects (unshared {}, lower bound {}); persistent {}",
            human_bytes(self.shared),
            self.objects,
            human_bytes(self.unshared),
            human_bytes(self.bound),
            human_bytes(self.persistent)
        )
    }
}
