//! The warnings of a study.

use super::overrides;
use crate::context::Context;
use frame_graph::codes::NO_EFFECT;
use frame_graph::{
    Diagnostic, Diagnostics, LinkContext, Overrides, PlanId, Severity, Traits, compile, link, resolve,
};
use std::collections::{BTreeMap, BTreeSet};
use study::{Plan, RunRequest};

/// The most runs of a study that are compiled before it runs.
pub(crate) const MOST_RUNS: usize = 1000;

/// Returns the warnings of a study and of its pipelines, without duplicates.
pub(super) fn warnings(context: &Context, plan: &Plan) -> Diagnostics {
    let mut warnings = plan.notes.clone();
    let mut pipelines: Vec<&str> =
        plan.distinct_runs().into_iter().map(|run| run.pipeline.as_str()).collect();
    pipelines.sort_unstable();
    pipelines.dedup();
    for name in pipelines {
        // Pipelines of a plan are there; values change no warning.
        let resolved = resolve(name, context.catalog.pipelines(), &Overrides::default());
        for warning in resolved.map(|resolved| resolved.warnings().0).unwrap_or_default() {
            if !warnings.0.contains(&warning) {
                warnings.0.push(warning);
            }
        }
    }
    let ids = plan_ids(context, plan, &mut warnings.0);
    warnings.0.extend(without_effect(plan, ids));
    warnings
}

/// Returns the plan of each run of a study that has one, and adds the warnings about its textures.
fn plan_ids<'p>(
    context: &Context,
    plan: &'p Plan,
    warnings: &mut Vec<Diagnostic>,
) -> Vec<(&'p RunRequest, PlanId)> {
    let catalog = &context.catalog;
    let mut traits: BTreeMap<&str, Option<Traits>> = BTreeMap::new();
    let mut id_of = |run: &'p RunRequest| {
        let load = || renderer::load_scene(catalog, &run.scene).ok().map(|scene| scene.traits());
        let traits = traits.entry(&run.scene).or_insert_with(load).clone()?;
        let link_context = LinkContext { frame: run.size, traits };
        let resolved = resolve(&run.pipeline, catalog.pipelines(), &overrides(&run.set)).ok()?;
        let graph = link(&resolved, &**catalog, &link_context).ok()?;
        let compiled = compile(&graph, &renderer::compile_options()).ok()?;
        for warning in resolved.against_interfaces(&compiled, catalog.interfaces()) {
            if !warnings.contains(&warning) {
                warnings.push(warning);
            }
        }
        Some((run, compiled.id))
    };
    plan.distinct_runs().into_iter().take(MOST_RUNS).filter_map(&mut id_of).collect()
}

/// Warns about axes whose values change nothing of a pipeline: the runs that differ in no other value have one plan.
pub(crate) fn without_effect<'p>(
    plan: &Plan,
    runs: impl IntoIterator<Item = (&'p RunRequest, PlanId)>,
) -> Vec<Diagnostic> {
    // For each pipeline and axis, the plans of the runs that are alike in all else.
    let mut plans: BTreeMap<(&str, &str), BTreeMap<String, Vec<PlanId>>> = BTreeMap::new();
    for (run, id) in runs {
        for (path, _) in run.set.iter().filter(|(path, _)| plan.axes.iter().any(|axis| axis.name == **path)) {
            let others: Vec<_> = run.set.iter().filter(|(other, _)| other != path).collect();
            let key = format!("{} {:?} {others:?}", run.scene, run.size);
            plans.entry((&run.pipeline, path)).or_default().entry(key).or_default().push(id);
        }
    }
    let is_same = |ids: &Vec<PlanId>| ids.iter().collect::<BTreeSet<_>>().len() == 1;
    let found = plans
        .into_iter()
        .filter(|(_, groups)| groups.values().all(is_same) && groups.values().any(|ids| ids.len() > 1));
    let warning = |((pipeline, path), _)| {
        let message =
            format!("the axis `{path}` has no effect on `{pipeline}`: no pass that runs takes its value");
        Diagnostic::warning(&NO_EFFECT, Severity::Warning, message)
    };
    found.map(warning).collect()
}
