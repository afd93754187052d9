//! Computes the resources of every output: formats, sizes, output metadata (facts).

use super::answers::{Answers, Question};
use super::wires::is_bare;
use super::{Described, GraphPort, GraphPorts, Linker, Made, Wire};
use crate::codes;
use crate::description::Body;
use crate::interface::check_facts;
use crate::port::{Facts, InputDesc, OutputContext, OutputDesc, PassTypeError, Usage};
use crate::resource::{Extent, ResourceDesc, TextureDesc};
use data_file::{Diagnostic, Name};
use smallvec::SmallVec;
use std::sync::{Arc, LazyLock};

/// Longest side of a texture that any device allows, in texels.
const MAX_SIDE: u32 = 32_768;
/// Most layers of a texture array that any device allows.
const MAX_LAYERS: u32 = 4_096;
/// Largest buffer, in bytes.
const MAX_BYTES: u64 = 1 << 40;
/// Iterations in which sizes that depend on history buffers must converge.
const MAX_ROUNDS: usize = 16;

static NO_FACTS: LazyLock<Arc<Facts>> = LazyLock::new(Arc::default);

/// Why the outputs of a pass are not known.
pub(super) enum Unknown {
    /// An input that reads a history buffer has no size yet.
    Waits(PassTypeError),
    /// The pass type refuses the use as long as not all inputs are known: for want of them, or for another reason.
    RefusedEarly(PassTypeError),
    /// The description is wrong.
    Wrong(Diagnostic),
    /// The pass type refuses the use.
    Refused(PassTypeError),
}

impl<'a> Linker<'a> {
    /// Computes the resources of every pass's outputs, in the order of data. Sizes that depend on the history
    /// buffer of a later pass take further iterations, until nothing changes.
    pub(super) fn find_sizes(&mut self, order: &[u32]) -> Vec<Described> {
        let mut ports: Vec<Described> = vec![None; self.nodes.len()];
        let mut answers = Answers::default();
        // Passes that read a history buffer of a later pass, or of one whose size is not known yet, are asked
        // again.
        let mut waiting = false;
        for i in order {
            let i = *i as usize;
            let Some(question) = self.question(i, &ports) else { continue };
            waiting |= !question.whole;
            match self.answer(i, question, &ports, &mut answers) {
                Ok(found) => ports[i] = Some(found),
                Err(unknown) => self.note_unknown(i, unknown, false, order, &ports),
            }
        }
        if waiting && self.errors.is_empty() {
            self.settle(order, &mut ports, &mut answers);
        }
        if self.errors.is_empty() {
            self.check_sorts(&ports);
            self.check_handed(&ports);
            self.check_continued(&ports);
        }
        ports
    }

    /// Repeats the computation until the sizes converge.
    fn settle(&mut self, order: &[u32], ports: &mut [Described], answers: &mut Answers) {
        for round in 0..MAX_ROUNDS {
            let last = round + 1 == MAX_ROUNDS;
            let mut changed = false;
            let mut unknown = Vec::new();
            for i in order {
                let i = *i as usize;
                let Some(question) = self.question(i, ports) else { continue };
                match self.answer(i, question, ports, answers) {
                    Ok(found) => {
                        let same = ports[i].as_ref().is_some_and(|old| same(old, &found));
                        if !same {
                            changed = true;
                            if last {
                                unknown
                                    .push((i, Unknown::Waits(PassTypeError::new("its size keeps changing"))));
                            }
                            ports[i] = Some(found);
                        }
                    }
                    Err(why) => unknown.push((i, why)),
                }
            }
            if !changed || last {
                let causes: Vec<_> =
                    unknown.iter().filter_map(|(i, why)| self.cause(*i, why, ports)).collect();
                // A pass that reads no history buffer only waits for one that does.
                let reads_past =
                    |i: usize| self.is_on(i) && self.wires_now(i).iter().any(|wire| wire.end.past);
                if !causes.is_empty() {
                    unknown = causes;
                } else if unknown.iter().any(|(i, _)| reads_past(*i)) {
                    unknown.retain(|(i, _)| reads_past(*i));
                }
                for (i, why) in unknown {
                    self.note_unknown(i, why, true, order, ports);
                }
                return;
            }
        }
    }

