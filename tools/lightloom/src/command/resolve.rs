//! `lightloom resolve`: a pipeline without its inheritance.

use crate::context::{Context, overrides};
use crate::output::say;
use anyhow::Result;
use frame_graph::resolve;

/// Print a pipeline as one file without inheritance, each value with its origin.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  lightloom resolve ism-invtm --set lights=64")]
pub(crate) struct Args {
    /// A pipeline by name, or a .ron file
    pipeline: String,
    /// A value for a parameter or a pass's setting; any number of times
    #[arg(long, value_name = "NAME=VALUE", value_parser = crate::context::parse_set)]
    set: Vec<String>,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    let resolved = resolve(&args.pipeline, context.catalog.pipelines(), &overrides(&args.set)?)?;
    if context.json {
        crate::output::json(&resolved.to_json(&*context.catalog));
    } else {
        say!("{}", resolved.to_ron(&*context.catalog, true));
    }
    Ok(())
}
