//! From a flat description to a graph: switches, ports, interfaces, sizes.

mod answers;
mod checks;
mod cycle;
mod handed;
mod idle;
mod joints;
mod limits;
mod needs;
mod sizes;
mod switches;
mod unite;
mod uses;
mod wires;

pub use unite::{name_in_united, original_name, unite};

use crate::codes;
use crate::description::{Body, HistoryPolicy, Link, OutputDecl};
use crate::interface::Interface;
use crate::port::{Facts, OutputOverride, PassTypes, SceneBindings, Usage};
use crate::resolve::{Node, Resolved};
use crate::resource::ResourceDesc;
use data_file::{Diagnostic, Diagnostics, Name, Place, Settings, Span, Traits};
use petgraph::Direction::Incoming;
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::EdgeRef as _;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;
use uses::UseOf;
use wires::{End, Found, is_bare};

/// What a graph depends on in addition to its description.
#[derive(Clone, Debug, Default)]
pub struct LinkContext {
    /// Size of the frame in pixels.
    pub frame: (u32, u32),
    /// The traits of the scene: what it contains.
    pub traits: Traits,
}

/// A linked graph.
#[derive(Clone, Debug)]
pub struct Graph {
    pub(crate) frame: (u32, u32),
    /// The passes in the order of the file, and the links from producers to readers.
    pub(crate) passes: DiGraph<GraphPass, GraphLink>,
    pub(crate) outputs: Vec<GraphOutput>,
    /// The passes that were left out: see [`link`].
    pub(crate) left_out: Vec<Name>,
}

/// A pass of a graph.
#[derive(Clone, Debug)]
pub(crate) struct GraphPass {
    pub(crate) name: Name,
    pub(crate) kind: Name,
    pub(crate) shader: Option<Name>,
    pub(crate) settings: Arc<Settings>,
    pub(crate) overrides: Arc<BTreeMap<String, OutputOverride>>,
    pub(crate) scene_bindings: SceneBindings,
    pub(crate) depends_on: SceneBindings,
    pub(crate) remembers: bool,
    pub(crate) history: Option<Arc<HistoryPolicy>>,
    pub(crate) outputs: GraphPorts,
    pub(crate) off: Option<GraphOff>,
}

/// What is reported about a pass that is off.
#[derive(Clone, Debug)]
pub(crate) struct GraphOff {
    pub(crate) why: String,
    pub(crate) instead: String,
}

/// A link into an input.
#[derive(Clone, Debug)]
pub(crate) struct GraphLink {
    /// The input.
    pub(crate) port: Name,
    pub(crate) from: LinkSource,
    /// Whether it reads the frame before.
    pub(crate) past: bool,
}

impl GraphLink {
    /// Returns whether the reader waits for the producer: not for a history buffer.
    pub(crate) fn waits(&self) -> bool {
        !self.past
    }
}

impl Graph {
    /// Returns the links into a pass, from its last input to its first: petgraph lists the newest edge first.
    pub(crate) fn inputs(&self, pass: NodeIndex) -> impl Iterator<Item = &GraphLink> + Clone {
        self.passes.edges_directed(pass, Incoming).map(|link| link.weight())
    }

    /// Returns the port that a link takes.
    pub(crate) fn port(&self, source: &LinkSource) -> &GraphPort {
        &self.passes[source.pass].outputs[source.port as usize]
    }
}

/// What a link takes from a pass: a port, or one of its resources.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LinkSource {
    pub(crate) pass: NodeIndex,
    pub(crate) port: u32,
    /// Index into the members of the [`GraphPort`].
    pub(crate) member: Option<u32>,
    /// Whether the one resource goes without its member's name.
    pub(crate) bare: bool,
}

/// The outputs of a pass, then its scratch. Passes that their pass type cannot distinguish share them.
pub(crate) type GraphPorts = Arc<[GraphPort]>;

/// The outputs of a node; `None` where they are not known yet, or the node is no pass.
type Described = Option<GraphPorts>;

