//! `lightloom diff`: what two pipelines differ in.

use crate::context::{Context, overrides};
use crate::output::{self, say};
use anyhow::Result;
use frame_graph::resolve::diff;
use frame_graph::{Difference, resolve};
use serde_json::json;

/// Print what two pipelines differ in.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  lightloom diff ism ism-invtm\n  lightloom diff ism ism-invtm --set lights=64"
)]
pub(crate) struct Args {
    /// A pipeline
    a: String,
    /// Another
    b: String,
    /// A value for a parameter or a pass's setting, in both pipelines; any number of times
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<String>,
    /// A value in the second pipeline alone; any number of times
    #[arg(long, value_name = "NAME=VALUE")]
    set_second: Vec<String>,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    let files = context.catalog.pipelines();
    let (both, mut second) = (overrides(&args.set)?, overrides(&args.set)?);
    second.0.extend(overrides(&args.set_second)?.0);
    let (a, b) = (resolve(&args.a, files, &both)?, resolve(&args.b, files, &second)?);
    let differences = diff(&a, &b, &*context.catalog);
    if context.json {
        let differences: Vec<_> = differences.iter().map(Difference::to_json).collect();
        output::json(&json!({ "a": args.a, "b": args.b, "differences": differences }));
    } else if differences.is_empty() {
        say!("no difference");
    } else {
        differences.iter().for_each(|difference| say!("{difference}"));
    }
    Ok(())
}
