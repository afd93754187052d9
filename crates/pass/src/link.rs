//! Links the steps of a pass to the resources of a plan: shaders loaded, globals resolved by name, types
//! checked, uniforms laid out. All of this works without a GPU, so that `check` verifies what an executor will run.

use crate::codes;
use crate::record::{Compute, Draw, PortDesc, Raster, RecordContext, Recording, Step, WINDOW_ALIGNMENT};
use crate::{Interface, Pass, declaration, lights, scene_bindings};
use data_file::Code;
use fit::{describe, describe_global, mismatch};
use frame_graph::plan::{Begins, HistoryId, PassId, Plan, PlannedPass, ResourceId};
use frame_graph::{Diagnostic, Diagnostics, Label, ResourceDesc, Setting, Span, Traits, Use, nearest};
use names::{Named, Names};
use shader_library::{Global, GlobalKind, Library, Request, Shader, Stage};
use std::ops::Range;
use std::sync::Arc;

mod contents;
mod fit;
mod names;
mod uniform;

pub use contents::{BoundLayout, layout_of};
pub use uniform::{FrameValue, FrameWord, PastFact, UniformFill};
pub(crate) use uniform::{SAMPLE, SEED};

/// The source that a global is bound to.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A resource of the plan: this frame's version.
    Resource(ResourceId),
    /// The history buffer of a resource: its version of the frame before.
    Past(HistoryId),
    /// A scene binding, by the global's name.
    SceneBinding(&'static str),
    /// A scene binding that holds but the light of the sources of these names.
    ChosenLights {
        /// The global's name.
        global: &'static str,
        /// The names of lights, and of materials that emit.
        names: Arc<[String]>,
    },
    /// A uniform of the step: index into [`LinkedStep::uniforms`].
    Uniform(usize),
}

/// A global of a shader with what it is bound to.
#[derive(Clone, Debug)]
pub struct Bound {
    /// Index into the globals of the shader interface.
    pub global: usize,
    /// The source that it is bound to.
    pub source: Source,
    /// The bytes of its buffer that it sees; `None` for all.
    pub window: Option<Range<u64>>,
}

/// A step with all names resolved.
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
    /// The uniforms that the entry points use: `settings`, and those of modules.
    pub uniforms: Vec<UniformFill>,
    /// Color targets of a draw.
    pub targets: Vec<ResourceId>,
    /// Depth target of a draw.
    pub depth: Option<ResourceId>,
    /// The buffer that an indirect dispatch or draw reads its size from: a resource or a history buffer.
    pub indirect: Option<Source>,
}

/// The linked steps of a pass. An executor that is given the very steps that it has loaded does not build them again.
pub type LinkedSteps = Vec<Arc<LinkedStep>>;

impl LinkedStep {
    /// Returns the scene bindings that the step reads, by the names of their globals.
    pub fn scene_bindings(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.bindings.iter().filter_map(|bound| match bound.source {
            Source::SceneBinding(name) | Source::ChosenLights { global: name, .. } => Some(name),
            _ => None,
        })
    }

    /// Returns the names of the sources of light that the step takes alone; `None` where it takes all.
    pub fn chosen_lights(&self) -> Option<&Arc<[String]>> {
        self.bindings.iter().find_map(|bound| match &bound.source {
            Source::ChosenLights { names, .. } => Some(names),
            _ => None,
        })
    }

    /// Returns whether the step is a draw whose size is read from a buffer on the GPU.
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

    /// Returns whether the step needs an adapter with ray queries.
    pub fn queries_rays(&self) -> bool {
        let globals = &self.shader.interface.globals;
        self.bindings.iter().any(|bound| globals[bound.global].kind == GlobalKind::AccelerationStructure)
    }
}

