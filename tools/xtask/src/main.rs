//! The command line of the chores.

use anyhow::Result;
use clap::{Parser, Subcommand};
use std::process::ExitCode;
use xtask::mutate_shaders::Options;
use xtask::packages::Consent;
use xtask::{bless, demo, docs, mutate_shaders, new_pass, release, semver, test, tidy, tree};

/// Chores of the tree.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Build Lightloom and render the Cornell box
    Demo {
        /// Install a Vulkan driver without asking where there is no GPU
        #[arg(short, long)]
        yes: bool,
    },
    /// Build and run the tests
    Test {
        /// Run the slow tests too, as continuous integration does, and fail where there is no adapter for those that
        /// need one
        #[arg(short, long)]
        all: bool,
        /// Install a Vulkan driver where there is no GPU, Chromium where there is no browser, and Xvfb with
        /// xdotool and the libraries of a window where they are missing, without asking
        #[arg(short, long)]
        yes: bool,
    },
    /// Build the Python package as a wheel, and print where it is
    Wheel,
    /// Build what a release has: the program with its manual and completions, its symbols, the wheel, a list of all
    /// packages in it, and checksums
    Release,
    /// Check that the APIs of published crates changed no more than their version says
    Semver {
        /// The commit to compare with. Without it, the last release
        baseline: Option<String>,
    },
    /// Make a pass that compiles and is tested: a folder under passes/, and its line in the catalog
    NewPass {
        /// Its name in RON and of its folder, in kebab-case
        name: String,
    },
    /// Check the rules of the tree that no compiler knows
    Tidy,
    /// Write the tables of documents from what passes, interfaces and pipelines declare
    Docs,
    /// Make small changes of WGSL, one at a time, and list those that no test notices
    MutateShaders {
        /// Only files whose path contains this
        #[arg(default_value = "")]
        filter: String,
        /// Draw other changes
        #[arg(long, default_value_t = 0)]
        seed: u64,
        /// The number of changes
        #[arg(long, default_value_t = 20)]
        count: usize,
        /// The most packages whose tests run for a file that passes share
        #[arg(long, default_value_t = 5)]
        packages: usize,
        /// The most seconds that the tests of a package may take
        #[arg(long, default_value_t = 300)]
        limit: u64,
    },
    /// Take the results of a package's tests as its snapshots and images
    Bless {
        /// Name of the package
        package: String,
        /// Only tests whose name contains this
        filter: Option<String>,
    },
}

fn main() -> ExitCode {
    match run(Cli::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(command: Command) -> Result<()> {
    let root = tree::root();
    match command {
        Command::Demo { yes } => demo::run(&root, Consent::new(yes)),
        Command::Test { all, yes } => test::run(&root, Consent::new(yes), all),
        Command::Wheel => release::wheel(&root).map(|_| ()),
        Command::Release => release::run(&root),
        Command::Semver { baseline } => semver::run(&root, baseline.as_deref()),
        Command::NewPass { name } => new_pass::run(&root, &name),
        Command::Tidy => tidy::run(&root),
        Command::Docs => docs::run(&root),
        Command::MutateShaders { filter, seed, count, packages, limit } => {
            mutate_shaders::run(&root, &Options { filter, seed, count, packages, limit })
        }
        Command::Bless { package, filter } => bless::run(&root, &package, filter.as_deref()),
    }
}
