//! `lightloom check`: everything that can be checked without a GPU.

use crate::command::study::{self, CatalogRegistry};
use crate::context::Context;
use crate::output::{self, say};
use ::study::Plan;
use anyhow::{Result, bail};
use frame_graph::resolve::Files;
use frame_graph::{Diagnostics, LinkContext, Overrides, Traits, resolve};
use renderer::{Catalog, Compiled, load_scene};
use serde_json::json;
use std::collections::BTreeMap;
use std::sync::Arc;

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
    let mut traits: BTreeMap<String, Traits> = BTreeMap::new();
    let mut results: Vec<(String, Result<String, String>)> = Vec::new();
    let judged: Vec<&String> =
        args.scene.as_ref().map_or_else(|| scenes.iter().collect(), |scene| vec![scene]);
    for name in &names {
        let is_scene = name.ends_with(".glb")
            || name.ends_with(".gltf")
            || (scenes.contains(name) && !is_pipeline(catalog, name))
            || is_file_of(catalog, name, "Scene");
        let is_study =
            (studies.contains(name) && !is_pipeline(catalog, name)) || is_file_of(catalog, name, "Study");
        let result = if is_study {
            check_study(context, name)
        } else if is_scene {
            load_scene(catalog, name)
                .map(|scene| format!("scene of {} triangles", scene.triangles()))
                .map_err(|error| error.to_string())
        } else {
            for scene in &judged {
                if !traits.contains_key(*scene) {
                    traits.insert((*scene).clone(), load_scene(catalog, scene)?.traits());
                }
            }
            check_pipeline(catalog, name, &judged, &traits).map_err(|errors| errors.to_string())
        };
        results.push((name.clone(), result));
    }
    let failed = results.iter().filter(|(_, result)| result.is_err()).count();
    if context.json {
        let rows: Vec<_> = results.iter().map(|(name, result)| json!({ "name": name, "ok": result.is_ok(), "message": result.as_ref().map_or_else(Clone::clone, Clone::clone) })).collect();
        output::json(&json!({ "checked": rows, "failed": failed }));
    } else {
        for (name, result) in &results {
            match result {
                Ok(what) => say!("ok      {name}: {what}"),
                Err(errors) => say!("failed  {name}\n{}", errors.trim_end()),
            }
        }
    }
    if failed > 0 {
        bail!("{failed} of {} failed", results.len());
    }
    Ok(())
}

fn stem(path: &str) -> String {
    path.trim_start_matches("scenes/").trim_end_matches(".ron").to_owned()
}

fn is_pipeline(catalog: &Catalog, name: &str) -> bool {
    catalog.pipelines().read(name).is_some()
}

/// Checks every name and value of a study; returns how many cells it would run.
fn check_study(context: &Context, name: &str) -> Result<String, String> {
    let plan = || -> Result<Plan> {
        let study = ::study::parse(study::source(context, name)?)?;
        Ok(Plan::new(study, &CatalogRegistry::new(Arc::clone(&context.catalog)))?)
    };
    plan().map(|plan| format!("study of {} cells", plan.cells.len())).map_err(|error| error.to_string())
}

/// Whether a `.ron` file describes a scene or a study: its first word says so.
fn is_file_of(catalog: &Catalog, name: &str, what: &str) -> bool {
    let text = catalog.assets().text(name).unwrap_or_default();
    let code = text
        .lines()
        .map(str::trim)
        .find(|line| !line.is_empty() && !line.starts_with("//") && !line.starts_with("#!"));
    name.ends_with(".ron") && code.is_some_and(|line| line.starts_with(what))
}

/// Compiles a pipeline for every scene: each has other switches on.
fn check_pipeline(
    catalog: &Catalog,
    name: &str,
    scenes: &[&String],
    traits: &BTreeMap<String, Traits>,
) -> Result<String, Diagnostics> {
    let resolved = resolve(name, catalog.pipelines(), &Overrides::default())?;
    if resolved.is_part() {
        return Ok("a sub-graph, checked where it is used".to_owned());
    }
    let options = renderer::compile_options();
    let (mut passes, mut shaders) = (0, 0);
    for scene in scenes {
        let context = LinkContext { frame: (512, 512), traits: traits[*scene].clone() };
        let compiled = Compiled::new(catalog, name, &Overrides::default(), &context, &options)?;
        passes = passes.max(compiled.plan.passes.len());
        shaders = shaders.max(compiled.shader_files().len());
    }
    Ok(format!("{passes} passes, {shaders} WGSL files, for {} scenes", scenes.len()))
}