/// Returns the seed of a pass: a hash of the run's seed and the pass's name, and of nothing else. The copies of a pass in a
/// graph of several variants have its seed. A run's seed of 0 gives every pass the seed 0: plain sequences, as the papers use
/// them.
pub fn pass_seed(run: u32, pass: &str) -> u32 {
    let pass = frame_graph::original_name(pass);
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
/// Errors of the pass itself, of its shaders, and of names that cannot be bound.
pub fn link_steps(
    plan: &Plan,
    id: PassId,
    kind: &dyn Pass,
    traits: &Traits,
    library: &Library,
    interfaces: &[Interface],
) -> Result<LinkedSteps, Diagnostics> {
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
    let main = kind.main_shader(&use_).ok();
    let context = RecordContext {
        main: main.as_ref(),
        name: &planned.name,
        use_,
        settings: &planned.settings,
        inputs: &inputs,
        outputs: &outputs,
        frame: plan.frame,
        traits,
        shaders: library,
        interfaces,
    };
    let recording: Recording = kind.record(&context).map_err(|error| {
        let mut notes: Vec<String> = error.help.into_iter().collect();
        notes.push(format!("in pass `{}` of pass type `{}`", planned.name, planned.kind));
        Diagnostics::from(Diagnostic { notes, ..Diagnostic::new(&codes::REFUSED, error.message) })
    })?;
    let schema = kind.settings(&context.use_context()).unwrap_or_default();
    let (names, inputs, outputs, schema) = (&names, &inputs[..], &outputs[..], &schema[..]);
    let linker = StepLinker { entry: "", planned, plan, names, inputs, outputs, schema, interfaces };
    let steps = recording
        .steps
        .into_iter()
        .map(|step| {
            let entry = step.entry().to_owned();
            StepLinker { entry: &entry, ..linker }.link(step, library).map(Arc::new)
        })
        .collect::<Result<LinkedSteps, Diagnostics>>()?;
    linker.check_order(&steps)?;
    Ok(steps)
}

#[derive(Clone, Copy)]
struct StepLinker<'a> {
    /// The entry point of the step that is linked: of a draw, that of the fragments where it has one.
    entry: &'a str,
    planned: &'a PlannedPass,
    plan: &'a Plan,
    names: &'a Names,
    inputs: &'a [PortDesc],
    outputs: &'a [PortDesc],
    schema: &'a [Setting],
    interfaces: &'a [Interface],
}

