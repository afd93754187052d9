//! `lightloom stress`: every pipeline at the extremes.

use super::cases::CaseArgs;
use super::study::{GpuLaboratory, Progress, summary};
use crate::context::{Context, parse_set, parse_size, set_text};
use crate::output::{self, stdout};
use anyhow::{Result, bail};
use frame_graph::{LinkContext, Overrides, Value};
use renderer::{Compiled, compile_options};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use stress::{Case, Cell, Child, Options, Program, REFERENCE, Subject, Verdict};
use study::{Laboratory, RunOptions, Shard};

/// Render extreme cases by every pipeline, and report the results.
///
/// Each case is rendered in a process of its own. Finished cells in the folder do not run again. Cases are extremes of scale, place, light, camera, geometry and frames;
/// with --settings also both ends of the range of each setting. Exits with 1 if a picture is not finite, has negative values
/// or another energy than expected, or if a run crashes. If the energy differs from the path tracer's, the mean over further
/// seeds decides.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  lightloom stress -o out/stress
  lightloom stress 'far*' 'cone*' --pipeline ism --pipeline acrsm
  lightloom stress -o out/stress --pipeline tcas --settings --pairs 32
  lightloom stress plain --long 10000 --size 32x32")]
pub(crate) struct Args {
    #[command(flatten)]
    cases: CaseArgs,
    /// A pipeline, by name or .ron file; all by default. May be repeated
    #[arg(long)]
    pipeline: Vec<String>,
    /// Also try both ends of the range of each setting
    #[arg(long)]
    settings: bool,
    /// Number of random pairs of settings at the ends of their ranges
    #[arg(long, default_value_t = 0)]
    pairs: usize,
    /// Also run pipelines with history buffers for this number of frames, at least 500: with a moving light, and with a
    /// still scene
    #[arg(long, value_name = "FRAMES", value_parser = clap::value_parser!(u32).range(i64::from(stress::SHORTEST)..))]
    long: Option<u32>,
    /// Seed of the choice of pairs
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Size of frames in pixels, for cases without a size
    #[arg(long, default_value = "64x64", value_parser = parse_size)]
    size: (u32, u32),
    /// A value for all pipelines that have the name, unless a case sets it. May be repeated
    #[arg(long, value_name = "NAME=VALUE", value_parser = parse_set, default_values = ["lights=256", "map=32", "rsm.size=64"])]
    set: Vec<(String, Value)>,
    /// Samples per pixel of the path tracer; cases of fewer pixels have the same total
    #[arg(long, default_value_t = 256)]
    samples: u32,
    /// Run shard i of n, into a folder of its own; `study merge` joins shards, and the command without it then evaluates them
    #[arg(long, value_name = "i/n")]
    shard: Option<Shard>,
    /// A folder for references, shared with other runs and shards
    #[arg(long, value_name = "DIR")]
    references: Option<PathBuf>,
    /// Seconds after which the process of one picture is killed
    #[arg(long, value_name = "SECONDS", default_value_t = 120, value_parser = clap::value_parser!(u64).range(1..))]
    isolated: u64,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    let all = stress::cases();
    let names: Vec<(String, String)> =
        all.iter().map(|case| (case.name.clone(), format!("{}: {}", case.group, case.about))).collect();
    let Some(chosen) = args.cases.chosen(context, "stress", &names)? else { return Ok(()) };
    let cases: Vec<Case> = chosen.into_iter().map(|index| all[index].clone()).collect();
    let folder = args.cases.folder("stress");
    let subjects = subjects(context, args)?;
    let command = "lightloom stress -o DIR".to_owned();
    let one_sample = ("supersampling".to_owned(), Value::U32(1));
    let options = Options {
        folder: folder.clone(),
        size: args.size,
        set: [&one_sample]
            .into_iter()
            .chain(&args.set)
            .map(|(path, value)| (path.clone(), value.to_argument()))
            .collect(),
        // A pixel is what its centre sees, as in a G-buffer of one sample: in a frame of few pixels its mean is another thing.
        set_reference: vec![("filter".to_owned(), "centre".to_owned())],
        samples: args.samples,
        limit: Duration::from_secs(args.isolated),
        study: RunOptions {
            shard: args.shard.clone(),
            references: args.references.clone(),
            command,
            ..RunOptions::default()
        },
    };
    let mut words = context.program()?.into_iter();
    let child = Child { path: words.next().unwrap_or_default().into(), before: words.collect() };
    let mut known = GpuLaboratory::open(Arc::clone(&context.catalog), None)?;
    let mut progress = Progress::new();
    let lab = (&child as &dyn Program, &mut known as &mut dyn Laboratory);
    let (mut results, cells) =
        stress::run(lab, &subjects, &cases, &options, &mut |event| progress.report(event))?;
    progress.finish();
    (results.study.about, results.study.size) = (about(args), args.size);
    stress::add(&mut results, &cells);
    // A part has no verdicts of its own.
    if args.shard.is_none() {
        study::keep(&results, &folder)?;
    }
    let tables = stress::tables(&cells, &shown(args, &cases));
    let page = study::report_with(&results, &folder, &tables)?.swap_remove(0);
    let defects: Vec<&Cell> = cells.iter().filter(|cell| cell.is_defect()).collect();
    if context.json {
        output::json(&summary(&results, &page, None));
    } else {
        for cell in &defects {
            stdout!("{:<11} {} · {}", cell.verdict.word(), cell.pipeline, cell.case);
        }
        let count = |verdict| cells.iter().filter(|cell| cell.verdict == verdict).count();
        stdout!(
            "{} of {} held, {} refused with a reason, {} took too long, {} did not hold",
            count(Verdict::Held),
            cells.len(),
            count(Verdict::Refused),
            count(Verdict::TimedOut),
            defects.len()
        );
        stdout!("{}", page.display());
    }
    if !defects.is_empty() {
        let (count, all) = (defects.len(), cells.len());
        bail!("{count} of {all} cells did not hold; {} has the command for each", page.display());
    }
    Ok(())
}

