//! `lightloom diff`: the differences between two pipelines.

use crate::context::{Context, Sort, parse_set};
use crate::output::{self, stdout};
use anyhow::Result;
use frame_graph::resolve::diff;
use frame_graph::{Difference, Overrides, Value, resolve};
use serde_json::json;

/// Print the differences between two pipelines.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  lightloom diff ism ism-invtm\n  lightloom diff ism ism-invtm --set lights=64"
)]
pub(crate) struct Args {
    /// A pipeline
    a: String,
    /// Another
    b: String,
    /// A value for a parameter or a pass's setting, in both pipelines. May be repeated
    #[arg(long, value_name = "NAME=VALUE", value_parser = parse_set)]
    set: Vec<(String, Value)>,
    /// A value in the second pipeline alone. May be repeated
    #[arg(long, value_name = "NAME=VALUE", value_parser = parse_set)]
    set_second: Vec<(String, Value)>,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    [&args.a, &args.b].into_iter().try_for_each(|name| context.expect(Sort::Pipeline, name))?;
    let files = context.catalog.pipelines();
    let both = Overrides(args.set.clone());
    let second = Overrides([&args.set[..], &args.set_second].concat());
    let (a, b) = (resolve(&args.a, files, &both)?, resolve(&args.b, files, &second)?);
    let differences = diff(&a, &b, &*context.catalog);
    if context.json {
        let differences: Vec<_> = differences.iter().map(Difference::to_json).collect();
        output::json(&json!({ "a": args.a, "b": args.b, "differences": differences }));
    } else if differences.is_empty() {
        stdout!("no difference");
    } else {
        differences.iter().for_each(|difference| stdout!("{difference}"));
    }
    Ok(())
}