impl StepLinker<'_> {
    fn link(&self, step: Step, library: &Library) -> Result<LinkedStep, Diagnostics> {
        let (request, entry_names, bind, windows, values) = match &step {
            Step::Compute(Compute { shader, entry, bind, windows, values, .. }) => {
                (shader, vec![(entry, Stage::Compute)], bind, windows, values)
            }
            Step::Raster(Raster { shader, vertex, fragment, bind, windows, values, .. }) => {
                let mut entries = vec![(vertex, Stage::Vertex)];
                entries.extend(fragment.iter().map(|name| (name, Stage::Fragment)));
                (shader, entries, bind, windows, values)
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
        let mut uniforms = Vec::new();
        for global in used {
            let Global { name, kind, .. } = &shader.interface.globals[global];
            let renamed = bind.iter().find(|(from, _)| from == name).map(|(_, resource)| resource.as_str());
            let fill = if renamed.is_some() {
                None
            } else if name == "settings" {
                Some(self.settings(&shader, request, global, values)?)
            } else if let Some(port) = self.port_of_facts(name, kind) {
                Some(self.facts(&shader, request, global, port)?)
            } else {
                None
            };
            let source = match fill {
                Some(fill) => {
                    uniforms.push(fill);
                    Source::Uniform(uniforms.len() - 1)
                }
                None => self.bind(&shader, request, global, renamed)?,
            };
            let window = windows.iter().find(|(of, _)| of == name).map(|(_, bytes)| bytes.clone());
            if let Some(bytes) = &window {
                self.check_window(&shader, request, global, &source, bytes)?;
            }
            bindings.push(Bound { global, source, window });
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
            LinkedStep { step, shader, entries, bindings, uniforms, targets, depth, indirect: None };
        if let Some((buffer, offset, bytes)) = place {
            linked.indirect = Some(self.indirect(&linked, &buffer, offset, bytes)?);
        }
        Ok(linked)
    }

    /// Checks that what an indirect step reads its size from has been written when the step comes.
    fn check_order(&self, steps: &[Arc<LinkedStep>]) -> Result<(), Diagnostics> {
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
                        self.file(step.request()),
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
            let (file, variant) = (self.file(request), shader.variant());
            let of_variant =
                if variant.is_empty() { String::new() } else { format!("in the variant {variant} ") };
            let notes = vec![format!("{of_variant}it has {has}")];
            let message = format!("{file} has no {stage:?} entry point `{name}`");
            self.error(&codes::ENTRY, message, Some(shader.place_of_name(file, name)), notes)
        })
    }

    fn bind(
        &self,
        shader: &Shader,
        request: &Request,
        global: usize,
        renamed: Option<&str>,
    ) -> Result<Source, Diagnostics> {
        let place = shader.global_place(global);
        let global = &shader.interface.globals[global];
        let external =
            scene_bindings::GLOBALS.iter().find(|(name, _)| renamed.is_none() && *name == global.name);
        if let Some((name, scene_bindings)) = external {
            if !self.planned.scene_bindings.contains(*scene_bindings) {
                return Err(self.error(
                    &codes::UNDECLARED,
                    format!(
                        "{} reads `{name}`, which the pass type `{}` does not declare among its scene bindings",
                        self.file(request), self.planned.kind
                    ),
                    place,
                    Vec::new(),
                ));
            }
            let chosen =
                self.schema.iter().any(lights::is_setting).then(|| lights::chosen(&self.planned.settings));
            return Ok(match chosen.flatten().filter(|_| lights::GLOBALS.contains(name)) {
                Some(names) => Source::ChosenLights { global: name, names },
                None => Source::SceneBinding(name),
            });
        }
        let wanted = renamed.unwrap_or(&global.name);
        let named = self.names.find(wanted).ok_or_else(|| self.unknown(request, wanted, place.clone()))?;
        if let Some(output) = self.continued_as(named) {
            return Err(self.error(
                &codes::MISMATCH,
                format!(
                    "{}: `{}` is continued as `{output}`, which holds it when the pass begins",
                    self.file(request),
                    named.name
                ),
                place,
                vec![format!(
                    "read `{output}` in its place, or link another input to the same history buffer"
                )],
            ));
        }
        if let Some(why) = mismatch(&global.kind, &named.desc, named.writable) {
            return Err(self.error(
                &codes::MISMATCH,
                format!(
                    "{}: `{}` is declared as {}, but `{}` is {}",
                    self.file(request),
                    global.name,
                    describe_global(&global.kind),
                    named.name,
                    describe(&named.desc)
                ),
                place,
                vec![why.to_owned(), self.line_for(&global.name, named)],
            ));
        }
        Ok(named.source.clone())
    }

    /// Returns the advice by what line to declare a global of a resource.
    fn line_for(&self, global: &str, named: &Named) -> String {
        let (port, member) = named.name.split_once('.').unwrap_or((&named.name, ""));
        let mut ports = self.inputs.iter().chain(self.outputs);
        let interface = ports.find(|known| known.name == port).map(|known| &*known.interface);
        let interface = self.interfaces.iter().find(|known| Some(known.name) == interface);
        let content = interface.and_then(|known| known.member(member)).map(|member| member.content);
        let line = declaration::of_resource(global, &named.desc, content, named.writable);
        format!("declare it as `{line}`")
    }

    /// Checks that a global can see these bytes of what it is bound to.
    fn check_window(
        &self,
        shader: &Shader,
        request: &Request,
        global: usize,
        source: &Source,
        bytes: &Range<u64>,
    ) -> Result<(), Diagnostics> {
        let name = &shader.interface.globals[global].name;
        let resource = match source {
            Source::Resource(id) => Some(*id),
            Source::Past(history) => Some(self.plan.histories[history.0 as usize].resource),
            Source::SceneBinding(_) | Source::ChosenLights { .. } | Source::Uniform(_) => None,
        };
        let why = match resource.map(|id| &self.plan.resources[id.0 as usize].desc) {
            Some(ResourceDesc::Buffer(buffer)) if bytes.is_empty() || bytes.end > buffer.bytes => {
                format!("it has {} bytes", buffer.bytes)
            }
            Some(ResourceDesc::Buffer(_)) if !bytes.start.is_multiple_of(WINDOW_ALIGNMENT) => {
                format!("the first is no multiple of {WINDOW_ALIGNMENT}")
            }
            Some(ResourceDesc::Buffer(_)) => return Ok(()),
            _ => "it is no buffer of the graph".to_owned(),
        };
        let message = format!(
            "{}: `{name}` cannot see the bytes {} to {}: {why}",
            self.file(request),
            bytes.start,
            bytes.end
        );
        Err(self.error(&codes::MISMATCH, message, shader.global_place(global), Vec::new()))
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
            let message = format!("{} cannot take its size from `{buffer}`: {why}", self.file(request));
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
                format!("{}: `{name}` is an input and cannot be drawn to", self.file(request)),
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
            format!(
                "{} uses `{name}`, which is no port, scratch or external of the pass",
                self.file(request)
            ),
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
        notes.push(self.in_pass());
        let labels = place.into_iter().map(|span| Label { span, message: String::new() }).collect();
        Diagnostic { labels, notes, ..Diagnostic::new(code, message) }.into()
    }

    /// The file that errors name: that of the user's, where the use names one, and not the one that imports it.
    fn file<'s>(&'s self, request: &'s Request) -> &'s str {
        self.planned.shader.as_deref().unwrap_or(&request.path)
    }

    fn in_pass(&self) -> String {
        let (pass, kind) = (&self.planned.name, &self.planned.kind);
        let entry =
            if self.entry.is_empty() { String::new() } else { format!(", entry point `{}`", self.entry) };
        format!("in pass `{pass}` of pass type `{kind}`{entry}")
    }
}
