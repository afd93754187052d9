//! `lightloom study`: ablation studies.

mod apart;
mod external;
mod laboratory;
mod progress;
mod registry;
mod snakefile;
mod summary;
mod warnings;
mod workers;

use crate::context::{Context, Sort, parse_set, parse_size, set_text, unknown};
use crate::output::{self, stderr, stdout, warn, write};
use anyhow::{Context as _, Result, bail};
use apart::Apart;
use data_file::why_unreadable;
use external::{WithExternals, consent};
use frame_graph::{Source, Value};
pub(crate) use laboratory::GpuLaboratory;
pub(crate) use progress::Progress;
pub(crate) use registry::{CatalogRegistry, overrides};
use renderer::Gpu;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;
use study::{
    AxisValue, Costs, Edits, Outcome, Plan, Ran, Results, RunOptions, SHARD_MINUTES, Shard, UNKNOWN_SECONDS,
};
pub(crate) use summary::{fail_if_any, failures, failures_json, print_failures, summary};
use summary::{failed, report, shard_report};
use warnings::warnings;
pub(crate) use warnings::{MOST_RUNS, without_effect};

/// Run an ablation study.
///
/// Finished cells in the folder do not run again: the same command continues a run that was stopped.
#[derive(clap::Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
#[command(after_help = "Examples:
  lightloom study speed-against-accuracy -o out/speed
  lightloom study my.ron -o out/my --quick
  lightloom study ism-fig-4 -o out/timing --timing
  lightloom study ism-fig-4 -o out/ism-fig-4 --shard 2/8 --costs out/timing
  lightloom study merge out/ism-fig-4 -o out/ism-fig-4
  snakemake -c1 --snakefile $(lightloom study ism-fig-4 --snakefile --costs out/timing) --config out=out/ism-fig-4
  lightloom study publish out/ism-fig-4")]
pub(crate) struct Args {
    #[command(subcommand)]
    other: Option<Other>,
    /// A study by name, or a .ron file
    #[arg(required = true)]
    file: Option<String>,
    /// The folder for cells, pictures, tables and the report
    #[arg(short, long = "out", value_name = "DIR", required_unless_present = "snakefile")]
    out: Option<PathBuf>,
    /// Write a Snakefile that runs the study in jobs of 10 to 30 minutes (Snakemake, also on Slurm), by default NAME.smk, and
    /// print its path. --costs says how long cells take
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true, conflicts_with_all = ["out", "shard", "references", "timing", "adapter"])]
    snakefile: Option<Option<PathBuf>>,
    /// Minutes that each job of a Snakefile is expected to take
    #[arg(long, value_name = "MINUTES", default_value_t = SHARD_MINUTES, value_parser = above_zero, requires = "snakefile")]
    shard_minutes: f64,
    /// Run shard i of n, cut by expected cost, into the folder of all or one of its own; `merge` joins shards. Also
    /// `references`, or places as a Snakefile has them
    #[arg(long, value_name = "i/n")]
    shard: Option<Shard>,
    /// The folder of a run that has the costs of cells, by which shards are cut; without it, cells count alike
    #[arg(long, value_name = "DIR")]
    costs: Option<PathBuf>,
    /// The adapter: its place in the list of `lightloom adapters`, from 0, or a part of its name. Without it, the first
    #[arg(long, value_name = "NAME|INDEX", conflicts_with = "workers")]
    adapter: Option<String>,
    /// Run on the first N adapters of this machine at once, each by a process of its own; references are rendered first, by one
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), conflicts_with_all = ["shard", "snakefile"])]
    workers: Option<u32>,
    /// Run each cell in a process of its own, which is killed after so many seconds: a crash or a hang takes no other cell with it
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u64).range(1..), conflicts_with_all = ["workers", "shard", "snakefile"])]
    isolated: Option<u64>,
    /// A folder for references, shared with other studies and shards
    #[arg(long, value_name = "DIR")]
    references: Option<PathBuf>,
    /// Size of frames in pixels, instead of the study's
    #[arg(long, allow_hyphen_values = true, value_parser = parse_size)]
    size: Option<(u32, u32)>,
    /// A value for all pipelines that have the name, instead of the study's; an axis of that name takes only this
    /// value. May be repeated
    #[arg(long, value_name = "NAME=VALUE", value_parser = parse_set)]
    set: Vec<(String, Value)>,
    /// A value for the pipeline that renders references. May be repeated
    #[arg(long, value_name = "NAME=VALUE", value_parser = parse_set)]
    set_reference: Vec<(String, Value)>,
    /// A scene instead of the study's. May be repeated
    #[arg(long)]
    scene: Vec<String>,
    /// Number of seeds, instead of the study's
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    seeds: Option<u32>,
    /// Measured frames per cell, instead of the study's
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    frames: Option<u32>,
    /// Time in milliseconds, instead of that of a budget of time; other budgets stay
    #[arg(long, value_parser = above_zero)]
    ms: Option<f64>,
    /// Let the study run the programs that it names (`External`): they may do anything that you may do
    #[arg(long)]
    allow_external: bool,
    /// A quick preview: a quarter of each side, one seed, first and last value of each axis
    #[arg(long)]
    quick: bool,
    /// A run that shows what cells cost, for --costs: one seed, first and last value of each axis. Its cells are cells of
    /// the study
    #[arg(long)]
    timing: bool,
}

