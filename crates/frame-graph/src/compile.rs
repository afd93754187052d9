//! From a graph to a plan: cull, order, lifetimes, sharing.

pub(crate) mod identity;
mod memory;
mod needs;
mod numbers;
mod order;

use crate::frame::ResetCause;
use crate::link::{Graph, GraphLink, LinkSource, Made};
use crate::plan::{
    AllocationId, Begins, Continued, Fate, History, HistoryId, Memory, PassId, Plan, PlanId, PlannedInput,
    PlannedMembers, PlannedOutput, PlannedPass, PlannedPort, PlannedResource, ResourceId,
};
use crate::port::{SceneBindings, Usage};
use data_file::{Diagnostics, Name};
use numbers::Numbers;
use petgraph::Direction::Outgoing;
use petgraph::graph::NodeIndex;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;

/// Options of compiling.
#[derive(Clone, Debug, PartialEq)]
pub struct CompileOptions {
    /// Whether transient resources share objects.
    pub sharing: bool,
    /// Names of the requested outputs; all if empty. Passes that none of them needs are culled.
    pub outputs: Vec<String>,
    /// Further resources to keep for readback, as `pass`, `pass.port`, `pass.member` or `pass.port.member`.
    /// The passes that write them are not culled.
    pub keep: Vec<String>,
    /// Interfaces whose resources are kept if a pass that runs writes them; this keeps no pass from being
    /// culled.
    pub keep_interfaces: Vec<String>,
}

impl Default for CompileOptions {
    fn default() -> CompileOptions {
        CompileOptions { sharing: true, outputs: Vec::new(), keep: Vec::new(), keep_interfaces: Vec::new() }
    }
}

/// Compiles a graph.
///
/// # Errors
/// If an output or a resource is requested that the graph does not have.
pub fn compile(graph: &Graph, options: &CompileOptions) -> Result<Plan, Diagnostics> {
    let mut work = Work::new(graph);
    work.want(options)?;
    work.cull();
    work.keep_made(&options.keep_interfaces);
    let by_file = order::by_file(&work);
    work.trace(&by_file);
    let order = order::order(&work, by_file);
    Ok(work.plan(&order, options))
}

/// No index.
const NONE: u32 = u32::MAX;

/// The state of compiling. Resources are numbered by pass, port and member of the graph.
struct Work<'a> {
    graph: &'a Graph,
    numbers: Numbers,
    resources: Vec<Resource>,
    /// The passes that are needed.
    needed: Vec<bool>,
    /// Indices of the requested outputs.
    wanted: Vec<u32>,
}

/// Maps the resources of the graph to those of the plan.
struct Ids {
    /// For each resource, its index in the plan.
    resources: Vec<u32>,
    /// For each port of a needed pass, its members in the plan.
    ports: Vec<PlannedMembers>,
}

/// The properties of a resource that compiling needs.
#[derive(Clone, Debug)]
struct Resource {
    bytes: u64,
    /// Whether it outlives its last reader.
    persistent: bool,
    /// Number of links of needed passes that read it in the same frame.
    readers: u32,
    /// The pass that writes it.
    pass: NodeIndex,
    /// Number of links of needed passes that read its history buffer.
    past_readers: u32,
    /// Index of its history buffer.
    history: u32,
    /// Whether anything reads it, in this frame or the next.
    read: bool,
}

impl<'a> Work<'a> {
    fn new(graph: &'a Graph) -> Work<'a> {
        let count = graph.passes.node_count();
        let mut first_port = Vec::with_capacity(count + 1);
        let mut ports = Vec::with_capacity(count * 2 + 1);
        let mut resources = Vec::with_capacity(count * 2);
        let mut hands = false;
        for pass in graph.passes.node_indices() {
            first_port.push(ports.len() as u32);
            for port in &*graph.passes[pass].outputs {
                ports.push(resources.len() as u32);
                for (_, desc, made) in &port.members {
                    hands |= matches!(made, Made::Handed { .. });
                    resources.push(Resource {
                        bytes: desc.bytes(),
                        pass,
                        persistent: false,
                        readers: 0,
                        past_readers: 0,
                        history: NONE,
                        read: false,
                    });
                }
            }
        }
        first_port.push(ports.len() as u32);
        ports.push(resources.len() as u32);
        let made = (0..resources.len() as u32).collect();
        let mut numbers = Numbers { first_port, ports, made };
        if hands {
            numbers.trace_handed(graph);
        }
        Work { graph, numbers, resources, needed: vec![false; count], wanted: Vec::new() }
    }

    /// Returns whether a pass writes anything: one that only hands on resources has no work in any frame.
    fn makes(&self, pass: NodeIndex) -> bool {
        self.numbers.made_by(pass).next().is_some()
    }

    fn runs(&self, pass: NodeIndex) -> bool {
        self.needed[pass.index()] && self.graph.passes[pass].off.is_none()
    }

    /// Returns the passes that run, in the order of the file.
    fn running(&self) -> impl Iterator<Item = NodeIndex> + '_ {
        self.graph.passes.node_indices().filter(|pass| self.runs(*pass))
    }

