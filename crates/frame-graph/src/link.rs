//! From a flat description to a graph: switches, ports, interfaces, sizes.

mod answers;
mod checks;
mod cycle;
mod handed;
mod joints;
mod limits;
mod needs;
mod sizes;
mod switches;
mod uses;
mod wires;

use crate::codes;
use crate::description::{Body, Link, OutputDecl, Past};
use crate::diagnostic::{Diagnostic, Diagnostics, Place, Span};
use crate::interface::Interface;
use crate::port::{Facts, OutputOverride, PassTypes, SceneBindings, Usage};
use crate::resolve::{Node, Resolved, told_once};
use crate::resource::{Clear, ResourceDesc};
use crate::value::{Settings, Traits};
use data_file::Name;
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
    /// Every pass, in the order of the file.
    pub(crate) passes: Vec<GraphPass>,
    pub(crate) outputs: Vec<GraphOutput>,
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
    pub(crate) inputs: SmallVec<[GraphInput; 2]>,
    pub(crate) outputs: GraphPorts,
    pub(crate) off: Option<GraphOff>,
}

/// What is reported about a pass that is off.
#[derive(Clone, Debug)]
pub(crate) struct GraphOff {
    pub(crate) why: String,
    pub(crate) instead: String,
}

/// A connected input.
#[derive(Clone, Debug)]
pub(crate) struct GraphInput {
    pub(crate) port: Name,
    pub(crate) from: LinkSource,
    pub(crate) past: Option<Arc<Past>>,
    /// What is put in place of a producer that is off.
    pub(crate) constant: Option<Clear>,
}

/// What a link takes from a pass: a port, or one of its resources.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct LinkSource {
    pub(crate) pass: u32,
    pub(crate) port: u32,
    /// Index into the members of the [`GraphPort`].
    pub(crate) member: Option<u32>,
    /// Whether the one resource goes without its member's name.
    pub(crate) bare: bool,
}

/// The outputs of a pass, then its scratch. Passes between which their pass type cannot tell share them.
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
    pub(crate) constant: Option<Clear>,
}

/// Links a flat description.
///
/// # Errors
/// Everything that is wrong with pass types, settings, links, switches and sizes; also in passes that are off.
pub fn link(resolved: &Resolved, kinds: &dyn PassTypes, context: &LinkContext) -> Result<Graph, Diagnostics> {
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
    let order = linker.order();
    linker.find_instead();
    if !linker.errors.is_empty() {
        return Err(linker.told());
    }
    let ports = linker.find_sizes(&order);
    if !linker.errors.is_empty() {
        return Err(linker.told());
    }
    Ok(linker.graph(ports, &order))
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
    wires: Vec<Wires<'a>>,
    /// Wires with what is off taken out; empty where nothing can be off.
    live: Vec<Wires<'a>>,
    /// Whether a node is on; known from the beginning where it has no switch.
    on: Vec<Option<bool>>,
    /// Why nodes are off, where their own switches say so.
    why: FxHashMap<usize, String>,
    /// What stands in place of passes that are off, where a link says so.
    instead: FxHashMap<usize, String>,
    /// Whether some sub-graph is repeated 0 times.
    copyless: bool,
    /// How many switches wait for each other.
    depth: u32,
    outputs: Vec<(&'a OutputDecl, End<'a>)>,
    /// Links of sub-graphs that are wrong and have been reported.
    bad_borders: Vec<Place>,
    errors: Vec<Diagnostic>,
}

/// The wires of a pass: most have few.
type Wires<'a> = SmallVec<[Wire<'a>; 2]>;