#[derive(clap::Subcommand)]
enum Other {
    /// Join the folders of the shards of a study
    Merge {
        /// The folders
        #[arg(required = true)]
        parts: Vec<PathBuf>,
        /// The folder of the merged study; it may be one of them
        #[arg(short, long = "out", value_name = "DIR")]
        out: PathBuf,
    },
    /// Print a table, in Markdown, of how long studies take on 1, 8 and 64 GPUs, from the costs of cells in folders of runs
    Costs {
        /// The folders: of whole runs, of a part or of --timing
        #[arg(required = true)]
        folders: Vec<PathBuf>,
    },
    /// Write tables and report of a folder again
    Report {
        /// The folder
        folder: PathBuf,
    },
    /// Write the results of folders to pages of Markdown, each to `NAME.md` between `<!-- study: NAME -->` and
    /// `<!-- end -->`
    Publish {
        /// The folders
        #[arg(required = true)]
        folders: Vec<PathBuf>,
        /// The folder of the pages
        #[arg(long, value_name = "DIR", default_value = "docs/results")]
        into: PathBuf,
    },
    /// Write the pictures of a folder, with time and error below each, into a page of Markdown between
    /// `<!-- gallery: NAME -->` and `<!-- end -->`
    Pictures {
        /// The folder
        folder: PathBuf,
        /// The page
        #[arg(long, value_name = "FILE", default_value = "README.md")]
        page: PathBuf,
        /// The folder of the pictures
        #[arg(long, value_name = "DIR", default_value = "docs/gallery")]
        into: PathBuf,
    },
}

/// What an error that ends a run means for what was finished.
const STOPPED: &str = "the study stopped; what is finished is kept, and the same command goes on from there";

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    match &args.other {
        Some(Other::Merge { parts, out }) => {
            let merged = study::merge(parts, out)?;
            for reason in &merged.refused {
                stderr!("not taken: {reason}");
            }
            report(context, &merged.results, out, None)
        }
        Some(Other::Costs { folders }) => {
            let one = |folder: &PathBuf| -> Result<(Plan, Costs)> {
                let (name, text) = study::source(folder)?;
                let study = study::parse(Source::new(format!("studies/{name}.ron"), text))?;
                let registry = CatalogRegistry::new(Arc::clone(&context.catalog));
                Ok((Plan::new(study, &registry)?, Costs::read(folder)?))
            };
            let studies: Vec<(Plan, Costs)> = folders.iter().map(one).collect::<Result<_>>()?;
            let table = study::costs(&studies);
            if context.json {
                output::json(&json!({ "table": table.markdown() }));
            } else {
                stdout!("{}", table.markdown());
            }
            Ok(())
        }
        Some(Other::Report { folder }) => {
            let results = Results::read(folder)?;
            study::write_tables(&results, folder)?;
            report(context, &results, folder, None)
        }
        Some(Other::Publish { folders, into }) => {
            let pages = study::publish(folders, into)?;
            if context.json {
                output::json(&json!({ "pages": pages }));
            } else {
                pages.iter().for_each(|page| stdout!("{}", page.display()));
            }
            Ok(())
        }
        Some(Other::Pictures { folder, page, into }) => {
            let files = study::gallery(folder, page, into)?;
            if context.json {
                output::json(&json!({ "files": files }));
            } else {
                stdout!("{}: {} pictures", page.display(), files.len() - 1);
            }
            Ok(())
        }
        // clap asks for both where there is no subcommand.
        None => run_study(
            context,
            args,
            args.file.as_deref().unwrap_or_default(),
            args.out.as_deref().unwrap_or(Path::new(".")),
        ),
    }
}