    /// Returns the resources of this frame that a pass reads, once for each link.
    fn reads(&self, pass: NodeIndex) -> impl Iterator<Item = usize> + '_ {
        let links = self.graph.inputs(pass).filter(|link| link.waits());
        links.flat_map(|link| self.numbers.of_source(&link.from))
    }

    /// Finds resources that must outlive their last reader, since their producer may be skipped when a reader
    /// is not.
    fn trace(&mut self, order: &[NodeIndex]) {
        // What makes a pass run again: bits for the scene bindings, then for history buffers. Two history
        // buffers may share a bit; then a pass may run once too often, which costs time but is never wrong.
        let mut sources = vec![0u64; self.graph.passes.node_count()];
        let graph = self.graph;
        let reads = |pass: &NodeIndex, what| graph.passes[*pass].scene_bindings.contains(what);
        let is_sampled = order.iter().any(|pass| reads(pass, SceneBindings::SAMPLE));
        // Where the frame is no sample, seeds stay as they are.
        let ignored = if is_sampled { SceneBindings::NONE } else { SceneBindings::SEED };
        for pass in order {
            let mut bits = u64::from(graph.passes[*pass].scene_bindings.0 & !ignored.0);
            for link in graph.inputs(*pass) {
                for r in self.numbers.of_source(&link.from) {
                    bits |= match link.past {
                        true => 1 << (8 + self.resources[r].history % 56),
                        false => sources[self.resources[r].pass.index()],
                    };
                }
            }
            sources[pass.index()] = bits;
            if !self.makes(*pass) {
                continue;
            }
            for link in graph.inputs(*pass).filter(|link| link.waits()) {
                for r in self.numbers.of_source(&link.from) {
                    let made = sources[self.resources[r].pass.index()];
                    // A producer that runs in every frame is never skipped.
                    if made != bits && made & u64::from(SceneBindings::FRAME.0) == 0 {
                        self.resources[r].persistent = true;
                    }
                }
            }
        }
    }

    fn plan(self, order: &[NodeIndex], options: &CompileOptions) -> Plan {
        let graph = self.graph;
        let mut position = vec![NONE; graph.passes.node_count()];
        for (at, pass) in order.iter().enumerate() {
            position[pass.index()] = at as u32;
        }
        let mut plan = Plan {
            id: PlanId(0),
            structure: PlanId(0),
            frame: graph.frame,
            passes: Vec::with_capacity(order.len()),
            resources: Vec::with_capacity(self.resources.len()),
            allocations: Vec::with_capacity(self.resources.len()),
            histories: Vec::new(),
            outputs: Vec::with_capacity(self.wanted.len()),
            fates: Vec::with_capacity(position.len()),
            memory: Memory::default(),
        };
        let ids = self.plan_resources(&mut plan, order);
        self.plan_passes(&mut plan, order, &position, &ids);
        for i in &self.wanted {
            let output = &graph.outputs[*i as usize];
            let port = graph.port(&output.from);
            let pass = &graph.passes[output.from.pass].name;
            let member = output.from.member.map_or("", |m| &*port.members[m as usize].0);
            let dot = if member.is_empty() { "" } else { "." };
            plan.outputs.push(PlannedOutput {
                name: output.name.clone(),
                from: Name::from(format!("{pass}.{}{dot}{member}", port.port)),
                interface: self.interface(&output.from),
                members: self.members(&output.from, &ids),
            });
        }
        memory::share(&mut plan, options.sharing);
        plan.fates = self.fates(&position);
        (plan.structure, plan.id) = identity::of(&plan);
        plan
    }

    /// Numbers the resources in the order in which they are written.
    fn plan_resources(&self, plan: &mut Plan, order: &[NodeIndex]) -> Ids {
        let graph = self.graph;
        let mut ids = vec![NONE; self.resources.len()];
        let mut name = String::new();
        for (at, i) in order.iter().enumerate() {
            let (at, i) = (at as u32, *i);
            let pass = &graph.passes[i];
            let members = pass.outputs.iter().flat_map(|port| port.members.iter().map(move |m| (port, m)));
            for (r, (port, (member, desc, _))) in self.numbers.of_pass(i).zip(members) {
                let resource = &self.resources[r];
                let handed = self.numbers.made[r] as usize != r;
                if handed {
                    continue;
                }
                ids[r] = plan.resources.len() as u32;
                name.clear();
                for part in [&*pass.name, ".", &port.port, if member.is_empty() { "" } else { "." }, member] {
                    name.push_str(part);
                }
                plan.resources.push(PlannedResource {
                    name: Name::from(name.as_str()),
                    desc: desc.clone(),
                    allocation: AllocationId(NONE),
                    producer: PassId(at),
                    readers: SmallVec::with_capacity(resource.readers as usize),
                    lifetime: (at, at),
                    persistent: resource.persistent,
                    history: (resource.history != NONE).then_some(HistoryId(resource.history)),
                });
            }
        }
        for r in 0..ids.len() {
            ids[r] = ids[self.numbers.made[r] as usize];
        }
        let mut ports = Vec::with_capacity(self.numbers.ports.len());
        for i in graph.passes.node_indices() {
            for (at, port) in graph.passes[i].outputs.iter().enumerate() {
                ports.push(if self.needed[i.index()] {
                    let ids = &ids[self.numbers.of_port(i, at as u32)];
                    port.members
                        .iter()
                        .zip(ids)
                        .map(|((name, ..), id)| (name.clone(), ResourceId(*id)))
                        .collect()
                } else {
                    PlannedMembers::default()
                });
            }
        }
        Ids { ports, resources: ids }
    }

    fn interface(&self, source: &LinkSource) -> Name {
        let port = self.graph.port(source);
        if source.member.is_none() {
            return port.interface.clone();
        }
        let first = self.numbers.in_port(source).start - self.numbers.of_port(source.pass, source.port).start;
        let texture = port.members.get(first).is_some_and(|(_, desc, _)| desc.texture().is_some());
        Name::new(if texture { "Texture" } else { "Buffer" })
    }

    fn members(&self, source: &LinkSource, ids: &Ids) -> PlannedMembers {
        if source.member.is_none() && !source.bare {
            return ids.ports[self.numbers.port(source.pass, source.port)].clone();
        }
        let port = self.graph.port(source);
        let first = self.numbers.of_port(source.pass, source.port).start;
        let name = |r: usize| if source.bare { Name::default() } else { port.members[r - first].0.clone() };
        self.numbers.in_port(source).map(|r| (name(r), ResourceId(ids.resources[r]))).collect()
    }

    fn plan_passes(&self, plan: &mut Plan, order: &[NodeIndex], position: &[u32], ids: &Ids) {
        let histories = self.resources.iter().filter(|r| r.history != NONE).count();
        let unset = History {
            resource: ResourceId(NONE),
            copies: [AllocationId(NONE); 2],
            in_place: false,
            reset: ResetCause::DEFAULT.to_vec(),
            rest: None,
            catches_up: false,
        };
        plan.histories = vec![unset; histories];
        for (at, i) in order.iter().enumerate() {
            let pass = &self.graph.passes[*i];
            let input = |link: &GraphLink| PlannedInput {
                port: link.port.clone(),
                producer: PassId(position[link.from.pass.index()]),
                producer_port: self.graph.port(&link.from).port.clone(),
                interface: self.interface(&link.from),
                members: self.members(&link.from, ids),
                history: self.plan_reads(plan, PassId(at as u32), link, ids),
                facts: self.graph.port(&link.from).facts.clone(),
            };
            let mut inputs: Vec<PlannedInput> = self.graph.inputs(*i).map(input).collect();
            inputs.reverse();
            let mut planned = PlannedPass {
                name: pass.name.clone(),
                kind: pass.kind.clone(),
                shader: pass.shader.clone(),
                settings: pass.settings.clone(),
                overrides: pass.overrides.clone(),
                inputs,
                outputs: Vec::with_capacity(pass.outputs.len()),
                scene_bindings: pass.scene_bindings,
                depends_on: pass.depends_on,
                remembers: pass.remembers,
                clears: Vec::new(),
                continues: Vec::new(),
            };
            self.plan_outputs(plan, *i, &mut planned, ids);
            plan.passes.push(planned);
        }
    }

    /// Adds a pass to the readers of what a link takes; returns the history buffers, if it takes those.
    fn plan_reads(
        &self,
        plan: &mut Plan,
        reader: PassId,
        link: &GraphLink,
        ids: &Ids,
    ) -> Option<Vec<HistoryId>> {
        let resources = self.numbers.of_source(&link.from);
        if !link.past {
            for r in resources {
                let resource = &mut plan.resources[ids.resources[r] as usize];
                if resource.readers.last() != Some(&reader) {
                    resource.readers.push(reader);
                }
                resource.lifetime.1 = resource.lifetime.1.max(reader.0);
            }
            return None;
        }
        let history = |r: usize| {
            let id = self.resources[r].history;
            let history = &mut plan.histories[id as usize];
            history.resource = ResourceId(ids.resources[r]);
            if let Some(policy) = &self.graph.passes[self.resources[r].pass].history {
                history.reset.clone_from(&policy.reset);
                history.rest = policy.rest;
                history.catches_up = policy.catches_up;
            }
            HistoryId(id)
        };
        Some(resources.map(history).collect())
    }

    /// Adds the outputs of a pass.
    fn plan_outputs(&self, plan: &mut Plan, pass: NodeIndex, planned: &mut PlannedPass, ids: &Ids) {
        let mut resources = self.numbers.of_pass(pass);
        for (at, port) in self.graph.passes[pass].outputs.iter().enumerate() {
            let mut connected = false;
            let mut handed = Vec::new();
            for ((name, _, made), r) in port.members.iter().zip(&mut resources) {
                let id = ResourceId(ids.resources[r]);
                connected |= self.resources[r].read;
                match made {
                    Made::Handed { .. } => handed.push((name.clone(), id)),
                    Made::Here(Usage::ClearFirst(clear)) => planned.clears.push((id, *clear)),
                    Made::Here(Usage::Overwrites) => {}
                    Made::Here(Usage::Continue { input, member }) => {
                        let Some(from) = self.begins_as(pass, r, input, member, &ids.resources) else {
                            continue;
                        };
                        if let Begins::InPlace(history) = from {
                            plan.histories[history.0 as usize].in_place = true;
                        }
                        planned.continues.push(Continued { resource: id, input: Name::from(input), from });
                    }
                }
            }
            let all = &ids.ports[self.numbers.port(pass, at as u32)];
            let members = match handed.is_empty() {
                true => all.clone(),
                false => all.iter().filter(|member| !handed.contains(member)).cloned().collect(),
            };
            planned.outputs.push(PlannedPort {
                port: port.port.clone(),
                interface: port.interface.clone(),
                members,
                handed,
                connected,
                facts: port.facts.clone(),
            });
        }
    }

    /// Returns the initial content of a resource that continues an input.
    fn begins_as(&self, pass: NodeIndex, r: usize, input: &str, member: &str, ids: &[u32]) -> Option<Begins> {
        let (input, from) = self.numbers.member_of(self.graph, pass, input, member)?;
        let from = self.numbers.made[from] as usize;
        let made = &self.resources[from];
        let rests = self.graph.passes[made.pass].history.as_ref().is_some_and(|policy| policy.rest.is_some());
        Some(match input.past {
            false => Begins::Copy(ResourceId(ids[from])),
            // Its own history buffer, which no other pass reads. One that rests keeps what its last frame was made of.
            true if from == r && made.past_readers == 1 && !rests => Begins::InPlace(HistoryId(made.history)),
            true => Begins::CopyOfPast(HistoryId(made.history)),
        })
    }

    /// Returns whether each pass runs, and why.
    fn fates(&self, position: &[u32]) -> Vec<(Name, Fate)> {
        let passes = &self.graph.passes;
        let mut outputs: FxHashMap<NodeIndex, Vec<Name>> = FxHashMap::default();
        for i in &self.wanted {
            let output = &self.graph.outputs[*i as usize];
            outputs.entry(output.from.pass).or_default().push(Name::from(format!("out.{}", output.name)));
        }
        let mut fates = Vec::with_capacity(position.len());
        for i in passes.node_indices() {
            // For a kept pass, its kept readers count; for a culled one, all of them.
            let counts = |reader: &NodeIndex| position[reader.index()] != NONE || position[i.index()] == NONE;
            let mut found: SmallVec<[NodeIndex; 8]> =
                passes.neighbors_directed(i, Outgoing).filter(counts).collect();
            found.dedup();
            // Petgraph lists the newest link first, and so the last reader.
            let mut readers: Vec<Name> =
                found.iter().rev().map(|reader| passes[*reader].name.clone()).collect();
            readers.extend(outputs.remove(&i).unwrap_or_default());
            let fate = match &passes[i].off {
                Some(off) => Fate::Off { why: off.why.clone(), instead: off.instead.clone() },
                None if self.runs(i) => Fate::Kept { readers },
                None => Fate::Culled { readers },
            };
            fates.push((passes[i].name.clone(), fate));
        }
        let off = |name: &Name| {
            let why = "left out: nothing needs it, and it does not fit this pipeline".to_owned();
            (name.clone(), Fate::Off { why, instead: "nothing".to_owned() })
        };
        fates.extend(self.graph.left_out.iter().map(off));
        fates
    }
}
