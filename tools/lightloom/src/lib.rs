//! The command line of Lightloom: the program `lightloom`, and what the Python package runs.
//!
//! An application that renders needs none of this: it depends on [`renderer`], which takes a scene and a pipeline and gives frames. A
//! crate with passes of its own depends on [`pass`].

mod command;
mod context;
mod output;
mod start;
mod trace;
mod version;

use anyhow::Result;
use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};
pub use output::{errors, text};
use std::ffi::OsString;
use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};
use trace::Trace;
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::layer::SubscriberExt as _;
use tracing_subscriber::util::SubscriberInitExt as _;
use tracing_subscriber::{EnvFilter, Layer as _};

/// Real-time global illumination by virtual lights, described in RON files.
#[derive(Parser)]
#[command(name = "lightloom", version, max_term_width = 100)]
struct Cli {
    /// Folder whose pipelines, shaders and scenes take precedence over the built-in ones [default: the Lightloom tree
    /// around the working folder]
    #[arg(long, global = true, value_name = "DIR", value_parser = folder)]
    root: Option<PathBuf>,
    /// Print JSON on standard output, for other programs
    #[arg(long, global = true)]
    json: bool,
    /// Write a trace of the program to FILE, in Chrome's format, for ui.perfetto.dev
    #[arg(long, global = true, value_name = "FILE")]
    trace: Option<PathBuf>,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Open a window: fly through a scene, edit shaders and pipelines, compare, inspect
    #[cfg(feature = "window")]
    View(command::view::Args),
    /// Render a scene by a pipeline into a picture, or a sequence of them
    Render(command::render::Args),
    /// Check pipelines, their shaders, scenes and studies, without a GPU
    Check(command::check::Args),
    /// Write a variant of a pipeline to begin with, with parameters and passes in comments
    New(command::new::Args),
    /// Lay out RON files: spaces, indentation and commas
    Fmt(command::fmt::Args),
    /// Answer an editor by the Language Server Protocol: completion, errors, definitions
    Lsp(command::lsp::Args),
    /// Draw the compiled graph of a pipeline: order, sizes, memory, reason for each pass
    Graph(command::graph::Args),
    /// Print a pipeline as one file, each value with its origin
    Resolve(command::resolve::Args),
    /// Print the differences between two pipelines
    Diff(command::diff::Args),
    /// Render a picture again from the record inside its file, and print the differences
    Rerun(command::rerun::Args),
    /// Compare two pictures: RMSE, relMSE, MAPE, SSIM, ꟻLIP
    Compare(command::compare::Args),
    /// Measure frames of another engine: error, energy, flicker, lag, equal time
    Judge(command::judge::Args),
    /// Share the error of a picture out between what its pipeline approximates
    Blame(command::blame::Args),
    /// Search settings for the least error in a time, or the least time for an error
    Tune(command::tune::Args),
    /// Run an ablation study: pipelines, scenes and values against time and error
    Study(command::study::Args),
    /// Run the studies of a paper, and print a line for each of its findings
    Reproduce(command::reproduce::Args),
    /// Render extreme cases by every pipeline, and check pictures for NaN and wrong energy
    Stress(command::stress::Args),
    /// Compare shader functions in f32 with the same in f64: the precision that is lost
    Precision(command::precision::Args),
    /// Measure rays, the frame graph, reloading and the limits of the adapter on this machine
    Bench(command::bench::Args),
    /// List the pass types, or show one with its ports and settings
    Passes(command::passes::Args),
    /// List the interfaces of ports, or show one with its members as WGSL declares them
    Interfaces(command::interfaces::Args),
    /// List the pipelines, or show one with its outputs and parameters
    Pipelines(command::lists::PipelinesArgs),
    /// List the scenes
    Scenes(command::lists::Args),
    /// List the measures of studies
    Measures(command::lists::Args),
    /// List the graphics adapters; fails if there is none
    Adapters(command::lists::Args),
    /// Print a script by which a shell completes commands and options
    Completions(command::completions::Args),
    /// Write the manual, a page for each command
    Man(command::completions::ManArgs),
}

fn folder(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    if path.is_dir() { Ok(path) } else { Err("there is no such folder".to_owned()) }
}

/// Parses the arguments. Where they are wrong or ask for help or the version, it prints and ends the process.
fn parse(arguments: Vec<OsString>) -> Cli {
    let mut command = Cli::command();
    // To ask for the adapters starts the drivers, so it is done only to print them.
    if arguments.iter().any(|argument| argument == "--version") {
        command = command.long_version(version::long());
    }
    Cli::from_arg_matches(&command.get_matches_from(arguments)).unwrap_or_else(|error| error.exit())
}

