//! `lightloom diff`: what two pipelines differ in.

use crate::context::Context;
use crate::output::{self, say};
use anyhow::Result;
use frame_graph::resolve::diff;
use frame_graph::{Overrides, resolve};
use serde_json::json;

/// Print what two pipelines differ in.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  lightloom diff ism ism-invtm")]
pub(crate) struct Args {
    /// A pipeline
    a: String,
    /// Another
    b: String,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    let files = context.catalog.pipelines();
    let (a, b) =
        (resolve(&args.a, files, &Overrides::default())?, resolve(&args.b, files, &Overrides::default())?);
    let differences: Vec<String> = diff(&a, &b).iter().map(ToString::to_string).collect();
    if context.json {
        output::json(&json!({ "a": args.a, "b": args.b, "differences": differences }));
    } else if differences.is_empty() {
        say!("no difference");
    } else {
        differences.iter().for_each(|line| say!("{line}"));
    }
    Ok(())
}
