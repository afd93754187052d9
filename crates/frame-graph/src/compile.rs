//! From a graph to a plan: cull, order, lifetimes, sharing.

pub(crate) mod identity;
mod memory;
mod needs;
mod numbers;
mod order;

use crate::diagnostic::Diagnostics;
use crate::link::{Graph, GraphPass, LinkSource, Made};
use crate::plan::{
    AllocationId, Begins, Continued, Fate, History, HistoryId, Memory, PassId, Plan, PlanId, PlannedInput,
    PlannedMembers, PlannedOutput, PlannedPass, PlannedPort, PlannedResource, ResourceId,
};
use crate::port::{SceneBindings, Usage};
use crate::resource::Clear;
use data_file::Name;
use numbers::Numbers;
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
    /// The passes that are needed, including those of which only a constant is needed.
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
    /// The value of the constant that replaces it, if that is needed.
    constant: Option<Clear>,
    /// Number of links of needed passes that read it in the same frame.
    readers: u32,
    /// The pass that writes it, or that a constant replaces.
    pass: u32,
    /// Number of links of needed passes that read its history buffer.
    past_readers: u32,
    /// Index of its history buffer.
    history: u32,
    /// Whether anything reads it, in this frame or the next.
    read: bool,
}

impl<'a> Work<'a> {
    fn new(graph: &'a Graph) -> Work<'a> {
        let count = graph.passes.len();
        let mut first_port = Vec::with_capacity(count + 1);
        let mut ports = Vec::with_capacity(count * 2 + 1);
        let mut resources = Vec::with_capacity(count * 2);
        let mut hands = false;
        for (i, pass) in graph.passes.iter().enumerate() {
            first_port.push(ports.len() as u32);
            for port in &*pass.outputs {
                ports.push(resources.len() as u32);
                for (_, desc, made) in &port.members {
                    hands |= matches!(made, Made::Handed { .. });
                    resources.push(Resource {
                        bytes: desc.bytes(),
                        pass: i as u32,
                        persistent: false,
                        constant: None,
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
    fn makes(&self, pass: u32) -> bool {
        self.numbers.made_by(pass as usize).next().is_some()
    }

    fn runs(&self, pass: usize) -> bool {
        self.needed[pass] && self.graph.passes[pass].off.is_none()
    }

    /// Finds resources that must outlive their last reader, since their producer may be skipped when a reader
    /// is not.
    fn trace(&mut self, order: &[u32]) {
        // What makes a pass run again: bits for the scene bindings, then for history buffers. Two history
        // buffers may share a bit; then a pass may run once too often, which costs time but is never wrong.
        let mut sources = vec![0u64; self.graph.passes.len()];
        for i in order {
            let graph = self.graph;
            let pass = &graph.passes[*i as usize];
            let mut bits = u64::from(pass.scene_bindings.0);
            for input in pass.inputs.iter().filter(|input| input.constant.is_none()) {
                for r in self.numbers.of_source(&input.from) {
                    bits |= match input.past {
                        Some(_) => 1 << (8 + self.resources[r].history % 56),
                        None => sources[self.resources[r].pass as usize],
                    };
                }
            }
            sources[*i as usize] = bits;
            if !self.makes(*i) {
                continue;
            }
            for input in pass.inputs.iter().filter(|input| input.constant.is_none() && input.past.is_none()) {
                for r in self.numbers.of_source(&input.from) {
                    let made = sources[self.resources[r].pass as usize];
                    // A producer that runs in every frame is never skipped.
                    if made != bits && made & u64::from(SceneBindings::FRAME.0) == 0 {
                        self.resources[r].persistent = true;
                    }
                }
            }
        }
    }

    fn plan(self, order: &[u32], options: &CompileOptions) -> Plan {
        let graph = self.graph;
        let mut position = vec![NONE; graph.passes.len()];
        for (at, i) in order.iter().enumerate() {
            position[*i as usize] = at as u32;
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
            fates: Vec::with_capacity(graph.passes.len()),
            memory: Memory::default(),
        };
        let ids = self.plan_resources(&mut plan, order);
        self.plan_passes(&mut plan, order, &position, &ids);
        for i in &self.wanted {
            let output = &graph.outputs[*i as usize];
            let port = &graph.passes[output.from.pass as usize].outputs[output.from.port as usize];
            let pass = &graph.passes[output.from.pass as usize].name;
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

    /// Numbers the resources in the order in which they are written, constants first.
    fn plan_resources(&self, plan: &mut Plan, order: &[u32]) -> Ids {
        let mut ids = vec![NONE; self.resources.len()];
        let mut name = String::new();
        let constants = (0..self.graph.passes.len() as u32)
            .filter(|i| self.needed[*i as usize] && self.graph.passes[*i as usize].off.is_some());
        let constants: Vec<u32> = constants.collect();
        let made = order.iter().enumerate().map(|(at, i)| (Some(at as u32), *i));
        for (at, i) in constants.into_iter().map(|i| (None, i)).chain(made) {
            let pass = &self.graph.passes[i as usize];
            let mut r = self.numbers.of_pass(i as usize).start;
            for port in &*pass.outputs {
                for (member, desc, _) in &port.members {
                    let resource = &self.resources[r];
                    r += 1;
                    let handed = self.numbers.made[r - 1] as usize != r - 1;
                    if handed || (at.is_none() && resource.constant.is_none()) {
                        continue;
                    }
                    ids[r - 1] = plan.resources.len() as u32;
                    name.clear();
                    for part in
                        [&*pass.name, ".", &port.port, if member.is_empty() { "" } else { "." }, member]
                    {
                        name.push_str(part);
                    }
                    let begin = at.unwrap_or(0);
                    let end = if at.is_none() { order.len().saturating_sub(1) as u32 } else { begin };
                    plan.resources.push(PlannedResource {
                        name: Name::from(name.as_str()),
                        desc: desc.clone(),
                        allocation: AllocationId(NONE),
                        producer: at.map(PassId),
                        readers: SmallVec::with_capacity(resource.readers as usize),
                        lifetime: (begin, end),
                        persistent: resource.persistent,
                        history: (resource.history != NONE).then_some(HistoryId(resource.history)),
                        constant: resource.constant.filter(|_| at.is_none()),
                    });
                }
            }
        }
        for r in 0..ids.len() {
            ids[r] = ids[self.numbers.made[r] as usize];
        }
        let ports = self.graph.passes.iter().enumerate().flat_map(|(i, pass)| {
            pass.outputs.iter().enumerate().map(move |(at, port)| (i, at, &port.members))
        });
        let members = ports.map(|(i, at, members)| match self.needed[i] {
            true => {
                let members = members.iter().zip(&ids[self.numbers.of_port(i as u32, at as u32)]);
                members.map(|((name, _, _), id)| (name.clone(), ResourceId(*id))).collect()
            }
            false => PlannedMembers::default(),
        });
        Ids { ports: members.collect(), resources: ids }
    }

    fn interface(&self, source: &LinkSource) -> Name {
        let port = &self.graph.passes[source.pass as usize].outputs[source.port as usize];
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
        let port = &self.graph.passes[source.pass as usize].outputs[source.port as usize];
        let first = self.numbers.of_port(source.pass, source.port).start;
        let name = |r: usize| if source.bare { Name::EMPTY } else { port.members[r - first].0.clone() };
        self.numbers.in_port(source).map(|r| (name(r), ResourceId(ids.resources[r]))).collect()
    }

    fn plan_passes(&self, plan: &mut Plan, order: &[u32], position: &[u32], ids: &Ids) {
        let histories = self.resources.iter().filter(|r| r.history != NONE).count();
        let unset = History {
            resource: ResourceId(NONE),
            copies: [AllocationId(NONE); 2],
            in_place: false,
            init: Clear::Zero,
            reset: Vec::new(),
            rest: None,
        };
        plan.histories = vec![unset; histories];
        for (at, i) in order.iter().enumerate() {
            let pass: &GraphPass = &self.graph.passes[*i as usize];
            let mut inputs = Vec::with_capacity(pass.inputs.len());
            for input in &pass.inputs {
                let mut past = None;
                if let Some(of) = &input.past {
                    let mut list = Vec::new();
                    for r in self.numbers.of_source(&input.from) {
                        let id = self.resources[r].history;
                        let history = &mut plan.histories[id as usize];
                        history.resource = ResourceId(ids.resources[r]);
                        history.init = of.init;
                        history.reset.clone_from(&of.reset);
                        history.rest = of.rest;
                        list.push(HistoryId(id));
                    }
                    past = Some(list);
                } else {
                    for r in self.numbers.of_source(&input.from) {
                        let resource = &mut plan.resources[ids.resources[r] as usize];
                        if resource.readers.last() != Some(&PassId(at as u32)) {
                            resource.readers.push(PassId(at as u32));
                        }
                        resource.lifetime.1 = resource.lifetime.1.max(at as u32);
                    }
                }
                let port = &self.graph.passes[input.from.pass as usize].outputs[input.from.port as usize];
                let producer = input.from.pass;
                inputs.push(PlannedInput {
                    port: input.port.clone(),
                    producer: input.constant.is_none().then(|| PassId(position[producer as usize])),
                    producer_port: port.port.clone(),
                    interface: self.interface(&input.from),
                    members: self.members(&input.from, ids),
                    history: past,
                    facts: port.facts.clone(),
                });
            }
            let mut outputs = Vec::with_capacity(pass.outputs.len());
            let mut clears = Vec::new();
            let mut continues = Vec::new();
            let mut r = self.numbers.of_pass(*i as usize).start;
            for (at, port) in pass.outputs.iter().enumerate() {
                let mut connected = false;
                let mut handed = Vec::new();
                for (name, _, made) in &port.members {
                    let id = ResourceId(ids.resources[r]);
                    connected |= self.resources[r].read;
                    r += 1;
                    match made {
                        Made::Handed { .. } => {
                            handed.push((name.clone(), id));
                            continue;
                        }
                        Made::Here(Usage::ClearFirst(clear)) => clears.push((id, *clear)),
                        Made::Here(Usage::Overwrites) => {}
                        Made::Here(Usage::Continue { input, member }) => {
                            let begins = self.begins_as(pass, r - 1, input, member, &ids.resources);
                            if let Some(Begins::InPlace(history)) = begins {
                                plan.histories[history.0 as usize].in_place = true;
                            }
                            continues.extend(begins.map(|from| Continued {
                                resource: id,
                                input: Name::from(input),
                                from,
                            }));
                        }
                    }
                }
                let all = &ids.ports[self.numbers.port(*i, at as u32)];
                let members = match handed.is_empty() {
                    true => all.clone(),
                    false => all.iter().filter(|member| !handed.contains(member)).cloned().collect(),
                };
                outputs.push(PlannedPort {
                    port: port.port.clone(),
                    interface: port.interface.clone(),
                    members,
                    handed,
                    connected,
                    facts: port.facts.clone(),
                });
            }
            plan.passes.push(PlannedPass {
                name: pass.name.clone(),
                kind: pass.kind.clone(),
                shader: pass.shader.clone(),
                settings: pass.settings.clone(),
                overrides: pass.overrides.clone(),
                inputs,
                outputs,
                scene_bindings: pass.scene_bindings,
                depends_on: pass.depends_on,
                remembers: pass.remembers,
                clears,
                continues,
            });
        }
    }

    /// Returns the initial content of a resource that continues an input.
    fn begins_as(
        &self,
        pass: &GraphPass,
        r: usize,
        input: &str,
        member: &str,
        ids: &[u32],
    ) -> Option<Begins> {
        let (input, from) = self.numbers.member_of(self.graph, pass, input, member)?;
        let from = self.numbers.made[from] as usize;
        let made = &self.resources[from];
        Some(match &input.past {
            None => Begins::Copy(ResourceId(ids[from])),
            // Its own history buffer, which no other pass reads. One that rests keeps what its last frame was made of.
            Some(past) if from == r && made.past_readers == 1 && past.rest.is_none() => {
                Begins::InPlace(HistoryId(made.history))
            }
            Some(_) => Begins::CopyOfPast(HistoryId(made.history)),
        })
    }

    /// Returns whether each pass runs, and why.
    fn fates(&self, position: &[u32]) -> Vec<(Name, Fate)> {
        let passes = &self.graph.passes;
        let mut readers: Vec<Vec<Name>> = vec![Vec::new(); passes.len()];
        for (i, pass) in passes.iter().enumerate() {
            for input in &pass.inputs {
                let producer = input.from.pass as usize;
                // For a kept pass, its kept readers count; for a culled one, all of them.
                let counts = position[i] != NONE || position[producer] == NONE;
                if counts && readers[producer].last() != Some(&pass.name) {
                    readers[producer].push(pass.name.clone());
                }
            }
        }
        for i in &self.wanted {
            let output = &self.graph.outputs[*i as usize];
            readers[output.from.pass as usize].push(Name::from(format!("out.{}", output.name)));
        }
        let fate = |i: usize, readers: Vec<Name>| match &passes[i].off {
            Some(off) => Fate::Off { why: off.why.clone(), instead: off.instead.clone() },
            None if self.runs(i) => Fate::Kept { readers },
            None => Fate::Culled { readers },
        };
        readers
            .into_iter()
            .enumerate()
            .map(|(i, readers)| (passes[i].name.clone(), fate(i, readers)))
            .collect()
    }
}
