//! Compiles a pipeline, from its name to linked steps, without a GPU: what `check` verifies and an executor runs.

use catalog::Catalog;
use frame_graph::plan::{PassId, PlannedPass};
use frame_graph::{
    CompileOptions, Diagnostic, Diagnostics, Graph, LinkContext, Overrides, Plan, Resolved, SceneBindings,
    compile, link, resolve, unite,
};
use interfaces::counters;
use pass::codes;
use pass::{LinkedSteps, link_steps};
use rayon::prelude::*;
use std::sync::Arc;

/// Returns the options with which a renderer compiles: outputs of the interface `Counters` are kept.
pub fn compile_options() -> CompileOptions {
    CompileOptions { keep_interfaces: vec![counters::INTERFACE.name.to_owned()], ..CompileOptions::default() }
}

/// A pipeline, compiled as far as is possible without a GPU.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// The flattened description.
    pub resolved: Arc<Resolved>,
    /// The plan.
    pub plan: Arc<Plan>,
    /// The linked steps of each pass of the plan.
    pub steps: Vec<LinkedSteps>,
}

impl Compiled {
    /// Returns whether frames are samples of their own: whether a pass asks for the place of a sample in the pixel.
    pub fn is_sampled(&self) -> bool {
        self.plan.passes.iter().any(|pass| pass.scene_bindings.contains(SceneBindings::SAMPLE))
    }

    /// Returns the pipeline with other overrides, in the same context; `options` are those that it was compiled with.
    ///
    /// Where only values of settings differ, only the passes that these reach are linked again: see
    /// [`Plan::with_values`].
    ///
    /// # Errors
    /// As [`Compiled::new`].
    pub fn with_overrides(
        &self,
        catalog: &Catalog,
        pipeline: &str,
        overrides: &Overrides,
        context: &LinkContext,
        options: &CompileOptions,
    ) -> Result<Compiled, Diagnostics> {
        let resolved = resolve(pipeline, catalog.pipelines(), overrides)?;
        let Some(plan) = self.plan.with_values(&self.resolved, &resolved, catalog, context) else {
            return Compiled::of(catalog, resolved, context, options);
        };
        let steps = link_all(catalog, &resolved, &plan, context, |pass| {
            let same = same_values(&self.plan.passes[pass], &plan.passes[pass]);
            same.then(|| self.steps[pass].clone())
        })?;
        Ok(Compiled { resolved: Arc::new(resolved), plan: Arc::new(plan), steps })
    }

    /// Resolves, links and compiles a pipeline, and links the steps of its passes.
    ///
    /// # Errors
    /// Everything that is wrong with the pipeline or, where that is sound, with its shaders.
    pub fn new(
        catalog: &Catalog,
        pipeline: &str,
        overrides: &Overrides,
        context: &LinkContext,
        options: &CompileOptions,
    ) -> Result<Compiled, Diagnostics> {
        Compiled::of(catalog, resolve(pipeline, catalog.pipelines(), overrides)?, context, options)
    }

    /// Compiles several variants of a pipeline into one plan, in which what is equal runs once: see [`unite`]. The first is
    /// the pipeline itself.
    ///
    /// # Errors
    /// As [`Compiled::new`], of any variant.
    ///
    /// # Panics
    /// If there is no variant.
    pub fn united(
        catalog: &Catalog,
        variants: &[Resolved],
        context: &LinkContext,
        options: &CompileOptions,
    ) -> Result<Compiled, Diagnostics> {
        let graphs: Vec<Graph> =
            variants.par_iter().map(|variant| link(variant, catalog, context)).collect::<Result<_, _>>()?;
        Compiled::of_graph(catalog, variants[0].clone(), &unite(&graphs), context, options)
    }

    fn of(
        catalog: &Catalog,
        resolved: Resolved,
        context: &LinkContext,
        options: &CompileOptions,
    ) -> Result<Compiled, Diagnostics> {
        let linking = tracing::info_span!(target: "phase", "graph linked and planned").entered();
        let graph = link(&resolved, catalog, context)?;
        drop(linking);
        Compiled::of_graph(catalog, resolved, &graph, context, options)
    }

    fn of_graph(
        catalog: &Catalog,
        resolved: Resolved,
        graph: &Graph,
        context: &LinkContext,
        options: &CompileOptions,
    ) -> Result<Compiled, Diagnostics> {
        let planning = tracing::info_span!(target: "phase", "graph linked and planned").entered();
        let plan = compile(graph, options)?;
        drop(planning);
        let _phase = tracing::info_span!(target: "phase", "steps linked").entered();
        let steps = link_all(catalog, &resolved, &plan, context, |_| None)?;
        Ok(Compiled { resolved: Arc::new(resolved), plan: Arc::new(plan), steps })
    }

