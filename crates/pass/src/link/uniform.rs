//! The contents of the uniforms of a step: `settings`, and `PORT_facts` of the modules that its shader imports.

use super::StepLinker;
use crate::codes;
use crate::record::{PortDesc, supersampling};
use frame_graph::plan::HistoryId;
use frame_graph::{Diagnostic, Diagnostics, FactDecl, Setting, Value, ValueType, nearest};
use shader_library::{GlobalKind, MemberLayout, Request, Shader, StructLayout};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The layout and the values of a uniform of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct UniformFill {
    /// Layout of the struct. Members that are structs are replaced by theirs: named `MEMBER.NAME` in `settings`, and `NAME`
    /// in the facts of a module.
    pub layout: StructLayout,
    /// Members whose values are known.
    pub values: BTreeMap<String, Value>,
    /// Members about history buffers: name, history buffer, and whether it is the age or the cause of the reset.
    pub past: Vec<(String, HistoryId, PastFact)>,
    /// Whether a member `seed` is the seed of the pass.
    pub seeded: bool,
    /// Whether a member `sample` is the number of the sample that the frame is. The seed is then that of the run, the same in all samples.
    pub sampled: bool,
}

/// A word of a uniform that can differ between frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameWord {
    /// Its offset in the uniform \[bytes\].
    pub offset: usize,
    /// The value that it holds.
    pub value: FrameValue,
    /// Whether the shader declares it as `f32`.
    float: bool,
}

/// The value of a [`FrameWord`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameValue {
    /// The seed of the pass in this sample.
    Seed,
    /// The seed of the pass in the first sample.
    RunSeed,
    /// The number of the sample.
    Sample,
    /// The age or the reset cause of a history buffer.
    Past(HistoryId, PastFact),
}

impl FrameWord {
    /// Returns a value as the bytes of the word.
    pub fn bytes(self, value: u32) -> [u8; 4] {
        if self.float { (value as f32).to_le_bytes() } else { value.to_le_bytes() }
    }
}

/// A property of a history buffer that a shader can read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PastFact {
    /// Frames since the last reset; 0 where there is no history.
    Age,
    /// 0 if it was not reset in this frame, else 1 + the position of the cause in `ResetCause`.
    Reset,
}

impl UniformFill {
    /// Returns the bytes of the uniform in the first sample. `past` returns the age or the reset cause of a history buffer.
    pub fn bytes(&self, seed: u32, past: impl Fn(HistoryId, PastFact) -> u32) -> Vec<u8> {
        // Linking has proved that every member has a value that it can hold.
        shader_library::write_struct(&self.layout, &|name| self.value(name, seed, &past)).unwrap_or_default()
    }

    /// Returns the words that can differ between frames. The rest of [`UniformFill::bytes`] does not change.
    pub fn frame_words(&self) -> impl Iterator<Item = FrameWord> + '_ {
        self.layout.members.iter().filter_map(|member| {
            let past = self.past.iter().find(|(name, ..)| *name == member.name);
            let value = match past {
                Some((_, history, fact)) => FrameValue::Past(*history, *fact),
                None if self.seeded && member.name == SEED && self.sampled => FrameValue::RunSeed,
                None if self.seeded && member.name == SEED => FrameValue::Seed,
                None if self.sampled && member.name == SAMPLE => FrameValue::Sample,
                None => return None,
            };
            Some(FrameWord { offset: member.offset as usize, value, float: member.ty == "f32" })
        })
    }

    /// Returns the size of the uniform \[bytes\]: that of the struct, rounded up as uniform layouts are.
    pub fn size(&self) -> u64 {
        u64::from(self.layout.size).next_multiple_of(16)
    }

    fn value(&self, name: &str, seed: u32, past: impl Fn(HistoryId, PastFact) -> u32) -> Option<Value> {
        if let Some((_, history, fact)) = self.past.iter().find(|(member, ..)| member == name) {
            return Some(Value::U32(past(*history, *fact)));
        }
        if self.seeded && name == SEED {
            return Some(Value::U32(seed));
        }
        if self.sampled && name == SAMPLE {
            return Some(Value::U32(0));
        }
        self.values.get(name).cloned()
    }
}

/// The member that is a seed of random numbers.
pub(crate) const SEED: &str = "seed";

/// The member that counts the samples of a picture.
pub(crate) const SAMPLE: &str = "sample";

/// The values that the names of members can mean.
#[derive(Default)]
struct Known<'a> {
    values: BTreeMap<String, Value>,
    /// Those of the values that are settings.
    settings: BTreeMap<&'a str, &'a Setting>,
    past: Vec<(String, HistoryId, PastFact)>,
}

