//! `lightloom fmt`: the layout of RON files.

use crate::context::Context;
use crate::output::{self, stderr, stdout};
use anyhow::{Result, anyhow, bail};
use data_file::grammar::{format, parse};
use data_file::{Diagnostics, Source, read_text};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Lay out RON files as editors do by `lightloom lsp`: spaces, indentation and commas. Comments and line breaks stay.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  lightloom fmt my.ron
  lightloom fmt --check pipelines scenes studies")]
pub(crate) struct Args {
    /// Files, and folders whose .ron files are meant, with all that is below
    #[arg(required = true)]
    paths: Vec<PathBuf>,
    /// Write nothing; fail where a file is laid out otherwise
    #[arg(long)]
    check: bool,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    let (mut changed, mut refused) = (Vec::new(), 0);
    for path in files(&args.paths)? {
        match formatted(&path) {
            Ok(Some(text)) => {
                if !args.check {
                    output::write(&path, &text)?;
                }
                changed.push(path);
            }
            Ok(None) => {}
            Err(error) => {
                refused += 1;
                stderr!("{error}");
            }
        }
    }
    if context.json {
        output::json(&json!({ "changed": changed }));
    } else {
        changed.iter().for_each(|path| stdout!("{}", path.display()));
    }
    match changed.len() {
        _ if refused > 0 => bail!("{refused} cannot be laid out"),
        count if args.check && count > 0 => bail!("{count} to be laid out; `lightloom fmt` does so"),
        _ => Ok(()),
    }
}

/// Returns the text that a file is to have; `None` where it has it.
fn formatted(path: &Path) -> Result<Option<String>> {
    let text = read_text(path).map_err(|error| anyhow!("`{}` cannot be read: {error}", path.display()))?;
    match format(&text) {
        Some(formatted) => Ok(Some(formatted).filter(|formatted| *formatted != text)),
        None => {
            let source = Source::new(path.display().to_string(), text);
            let errors: Result<(), Diagnostics> = parse(&source, 0, |_, _| Some(()));
            Err(errors.err().unwrap_or_default().into())
        }
    }
}

fn files(paths: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for path in paths {
        if path.is_dir() {
            let all = shader_library::files_under(path).into_iter();
            files.extend(all.filter(|file| file.extension().is_some_and(|ending| ending == "ron")));
        } else if path.exists() {
            files.push(path.clone());
        } else {
            bail!("there is no file `{}`", path.display());
        }
    }
    files.sort();
    files.dedup();
    Ok(files)
}
