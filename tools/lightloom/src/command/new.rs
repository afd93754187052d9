//! `lightloom new`: a variant to begin with.

use crate::context::{Context, Sort};
use crate::output::{self, stdout};
use anyhow::{Context as _, Result, bail};
use frame_graph::{Overrides, resolve, template};
use serde_json::json;
use std::path::PathBuf;

/// Write a file that extends a pipeline, with its parameters and passes in comments.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  lightloom new my-ism --extends ism")]
pub(crate) struct Args {
    /// The new file; .ron is added to a name without it
    variant: PathBuf,
    /// The pipeline that it changes, by name, or a .ron file
    #[arg(long, value_name = "PIPELINE")]
    extends: String,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    context.expect(Sort::Pipeline, &args.extends)?;
    let path = match args.variant.extension() {
        Some(ending) if ending == "ron" => args.variant.clone(),
        Some(_) => bail!("{}: expected a name that ends in .ron", args.variant.display()),
        None => args.variant.with_extension("ron"),
    };
    if path.exists() {
        bail!("{} exists already; choose another name", path.display());
    }
    let resolved = resolve(&args.extends, context.catalog.pipelines(), &Overrides::default())?;
    let text = template(&args.extends, &resolved, &*context.catalog);
    whole_file::write_new(&path, text).with_context(|| format!("{} was not written", path.display()))?;
    let file = path.display().to_string();
    if context.json {
        output::json(&json!({ "written": file }));
    } else {
        stdout!(
            "wrote {file}; `lightloom check {file}` checks it, `lightloom diff {} {file}` shows what it changes",
            args.extends
        );
    }
    Ok(())
}