impl Known<'_> {
    /// Adds what is known of a port under these names: size, layers and supersampling of its first texture, and its facts.
    fn add_port(&mut self, prefix: &str, port: &PortDesc, frame: (u32, u32)) {
        if let Some(texture) = port.members.iter().find_map(|(_, desc)| desc.texture()) {
            let size = Value::Vector(vec![texture.size.0 as f32, texture.size.1 as f32]);
            self.values.insert(format!("{prefix}size"), size);
            self.values.insert(format!("{prefix}layers"), Value::U32(texture.layers));
            self.values.insert(format!("{prefix}supersampling"), Value::U32(supersampling(texture, frame)));
        }
        let of_module = port.facts.module().into_iter().flat_map(|module| &module.facts);
        let of_module = of_module.map(|(fact, value)| (fact.as_str(), value));
        let facts = port.facts.iter().chain(of_module);
        for (fact, value) in facts.filter(|(_, value)| value.as_text().is_none()) {
            self.values.entry(format!("{prefix}{fact}")).or_insert_with(|| value.clone());
        }
    }

    /// Adds 0 for the numbers among the facts that a producer may leave out, and did.
    fn add_absent(&mut self, prefix: &str, declared: &[FactDecl]) {
        for fact in declared.iter().filter(|fact| fact.optional) {
            if let Some(zero) = Value::U32(0).convert(fact.ty) {
                self.values.entry(format!("{prefix}{}", fact.name)).or_insert(zero);
            }
        }
    }

    /// Adds the members about the history buffer of an input.
    fn add_past(&mut self, prefix: &str, histories: Option<&Vec<HistoryId>>) {
        if let Some(history) = histories.and_then(|histories| histories.first()) {
            self.past.push((format!("{prefix}age"), *history, PastFact::Age));
            self.past.push((format!("{prefix}reset"), *history, PastFact::Reset));
        }
    }

    fn names(&self) -> impl Iterator<Item = &str> {
        self.values.keys().map(String::as_str).chain(self.past.iter().map(|(name, ..)| name.as_str()))
    }

    fn gives(&self, member: &str) -> bool {
        self.names().any(|name| name == member)
    }
}

