//! Links the steps of a pass to the resources of a plan: shaders loaded, globals resolved by name, types
//! checked, uniforms laid out. All of it without a GPU, so that `check` proves what an executor will run.

use crate::record::{Compute, Draw, PortDesc, Raster, RecordContext, Recording, Step};
use crate::{Pass, UseContext, externals};
use fit::{describe, describe_global, mismatch};
use frame_graph::codes::{Code, link as codes};
use frame_graph::plan::{Begins, HistoryId, PassId, Plan, PlannedPass, ResourceId};
use frame_graph::{
    Diagnostic, Diagnostics, Externals, Label, ResourceDesc, Setting, Span, Traits, Use, Value, nearest,
};
use names::{Named, Names};
use shader_library::{GlobalKind, Library, Request, Shader, Stage, StructLayout};
use std::collections::BTreeMap;
use std::sync::Arc;

mod fit;
mod names;

/// What a global is bound to.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A resource of the plan: this frame's version.
    Resource(ResourceId),
    /// Last frame's version of a resource.
    Past(HistoryId),
    /// Data of the host program, by the global's name.
    External(&'static str),
    /// The uniform `settings`.
    Settings,
}

/// A global of a shader with what it is bound to.
#[derive(Clone, Debug)]
pub struct Bound {
    /// Index into the globals of the shader's interface.
    pub global: usize,
    /// What it is bound to.
    pub source: Source,
}

/// A step whose every name is resolved.
#[derive(Clone, Debug)]
pub struct LinkedStep {
    /// The step as recorded.
    pub step: Step,
    /// Its shader.
    pub shader: Arc<Shader>,
    /// Entry points: one of a dispatch; vertex and perhaps fragment of a draw.
    pub entries: Vec<usize>,
    /// The globals that the entry points use.
    pub bindings: Vec<Bound>,
    /// The uniform, where the shader uses one.
    pub settings: Option<SettingsFill>,
    /// Colour targets of a draw.
    pub targets: Vec<ResourceId>,
    /// Depth target of a draw.
    pub depth: Option<ResourceId>,
    /// The buffer that an indirect dispatch or draw reads its size from: a resource or the past of one.
    pub indirect: Option<Source>,
}

impl LinkedStep {
    /// The data of the host program that it reads, by names of globals.
    pub fn externals(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.bindings.iter().filter_map(|bound| match bound.source {
            Source::External(name) => Some(name),
            _ => None,
        })
    }

    /// Whether it is a draw whose size is on the GPU.
    pub fn draws_indirectly(&self) -> bool {
        matches!(&self.step, Step::Raster(raster) if matches!(raster.draw, Draw::Indirect { .. }))
    }

    /// The request by which its shader was loaded.
    fn request(&self) -> &Request {
        match &self.step {
            Step::Compute(compute) => &compute.shader,
            Step::Raster(raster) => &raster.shader,
        }
    }

    /// The buffers that its shader may write.
    fn written_buffers(&self) -> impl Iterator<Item = ResourceId> + '_ {
        let globals = &self.shader.interface.globals;
        self.bindings.iter().filter_map(|bound| match (&bound.source, &globals[bound.global].kind) {
            (Source::Resource(id), GlobalKind::Storage { writable: true, .. }) => Some(*id),
            _ => None,
        })
    }

    /// Whether it needs an adapter with ray queries.
    pub fn queries_rays(&self) -> bool {
        let globals = &self.shader.interface.globals;
        self.bindings.iter().any(|bound| globals[bound.global].kind == GlobalKind::AccelerationStructure)
    }
}

/// How the uniform of a step is filled.
#[derive(Clone, Debug)]
pub struct SettingsFill {
    /// Layout of the struct.
    pub layout: StructLayout,
    /// Members whose values are known.
    pub values: BTreeMap<String, Value>,
    /// Members that ask about the past: name, history, and whether it is the age or the cause of the reset.
    pub past: Vec<(String, HistoryId, PastFact)>,
    /// Whether it asks for the seed.
    pub seeded: bool,
}