    /// Returns the shader files of the pipeline, each once, sorted.
    pub fn shader_files(&self) -> Vec<String> {
        let mut files: Vec<String> =
            self.steps.iter().flatten().flat_map(|step| step.shader.files().iter().cloned()).collect();
        files.sort();
        files.dedup();
        files
    }
}

/// Whether a pass has the same settings and facts in two plans that differ in nothing else.
fn same_values(a: &PlannedPass, b: &PlannedPass) -> bool {
    let inputs = a.inputs.iter().zip(&b.inputs).all(|(a, b)| a.facts == b.facts);
    let outputs = a.outputs.iter().zip(&b.outputs).all(|(a, b)| a.facts == b.facts);
    inputs && outputs && a.settings == b.settings
}

/// Links the steps of all passes, but for those that `known` has, in parallel: most of it is reading and validating
/// their shaders.
fn link_all(
    catalog: &Catalog,
    resolved: &Resolved,
    plan: &Plan,
    context: &LinkContext,
    known: impl Fn(usize) -> Option<LinkedSteps> + Sync,
) -> Result<Vec<LinkedSteps>, Diagnostics> {
    let layouts = scene_upload::layouts();
    let link = |(index, pass): (usize, &PlannedPass)| -> Option<Result<LinkedSteps, Vec<Diagnostic>>> {
        if let Some(known) = known(index) {
            return Some(Ok(known));
        }
        let (id, traits) = (PassId(index as u32), &context.traits);
        let kind = catalog.pass(&pass.kind)?;
        Some(match link_steps(plan, id, kind, traits, catalog.shaders(), catalog.interfaces()) {
            Ok(linked) => {
                let checks = linked.iter().map(|step| step.shader.check_layout(&layouts, "the renderer"));
                let wrong: Vec<Diagnostic> =
                    checks.filter_map(Result::err).flat_map(|Diagnostics(found)| found).collect();
                if wrong.is_empty() { Ok(linked) } else { Err(wrong) }
            }
            Err(Diagnostics(found)) => {
                Err(found.into_iter().map(|error| at_pass(error, resolved, &pass.name)).collect())
            }
        })
    };
    let linked: Vec<_> = plan.passes.par_iter().enumerate().map(link).collect();
    let mut errors: Vec<Diagnostic> = Vec::new();
    let mut steps = Vec::with_capacity(plan.passes.len());
    for linked in linked.into_iter().flatten() {
        match linked {
            Ok(linked) => steps.push(linked),
            Err(found) => errors.extend(found),
        }
    }
    if errors.is_empty() { Ok(steps) } else { Err(Diagnostics(each_once(errors))) }
}

/// Merges the errors of several passes: an error in a module that they import was found by each, and is reported once, with
/// the notes of all.
fn each_once(errors: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let mut merged: Vec<Diagnostic> = Vec::new();
    for error in errors {
        let same = |known: &&mut Diagnostic| {
            known.code == error.code && known.message == error.message && known.labels == error.labels
        };
        match merged.iter_mut().find(same) {
            None => merged.push(error),
            Some(known) => {
                for note in error.notes {
                    if !known.notes.contains(&note) {
                        known.notes.push(note);
                    }
                }
            }
        }
    }
    merged
}

/// Adds the place of the pass in its pipeline to an error that is the pass's own; errors in the text of a shader
/// concern every pass that uses it, and have a place of their own.
fn at_pass(error: Diagnostic, resolved: &Resolved, pass: &str) -> Diagnostic {
    let own = error.labels.is_empty() || codes::CODES.iter().any(|code| code.code == error.code);
    match resolved.pass_span(pass) {
        Some(span) if own => error.label(span, "in this pass"),
        _ => error,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use frame_graph::{Source, Span};

    #[test]
    fn an_error_of_a_module_is_reported_once_for_all_that_import_it() {
        let source = Source::new("shaders/random.wgsl", "let x = nosuch;");
        let error = |at: u32, notes: &[&str]| {
            let span = Span { source: source.clone(), start: at, end: at + 1 };
            let mut error = Diagnostic::new(codes::CODES[0], "no definition").label(span, "unknown");
            error.notes = notes.iter().map(|note| (*note).to_owned()).collect();
            error
        };
        let merged = each_once(vec![
            error(8, &["imported by a"]),
            error(8, &["imported by b", "in a variant"]),
            error(8, &["imported by a"]),
            error(4, &["imported by a"]),
        ]);
        assert_eq!(
            merged,
            [error(8, &["imported by a", "imported by b", "in a variant"]), error(4, &["imported by a"])]
        );
    }
}