/// What is logged where `LIGHTLOOM_LOG` says nothing. That there is no driver is reported by the commands that need one.
const DEFAULT_LOG: &str = "error,wgpu_hal::vulkan::instance=off";

/// Prints what is logged, and records phases and a trace where they are wanted.
fn record(phases: Option<start::Phases>, trace: Option<&Path>) -> Result<Option<Trace>> {
    let logged = EnvFilter::try_from_env("LIGHTLOOM_LOG").unwrap_or_else(|_| DEFAULT_LOG.into());
    let is_terminal = std::io::stderr().is_terminal();
    let print = tracing_subscriber::fmt::layer().with_writer(std::io::stderr).with_ansi(is_terminal);
    // `eprintln!` would print it, which panics if standard error cannot be written.
    let print = print.log_internal_errors(false).with_filter(logged);
    let of_phases = Targets::new().with_target(start::TARGET, LevelFilter::INFO);
    let (file, trace) = trace.map(trace::to_file).transpose()?.unzip();
    let registry = tracing_subscriber::registry()
        .with(print)
        .with(phases.map(|phases| phases.with_filter(of_phases)))
        .with(file);
    #[cfg(feature = "tracy")]
    let registry = registry.with(trace::to_tracy());
    registry.init();
    Ok(trace)
}

/// Runs the command that the arguments ask for, the first of which is the name of the program. `program` starts it: the path of
/// an executable file, and arguments that come before those of a command. Commands that run some of their work in processes of
/// their own start them by it.
///
/// Returns the exit code: 0 done, 1 failed. Where the arguments are wrong or ask for help, the process ends with 2 or 0.
pub fn run(program: Vec<String>, arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let phases = start::Phases::begin();
    let cli = parse(arguments.into_iter().collect());
    let json = cli.json;
    let timed = matches!(&cli.command, Command::Render(args) if args.time);
    let trace = match record(timed.then(|| phases.clone()), cli.trace.as_deref()) {
        Ok(trace) => trace,
        Err(error) => {
            output::failure(&error, json);
            return 1;
        }
    };
    let has_root = cli.root.is_some();
    let context = context::Context::new(program, cli.root, cli.json, phases);
    let done = match &cli.command {
        #[cfg(feature = "window")]
        Command::View(args) => command::view::run(&context, args),
        Command::Render(args) => command::render::run(&context, args),
        Command::Check(args) => command::check::run(&context, args),
        Command::New(args) => command::new::run(&context, args),
        Command::Fmt(args) => command::fmt::run(&context, args),
        Command::Lsp(args) => command::lsp::run(has_root, &context, args),
        Command::Graph(args) => command::graph::run(&context, args),
        Command::Resolve(args) => command::resolve::run(&context, args),
        Command::Diff(args) => command::diff::run(&context, args),
        Command::Rerun(args) => command::rerun::run(&context, args),
        Command::Compare(args) => command::compare::run(&context, args),
        Command::Judge(args) => command::judge::run(&context, args),
        Command::Blame(args) => command::blame::run(&context, args),
        Command::Tune(args) => command::tune::run(&context, args),
        Command::Study(args) => command::study::run(&context, args),
        Command::Reproduce(args) => command::reproduce::run(&context, args),
        Command::Stress(args) => command::stress::run(&context, args),
        Command::Precision(args) => command::precision::run(&context, args),
        Command::Bench(args) => command::bench::run(&context, args),
        Command::Passes(args) => command::passes::run(&context, args),
        Command::Interfaces(args) => command::interfaces::run(&context, args),
        Command::Pipelines(args) => command::lists::pipelines(&context, args),
        Command::Scenes(_) => command::lists::scenes(&context),
        Command::Measures(_) => {
            command::lists::measures(&context);
            Ok(())
        }
        Command::Adapters(_) => command::lists::adapters(&context),
        Command::Completions(args) => command::completions::run(args, Cli::command()),
        Command::Man(args) => command::completions::man(&context, args, Cli::command()),
    };
    let traced = trace.map_or(Ok(()), Trace::finish);
    let mut code = 0;
    for error in [done, traced].into_iter().filter_map(Result::err) {
        output::failure(&error, json);
        code = 1;
    }
    code
}
