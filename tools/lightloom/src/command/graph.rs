//! `lightloom graph`: the compiled graph as text, SVG, DOT or JSON.

use crate::context::{Context, Sort, Values, parse_size};
use crate::output::{stdout, warn};
use anyhow::{Context as _, Result, bail};
use frame_graph::{CompileOptions, LinkContext, compile, link, resolve};
use renderer::without_effect;
use std::path::PathBuf;

/// Draw the compiled graph of a pipeline.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  lightloom graph ism-invtm
  lightloom graph ism-invtm atrium -o graph.svg")]
pub(crate) struct Args {
    /// A pipeline by name, or a .ron file
    pipeline: String,
    /// The scene whose traits decide switches [default: cornell-box]
    scene: Option<String>,
    /// .svg, .dot, .json or .txt; text on standard output where there is none
    #[arg(short, long = "out", value_name = "FILE")]
    out: Option<PathBuf>,
    /// Size of the frame in pixels
    #[arg(long, default_value = "512x512", allow_hyphen_values = true, value_parser = parse_size)]
    size: (u32, u32),
    #[command(flatten)]
    values: Values,
    /// Give every resource an object of its own
    #[arg(long)]
    no_sharing: bool,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    context.expect(Sort::Pipeline, &args.pipeline)?;
    args.scene.iter().try_for_each(|scene| context.expect(Sort::Scene, scene))?;
    let catalog = &context.catalog;
    let link_context = LinkContext { frame: args.size, traits: context.traits(args.scene.as_deref())? };
    let overrides = args.values.overrides();
    let resolved = resolve(&args.pipeline, catalog.pipelines(), &overrides)?;
    let graph = link(&resolved, &**catalog, &link_context)?;
    let options = CompileOptions { sharing: !args.no_sharing, ..renderer::compile_options() };
    let plan = compile(&graph, &options)?;
    let mut warnings = resolved.warnings();
    let (given, found) = ((&*args.pipeline, &overrides), (&resolved, &plan));
    warnings.0.extend(without_effect(catalog, given, found, &link_context, &options));
    warnings.0.extend(resolved.against_interfaces(&plan, catalog.interfaces()));
    warn(&warnings, context.json);
    let Some(out) = &args.out else {
        stdout!("{}", if context.json { format!("{:#}", plan.to_json()) } else { plan.to_text() });
        return Ok(());
    };
    let text = match out.extension().and_then(|extension| extension.to_str()) {
        Some("svg") => plan.to_svg(),
        Some("dot") => plan.to_dot(),
        Some("json") => format!("{:#}", plan.to_json()),
        Some("txt") => plan.to_text(),
        _ => bail!("{}: expected a name that ends in .svg, .dot, .json or .txt", out.display()),
    };
    whole_file::write(out, text).with_context(|| format!("{} was not written", out.display()))?;
    stdout!("{}", out.display());
    Ok(())
}