/// An output port, or scratch.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GraphPort {
    pub(crate) port: Name,
    /// Empty for scratch.
    pub(crate) interface: Name,
    pub(crate) members: SmallVec<[(Name, ResourceDesc, Made); 1]>,
    pub(crate) facts: Arc<Facts>,
}

/// Where the content of a resource of an output comes from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Made {
    /// The pass makes it.
    Here(Usage),
    /// It is this member of what is linked to this input.
    Handed { input: Name, member: Name },
}

/// An output of the pipeline.
#[derive(Clone, Debug)]
pub(crate) struct GraphOutput {
    pub(crate) name: Name,
    pub(crate) from: LinkSource,
}

/// Links a flat description.
///
/// A pass that a file inherits, that no output needs and that does not fit what the file changes is left out.
///
/// # Errors
/// Everything that is wrong with pass types, settings, links, switches and sizes; also in passes that are off.
pub fn link(resolved: &Resolved, kinds: &dyn PassTypes, context: &LinkContext) -> Result<Graph, Diagnostics> {
    link_all(resolved, kinds, context)
        .or_else(|errors| idle::link_without_idle(resolved, kinds, context, errors))
}

/// Links all passes.
fn link_all(resolved: &Resolved, kinds: &dyn PassTypes, context: &LinkContext) -> Result<Graph, Diagnostics> {
    let mut linker = Linker::new(resolved, kinds, context);
    linker.check_root();
    linker.find_uses();
    if linker.errors.is_empty() {
        linker.errors = resolved.check_defaults(kinds);
    }
    linker.check_switches();
    linker.find_wires();
    linker.find_switches();
    linker.find_live_wires();
    linker.find_outputs();
    let (links, order) = linker.order();
    linker.find_instead();
    if !linker.errors.is_empty() {
        return Err(linker.into_errors());
    }
    let nodes: Vec<u32> = order.iter().map(|pass| links[*pass]).collect();
    let ports = linker.find_sizes(&nodes);
    if !linker.errors.is_empty() {
        return Err(linker.into_errors());
    }
    Ok(linker.graph(&links, ports, &order))
}

/// What a pass takes of the links that its file names.
pub(crate) struct Taken {
    /// For each link, whether there is an input of that name.
    pub(crate) links: Vec<bool>,
    /// The input that takes what an insertion feeds to it.
    pub(crate) feed: Option<Name>,
    /// Whether the pass has another sample of the picture in each frame.
    pub(crate) sampled: bool,
}

/// Returns what each node of a description takes; `None` where it is no pass, or its pass type cannot say.
pub(crate) fn taken(resolved: &Resolved, kinds: &dyn PassTypes) -> Vec<Option<Taken>> {
    let context = LinkContext::default();
    let mut linker = Linker::new(resolved, kinds, &context);
    linker.find_uses();
    linker.find_wires();
    let taken = |(i, used): (usize, &Option<Rc<UseOf>>)| {
        let (used, fed) = (used.as_ref()?, linker.nodes[i].decl.links.len() as u32);
        let feed = linker.wires[i].iter().find(|wire| wire.link == fed);
        Some(Taken {
            links: used.linked.iter().map(Option::is_some).collect(),
            feed: feed.map(|wire| used.names.inputs[wire.input as usize].0.clone()),
            sampled: used.ports.scene_bindings.contains(SceneBindings::SAMPLE),
        })
    };
    linker.uses.iter().enumerate().map(taken).collect()
}

/// The work of linking: one entry a node in each list.
struct Linker<'a> {
    resolved: &'a Resolved,
    nodes: &'a [Node],
    kinds: &'a dyn PassTypes,
    interfaces: &'a [Interface],
    context: &'a LinkContext,
    uses: Rc<Vec<Option<Rc<UseOf>>>>,
    /// Wires as if everything were on.
    wires: Vec<Wires>,
    /// Wires with what is off taken out; empty where nothing can be off.
    live: Vec<Wires>,
    /// Whether a node is on; known from the beginning where it has no switch.
    on: Vec<Option<bool>>,
    /// Why nodes are off, where their own switches say so.
    why: FxHashMap<usize, String>,
    /// What stands in place of passes that are off, where a link says so.
    instead: FxHashMap<usize, String>,
    outputs: Vec<(&'a OutputDecl, End)>,
    /// Links of sub-graphs that are wrong and have been reported.
    bad_borders: Vec<Place>,
    errors: Vec<Diagnostic>,
}

