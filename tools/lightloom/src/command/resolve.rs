//! `lightloom resolve`: a pipeline without its inheritance.

use crate::context::{Context, Sort, Values};
use crate::output::stdout;
use anyhow::Result;
use frame_graph::resolve;

/// Print a pipeline as one file without inheritance, each value with its origin.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  lightloom resolve ism-invtm --set lights=64")]
pub(crate) struct Args {
    /// A pipeline by name, or a .ron file
    pipeline: String,
    #[command(flatten)]
    values: Values,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    context.expect(Sort::Pipeline, &args.pipeline)?;
    let resolved = resolve(&args.pipeline, context.catalog.pipelines(), &args.values.overrides())?;
    if context.json {
        crate::output::json(&resolved.to_json(&*context.catalog));
    } else {
        stdout!("{}", resolved.to_ron(&*context.catalog, true));
    }
    Ok(())
}