/// What a shader can ask of a past version.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PastFact {
    /// Frames that it has lasted; 0 where there is none.
    Age,
    /// 0 while it lasts, else 1 + the position of the cause in `ResetCause`.
    Reset,
}

impl SettingsFill {
    /// The bytes of the uniform. `past` answers for histories.
    pub fn bytes(&self, seed: u32, past: impl Fn(HistoryId, PastFact) -> u32) -> Vec<u8> {
        // Linking has proved that every member has a value that it can hold.
        shader_library::write_struct(&self.layout, &|name| self.value(name, seed, &past)).unwrap_or_default()
    }

    fn value(&self, name: &str, seed: u32, past: impl Fn(HistoryId, PastFact) -> u32) -> Option<Value> {
        if let Some((_, history, fact)) = self.past.iter().find(|(member, ..)| member == name) {
            return Some(Value::U32(past(*history, *fact)));
        }
        if self.seeded && name == "seed" {
            return Some(Value::U32(seed));
        }
        self.values.get(name).cloned()
    }
}

/// The seed of a pass: made from the run's seed and the pass's name, so that it depends on nothing else.
/// A run's seed of 0 gives every pass the seed 0: plain sequences, as the papers use them.
pub fn pass_seed(run: u32, pass: &str) -> u32 {
    if run == 0 {
        return 0;
    }
    // FNV-1a; a shader hashes it further.
    pass.bytes().fold(0x811c_9dc5 ^ run.wrapping_mul(0x9e37_79b9), |hash, byte| {
        (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193)
    }) | 1
}

/// Records a pass of a plan and links its steps.
///
/// # Errors
/// Errors of the pass itself, of its shaders, and of names that nothing answers to.
pub fn link_steps(
    plan: &Plan,
    id: PassId,
    kind: &dyn Pass,
    traits: &Traits,
    library: &Library,
) -> Result<Vec<LinkedStep>, Diagnostics> {
    let planned = &plan.passes[id.0 as usize];
    let names = Names::new(plan, planned);
    let inputs: Vec<PortDesc> = planned.inputs.iter().map(|input| names::input(plan, input)).collect();
    let outputs: Vec<PortDesc> = planned.outputs.iter().map(|output| names::output(plan, output)).collect();
    let linked: Vec<String> = planned.inputs.iter().map(|input| input.port.to_string()).collect();
    let use_ = Use {
        kind: &planned.kind,
        shader: planned.shader.as_deref(),
        inputs: &linked,
        outputs: &planned.overrides,
    };
    let context = RecordContext {
        name: &planned.name,
        use_,
        settings: &planned.settings,
        inputs: &inputs,
        outputs: &outputs,
        frame: plan.frame,
        traits,
        shaders: library,
    };
    let recording: Recording = kind.record(&context).map_err(|error| {
        let mut notes: Vec<String> = error.help.into_iter().collect();
        notes.push(format!("in pass `{}` of kind `{}`", planned.name, planned.kind));
        Diagnostics::from(Diagnostic { notes, ..Diagnostic::new(&codes::REFUSED, error.message) })
    })?;
    let cx = UseContext { use_, shaders: library };
    let declared = kind.ports(&cx, &planned.settings).map_or(Externals::NONE, |ports| ports.externals);
    let schema = kind.settings(&cx).unwrap_or_default();
    let linker = StepLinker {
        planned,
        plan,
        names: &names,
        inputs: &inputs,
        outputs: &outputs,
        declared,
        schema: &schema,
    };
    let steps = recording
        .steps
        .into_iter()
        .map(|step| linker.link(step, library))
        .collect::<Result<Vec<LinkedStep>, Diagnostics>>()?;
    linker.check_order(&steps)?;
    Ok(steps)
}

struct StepLinker<'a> {
    planned: &'a PlannedPass,
    plan: &'a Plan,
    names: &'a Names,
    inputs: &'a [PortDesc],
    outputs: &'a [PortDesc],
    declared: Externals,
    schema: &'a [Setting],
}