/// A link that has been followed to its end.
#[derive(Clone, Copy, Debug)]
struct Wire<'a> {
    /// Index into the inputs of the pass type's ports.
    input: u32,
    end: End<'a>,
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
            copyless: resolved.nodes.iter().any(
                |node| matches!(&node.decl.body, Body::Group(group) if matches!(group.copies, Some((0, _)))),
            ),
            depth: 0,
            outputs: Vec::new(),
            bad_borders: Vec::new(),
            errors: Vec::new(),
        }
    }

    fn told(self) -> Diagnostics {
        Diagnostics::sorted(told_once(self.errors, self.nodes))
    }

    fn span(&self, place: Place) -> Span {
        self.resolved.sources.span(place)
    }

    /// The link of a wire.
    fn link_of(&self, node: usize, wire: &Wire<'_>) -> &'a Link {
        let decl = &self.nodes[node].decl;
        let feed = decl.feed.as_ref();
        decl.links.get(wire.link as usize).or(feed).expect("a wire is made from a link or a feed")
    }

    fn check_root(&mut self) {
        if let Some(input) = self.resolved.inputs.iter().find(|input| !input.optional) {
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
                Found::Nothing(off) if self.without_copy(off).is_some() => Found::Nothing(off),
                Found::Nothing(_) | Found::Unlinked | Found::Told => continue,
            };
            match found {
                Found::End(end) => self.outputs.push((output, end)),
                Found::Nothing(off) => {
                    let error = self.off_read(format!("the output `{}`", output.name.value), link, off);
                    self.errors.push(error);
                }
                Found::Unlinked | Found::Told => {}
            }
        }
    }

    fn wires_now(&self, node: usize) -> &[Wire<'a>] {
        if self.live.is_empty() { &self.wires[node] } else { &self.live[node] }
    }

    fn graph(self, mut ports: Vec<Described>, order: &[u32]) -> Graph {
        const NONE: u32 = u32::MAX;
        // Sub-graphs are no passes: passes get indices of their own.
        let mut index = vec![NONE; self.nodes.len()];
        let mut count = 0;
        for (i, used) in self.uses.iter().enumerate() {
            if used.is_some() {
                index[i] = count;
                count += 1;
            }
        }
        let source = |end: &End<'_>, bare: bool| {
            let port = ports[end.node as usize].as_ref().and_then(|ports| ports.get(end.port as usize));
            let member = port.zip(self.member(&self.interface_of(end), end.member));
            let member = member.and_then(|(port, name)| port.members.iter().position(|(n, _, _)| *n == name));
            LinkSource {
                pass: index[end.node as usize],
                port: end.port,
                member: member.map(|m| m as u32),
                bare,
            }
        };
        let mut passes = Vec::with_capacity(count as usize);
        let none = GraphPorts::default();
        for i in 0..self.nodes.len() {
            let Some(used) = &self.uses[i] else { continue };
            let Body::Pass { kind, shader } = &self.nodes[i].decl.body else { continue };
            let is_on = self.on[i] != Some(false);
            // Of a pass that is off, what it would read.
            let wires = if is_on { self.wires_now(i) } else { &self.wires[i] };
            let modules = wires
                .iter()
                .filter(|wire| wire.end.constant.is_none() && wire.end.member.is_none())
                .filter_map(|wire| {
                    ports[wire.end.node as usize].as_ref()?[wire.end.port as usize].facts.module()
                });
            let scene_bindings =
                modules.fold(used.ports.scene_bindings, |all, module| all.and(module.scene_bindings));
            let inputs = wires.iter().map(|wire| {
                let (port, wanted) = &used.names.inputs[wire.input as usize];
                GraphInput {
                    port: port.clone(),
                    from: source(&wire.end, is_bare(wanted, &wire.end)),
                    past: wire.end.past.filter(|_| wire.end.constant.is_none()).cloned(),
                    constant: wire.end.constant,
                }
            });
            passes.push(GraphPass {
                name: self.nodes[i].name.clone(),
                kind: kind.value.clone(),
                shader: shader.as_ref().map(|s| s.value.clone()),
                settings: Arc::clone(&used.settings),
                overrides: Arc::clone(&self.nodes[i].decl.overrides),
                scene_bindings,
                depends_on: scene_bindings,
                remembers: false,
                inputs: inputs.collect(),
                outputs: Arc::clone(&none),
                off: if is_on { None } else { Some(self.off(i)) },
            });
        }
        let output = |(output, end): &(&OutputDecl, End<'_>)| GraphOutput {
            name: output.name.value.clone(),
            from: source(end, end.member.is_some()),
            constant: end.constant,
        };
        let outputs = self.outputs.iter().map(output).collect();
        for (i, ports) in ports.iter_mut().enumerate().filter(|(i, _)| index[*i] != NONE) {
            passes[index[i] as usize].outputs = ports.take().unwrap_or_else(|| Arc::clone(&none));
        }
        let order: Vec<u32> = order.iter().map(|i| index[*i as usize]).filter(|i| *i != NONE).collect();
        dependencies(&mut passes, &order);
        Graph { frame: self.context.frame, passes, outputs }
    }
}

/// Unites what each pass depends on over all that it reads.
fn dependencies(passes: &mut [GraphPass], order: &[u32]) {
    let loops = passes.iter().any(|pass| pass.inputs.iter().any(|input| input.past.is_some()));
    loop {
        let mut changed = false;
        for i in order {
            let pass = &passes[*i as usize];
            let (mut depends_on, mut remembers) = (pass.depends_on, pass.remembers);
            for input in pass.inputs.iter().filter(|input| input.constant.is_none()) {
                let producer = &passes[input.from.pass as usize];
                depends_on = depends_on.and(producer.depends_on);
                remembers |= producer.remembers || input.past.is_some();
            }
            let pass = &mut passes[*i as usize];
            changed |= (pass.depends_on, pass.remembers) != (depends_on, remembers);
            (pass.depends_on, pass.remembers) = (depends_on, remembers);
        }
        // The order follows the data of one frame; what comes out of the past may need another round.
        if !(loops && changed) {
            return;
        }
    }
}
