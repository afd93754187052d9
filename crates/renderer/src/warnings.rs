//! Warnings about what a pipeline renders otherwise than its user may expect.

use crate::Compiled;
use catalog::Catalog;
use frame_graph::codes::{LEFT_OUT, NO_EFFECT};
use frame_graph::plan::Fate;
use frame_graph::port::PassTypes as _;
use frame_graph::{
    CompileOptions, Diagnostic, Diagnostics, LinkContext, Overrides, Plan, Resolved, Severity, Source, Span,
    Traits, Use, Value, compile, link, resolve,
};

impl Compiled {
    /// Returns what is no error and perhaps not meant: the warnings of the files, overrides that change nothing, and
    /// light of the scene that the pipeline leaves out. The arguments are those that it was compiled with.
    pub fn warnings(
        &self,
        catalog: &Catalog,
        pipeline: &str,
        overrides: &Overrides,
        context: &LinkContext,
        options: &CompileOptions,
    ) -> Diagnostics {
        let Diagnostics(mut all) = self.of_files(catalog);
        let given = (pipeline, overrides);
        all.extend(without_effect(catalog, given, (&self.resolved, &self.plan), context, options));
        all.extend(self.left_out(catalog, &context.traits));
        Diagnostics(all)
    }

    /// Returns the warnings of the files, and of the plan that they give.
    pub fn of_files(&self, catalog: &Catalog) -> Diagnostics {
        let Diagnostics(mut all) = self.resolved.warnings();
        all.extend(self.resolved.against_interfaces(&self.plan, catalog.interfaces()));
        Diagnostics(all)
    }

    /// Notes light of a scene with these traits that the pipeline does not model: that of surfaces that emit and of the
    /// environment, where no step reads them as sources; and what an input is for that has the name of a trait and is not linked.
    fn left_out(&self, catalog: &Catalog, traits: &Traits) -> Vec<Diagnostic> {
        let has = |name: &str| traits.values.get(name) == Some(&Value::Bool(true));
        let mut notes = Vec::new();
        let mut note = |message: String| {
            let note = Diagnostic::warning(&LEFT_OUT, Severity::Note, message);
            notes.push(note.note("the pipeline `reference` models it"));
        };
        let read: Vec<&str> = self.steps.iter().flatten().flat_map(|step| step.scene_bindings()).collect();
        if has("emissive") && !read.contains(&"scene_emitters") {
            note(
                "the scene has surfaces that emit: they are seen, and no pass lights others by them"
                    .to_owned(),
            );
        }
        // Passes that only show the environment read its radiance alone.
        if has("environment") && !read.contains(&"scene_environment_table") {
            note("the scene has an environment: it is seen, and no pass lights surfaces by it".to_owned());
        }
        for pass in &self.plan.passes {
            let names: Vec<String> = pass.inputs.iter().map(|input| input.port.to_string()).collect();
            let (shader, outputs) = (pass.shader.as_deref(), &*pass.overrides);
            let use_ = Use { kind: &pass.kind, shader, inputs: &names, outputs };
            let Ok(ports) = catalog.ports(use_, &pass.settings) else { continue };
            for input in ports.inputs.iter().filter(|input| has(&input.name) && !names.contains(&input.name))
            {
                note(format!(
                    "the scene is {}, and nothing is linked to `{}.{}`: {}",
                    input.name, pass.name, input.name, input.doc
                ));
            }
        }
        notes
    }
}

/// Warns about overrides of a pipeline with and without which its plan is the same, though they are other values.
pub fn without_effect(
    catalog: &Catalog,
    (pipeline, overrides): (&str, &Overrides),
    (resolved, plan): (&Resolved, &Plan),
    context: &LinkContext,
    options: &CompileOptions,
) -> Vec<Diagnostic> {
    let last = |(i, given): &(usize, &(String, Value))| {
        !overrides.0[i + 1..].iter().any(|(path, _)| *path == given.0)
    };
    let given = overrides.0.iter().enumerate().filter(last).map(|(_, given)| given);
    let has_no_effect = |(path, _): &&(String, Value)| {
        let others = overrides.0.iter().filter(|(other, _)| other != path).cloned().collect();
        let Ok(without) = resolve(pipeline, catalog.pipelines(), &Overrides(others)) else { return false };
        let value = |resolved: &Resolved| {
            let one = resolved.settable(catalog).into_iter().find(|one| one.path == **path)?;
            one.value.convert(one.setting.ty)
        };
        if value(resolved) == value(&without) {
            return false;
        }
        let same = |other: &Plan| other.id == plan.id;
        match plan.with_values(resolved, &without, catalog, context) {
            Some(other) => same(&other),
            None => link(&without, catalog, context)
                .and_then(|graph| compile(&graph, options))
                .is_ok_and(|other| same(&other)),
        }
    };
    given.filter(has_no_effect).map(|(path, value)| no_effect(path, value, plan)).collect()
}

/// Returns the warning about a value that changes nothing, with the reason.
fn no_effect(path: &str, value: &Value, plan: &Plan) -> Diagnostic {
    let source = Source::new("--set", format!("{path}={value}"));
    let span = Span { source, start: 0, end: path.len() as u32 };
    let message = format!("`{path}` has no effect: with it the pipeline is the same as without it");
    let warning = Diagnostic::warning(&NO_EFFECT, Severity::Warning, message).label(span, "");
    let pass = path.rsplit_once('.').map_or("", |(pass, _)| pass);
    match plan.fates.iter().find(|(name, _)| *name == *pass) {
        Some((_, Fate::Culled { .. })) => warning.note(format!("no output that is rendered needs `{pass}`")),
        Some((_, Fate::Off { why, .. })) => warning.note(format!("`{pass}` is off: {why}")),
        _ => warning.note("no pass that runs takes it"),
    }
}
