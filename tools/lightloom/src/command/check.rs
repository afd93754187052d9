//! `lightloom check`: everything that can be checked without a GPU.

use crate::command::study::{self, CatalogRegistry, MOST_RUNS, overrides};
use crate::context::{Context, Sort};
use crate::output::{self, stdout};
use ::study::{Plan, RunRequest};
use anyhow::{Result, anyhow, bail};
use data_file::why_unreadable;
use frame_graph::resolve::Files;
use frame_graph::{
    Diagnostic, Diagnostics, LinkContext, Overrides, Severity, Source, Span, Traits, nearest_of_few, resolve,
};
use rayon::prelude::*;
use renderer::{Catalog, Compiled, load_scene};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// Check pipelines, their shaders, scenes and studies.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  lightloom check                      everything there is
  lightloom check ism-invtm my.ron     these alone
  lightloom check --scene sponza.glb ism")]
pub(crate) struct Args {
    /// Pipelines, scenes, studies or files; without any, all built-in ones
    names: Vec<String>,
    /// The scene whose traits decide switches and variants [default: each of the built-in scenes]
    #[arg(long)]
    scene: Option<String>,
}

/// The result of a check.
struct Checked {
    /// A description, or the errors.
    result: Result<String>,
    /// Warnings and notes.
    warnings: Diagnostics,
    /// What is repaired or left out of a scene.
    repairs: Vec<String>,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    let catalog = &context.catalog;
    let scenes: Vec<String> = catalog.assets().list("scenes", "ron").iter().map(|path| stem(path)).collect();
    let pipelines: Vec<String> =
        catalog.pipelines().list().iter().map(|path| path.trim_end_matches(".ron").to_owned()).collect();
    let studies = study::names(context);
    let names: Vec<String> = if args.names.is_empty() {
        scenes.iter().cloned().chain(pipelines.iter().cloned()).chain(studies.iter().cloned()).collect()
    } else {
        args.names.clone()
    };
    let judged: Vec<&String> =
        args.scene.as_ref().map_or_else(|| scenes.iter().collect(), |scene| vec![scene]);
    let known = Mutex::new(BTreeMap::new());
    let checked = |name: &String| {
        let sort = Sort::ALL.into_iter().find(|sort| context.is(*sort, name));
        let (mut warnings, mut repairs) = (Diagnostics::default(), Vec::new());
        // Each has the scenes that were loaded so far, and hands on those that it loads.
        let mut traits = known.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let result = match sort {
            None => Err(not_there(name, [&scenes, &pipelines, &studies])),
            Some(sort) => check(context, (sort, name), &judged, &mut traits, &mut warnings, &mut repairs),
        };
        known.lock().unwrap_or_else(PoisonError::into_inner).append(&mut traits);
        if args.names.is_empty() {
            // Among all files, notes are about what is meant.
            warnings.0.retain(|warning| warning.severity > Severity::Note);
            repairs.clear();
        }
        (name.clone(), Checked { result, warnings, repairs })
    };
    let results: Vec<(String, Checked)> = names.par_iter().map(checked).collect();
    let failed = results.iter().filter(|(_, checked)| checked.result.is_err()).count();
    if context.json {
        let rows: Vec<Value> = results.iter().map(|(name, checked)| row(name, checked)).collect();
        output::json(&json!({ "checked": rows, "failed": failed }));
    } else {
        for (name, Checked { result, warnings, repairs }) in &results {
            match result {
                Ok(what) => stdout!("ok      {name}: {what}"),
                Err(errors) => stdout!("failed  {name}\n{}", errors.to_string().trim_end()),
            }
            repairs.iter().for_each(|repair| stdout!("note: {repair}"));
            if !warnings.0.is_empty() {
                stdout!("{warnings}");
            }
        }
    }
    if failed > 0 {
        bail!("{failed} of {} failed", results.len());
    }
    Ok(())
}