    /// Returns the refusal of a pass that has another reason than that the size of its history buffer is not known: it is
    /// why that is not known.
    fn cause(&self, node: usize, why: &Unknown, ports: &[Described]) -> Option<(usize, Unknown)> {
        let Unknown::RefusedEarly(error) = why else { return None };
        let unknown =
            self.describing_wires(node).iter().filter(|wire| ports[wire.end.node as usize].is_none());
        let inputs = &self.uses[node].as_ref()?.names.inputs;
        let is_named = |wire: &Wire| error.input.as_deref() == Some(inputs[wire.input as usize].0.as_str());
        let mut others = unknown.filter(|wire| !wire.end.past || is_named(wire));
        others.next().is_none().then(|| (node, Unknown::Refused(error.clone())))
    }

    /// Reports why the outputs of a pass are not known. A pass that is off is checked where something reads what replaces
    /// it.
    fn note_unknown(
        &mut self,
        node: usize,
        unknown: Unknown,
        settled: bool,
        order: &[u32],
        ports: &[Described],
    ) {
        if !self.is_on(node) {
            return;
        }
        match unknown {
            Unknown::Wrong(error) => self.errors.push(error),
            Unknown::Refused(error) => {
                let error = self.advised(node, error, order, ports);
                self.refused(&self.nodes[node], &error);
            }
            Unknown::Waits(error) | Unknown::RefusedEarly(error) if settled => {
                let past = self.wires_now(node).iter().find(|wire| wire.end.past);
                let message =
                    format!("the size of `{}` depends on itself through `prev`", self.nodes[node].name);
                let mut loop_error = Diagnostic::new(&codes::SIZE_LOOP, message)
                    .label(self.span(self.nodes[node].place), "of this pass");
                if let Some(wire) = past {
                    loop_error =
                        loop_error.label(self.span(self.link_of(node, wire).place), "read from here");
                }
                loop_error = loop_error
                    .note(error.message)
                    .note("let the size follow another input, the frame, or a number");
                self.errors.push(loop_error);
            }
            Unknown::Waits(_) | Unknown::RefusedEarly(_) => {}
        }
    }

    /// Returns the wires that determine the outputs of a pass. A pass that is off is described as if all
    /// passes were on: what replaces it must have the same shape.
    pub(super) fn describing_wires(&self, node: usize) -> &[Wire] {
        if self.on[node] == Some(true) { self.wires_now(node) } else { &self.wires[node] }
    }

    /// Returns the question to a pass type about the outputs of a node; `None` if the node is no pass.
    pub(super) fn question(&self, node: usize, ports: &[Described]) -> Option<Question> {
        let mut question = Question::of(self.uses[node].as_ref()?);
        for wire in self.describing_wires(node) {
            question.link(wire, ports[wire.end.node as usize].as_ref());
        }
        Some(question)
    }

    /// Returns the outputs of a pass: the known answer to an equal question, or that of the pass type.
    pub(super) fn answer(
        &self,
        node: usize,
        question: Question,
        ports: &[Described],
        answers: &mut Answers,
    ) -> Result<GraphPorts, Unknown> {
        if let Some(known) = answers.get(&question) {
            return Ok(known);
        }
        let inputs = self.describe_inputs(node, ports);
        let found = self.describe(node, question.whole, &inputs)?;
        Ok(answers.add(question, found))
    }

