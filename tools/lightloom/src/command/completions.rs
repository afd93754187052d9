//! `lightloom completions` and `lightloom man`: what a package of the program installs beside it.

use crate::context::Context;
use crate::output::{self, stdout};
use anyhow::{Context as _, Result};
use clap_complete::Shell;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Print a script by which a shell completes commands and options.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  lightloom completions bash > ~/.local/share/bash-completion/completions/lightloom"
)]
pub(crate) struct Args {
    /// The shell
    shell: Shell,
}

/// Write the manual, a page for each command.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  lightloom man -o ~/.local/share/man/man1")]
pub(crate) struct ManArgs {
    /// The folder for the pages
    #[arg(short, long = "out", value_name = "DIR")]
    out: PathBuf,
}

/// Prints the script for the whole command line.
pub(crate) fn run(args: &Args, mut cli: clap::Command) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut cli, "lightloom", &mut script);
    stdout!("{}", String::from_utf8(script).context("the script is no text")?.trim_end());
    Ok(())
}

/// Writes the pages of the whole command line.
pub(crate) fn man(context: &Context, args: &ManArgs, cli: clap::Command) -> Result<()> {
    std::fs::create_dir_all(&args.out).with_context(|| format!("cannot make {}", args.out.display()))?;
    let mut cli = cli.disable_help_subcommand(true);
    // Options of the program belong to each command from here on.
    cli.build();
    let mut written = Vec::new();
    pages(&cli, &args.out, &mut written)?;
    if context.json {
        output::json(&json!({ "pages": written }));
    } else {
        written.iter().for_each(|page| stdout!("{}", page.display()));
    }
    Ok(())
}

/// Writes the page of a command, and those of the commands within it.
fn pages(command: &clap::Command, folder: &Path, written: &mut Vec<PathBuf>) -> Result<()> {
    let page = clap_mangen::Man::new(command.clone());
    let path = folder.join(page.get_filename());
    let mut text = Vec::new();
    page.render(&mut text)?;
    output::write(&path, &String::from_utf8(text).context("the page is no text")?)?;
    written.push(path);
    command
        .get_subcommands()
        .filter(|inner| !inner.is_hide_set())
        .try_for_each(|inner| pages(inner, folder, written))
}