/// Checks one file; returns a description.
fn check(
    context: &Context,
    (sort, name): (Sort, &str),
    scenes: &[&String],
    traits: &mut BTreeMap<String, Traits>,
    warnings: &mut Diagnostics,
    repairs: &mut Vec<String>,
) -> Result<String> {
    let catalog = &context.catalog;
    match sort {
        Sort::Study => check_study(context, name, traits, warnings),
        Sort::Scene => {
            let scene = load_scene(catalog, name)?;
            repairs.clone_from(&scene.repairs);
            Ok(format!("scene of {} triangles", scene.triangles()))
        }
        Sort::Pipeline => {
            for scene in scenes {
                know_traits(catalog, scene, traits)?;
            }
            Ok(check_pipeline(catalog, name, scenes, traits, warnings)?)
        }
    }
}

/// Returns all errors, warnings and notes of a file, for an editor: `traits` has those of the scenes that were loaded.
pub(crate) fn diagnostics(
    context: &Context,
    (sort, name): (Sort, &str),
    scene: &String,
    traits: &mut BTreeMap<String, Traits>,
) -> Vec<Diagnostic> {
    // The files that a scene names are found from its path.
    let in_root = context.catalog.assets().root().map(|root| root.join(name));
    let path = in_root.filter(|path| sort == Sort::Scene && path.exists());
    let path = path.map_or_else(|| name.to_owned(), |path| path.to_string_lossy().into_owned());
    let (mut warnings, mut repairs) = (Diagnostics::default(), Vec::new());
    let mut all = match check(context, (sort, &path), &[scene], traits, &mut warnings, &mut repairs) {
        Ok(_) => Vec::new(),
        Err(error) => match error.chain().find_map(output::diagnostics) {
            Some(Diagnostics(errors)) => errors.clone(),
            None => vec![at_start(name, Severity::Error, format!("{error:#}"))],
        },
    };
    all.extend(warnings.0);
    all.extend(repairs.into_iter().map(|repair| at_start(name, Severity::Note, repair)));
    let places = all.iter_mut().flat_map(|found| &mut found.labels).map(|label| &mut label.span);
    for span in places.filter(|span| span.source.name == path && path != name) {
        span.source = Source::new(name, &*span.source.text);
    }
    all
}

/// Returns what is said of a file as a whole.
fn at_start(name: &str, severity: Severity, message: String) -> Diagnostic {
    let span = Span { source: Source::new(name, ""), start: 0, end: 0 };
    Diagnostic { code: "", severity, message, labels: Vec::new(), notes: Vec::new() }.label(span, "")
}

/// Returns a result for programs.
fn row(name: &str, checked: &Checked) -> Value {
    let what = checked.result.as_ref().ok();
    let errors = checked.result.as_ref().err().map_or_else(|| json!([]), output::errors);
    json!({
        "name": name,
        "ok": what.is_some(),
        "what": what,
        "errors": errors,
        "warnings": checked.warnings.to_json(),
        "notes": checked.repairs,
    })
}

/// Loads a scene for its traits, once.
fn know_traits(catalog: &Catalog, scene: &str, traits: &mut BTreeMap<String, Traits>) -> Result<()> {
    if !traits.contains_key(scene) {
        traits.insert(scene.to_owned(), load_scene(catalog, scene)?.traits());
    }
    Ok(())
}

fn stem(path: &str) -> String {
    path.trim_start_matches("scenes/").trim_end_matches(".ron").to_owned()
}