/// The wires of a pass: most have few.
type Wires = SmallVec<[Wire; 2]>;

/// The passes, as indices of nodes, and the wires from producers to readers.
type Links = DiGraph<u32, Wire>;

/// A link that has been followed to its end.
#[derive(Clone, Copy, Debug)]
struct Wire {
    /// Index into the inputs of the pass type's ports.
    input: u32,
    end: End,
    /// Index into the links of the description; the number of links for its `feed`.
    link: u32,
}

impl<'a> Linker<'a> {
    fn new(resolved: &'a Resolved, kinds: &'a dyn PassTypes, context: &'a LinkContext) -> Linker<'a> {
        Linker {
            resolved,
            nodes: &resolved.nodes,
            kinds,
            interfaces: kinds.interfaces(),
            context,
            uses: Rc::default(),
            wires: Vec::with_capacity(resolved.nodes.len()),
            live: Vec::new(),
            on: Vec::with_capacity(resolved.nodes.len()),
            why: FxHashMap::default(),
            instead: FxHashMap::default(),
            outputs: Vec::new(),
            bad_borders: Vec::new(),
            errors: Vec::new(),
        }
    }

    fn into_errors(self) -> Diagnostics {
        Diagnostics::sorted(self.errors)
    }

    /// Returns what `look` finds, without the errors that it reports: they are reported elsewhere.
    fn silently<T>(&mut self, look: impl FnOnce(&mut Self) -> T) -> T {
        let count = self.errors.len();
        let found = look(self);
        self.errors.truncate(count);
        found
    }

    fn span(&self, place: Place) -> Span {
        self.resolved.sources.span(place)
    }

    /// Returns the link of a wire.
    fn link_of(&self, node: usize, wire: &Wire) -> &'a Link {
        let decl = &self.nodes[node].decl;
        let feed = decl.feed.as_ref();
        decl.links.get(wire.link as usize).or(feed).expect("a wire is made from a link or a feed")
    }

    fn check_root(&mut self) {
        if let Some(input) = self.resolved.inputs.first() {
            let message = format!("this file is a sub-graph: it needs an input `{}`", input.name.value);
            let error = Diagnostic::new(&codes::SUB_AS_PIPELINE, message)
                .label(self.span(input.name.place), format!("`{}` is expected here", input.interface.value))
                .note("use it in a pipeline with `Sub(file: …, in: { … })`");
            self.errors.push(error);
        }
        if self.resolved.outputs.is_empty() {
            let span = Span { source: Arc::clone(&self.resolved.sources.0[0]), start: 0, end: 0 };
            let error = Diagnostic::new(&codes::NO_OUTPUTS, "the pipeline has no outputs")
                .label(span, "")
                .note("add outputs: { \"image\": \"pass\" }");
            self.errors.push(error);
        }
    }

    /// Follows the outputs of the pipeline to their ends.
    fn find_outputs(&mut self) {
        for output in &self.resolved.outputs {
            let link = &output.link;
            // It must be sound with everything on, and lead somewhere as things are. What shows a pass that a
            // patch took out goes with it.
            let found = match self.follow(link, None, false) {
                Found::End(_) => self.follow(link, None, true),
                Found::Nothing(_) | Found::Reported => continue,
            };
            match found {
                Found::End(end) => {
                    self.check_output(output, &end);
                    self.outputs.push((output, end));
                }
                Found::Nothing(off) => {
                    let error = self.off_read(format!("the output `{}`", output.name.value), link, off);
                    self.errors.push(error);
                }
                Found::Reported => {}
            }
        }
    }

    fn wires_now(&self, node: usize) -> &[Wire] {
        if self.live.is_empty() { &self.wires[node] } else { &self.live[node] }
    }

