//! Checks the names and values of a study.

use super::names::located;
use super::{Resolved, combinations_of, product};
use crate::codes;
use crate::description::{
    At, Budget, Group, Pipelines, Reference, Relation, SEED, SIZE, Set, Study, StudyFigure, TRIANGLES,
    Variant,
};
use crate::error::Failure;
use crate::laboratory::{PipelineFacts, Registry, SceneFacts, Values};
use crate::measure::Measure;
use crate::phase::all_names;
use crate::record::{Axis, AxisValue, PipelineRecord};
use data_file::Code;
use frame_graph::{Diagnostic, Diagnostics, Misfit, Setting, Severity, ValueType};

pub(super) struct Checker<'a> {
    pub(super) study: &'a Study,
    pub(super) registry: &'a dyn Registry,
    pub(super) errors: Vec<Diagnostic>,
    /// Names that mean a file beside the study, and could mean one of the roots.
    pub(super) notes: Vec<Diagnostic>,
    /// Each pipeline that was looked up, the reference's too, with its outputs, and whether it has the study's.
    outputs: Vec<(String, Vec<String>, bool)>,
}

impl<'a> Checker<'a> {
    pub(super) fn new(study: &'a Study, registry: &'a dyn Registry) -> Checker<'a> {
        Checker { study, registry, errors: Vec::new(), notes: Vec::new(), outputs: Vec::new() }
    }

    /// Returns what is worth a note.
    pub(super) fn finish(mut self) -> Result<Diagnostics, Diagnostics> {
        self.errors.extend(self.without_output());
        self.notes.extend(self.cold_times());
        if self.errors.is_empty() {
            Ok(Diagnostics::sorted(self.notes))
        } else {
            Err(Diagnostics::sorted(self.errors))
        }
    }

    /// Warns about times of frames in which the driver may compile.
    fn cold_times(&self) -> Option<Diagnostic> {
        let times = self.study.measures.iter().find(|at| at.value == Measure::GpuMs);
        let span = match (times, self.study.phases.first()) {
            _ if self.study.warm_up > 0 => return None,
            (Some(times), _) => times.span.clone(),
            (None, Some(phase)) => phase.name.span.clone(),
            (None, None) => return None,
        };
        let message = "times without warm-up hold what the driver compiles in the first frame of a pipeline";
        let warning =
            Diagnostic::warning(&codes::COLD, Severity::Warning, message).label(span, "measured here");
        Some(warning.note("`warm_up: 1`, the default, leaves the first frame out"))
    }

    pub(super) fn scenes(&mut self) -> Vec<(String, SceneFacts)> {
        let mut found = Vec::new();
        for scene in &self.study.scenes {
            if !self.may_name(&codes::SCENE, scene) {
                continue;
            }
            self.note_shadowed("scenes", scene);
            match self.registry.scene(&located(self.registry, scene)) {
                Ok(mut facts) => {
                    facts.record.name.clone_from(&scene.value);
                    found.push((scene.value.clone(), facts));
                }
                Err(why) => {
                    let known = self.registry.scenes();
                    self.errors.push(refused(&codes::SCENE, "scene", scene, Some(&why), &known));
                }
            }
        }
        found
    }

    fn facts(&mut self, name: &At<String>) -> Option<PipelineFacts> {
        if !self.may_name(&codes::PIPELINE, name) {
            return None;
        }
        self.note_shadowed("pipelines", name);
        match self.registry.pipeline(&located(self.registry, name)) {
            Ok(facts) => Some(facts),
            Err(why) => {
                let known = self.registry.pipelines();
                self.errors.push(refused(&codes::PIPELINE, "pipeline", name, Some(&why), &known));
                None
            }
        }
    }

    /// Returns the pipelines with the values that hold in all their cells.
    pub(super) fn pipelines(&mut self) -> Vec<Resolved> {
        let variants = match &self.study.pipelines {
            Pipelines::These(variants) => variants.clone(),
            Pipelines::All { except, span } => {
                let names = self.registry.pipelines();
                for name in except.iter().filter(|name| !names.contains(&name.value)) {
                    self.errors.push(refused(&codes::PIPELINE, "pipeline", name, None, &names));
                }
                let wanted =
                    names.into_iter().filter(|name| !except.iter().any(|other| other.value == *name));
                // A pipeline that is broken, or has no such output, cannot be compared and is left out.
                let usable = wanted.filter(|name| {
                    self.registry.pipeline(name).is_ok_and(|facts| facts.has_output(&self.study.output.value))
                });
                let at = |value: String| At { value, span: span.clone() };
                let variant = |name: String| Variant {
                    name: at(name.clone()),
                    pipeline: at(name),
                    set: Vec::new(),
                    external: None,
                };
                usable.map(variant).collect()
            }
        };
        if variants.is_empty()
            && let Pipelines::All { span, .. } = &self.study.pipelines
        {
            let message = format!("no pipeline is left that has the output `{}`", self.study.output.value);
            self.errors.push(Diagnostic::new(&codes::EMPTY, message).label(span.clone(), ""));
        }
        let mut found = Vec::new();
        for variant in variants {
            if let Some(external) = &variant.external {
                found.push(self.external(&variant, external));
                continue;
            }
            let Some(facts) = self.facts(&variant.pipeline) else { continue };
            self.output(&variant.pipeline, &facts);
            let has = |set: &&Set| facts.settings.iter().any(|settable| settable.path == set.path.value);
            let set = self.study.set.iter().filter(has).chain(&variant.set);
            let set: Vec<(String, AxisValue)> =
                set.map(|set| (set.path.value.clone(), set.value.value.clone())).collect();
            for own in &variant.set {
                self.value(&variant.name.value, &facts, own, false);
            }
            let record = PipelineRecord {
                name: variant.name.value,
                pipeline: located(self.registry, &variant.pipeline),
                about: facts.about.clone(),
                paper: facts.paper.clone(),
                set: set.iter().cloned().collect(),
            };
            found.push(Resolved { record, facts, set, external: None });
        }
        found
    }

    /// Notes the outputs of a pipeline for [`Checker::without_output`].
    fn output(&mut self, pipeline: &At<String>, facts: &PipelineFacts) {
        if !self.outputs.iter().any(|(name, ..)| *name == pipeline.value) {
            let has = facts.has_output(&self.study.output.value);
            self.outputs.push((pipeline.value.clone(), facts.outputs.clone(), has));
        }
    }

    /// Returns the error for the pipelines that lack the study's output: one for all, where the study names it.
    fn without_output(&self) -> Option<Diagnostic> {
        let output = &self.study.output;
        let lacking: Vec<String> =
            self.outputs.iter().filter(|(.., has)| !has).map(|(name, ..)| format!("`{name}`")).collect();
        if lacking.is_empty() {
            return None;
        }
        // An output that all of them have would do; else the names of those that lack this one.
        let all: Vec<&[String]> = self.outputs.iter().map(|(_, outputs, _)| outputs.as_slice()).collect();
        let mut known: Vec<&str> = Vec::new();
        for (_, outputs, _) in self.outputs.iter().filter(|(.., has)| !has) {
            known.extend(outputs.iter().map(String::as_str));
        }
        known.sort_unstable();
        known.dedup();
        let shared: Vec<&str> = known
            .iter()
            .copied()
            .filter(|name| all.iter().all(|outputs| outputs.iter().any(|output| output == name)))
            .collect();
        let (what, names) =
            if shared.is_empty() { ("outputs", known) } else { ("outputs of all pipelines here", shared) };
        let verb = if lacking.len() == 1 { "has" } else { "have" };
        let message = format!("{} {verb} no output `{}`", lacking.join(", "), output.value);
        let error = output.unknown(&codes::OUTPUT, message, what, names);
        let text = output.span.source.text.get(output.span.start as usize..output.span.end as usize);
        let is_stated = text.is_some_and(|text| text.contains('"'));
        Some(if is_stated { error } else { error.note("a study without `output:` measures `indirect`") })
    }

    /// Checks a value of a single pipeline.
    fn value(&mut self, name: &str, facts: &PipelineFacts, set: &Set, optional: bool) {
        let found = facts.settings.iter().find(|settable| settable.path == set.path.value);
        match found {
            Some(settable) => self.fits(name, &settable.setting, &set.path.value, &set.value),
            None if optional => {}
            None => self.unknown(&[name], &set.path, facts),
        }
    }

    fn fits(&mut self, pipeline: &str, setting: &Setting, path: &str, value: &At<AxisValue>) {
        let setting = Setting { name: path.to_owned(), ..setting.clone() };
        let Err(Misfit::Type(message) | Misfit::Range(message)) = setting.check(value.value.to_value())
        else {
            return;
        };
        let error = value.error(&codes::VALUE, message);
        // Pipelines that share a declaration give the same error, which is reported once.
        if !self.errors.iter().any(|other| other.message == error.message && other.labels == error.labels) {
            self.errors.push(error.note(format!("in the pipeline `{pipeline}`")));
        }
    }

    fn unknown(&mut self, pipelines: &[&str], path: &At<String>, facts: &PipelineFacts) {
        let names: Vec<String> = pipelines.iter().map(|name| format!("`{name}`")).collect();
        let verb = if names.len() == 1 { "has" } else { "have" };
        let message = format!("{} {verb} no parameter or setting `{}`", names.join(", "), path.value);
        let known: Vec<&str> = facts.settings.iter().map(|settable| settable.path.as_str()).collect();
        self.errors.push(match &known[..] {
            [] => path.error(&codes::PATH, message),
            _ => path.unknown(&codes::PATH, message, "there are", known),
        });
    }

    /// Checks a path that several pipelines are given: reports those that lack it, unless it is optional.
    fn path<'r>(
        &mut self,
        path: &At<String>,
        optional: bool,
        form: Option<&str>,
        pipelines: impl IntoIterator<Item = &'r Resolved>,
    ) {
        let (having, lacking): (Vec<&Resolved>, Vec<&Resolved>) =
            pipelines.into_iter().partition(|pipeline| pipeline.has(&path.value));
        let Some(first) = lacking.first() else { return };
        let all = having.is_empty();
        if optional && !all {
            return;
        }
        let names: Vec<&str> = lacking.iter().map(|pipeline| pipeline.record.name.as_str()).collect();
        self.unknown(&names, path, &first.facts);
        if let (false, Some(form), Some(error)) = (all, form, self.errors.last_mut()) {
            error.notes.push(format!("write `Optional({form})` where pipelines may go without it"));
        }
    }

    /// Returns the axes, for the record.
    pub(super) fn axes(&mut self, pipelines: &[Resolved]) -> Vec<Axis> {
        let study = self.study;
        let axes = study.vary.iter().flat_map(|group| group.axes());
        axes.map(|axis| {
            let values = axis.values.iter().map(|at| at.value.clone()).collect();
            let name = axis.path.value.clone();
            if name == SIZE {
                return Axis { name, doc: "Size of the frame".to_owned(), unit: "px".to_owned(), values };
            }
            self.path(&axis.path, axis.optional, Some("[…]"), pipelines);
            for pipeline in pipelines {
                for (setting, value) in
                    axis.values.iter().filter_map(|at| Some((pipeline.setting(&name)?, at)))
                {
                    self.fits(&pipeline.record.name, setting, &name, value);
                }
            }
            let setting = pipelines.iter().find_map(|pipeline| pipeline.setting(&name));
            Axis {
                doc: setting.map(|setting| setting.doc.clone()).unwrap_or_default(),
                unit: setting.map(|setting| setting.unit.clone()).unwrap_or_default(),
                name,
                values,
            }
        })
        .collect()
    }

    /// Checks the values that all pipelines are given.
    pub(super) fn sets(&mut self, pipelines: &[Resolved]) {
        for set in &self.study.set {
            self.path(&set.path, set.optional, Some("value"), pipelines);
            for pipeline in pipelines {
                self.value(&pipeline.record.name, &pipeline.facts, set, true);
            }
        }
    }

    /// Returns the properties of the pipeline that renders references.
    pub(super) fn reference(&mut self, scenes: &[(String, SceneFacts)]) -> Option<PipelineFacts> {
        match &self.study.reference {
            Reference::None => None,
            Reference::Pictures(files) => {
                for (_, file) in files {
                    self.may_name(&codes::REFERENCE, file);
                }
                for (name, _) in scenes {
                    let of = |at: &Option<At<String>>| at.as_ref().is_none_or(|scene| scene.value == *name);
                    if !files.iter().any(|(scene, _)| of(scene)) {
                        let scene = self.study.scenes.iter().find(|at| at.value == *name);
                        let message = format!("there is no picture for the scene `{name}`");
                        self.errors.extend(scene.map(|scene| scene.error(&codes::REFERENCE, message)));
                    }
                }
                for scene in files.iter().filter_map(|(scene, _)| scene.as_ref()) {
                    let known: Vec<&str> = self.study.scenes.iter().map(|at| at.value.as_str()).collect();
                    if !known.contains(&scene.value.as_str()) {
                        let message = format!("`{}` is no scene of this study", scene.value);
                        self.errors.push(scene.unknown(&codes::REFERENCE, message, "scenes", known));
                    }
                }
                None
            }
            Reference::Pipeline { pipeline, set, follow, .. } => {
                let facts = self.facts(pipeline)?;
                self.output(pipeline, &facts);
                for set in set {
                    self.value(&pipeline.value, &facts, set, set.optional);
                }
                let axes = follow.iter().filter(|at| at.value != SIZE && at.value != SEED);
                for axis in axes {
                    if !facts.settings.iter().any(|settable| settable.path == axis.value) {
                        self.unknown(&[&pipeline.value], axis, &facts);
                    }
                }
                Some(facts)
            }
        }
    }

    pub(super) fn budget(&mut self, scenes: &[(String, SceneFacts)], pipelines: &[Resolved]) {
        if let Budget::Time { by: None, .. } = self.study.budget
            && let Some((name, _)) = scenes.iter().find(|(_, facts)| facts.moves)
            && let Some(at) = self.study.scenes.iter().find(|at| at.value == *name)
        {
            let message = format!("time cannot be spent over frames of `{name}`, which moves");
            let note = "`Time(ms: …, by: \"lights\")` gives each frame its time";
            self.errors.push(at.error(&codes::BUDGET, message).note(note));
        }
        let Some(by) = self.study.budget.by() else { return };
        // A program is given its time.
        let is_timed = matches!(self.study.budget, Budget::Time { .. });
        let chosen = pipelines.iter().filter(|pipeline| !(is_timed && pipeline.external.is_some()));
        self.path(by, false, None, chosen);
        for pipeline in pipelines {
            let Some(setting) = pipeline.setting(&by.value) else { continue };
            if let Budget::Lights { count, .. } = &self.study.budget {
                let value = At { value: AxisValue::Number(f64::from(count.value)), span: count.span.clone() };
                self.fits(&pipeline.record.name, setting, &by.value, &value);
            } else if !matches!(setting.ty, ValueType::U32 | ValueType::I32) {
                let message =
                    format!("a budget sets whole numbers, and `{}` is of type {}", by.value, setting.ty);
                let note = format!("in the pipeline `{}`", pipeline.record.name);
                self.errors.push(by.error(&codes::BUDGET, message).note(note));
            }
        }
    }

    /// Checks that each pass of a phase and each figure exists in some pipeline. Those of a pipeline that cannot be
    /// used are unknown.
    pub(super) fn phases_and_figures(&mut self, pipelines: &[Resolved]) {
        if self.errors.iter().any(|error| error.code == codes::PIPELINE.code) {
            return;
        }
        let passes = pipelines.iter().flat_map(|pipeline| &pipeline.facts.passes);
        let passes = all_names(passes.map(String::as_str));
        let figures = pipelines.iter().flat_map(|pipeline| &pipeline.facts.figures);
        let figures: Vec<&str> = figures.map(String::as_str).collect();
        let mut check = |name: &At<String>, code, (one, many): (&str, &str), known: &[&str]| {
            if !known.contains(&name.value.as_str()) {
                let message = format!("no pipeline has a {one} `{}`", name.value);
                self.errors.push(name.unknown(code, message, many, known.iter().copied()));
            }
        };
        for pass in self.study.phases.iter().flat_map(|phase| &phase.passes) {
            check(pass, &codes::PHASE, ("pass or sub-graph", "passes and sub-graphs"), &passes);
        }
        for StudyFigure { of, .. } in &self.study.figures {
            check(of, &codes::FIGURE, ("figure", "figures"), &figures);
        }
    }

    /// Checks that claims are about pipelines of the study that have the axes of their picks.
    pub(super) fn claims(&mut self, pipelines: &[Resolved]) {
        // Pipelines that cannot be used are reported elsewhere.
        let known: Vec<&str> = match &self.study.pipelines {
            Pipelines::These(variants) => {
                variants.iter().map(|variant| variant.name.value.as_str()).collect()
            }
            Pipelines::All { .. } => pipelines.iter().map(|pipeline| pipeline.record.name.as_str()).collect(),
        };
        let picks = self.study.claims.iter().flat_map(|claim| {
            let over = match &claim.relation {
                Relation::Growth { over, .. } if over.value != TRIANGLES => Some(over),
                _ => None,
            };
            claim.relation.picks().into_iter().map(move |pick| (pick, over))
        });
        for (pick, over) in picks {
            let name = &pick.pipeline;
            if !known.contains(&name.value.as_str()) {
                let message = format!("no pipeline of this study is named `{}`", name.value);
                self.errors.push(name.unknown(&codes::CLAIM, message, "pipelines", known.iter().copied()));
            }
            let Some(found) = pipelines.iter().find(|pipeline| pipeline.record.name == name.value) else {
                continue;
            };
            let axes = pick.at.iter().map(|(axis, _)| axis).chain(over);
            for axis in axes.filter(|axis| axis.value != SIZE && !found.has(&axis.value)) {
                let message = format!("`{}` has no axis `{}`, and so no cells there", name.value, axis.value);
                self.errors.push(axis.error(&codes::CLAIM, message));
            }
        }
    }

    /// Returns every combination of the values of all axes.
    pub(super) fn combinations(&mut self, most: usize, times: usize) -> Vec<Values> {
        let study = self.study;
        let count = study.vary.iter().fold(times, |count, group| {
            let sizes = group.axes().iter().map(|axis| axis.values.len());
            let of_group = match group {
                Group::Grid(_) => sizes.fold(1, usize::saturating_mul),
                Group::Paired(_) => sizes.min().unwrap_or(0),
            };
            count.saturating_mul(of_group)
        });
        if count > most {
            let place = study.vary.first().and_then(|group| group.axes().first());
            let error = Diagnostic::new(
                &codes::RANGE,
                format!("these are {count} cells; a study has at most {most}"),
            );
            self.errors.push(match place {
                Some(axis) => error.label(axis.path.span.clone(), ""),
                None => error,
            });
            return Vec::new();
        }
        study.vary.iter().fold(vec![Vec::new()], |rows, group| product(&rows, &combinations_of(group)))
    }
}

/// Returns the error for a pipeline that cannot be used: the reason if it exists, otherwise the names that
/// exist.
fn refused(
    code: &'static Code,
    what: &str,
    name: &At<String>,
    why: Option<&Failure>,
    known: &[String],
) -> Diagnostic {
    let is_file = name.value.contains(['/', '\\', '.']);
    if let Some(why) = why.filter(|_| is_file || known.contains(&name.value)) {
        return name.error(code, format!("the {what} `{}` cannot be used", name.value)).note(why.to_string());
    }
    let message = format!("there is no {what} `{}`", name.value);
    name.unknown(code, message, &format!("{what}s"), known.iter().map(String::as_str))
}
