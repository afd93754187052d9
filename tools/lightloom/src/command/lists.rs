//! `lightloom pipelines`, `scenes`, `measures`, `adapters`: lists.

use super::passes::{setting_json, setting_text};
use crate::context::{Context, Sort};
use crate::output::{self, stdout};
use anyhow::{Result, bail};
use frame_graph::{Overrides, resolve};
use renderer::{Gpu, Named};
use serde_json::{Value, json};
use study::Measure;

/// The options of all commands alone.
#[derive(clap::Args)]
pub(crate) struct Args {}

/// List the pipelines, or show one.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  lightloom pipelines tcas\n  lightloom pipelines --parts")]
pub(crate) struct PipelinesArgs {
    /// A pipeline
    pipeline: Option<String>,
    /// List the sub-graphs that pipelines use by `Sub(file: …)`, instead of the pipelines
    #[arg(long, conflicts_with = "pipeline")]
    parts: bool,
}

/// Prints names with a line about each.
pub(crate) fn print(context: &Context, rows: &[(String, String)]) {
    if context.json {
        let rows: Vec<Value> =
            rows.iter().map(|(name, about)| json!({ "name": name, "about": about })).collect();
        output::json(&Value::Array(rows));
    } else {
        let width = rows.iter().map(|(name, _)| name.len()).max().unwrap_or_default().max(26);
        rows.iter().for_each(|(name, about)| stdout!("{name:<width$} {about}"));
    }
}

/// Prints files with a line about each.
fn print_named(context: &Context, all: Vec<Named>) {
    let broken = || "broken: `lightloom check` prints the errors".to_owned();
    let rows = all.into_iter().map(|named| (named.name, named.about.unwrap_or_else(broken)));
    print(context, &rows.collect::<Vec<_>>());
}

pub(crate) fn pipelines(context: &Context, args: &PipelinesArgs) -> Result<()> {
    if let Some(name) = &args.pipeline {
        return pipeline(context, name);
    }
    let catalog = &context.catalog;
    print_named(context, if args.parts { catalog.list_parts() } else { catalog.list_pipelines() });
    Ok(())
}

/// Prints a pipeline's description, its outputs, and the parameters that `--set` takes.
fn pipeline(context: &Context, name: &str) -> Result<()> {
    context.expect(Sort::Pipeline, name)?;
    let resolved = resolve(name, context.catalog.pipelines(), &Overrides::default())?;
    let (about, paper) = (resolved.about().unwrap_or_default(), resolved.paper().unwrap_or_default());
    let outputs: Vec<&str> = resolved.outputs().map(|name| name.as_str()).collect();
    let settable = resolved.settable(&*context.catalog);
    // Parameters of sub-graphs and settings of passes have paths with a dot.
    let parameters = settable.iter().filter(|settable| !settable.path.contains('.'));
    if context.json {
        let parameters: Vec<Value> =
            parameters.map(|p| setting_json(&p.path, &p.setting, &p.value)).collect();
        output::json(&json!({
            "name": name, "about": about, "paper": paper, "outputs": outputs, "parameters": parameters,
        }));
        return Ok(());
    }
    stdout!("{name}: {about}");
    if !paper.is_empty() {
        stdout!("paper: {paper}");
    }
    stdout!("outputs: {}\nparameters", outputs.join(", "));
    parameters.for_each(|p| stdout!("{}", setting_text(&p.path, &p.setting, &p.value)));
    Ok(())
}

pub(crate) fn scenes(context: &Context) -> Result<()> {
    print_named(context, context.catalog.list_scenes());
    Ok(())
}

/// The measures of studies: name, unit, which values are better, and what each is.
pub(crate) fn measures(context: &Context) {
    let rows = Measure::all().map(|measure| (measure.info(), measure.needed()));
    if context.json {
        let row = |(info, needed): (study::MeasureInfo, Vec<String>)| {
            json!({
                "name": info.key, "label": info.label, "unit": info.unit, "better": info.better,
                "is_error": info.is_error, "needs": needed, "about": info.doc,
            })
        };
        output::json(&Value::Array(rows.map(row).collect()));
        return;
    }
    stdout!("{:<18} {:<14} {:<12} {}", "name", "unit", "better", "what it is");
    for (info, needed) in rows {
        let needs = if needed.is_empty() { String::new() } else { format!(" [needs {}]", needed.join(", ")) };
        stdout!("{:<18} {:<14} {:<12} {}{needs}", info.key, info.unit, info.better.word(), info.doc);
    }
    stdout!(
        "A study can also name groups of passes (`phases`) and figures of passes (`figures`) as measures."
    );
}

pub(crate) fn adapters(context: &Context) -> Result<()> {
    let adapters = Gpu::adapters();
    if adapters.is_empty() {
        bail!(
            "no graphics adapter was found; on Debian or Ubuntu `apt-get install mesa-vulkan-drivers` gives one that runs on the CPU"
        );
    }
    let rows: Vec<(String, String)> = adapters
        .iter()
        .map(|info| {
            (
                info.name.clone(),
                format!("{:?}, {:?}, {} {}", info.device_type, info.backend, info.driver, info.driver_info),
            )
        })
        .collect();
    print(context, &rows);
    Ok(())
}