    fn graph(self, links: &Links, ports: Vec<Described>, order: &[NodeIndex]) -> Graph {
        let source = |pass: NodeIndex, end: &End, bare: bool| {
            let port = ports[end.node as usize].as_ref().and_then(|ports| ports.get(end.port as usize));
            let member = port.zip(self.member(&self.interface_of(end), end.member));
            let member = member.and_then(|(port, name)| port.members.iter().position(|(n, _, _)| *n == name));
            LinkSource { pass, port: end.port, member: member.map(|m| m as u32), bare }
        };
        let none = GraphPorts::default();
        let pass = |pass: NodeIndex, node: usize| {
            let (Some(used), Body::Pass { kind, shader }) = (&self.uses[node], &self.nodes[node].decl.body)
            else {
                unreachable!("only passes are linked")
            };
            let modules = links
                .edges_directed(pass, Incoming)
                .map(|link| &link.weight().end)
                .filter(|end| end.member.is_none())
                .filter_map(|end| ports[end.node as usize].as_ref()?[end.port as usize].facts.module());
            let scene_bindings =
                modules.fold(used.ports.scene_bindings, |all, module| all.and(module.scene_bindings));
            GraphPass {
                name: self.nodes[node].name.clone(),
                kind: kind.value.clone(),
                shader: shader.as_ref().map(|s| s.value.clone()),
                settings: Arc::clone(&used.settings),
                overrides: Arc::clone(&self.nodes[node].decl.overrides),
                scene_bindings,
                depends_on: scene_bindings,
                remembers: false,
                history: self.nodes[node].decl.history.as_ref().map(|policy| Arc::clone(&policy.value)),
                outputs: ports[node].clone().unwrap_or_else(|| Arc::clone(&none)),
                off: (self.on[node] == Some(false)).then(|| self.off(node)),
            }
        };
        let link = |producer: NodeIndex, reader: NodeIndex, wire: &Wire| {
            let used = self.uses[links[reader] as usize].as_ref().expect("only passes are linked");
            let (port, wanted) = &used.names.inputs[wire.input as usize];
            GraphLink {
                port: port.clone(),
                from: source(producer, &wire.end, is_bare(wanted, &wire.end)),
                past: wire.end.past,
            }
        };
        let ends = |edge| links.edge_endpoints(edge).expect("an edge of the graph");
        let mut passes = links.map(
            |index, node| pass(index, *node as usize),
            |edge, wire| {
                let (producer, reader) = ends(edge);
                link(producer, reader, wire)
            },
        );
        let pass_of = |node: u32| {
            let pass = links.raw_nodes().binary_search_by_key(&node, |pass| pass.weight);
            NodeIndex::new(pass.expect("outputs lead to passes"))
        };
        let output = |(output, end): &(&OutputDecl, End)| GraphOutput {
            name: output.name.value.clone(),
            from: source(pass_of(end.node), end, end.member.is_some()),
        };
        let outputs = self.outputs.iter().map(output).collect();
        dependencies(&mut passes, order);
        Graph { frame: self.context.frame, passes, outputs, left_out: Vec::new() }
    }
}

/// Unites what each pass depends on over all that it reads.
fn dependencies(passes: &mut DiGraph<GraphPass, GraphLink>, order: &[NodeIndex]) {
    let loops = passes.edge_weights().any(|link| link.past);
    loop {
        let mut changed = false;
        for pass in order {
            let (mut depends_on, mut remembers) = (passes[*pass].depends_on, passes[*pass].remembers);
            for link in passes.edges_directed(*pass, Incoming) {
                let producer = &passes[link.source()];
                depends_on = depends_on.and(producer.depends_on);
                remembers |= producer.remembers || link.weight().past;
            }
            let pass = &mut passes[*pass];
            changed |= (pass.depends_on, pass.remembers) != (depends_on, remembers);
            (pass.depends_on, pass.remembers) = (depends_on, remembers);
        }
        // The order follows the data of one frame; what comes out of history buffers may need another round.
        if !(loops && changed) {
            return;
        }
    }
}