impl StepLinker<'_> {
    /// Fills `settings`.
    pub(super) fn settings(
        &self,
        shader: &Shader,
        request: &Request,
        global: usize,
        values: &[(String, Value)],
    ) -> Result<UniformFill, Diagnostics> {
        let mut known = Known::default();
        for port in self.inputs.iter().chain(self.outputs) {
            let prefix = format!("{}_", port.name);
            known.add_port(&prefix, port, self.plan.frame);
            let interface = self.interfaces.iter().find(|known| known.name == port.interface);
            known.add_absent(&prefix, interface.map_or(&[], |interface| interface.facts));
        }
        let settings = self.planned.settings.0.iter();
        known.values.extend(settings.map(|(name, value)| (name.clone(), self.in_shader(name, value))));
        known.settings = self.schema.iter().map(|setting| (setting.name.as_str(), setting)).collect();
        for (name, value) in values {
            known.settings.remove(name.as_str());
            known.values.insert(name.clone(), value.clone());
        }
        for input in &self.planned.inputs {
            known.add_past(&format!("{}_", input.port), input.history.as_ref());
        }
        let note =
            format!("it is neither a setting of the pass type `{}` nor a fact of a port", self.planned.kind);
        let mut notes = vec![note];
        if self.planned.shader.is_some() {
            notes.push("a setting of its own has a doc comment that ends in its default: `/// What it does. [default: 1.0]`".into());
        }
        self.fill(shader, self.file(request), global, known, notes)
    }

    /// Fills the uniform that the module of an input declares.
    pub(super) fn facts(
        &self,
        shader: &Shader,
        request: &Request,
        global: usize,
        port: &PortDesc,
    ) -> Result<UniformFill, Diagnostics> {
        let mut known = Known::default();
        known.add_port("", port, self.plan.frame);
        let input = self.planned.inputs.iter().find(|input| input.port == port.name);
        known.add_past("", input.and_then(|input| input.history.as_ref()));
        let module = port.facts.module().map_or_else(|| self.file(request), |module| module.path.as_str());
        let producer = self
            .plan
            .passes
            .iter()
            .find(|pass| pass.outputs.iter().any(|output| Arc::ptr_eq(&output.facts, &port.facts)));
        let producer = producer.map_or_else(
            || "what is linked".to_owned(),
            |pass| format!("`{}` of the pass type `{}`, which is linked", pass.name, pass.kind),
        );
        let given: Vec<&str> = known.names().collect();
        let given = if given.is_empty() { "no facts".to_owned() } else { given.join(", ") };
        let note = format!("{producer} to `{}`, gives {given}", port.name);
        self.fill(shader, module, global, known, vec![note])
    }

    /// Returns the input whose module declares a uniform of that name.
    pub(super) fn port_of_facts(&self, global: &str, kind: &GlobalKind) -> Option<&PortDesc> {
        let port = global.strip_suffix("_facts")?;
        let uniform = matches!(kind, GlobalKind::Uniform { .. });
        self.inputs.iter().find(|input| uniform && input.name == port)
    }

    fn fill(
        &self,
        shader: &Shader,
        path: &str,
        global: usize,
        mut known: Known<'_>,
        about: Vec<String>,
    ) -> Result<UniformFill, Diagnostics> {
        let place = shader.global_place(global);
        let global = &shader.interface.globals[global];
        let layout = match &global.kind {
            GlobalKind::Uniform { layout } => shader.interface.layout(&layout.ty),
            _ => None,
        };
        let Some(layout) = layout else {
            let message = format!("{path}: `{}` must be a `var<uniform>` of a struct", global.name);
            return Err(self.error(&codes::SETTINGS, message, place, Vec::new()));
        };
        let flat = flattened(layout, &shader.interface.structs, global.name == "settings");
        let given_by_frame = |name: &str| !known.values.contains_key(name);
        let (seeded, sampled) = (given_by_frame(SEED), given_by_frame(SAMPLE));
        let sampled = sampled && flat.members.iter().any(|member| member.name == SAMPLE);
        for member in flat.members.iter().filter(|member| !is_padding(&member.name)) {
            if known.gives(&member.name)
                || (seeded && member.name == SEED)
                || (sampled && member.name == SAMPLE)
            {
                continue;
            }
            let near = nearest(&member.name, known.names().chain([SEED, SAMPLE]));
            let mut notes: Vec<String> =
                near.map(|name| format!("did you mean `{name}`?")).into_iter().collect();
            notes.extend(about);
            let message = format!("{path}: nothing gives `{}.{}` a value", global.name, member.name);
            let outer = member.name.split('.').next().unwrap_or_default();
            return Err(self.error(&codes::VALUE, message, shader.member_place(&layout.name, outer), notes));
        }
        for member in &flat.members {
            if let Some(setting) = known.settings.get(member.name.as_str())
                && member.ty != type_in_shader(setting)
            {
                return Err(self.wrong_type(shader, path, (&global.name, &layout.name), member, setting));
            }
        }
        known.values.retain(|name, _| flat.members.iter().any(|member| member.name == *name));
        // Padding has no meaning, and so no value.
        for member in flat.members.iter().filter(|member| is_padding(&member.name)) {
            known.values.entry(member.name.clone()).or_insert(Value::U32(0));
        }
        let fill = UniformFill { layout: flat, values: known.values, past: known.past, seeded, sampled };
        match shader_library::write_struct(&fill.layout, &|name| fill.value(name, 0, |_, _| 0)) {
            Ok(_) => Ok(fill),
            Err(refused) => Err(self.error(&codes::VALUE, format!("{path}: {refused}"), place, Vec::new())),
        }
    }

    /// The error that a member has a setting's name and another type. Whether it could hold a value would
    /// depend on the value.
    fn wrong_type(
        &self,
        shader: &Shader,
        path: &str,
        (global, structure): (&str, &str),
        member: &MemberLayout,
        setting: &Setting,
    ) -> Diagnostics {
        let (name, found, expected) = (&setting.name, &member.ty, type_in_shader(setting));
        let message = format!("{path}: `{global}.{name}` is of another type than the setting `{name}`");
        let mut declared = format!("the setting is {}", setting.ty.with_article());
        if !setting.declared.is_empty() {
            declared.push_str(&format!(", declared in {}", setting.declared));
        }
        let error = Diagnostic::new(&codes::VALUE, message).note(declared).note(self.in_pass());
        match shader.member_place(structure, name) {
            Some(place) => error.label(place, format!("expected {expected}, found {found}")),
            None => error.note(format!("expected {expected}, found {found}")),
        }
        .into()
    }

    /// The value of a setting as a shader sees it: one of several words is its position among them.
    fn in_shader(&self, name: &str, value: &Value) -> Value {
        let words = self
            .schema
            .iter()
            .find(|setting| setting.name == name)
            .map_or(&[][..], |setting| &setting.one_of);
        match (value, words.iter().position(|word| word == value)) {
            (Value::Text(_), Some(index)) => Value::U32(index as u32),
            _ => value.clone(),
        }
    }
}

/// The type in WGSL of the member that takes a setting's values: truths are 0 and 1, words their positions.
fn type_in_shader(setting: &Setting) -> String {
    match setting.ty {
        ValueType::Bool | ValueType::Text => ValueType::U32.to_string(),
        ValueType::U32 | ValueType::I32 | ValueType::F32 => setting.ty.to_string(),
        ValueType::Vector(_) => format!("{}<f32>", setting.ty),
    }
}

fn is_padding(member: &str) -> bool {
    member.rsplit('.').next().is_some_and(|name| name.starts_with("pad"))
}

/// A layout without structs inside: their members stand in their place, named `MEMBER.NAME` or, where names are not `dotted`,
/// `NAME`. Names are those of settings.
fn flattened(layout: &StructLayout, structs: &[StructLayout], dotted: bool) -> StructLayout {
    let mut members = Vec::with_capacity(layout.members.len());
    for member in &layout.members {
        match structs.iter().find(|inner| inner.name == member.ty) {
            None => {
                let name = shader_library::setting_name(&member.name).to_owned();
                members.push(MemberLayout { name, ..member.clone() });
            }
            Some(inner) => {
                members.extend(flattened(inner, structs, dotted).members.into_iter().map(|inner| {
                    MemberLayout {
                        name: if dotted { format!("{}.{}", member.name, inner.name) } else { inner.name },
                        offset: member.offset + inner.offset,
                        ..inner
                    }
                }));
            }
        }
    }
    StructLayout { members, ..layout.clone() }
}