/// Parses a number above 0.
pub(crate) fn above_zero(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if number > 0.0 && f64::is_finite(number) => Ok(number),
        _ => Err("expected a number above 0".to_owned()),
    }
}

fn run_study(context: &Context, args: &Args, file: &str, out: &Path) -> Result<()> {
    let edits = Edits {
        scenes: args.scene.clone(),
        size: args.size,
        set: values(&args.set),
        set_reference: values(&args.set_reference),
        seeds: args.seeds,
        frames: args.frames,
        ms: args.ms,
        quick: args.quick,
        timing: args.timing,
    };
    let registry = CatalogRegistry::new(Arc::clone(&context.catalog));
    let mut study = study::parse_with(source(context, file)?, &registry)?;
    study.edit(&edits)?;
    let plan = Plan::new(study, &registry)?;
    consent(&plan, args.allow_external)?;
    if let Some(path) = &args.snakefile {
        return write_snakefile(context, args, file, &plan, path.as_deref());
    }
    warn(&warnings(context, &plan), context.json);
    if let Some(workers) = args.workers {
        return run_workers(context, args, (file, out), &plan, workers);
    }
    if args.isolated.is_some() {
        // Their time is not that of a cell.
        run_here(context, args, (file, out), &plan, Some(Shard::References { places: None }))?;
    }
    let ran = run_here(context, args, (file, out), &plan, args.shard.clone())?;
    if args.shard.is_some() {
        shard_report(context, &ran);
        return Ok(());
    }
    report(context, &ran.results, out, Some(ran.run))?;
    if ran.failed > 0 {
        bail!("{}", failed(ran.failed));
    }
    Ok(())
}

/// Runs a study, or a shard of it, in this process.
fn run_here(
    context: &Context,
    args: &Args,
    (file, out): (&str, &Path),
    plan: &Plan,
    shard: Option<Shard>,
) -> Result<Ran> {
    let lab = GpuLaboratory::open(Arc::clone(&context.catalog), args.adapter.as_deref())?;
    let apart = args.isolated.map(|seconds| apart(context, args, (file, out), plan, seconds)).transpose()?;
    let mut lab = WithExternals::new(lab, context, &plan.study.source.name).apart(apart);
    let options = RunOptions {
        shard,
        costs: costs(args, out)?,
        references: args.references.clone(),
        command: command(args, file),
    };
    let mut progress = Progress::new();
    let ran = study::run(plan, &mut lab, out, &options, &mut |event| progress.report(event));
    progress.finish();
    ran.context(STOPPED)
}

/// Returns what runs each cell in a process of its own.
fn apart(
    context: &Context,
    args: &Args,
    (file, out): (&str, &Path),
    plan: &Plan,
    seconds: u64,
) -> Result<Apart> {
    let mut command = context.program()?;
    command.push("study".to_owned());
    command.extend(words(args, file));
    command.extend(["-o".to_owned(), out.display().to_string()]);
    args.adapter.iter().for_each(|adapter| command.extend(["--adapter".to_owned(), adapter.clone()]));
    let references = args.references.iter().map(|folder| folder.display().to_string());
    references.for_each(|folder| command.extend(["--references".to_owned(), folder]));
    Ok(Apart { command, cells: plan.cells.len(), limit: Duration::from_secs(seconds) })
}

/// Runs a study on several adapters of this machine.
fn run_workers(
    context: &Context,
    args: &Args,
    (file, out): (&str, &Path),
    plan: &Plan,
    workers: u32,
) -> Result<()> {
    let adapters = Gpu::adapters();
    if workers as usize > adapters.len() {
        let names: Vec<&str> = adapters.iter().map(|adapter| adapter.name.as_str()).collect();
        bail!(
            "--workers {workers} needs as many adapters, and this machine has {}: {}",
            names.len(),
            names.join(", ")
        );
    }
    run_here(context, args, (file, out), plan, Some(Shard::References { places: None }))?;
    let costs = args.costs.as_deref().map(Costs::read).transpose()?.unwrap_or_default();
    let mut program = context.program()?;
    program.push("study".to_owned());
    program.extend(words(args, file));
    workers::run(&program, out, workers, plan, &costs).context(STOPPED)?;
    let results = study::merge(&[out.to_owned()], out)?.results;
    report(context, &results, out, None)?;
    match results.cells.iter().filter(|cell| cell.outcome != Outcome::Done).count() {
        0 => Ok(()),
        count => bail!("{}", failed(count)),
    }
}