impl StepLinker<'_> {
    fn link(&self, step: Step, library: &Library) -> Result<LinkedStep, Diagnostics> {
        let (request, entry_names, bind, values) = match &step {
            Step::Compute(Compute { shader, entry, bind, values, .. }) => {
                (shader, vec![(entry, Stage::Compute)], bind, values)
            }
            Step::Raster(Raster { shader, vertex, fragment, bind, values, .. }) => {
                let mut entries = vec![(vertex, Stage::Vertex)];
                entries.extend(fragment.iter().map(|name| (name, Stage::Fragment)));
                (shader, entries, bind, values)
            }
        };
        let shader = library.load(request)?;
        let entries = entry_names
            .into_iter()
            .map(|(name, stage)| self.entry(&shader, request, name, stage))
            .collect::<Result<Vec<usize>, Diagnostics>>()?;
        let mut used: Vec<usize> =
            entries.iter().flat_map(|&e| shader.interface.entries[e].globals.iter().copied()).collect();
        used.sort_unstable();
        used.dedup();
        let mut bindings = Vec::with_capacity(used.len());
        let mut settings = None;
        for global in used {
            let source = self.bind(&shader, request, global, bind)?;
            if source == Source::Settings {
                settings = Some(self.settings(&shader, request, global, values)?);
            }
            bindings.push(Bound { global, source });
        }
        let (mut targets, mut depth) = (Vec::new(), None);
        if let Step::Raster(raster) = &step {
            for target in &raster.targets {
                targets.push(self.written(request, &target.resource)?);
            }
            if let Some(target) = &raster.depth {
                depth = Some(self.written(request, &target.resource)?);
            }
        }
        let place = step.indirect().map(|(buffer, offset, bytes)| (buffer.to_owned(), offset, bytes));
        let mut linked =
            LinkedStep { step, shader, entries, bindings, settings, targets, depth, indirect: None };
        if let Some((buffer, offset, bytes)) = place {
            linked.indirect = Some(self.indirect(&linked, &buffer, offset, bytes)?);
        }
        Ok(linked)
    }

    /// Checks that what an indirect step reads its size from has been written when the step comes.
    fn check_order(&self, steps: &[LinkedStep]) -> Result<(), Diagnostics> {
        let mut written: Vec<ResourceId> = Vec::new();
        for step in steps {
            let own = self.planned.outputs.iter().flat_map(|port| port.members.iter().map(|(_, id)| *id));
            if let Some(Source::Resource(id)) = step.indirect
                && own.into_iter().any(|own| own == id)
                && !written.contains(&id)
            {
                return Err(self.error(
                    &codes::INDIRECT,
                    format!(
                        "{} cannot take its size from `{}`: no earlier step of the pass writes it",
                        step.request().path,
                        self.plan.resources[id.0 as usize].name
                    ),
                    None,
                    Vec::new(),
                ));
            }
            written.extend(step.written_buffers());
        }
        Ok(())
    }

    fn entry(
        &self,
        shader: &Shader,
        request: &Request,
        name: &str,
        stage: Stage,
    ) -> Result<usize, Diagnostics> {
        let entries = &shader.interface.entries;
        entries.iter().position(|entry| entry.name == name && entry.stage == stage).ok_or_else(|| {
            let found: Vec<String> =
                entries.iter().map(|e| format!("`{}` ({:?})", e.name, e.stage)).collect();
            let has = if found.is_empty() { "none".to_owned() } else { found.join(", ") };
            self.error(
                &codes::ENTRY,
                format!("{} has no {stage:?} entry point `{name}`", request.path),
                Some(shader.start()),
                vec![format!("it has {has}")],
            )
        })
    }

    fn bind(
        &self,
        shader: &Shader,
        request: &Request,
        global: usize,
        bind: &[(String, String)],
    ) -> Result<Source, Diagnostics> {
        let place = shader.global_place(global);
        let global = &shader.interface.globals[global];
        let renamed =
            bind.iter().find(|(name, _)| *name == global.name).map(|(_, resource)| resource.as_str());
        if renamed.is_none() {
            if global.name == "settings" {
                return Ok(Source::Settings);
            }
            if let Some((name, externals)) = externals::GLOBALS.iter().find(|(name, _)| *name == global.name)
            {
                if !self.declared.contains(*externals) {
                    return Err(self.error(
                        &codes::UNDECLARED,
                        format!(
                            "{} reads `{name}`, which the kind `{}` does not declare among its externals",
                            request.path, self.planned.kind
                        ),
                        place,
                        Vec::new(),
                    ));
                }
                return Ok(Source::External(name));
            }
        }
        let wanted = renamed.unwrap_or(&global.name);
        let named = self.names.find(wanted).ok_or_else(|| self.unknown(request, wanted, place.clone()))?;
        if let Some(output) = self.continued_as(named) {
            return Err(self.error(
                &codes::MISMATCH,
                format!(
                    "{}: `{}` is continued as `{output}`, which holds it when the pass begins",
                    request.path, named.name
                ),
                place,
                vec![format!("read `{output}` in its place, or link another input to the same `Prev`")],
            ));
        }
        if let Some(why) = mismatch(&global.kind, &named.desc, named.writable) {
            return Err(self.error(
                &codes::MISMATCH,
                format!(
                    "{}: `{}` is declared as {}, but `{}` is {}",
                    request.path,
                    global.name,
                    describe_global(&global.kind),
                    named.name,
                    describe(&named.desc)
                ),
                place,
                vec![why.to_owned()],
            ));
        }
        Ok(named.source.clone())
    }

    fn settings(
        &self,
        shader: &Shader,
        request: &Request,
        global: usize,
        values: &[(String, Value)],
    ) -> Result<SettingsFill, Diagnostics> {
        let of_struct = match &shader.interface.globals[global].kind {
            GlobalKind::Uniform { layout } => shader.interface.layout(&layout.ty),
            _ => None,
        };
        let layout = of_struct.ok_or_else(|| {
            self.error(
                &codes::SETTINGS,
                format!("{}: `settings` must be a `var<uniform>` of a struct", request.path),
                shader.global_place(global),
                Vec::new(),
            )
        })?;
        let mut known: BTreeMap<String, Value> = BTreeMap::new();
        for port in self.inputs.iter().chain(self.outputs) {
            if let Some(texture) = port.members.iter().find_map(|(_, desc)| desc.texture()) {
                known.insert(
                    format!("{}_size", port.name),
                    Value::Vector(vec![texture.size.0 as f32, texture.size.1 as f32]),
                );
                known.insert(format!("{}_layers", port.name), Value::U32(texture.layers));
            }
            for (fact, value) in port.facts.iter().filter(|(_, value)| value.as_text().is_none()) {
                known.entry(format!("{}_{fact}", port.name)).or_insert_with(|| value.clone());
            }
        }
        known.extend(
            self.planned.settings.0.iter().map(|(name, value)| (name.clone(), self.in_shader(name, value))),
        );
        known.extend(values.iter().cloned());
        let mut past = Vec::new();
        for input in &self.planned.inputs {
            if let Some(history) = input.history.as_ref().and_then(|histories| histories.first()) {
                past.push((format!("{}_age", input.port), *history, PastFact::Age));
                past.push((format!("{}_reset", input.port), *history, PastFact::Reset));
            }
        }
        let seeded = !known.contains_key("seed");
        for member in &layout.members {
            let answered = known.contains_key(&member.name)
                || past.iter().any(|(name, ..)| *name == member.name)
                || (seeded && member.name == "seed");
            // Padding has no meaning, and so no value.
            if !answered && !member.name.starts_with("pad") {
                let names = known
                    .keys()
                    .map(String::as_str)
                    .chain(past.iter().map(|(name, ..)| name.as_str()))
                    .chain(["seed"]);
                let mut notes = nearest(&member.name, names)
                    .map(|name| format!("did you mean `{name}`?"))
                    .into_iter()
                    .collect::<Vec<_>>();
                notes.push(format!(
                    "it is neither a setting of the kind `{}` nor a fact of a port",
                    self.planned.kind
                ));
                return Err(self.error(
                    &codes::VALUE,
                    format!("{}: nothing gives `settings.{}` a value", request.path, member.name),
                    shader.member_place(&layout.name, &member.name),
                    notes,
                ));
            }
        }
        known.retain(|name, _| layout.members.iter().any(|member| member.name == *name));
        for member in layout.members.iter().filter(|member| member.name.starts_with("pad")) {
            known.entry(member.name.clone()).or_insert(Value::U32(0));
        }
        let fill = SettingsFill { layout: layout.clone(), values: known, past, seeded };
        match shader_library::write_struct(&fill.layout, &|name| fill.value(name, 0, |_, _| 0)) {
            Ok(_) => Ok(fill),
            Err(refused) => Err(self.error(
                &codes::VALUE,
                format!("{}: {refused}", request.path),
                shader.global_place(global),
                Vec::new(),
            )),
        }
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

    /// The buffer that an indirect dispatch or draw takes its size from. The step itself cannot write it.
    fn indirect(
        &self,
        step: &LinkedStep,
        buffer: &str,
        offset: u64,
        bytes: u64,
    ) -> Result<Source, Diagnostics> {
        let request = step.request();
        let named = self.names.find(buffer).ok_or_else(|| self.unknown(request, buffer, None))?;
        let refused = |why: String| {
            let message = format!("{} cannot take its size from `{buffer}`: {why}", request.path);
            Err(self.error(&codes::INDIRECT, message, None, Vec::new()))
        };
        let ResourceDesc::Buffer(desc) = &named.desc else {
            return refused(format!("it is {}, not a buffer", describe(&named.desc)));
        };
        if !offset.is_multiple_of(4) {
            return refused(format!("the offset {offset} is no multiple of 4"));
        }
        if offset.checked_add(bytes).is_none_or(|end| end > desc.bytes) {
            return refused(format!(
                "{bytes} bytes from the offset {offset} go beyond its {} bytes",
                desc.bytes
            ));
        }
        if let Some(output) = self.continued_as(named) {
            return refused(format!("it is continued as `{output}`, which holds it when the pass begins"));
        }
        if step.written_buffers().any(|id| named.source == Source::Resource(id)) {
            return refused("the same step writes it; an earlier one has to".to_owned());
        }
        Ok(named.source.clone())
    }

    /// The output that continues a member of an input: the two may be one object.
    fn continued_as(&self, named: &Named) -> Option<String> {
        let port = named.name.split('.').next().unwrap_or("");
        let continued = self.planned.continues.iter().find(|continued| {
            continued.input == *port
                && match (continued.from, &named.source) {
                    (Begins::InPlace(a) | Begins::CopyOfPast(a), Source::Past(b)) => a == *b,
                    _ => false,
                }
        })?;
        Some(self.plan.resources[continued.resource.0 as usize].name.to_string())
    }

    fn written(&self, request: &Request, name: &str) -> Result<ResourceId, Diagnostics> {
        match self.names.find(name) {
            Some(Named { writable: true, source: Source::Resource(id), .. }) => Ok(*id),
            Some(_) => Err(self.error(
                &codes::MISMATCH,
                format!("{}: `{name}` is an input and cannot be drawn to", request.path),
                None,
                Vec::new(),
            )),
            None => Err(self.unknown(request, name, None)),
        }
    }

    fn unknown(&self, request: &Request, name: &str, place: Option<Span>) -> Diagnostics {
        let names: Vec<String> = self.names.all().collect();
        let mut notes: Vec<String> = nearest(name, names.iter().map(String::as_str))
            .map(|name| format!("did you mean `{name}`?"))
            .into_iter()
            .collect();
        notes.push(format!("there is: {}", self.names.own().collect::<Vec<_>>().join(", ")));
        self.error(
            &codes::UNKNOWN,
            format!("{} uses `{name}`, which is no port, scratch or external of the pass", request.path),
            place,
            notes,
        )
    }

    /// Returns an error at the place in the shader where the name at fault is declared, where it is declared there.
    fn error(
        &self,
        code: &'static Code,
        message: String,
        place: Option<Span>,
        mut notes: Vec<String>,
    ) -> Diagnostics {
        notes.push(format!("in pass `{}` of kind `{}`", self.planned.name, self.planned.kind));
        let labels = place.into_iter().map(|span| Label { span, message: String::new() }).collect();
        Diagnostic { labels, notes, ..Diagnostic::new(code, message) }.into()
    }
}