/// Checks every name and value of a study, and compiles its pipelines with the values that its cells give them; returns
/// how many cells it would run.
fn check_study(
    context: &Context,
    name: &str,
    traits: &mut BTreeMap<String, Traits>,
    warnings: &mut Diagnostics,
) -> Result<String> {
    let catalog = &context.catalog;
    let registry = CatalogRegistry::new(Arc::clone(catalog));
    let study = ::study::parse_with(study::source(context, name)?, &registry)?;
    let plan = Plan::new(study, &registry)?;
    warnings.0.extend(plan.notes.0.iter().cloned());
    let runs = plan.distinct_runs();
    let (mut errors, mut plans): (Vec<Diagnostic>, _) = (Vec::new(), Vec::new());
    // Where a cell differs from the one before in values alone, only what reads them is compiled again.
    let mut before: Option<(&RunRequest, Compiled)> = None;
    for run in runs.iter().take(MOST_RUNS) {
        know_traits(catalog, &run.scene, traits)?;
        let link = LinkContext { frame: run.size, traits: traits[&run.scene].clone() };
        let (values, options) = (overrides(&run.set), renderer::compile_options());
        let alike = |other: &RunRequest| {
            (&other.pipeline, &other.scene, other.size) == (&run.pipeline, &run.scene, run.size)
        };
        let compiled = match before.as_ref().filter(|(other, _)| alike(other)) {
            Some((_, known)) => known.with_overrides(catalog, &run.pipeline, &values, &link, &options),
            None => Compiled::new(catalog, &run.pipeline, &values, &link, &options),
        };
        let (found, list) = match compiled {
            Ok(compiled) => {
                plans.push((*run, compiled.plan.id));
                let found = compiled.of_files(catalog);
                before = Some((*run, compiled));
                (found, &mut warnings.0)
            }
            Err(found) => (found, &mut errors),
        };
        for diagnostic in found.0 {
            // Many cells have the same errors.
            if !list.contains(&diagnostic) {
                list.push(diagnostic);
            }
        }
    }
    if !errors.is_empty() {
        return Err(Diagnostics(errors).into());
    }
    warnings.0.extend(study::without_effect(&plan, plans));
    let left = match runs.len().saturating_sub(MOST_RUNS) {
        0 => String::new(),
        left => format!(", of whose pipelines {left} more are not checked"),
    };
    Ok(format!("study of {} cells, {} pipelines compiled{left}", plan.cells.len(), runs.len().min(MOST_RUNS)))
}

/// Returns the error for a name that is no pipeline, scene or study.
fn not_there(name: &str, known: [&Vec<String>; 3]) -> anyhow::Error {
    if Path::new(name).is_dir() {
        return anyhow!("`{name}` is a folder: name the files in it");
    }
    if let Some(why) = why_unreadable(Path::new(name)) {
        return anyhow!("`{name}` cannot be read: {why}");
    }
    let stem = name.strip_suffix(".ron").unwrap_or(name);
    if Path::new(name).is_file() {
        return anyhow!(
            "`{name}` is no pipeline, scene or study: such files end in .ron, .glb, .gltf, .pbrt or .xml"
        );
    }
    match nearest_of_few(stem, known.into_iter().flatten().map(String::as_str)) {
        Some(near) => anyhow!("there is no pipeline, scene or study `{name}`; did you mean `{near}`?"),
        None => anyhow!(
            "there is no pipeline, scene or study `{name}`; `lightloom pipelines` and `lightloom scenes` list them, and \
             files end in .ron, .glb, .gltf, .pbrt or .xml"
        ),
    }
}

/// Compiles a pipeline for every scene: each has other switches on.
fn check_pipeline(
    catalog: &Catalog,
    name: &str,
    scenes: &[&String],
    traits: &BTreeMap<String, Traits>,
    warnings: &mut Diagnostics,
) -> Result<String, Diagnostics> {
    let resolved = resolve(name, catalog.pipelines(), &Overrides::default())?;
    *warnings = resolved.warnings();
    if resolved.is_part() {
        return Ok("a sub-graph, checked where it is used".to_owned());
    }
    let options = renderer::compile_options();
    let (mut passes, mut shaders) = (0, 0);
    for scene in scenes {
        let context = LinkContext { frame: (512, 512), traits: traits[*scene].clone() };
        let compiled = Compiled::new(catalog, name, &Overrides::default(), &context, &options)?;
        for warning in compiled.of_files(catalog).0 {
            if !warnings.0.contains(&warning) {
                warnings.0.push(warning);
            }
        }
        if scenes.len() == 1 {
            *warnings = compiled.warnings(catalog, name, &Overrides::default(), &context, &options);
        }
        passes = passes.max(compiled.plan.passes.len());
        shaders = shaders.max(compiled.shader_files().len());
    }
    Ok(format!("{passes} passes, {shaders} WGSL files, for {} scenes", scenes.len()))
}