/// Reads the costs of cells. Shards that are cut by them must all find the same, so they cannot be in the folder that the
/// shards write into.
fn costs(args: &Args, out: &Path) -> Result<Costs> {
    let Some(folder) = &args.costs else { return Ok(Costs::default()) };
    let is_same = folder.canonicalize().ok().is_some_and(|folder| out.canonicalize().ok() == Some(folder));
    if is_same && matches!(args.shard, Some(Shard::Part { .. })) {
        bail!(
            "--costs {} is the folder that the shards write into, so each would cut others: give a copy, or the folder of a --timing run",
            folder.display()
        );
    }
    Ok(Costs::read(folder)?)
}

/// Returns a study by name or path.
pub(crate) fn source(context: &Context, name: &str) -> Result<Arc<Source>> {
    context.expect(Sort::Study, name)?;
    let file = if name.ends_with(".ron") { name.to_owned() } else { format!("{name}.ron") };
    for path in [format!("studies/{file}"), file] {
        if let Some(text) = context.catalog.assets().text(&path) {
            return Ok(Source::new(path, text));
        }
        if let Some(why) = why_unreadable(Path::new(&path)) {
            bail!("`{path}` cannot be read: {why}");
        }
    }
    let known = names(context);
    Err(unknown("study", name, &known, "check"))
}

/// Returns the names of all studies.
pub(crate) fn names(context: &Context) -> Vec<String> {
    let paths = context.catalog.assets().list("studies", "ron");
    paths.iter().map(|path| path.trim_start_matches("studies/").trim_end_matches(".ron").to_owned()).collect()
}

fn values(given: &[(String, Value)]) -> Vec<(String, AxisValue)> {
    given.iter().map(|(name, value)| (name.clone(), AxisValue::from_value(value))).collect()
}

/// Returns the command that repeats the run.
fn command(args: &Args, file: &str) -> String {
    format!("lightloom study {} -o DIR", words(args, file).join(" "))
}

/// Returns the arguments that say which study runs.
fn words(args: &Args, file: &str) -> Vec<String> {
    let mut words = vec![file.to_owned()];
    let mut add = |option: &str, value: String| words.extend([option.to_owned(), value]);
    if let Some((width, height)) = args.size {
        add("--size", format!("{width}x{height}"));
    }
    args.set.iter().for_each(|set| add("--set", set_text(set)));
    args.set_reference.iter().for_each(|set| add("--set-reference", set_text(set)));
    args.scene.iter().for_each(|scene| add("--scene", scene.clone()));
    args.seeds.iter().for_each(|seeds| add("--seeds", seeds.to_string()));
    args.frames.iter().for_each(|frames| add("--frames", frames.to_string()));
    args.ms.iter().for_each(|ms| add("--ms", ms.to_string()));
    words.extend(args.allow_external.then(|| "--allow-external".to_owned()));
    words.extend(args.quick.then(|| "--quick".to_owned()));
    words.extend(args.timing.then(|| "--timing".to_owned()));
    words
}

/// Writes the Snakefile of a study, and prints its path alone.
fn write_snakefile(
    context: &Context,
    args: &Args,
    file: &str,
    plan: &Plan,
    path: Option<&Path>,
) -> Result<()> {
    let name = &plan.study.name;
    let path = path.map_or_else(|| PathBuf::from(format!("{name}.smk")), Path::to_owned);
    let costs = args.costs.as_deref().map(Costs::read).transpose()?.unwrap_or_default();
    if costs.cell_count() == 0 {
        stderr!(
            "note: nothing is known of the costs of cells, and each counts as {UNKNOWN_SECONDS} seconds: a run with --timing shows them, for --costs"
        );
    }
    let workflow = snakefile::Workflow {
        name,
        file: &path.display().to_string(),
        program: &context.program()?,
        study: &words(args, file),
    };
    write(&path, &snakefile::text(plan, &costs, args.shard_minutes, &workflow))?;
    if context.json {
        output::json(&json!({ "snakefile": path }));
    } else {
        stdout!("{}", path.display());
    }
    Ok(())
}