    /// Returns the connected inputs of a pass, without those whose size is not known yet.
    fn describe_inputs(&self, node: usize, ports: &[Described]) -> Vec<InputDesc> {
        let Some(used) = &self.uses[node] else { return Vec::new() };
        let describe = |wire: &Wire| {
            let port = &ports[wire.end.node as usize].as_ref()?[wire.end.port as usize];
            let (name, wanted) = &used.names.inputs[wire.input as usize];
            let bare = is_bare(wanted, &wire.end);
            let chosen = self.member(&port.interface, wire.end.member);
            let taken =
                port.members.iter().filter(|(name, _, _)| chosen.is_none_or(|chosen| *name == chosen));
            let members: Vec<_> = taken
                .map(|(name, resource, _)| {
                    (if bare { String::new() } else { name.to_string() }, resource.clone())
                })
                .collect();
            let interface = match members.last() {
                Some((_, resource)) if wire.end.member.is_some() => sort(resource).to_owned(),
                _ => port.interface.to_string(),
            };
            Some(InputDesc { name: name.to_string(), interface, members, facts: Arc::clone(&port.facts) })
        };
        self.describing_wires(node).iter().filter_map(describe).collect()
    }

    /// Returns the name of the member that a link takes.
    pub(super) fn member(&self, interface: &str, member: Option<u32>) -> Option<&'static str> {
        let found = self.interfaces.iter().find(|i| member.is_some() && i.name == interface)?;
        found.members.get(member? as usize).map(|m| m.name)
    }

    /// Asks the pass type for its outputs, and computes their sizes.
    fn describe(&self, node: usize, whole: bool, inputs: &[InputDesc]) -> Result<Vec<GraphPort>, Unknown> {
        // A fact that is too great is known, whatever else is not.
        let waits = |error: PassTypeError| match whole || error.limit.is_some() {
            true => Unknown::Refused(error),
            false => Unknown::RefusedEarly(error),
        };
        let (Some(used), decl) = (&self.uses[node], &self.nodes[node].decl) else {
            return Ok(Vec::new());
        };
        let Some(use_) = used.ask(decl) else { return Ok(Vec::new()) };
        let context = OutputContext {
            use_,
            settings: &used.settings,
            inputs,
            frame: self.context.frame,
            traits: &self.context.traits,
        };
        let outputs = self.kinds.outputs(&context).map_err(waits)?;
        let mut found = Vec::with_capacity(outputs.len());
        let mut scratch = Vec::new();
        let mut in_order = true;
        for output in outputs {
            let place = found.len();
            let declared = &used.names.outputs;
            // Pass types usually describe their ports in order; any other order is accepted too.
            let port = match declared.get(place) {
                _ if output.scratch => None,
                Some((port, _)) if *port == output.port => Some(place),
                _ => {
                    in_order = false;
                    declared.iter().position(|(port, _)| *port == output.port)
                }
            };
            let (name, interface) = match port {
                Some(port) => declared[port].clone(),
                None if output.scratch => (Name::from(&output.port), Name::default()),
                None => {
                    return Err(self.defect(
                        node,
                        format!("describes an output `{}` that it does not have", output.port),
                    ));
                }
            };
            let is_scratch = output.scratch;
            let described = self.describe_port(node, name, interface, output, whole, inputs)?;
            if is_scratch { scratch.push(described) } else { found.push(described) }
        }
        if !in_order || found.len() != used.names.outputs.len() {
            let missing = used
                .names
                .outputs
                .iter()
                .find(|(name, _)| found.iter().all(|port: &GraphPort| port.port != *name));
            if let Some((missing, _)) = missing {
                return Err(self.defect(node, format!("does not describe its output `{missing}`")));
            }
            if found.len() > used.names.outputs.len() {
                return Err(self.defect(node, "describes an output twice".to_owned()));
            }
            found.sort_by_key(|port| used.names.outputs.iter().position(|(name, _)| port.port == *name));
        }
        found.extend(scratch);
        Ok(found)
    }

    fn describe_port(
        &self,
        node: usize,
        port: Name,
        interface: Name,
        output: OutputDesc,
        whole: bool,
        inputs: &[InputDesc],
    ) -> Result<GraphPort, Unknown> {
        let known = self.interfaces.iter().find(|i| i.name == interface.as_str());
        if let Some(known) = known {
            check_facts(known, &port, &output.facts).map_err(|what| self.defect(node, what))?;
        }
        let facts = if output.facts.is_empty() { Arc::clone(&NO_FACTS) } else { Arc::new(output.facts) };
        // A single resource without a name, as in most ports, needs no search.
        let plain = known.is_none_or(|i| matches!(i.members, [only] if only.name.is_empty()));
        let plain = plain && matches!(&output.members[..], [(name, _, _)] if name.is_empty());
        let mut members = SmallVec::new();
        for (member, desc, usage) in output.members {
            let name =
                match known.filter(|_| !plain).and_then(|i| i.members.iter().find(|m| m.name == member)) {
                    Some(member) => Name::new(member.name),
                    None if plain => Name::default(),
                    None if interface.is_empty() => Name::from(member),
                    None => {
                        return Err(self.defect(
                            node,
                            format!("describes a member `{member}` that `{interface}` lacks"),
                        ));
                    }
                };
            let desc = self.work_out(node, &port, desc, whole, inputs)?;
            if let Usage::Continue { input, .. } = &usage
                && whole
                && inputs.iter().all(|desc| desc.name != *input)
            {
                let what =
                    format!("continues `{input}` in its output `{port}`, which is no input that is linked");
                return Err(self.defect(node, what));
            }
            members.push((name, desc, Made::Here(usage)));
        }
        for handed in &output.handed {
            self.hand_on(node, &port, known, handed, whole, inputs, &mut members)?;
        }
        if let Some(known) = known.filter(|_| !output.handed.is_empty()) {
            members.sort_by_key(|(name, _, _)| known.members.iter().position(|m| *name == m.name));
        }
        let lacks = |name: &str| members.iter().all(|(n, _, _)| n != name);
        let missing = match known.filter(|_| !plain) {
            Some(known) => known.members.iter().find(|m| !m.optional && lacks(m.name)).map(|m| m.name),
            None => (!interface.is_empty() && lacks("")).then_some(""),
        };
        if let Some(missing) = missing {
            return Err(self.defect(node, format!("does not describe `{missing}` of its output `{port}`")));
        }
        if matches!(&*interface, "Texture" | "Buffer")
            && members.iter().any(|(_, desc, _)| sort(desc) != &*interface)
        {
            return Err(
                self.defect(node, format!("describes its output `{port}` as another sort than {interface}"))
            );
        }
        Ok(GraphPort { port, interface, members, facts })
    }

    pub(super) fn defect(&self, node: usize, what: String) -> Unknown {
        let node = &self.nodes[node];
        let kind = if let Body::Pass { kind, .. } = &node.decl.body { &*kind.value } else { "" };
        let error = Diagnostic::new(&codes::KIND_DEFECT, format!("the pass type `{kind}` {what}"))
            .label(self.span(node.place), "used here")
            .note("this is a defect of the pass type, not of the file");
        Unknown::Wrong(error)
    }

    /// Computes the size of one resource, and checks the limits.
    fn work_out(
        &self,
        node: usize,
        port: &str,
        desc: ResourceDesc<Extent>,
        whole: bool,
        inputs: &[InputDesc],
    ) -> Result<ResourceDesc, Unknown> {
        let limit = |what: String| {
            let node = &self.nodes[node];
            let out = node.decl.outs.iter().find(|o| o.port.value == *port);
            let size = out.and_then(|o| o.size.as_ref().map(|s| s.place));
            let mut error = Diagnostic::new(&codes::SIZE_LIMIT, format!("`{}.{port}` {what}", node.name));
            if let Some(size) = size {
                error = error.label(self.span(size), "this size");
            }
            Unknown::Wrong(error.label(self.span(node.place), "of this pass"))
        };
        let texture = match desc {
            ResourceDesc::Buffer(buffer) if buffer.bytes == 0 || buffer.bytes > MAX_BYTES => {
                return Err(limit(format!("is a buffer of {} bytes", buffer.bytes)));
            }
            ResourceDesc::Buffer(buffer) => return Ok(ResourceDesc::Buffer(buffer)),
            ResourceDesc::Texture(texture) => texture,
        };
        let scale = |side: u32, num: u32, den: u32| {
            (u64::from(side) * u64::from(num)).div_ceil(u64::from(den.max(1))).max(1)
        };
        let (w, h) = match &texture.size {
            Extent::Fixed(w, h) => (u64::from(*w), u64::from(*h)),
            Extent::Frame { num, den } => {
                let (w, h) = self.context.frame;
                (scale(w, *num, *den), scale(h, *num, *den))
            }
            Extent::Like { input, num, den } => {
                match inputs.iter().find(|i| i.name == *input).and_then(InputDesc::size) {
                    Some((w, h)) => (scale(w, *num, *den), scale(h, *num, *den)),
                    None if !whole && self.takes(node, input) => {
                        return Err(Unknown::Waits(PassTypeError::new(format!(
                            "`{port}` is sized like `{input}`"
                        ))));
                    }
                    None => return Err(Unknown::Wrong(self.no_size(node, port, input, inputs))),
                }
            }
        };
        let limits = 1..=u64::from(MAX_SIDE);
        if !limits.contains(&w) || !limits.contains(&h) {
            return Err(limit(format!("is {w}×{h} texels: a side is from 1 to {MAX_SIDE}")));
        }
        if texture.layers == 0 || texture.layers > MAX_LAYERS || (texture.layers > 1 && !texture.array) {
            return Err(limit(format!("has {} layers: an array has from 1 to {MAX_LAYERS}", texture.layers)));
        }
        let TextureDesc { format, layers, array, .. } = texture;
        Ok(ResourceDesc::Texture(TextureDesc { format, size: (w as u32, h as u32), layers, array }))
    }

    /// Returns whether something is linked to an input of a pass.
    fn takes(&self, node: usize, input: &str) -> bool {
        let inputs = self.uses[node].as_ref().map(|used| &used.names.inputs);
        let name = |wire: &Wire| inputs.map(|inputs| inputs[wire.input as usize].0.as_str());
        self.describing_wires(node).iter().any(|wire| name(wire) == Some(input))
    }

    fn no_size(&self, node: usize, port: &str, input: &str, inputs: &[InputDesc]) -> Diagnostic {
        let node = &self.nodes[node];
        let connected = inputs.iter().any(|i| i.name == input);
        let why = if connected { "which holds no texture" } else { "which is not linked" };
        let message = format!("`{}.{port}` is sized like its input `{input}`, {why}", node.name);
        let out = node.decl.outs.iter().find(|o| o.port.value == *port).and_then(|o| o.size.as_ref());
        let mut error = Diagnostic::new(&codes::SIZE_INPUT, message);
        error = match (out, node.decl.link(input)) {
            (Some(size), _) => error.label(self.span(size.place), "this size"),
            (None, Some(link)) => error.label(self.span(link.place), "no texture comes from here"),
            (None, None) => error.label(self.span(node.place), "in this pass"),
        };
        let textures = inputs.iter().filter(|i| i.size().is_some()).map(|i| i.name.as_str());
        error.suggest("linked inputs with a texture", input, textures)
    }
}

/// Returns `Texture` or `Buffer`.
pub(super) fn sort(desc: &ResourceDesc) -> &'static str {
    if desc.texture().is_some() { "Texture" } else { "Buffer" }
}

fn same(a: &GraphPorts, b: &GraphPorts) -> bool {
    let same = |a: &GraphPort, b: &GraphPort| a.members == b.members && a.facts == b.facts;
    Arc::ptr_eq(a, b) || (a.len() == b.len() && a.iter().zip(&**b).all(|(a, b)| same(a, b)))
}