fn about(args: &Args) -> String {
    format!(
        "Lightloom {}; frames of {}×{}; {}; references of {} samples per pixel.",
        env!("CARGO_PKG_VERSION"),
        args.size.0,
        args.size.1,
        args.set.iter().map(set_text).collect::<Vec<_>>().join(", "),
        args.samples
    )
}

/// Returns the cases that the page has rows for.
fn shown(args: &Args, cases: &[Case]) -> Vec<Case> {
    let long = args.long.map(|frames| stress::long(frames, false));
    cases.iter().cloned().chain(long.into_iter().flatten()).collect()
}

/// Returns the pipelines with their settings. Without names, all that output indirect light except the reference.
fn subjects(context: &Context, args: &Args) -> Result<Vec<Subject>> {
    let link = LinkContext { frame: args.size, traits: context.traits(None)? };
    if !args.pipeline.is_empty() {
        let subjects = args.pipeline.iter().map(|name| Ok(subject(context, args, &link, name)?.0));
        return subjects.collect();
    }
    let mut all = Vec::new();
    for named in context.catalog.list_pipelines().iter().filter(|named| named.name != REFERENCE) {
        let (subject, has_indirect) = subject(context, args, &link, &named.name)?;
        if has_indirect {
            all.push(subject);
        }
    }
    Ok(all)
}

/// Returns a pipeline, and whether it outputs indirect light.
fn subject(context: &Context, args: &Args, link: &LinkContext, name: &str) -> Result<(Subject, bool)> {
    let compiled = Compiled::new(&context.catalog, name, &Overrides::default(), link, &compile_options())
        .map_err(|errors| anyhow::anyhow!("{errors}"))?;
    let settable = compiled.resolved.settable(&*context.catalog);
    let bounces = settable.iter().find(|settable| settable.path == "bounces");
    let mut cases = if args.settings { stress::of_settings(&settable) } else { Vec::new() };
    cases.extend(stress::of_pairs(&settable, args.pairs, args.seed));
    if let Some(frames) = args.long.filter(|_| !compiled.plan.histories.is_empty()) {
        cases.extend(stress::long(frames, compiled.is_sampled()));
    }
    let subject = Subject {
        bounces: match bounces.map(|settable| &settable.value) {
            Some(Value::U32(bounces)) => *bounces,
            _ => 1,
        },
        sampled: compiled.is_sampled(),
        settable: settable.into_iter().map(|settable| settable.path).collect(),
        name: name.to_owned(),
        cases,
    };
    Ok((subject, compiled.plan.output("indirect").is_some()))
}
