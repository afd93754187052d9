//! `lightloom stress`: every pipeline at the extremes.

use super::lists::print;
use crate::context::{Context, parse_set, parse_size, set_text, unknown};
use crate::output::{self, progress, stderr, stdout, write};
use anyhow::{Context as _, Result, bail};
use frame_graph::{LinkContext, Overrides, Value};
use renderer::{Compiled, compile_options};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use stress::{Case, Cell, Child, Event, Options, REFERENCE, Subject, Verdict};

/// Interval at which the report is written while cells run.
const BETWEEN_REPORTS: Duration = Duration::from_secs(20);

/// Render extreme cases by every pipeline, and report the results.
///
/// Each case is rendered in a process of its own. Cases are extremes of scale, place, light, camera, geometry and frames;
/// with --settings also both ends of the range of each setting. Exits with 1 if a picture is not finite, has negative values
/// or another energy than expected, or if a run crashes. If the energy differs from the path tracer's, the mean over further
/// seeds decides.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  lightloom stress -o out/stress
  lightloom stress -o out/stress --pipeline ism --pipeline acrsm --case 'far*' --case 'cone*'
  lightloom stress -o out/stress --pipeline tcas --settings --pairs 32
  lightloom stress -o out/stress --case plain --long 10000 --size 32x32")]
pub(crate) struct Args {
    /// The folder for scenes, pictures of defects and the report
    #[arg(short, long = "out", value_name = "DIR", default_value = "out/stress")]
    out: PathBuf,
    /// A pipeline, by name or .ron file; all by default. May be repeated
    #[arg(long)]
    pipeline: Vec<String>,
    /// A case by name, or several as far*; all by default. May be repeated
    #[arg(long)]
    case: Vec<String>,
    /// List the cases
    #[arg(long)]
    list: bool,
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
    /// Time limit of one picture, in seconds
    #[arg(long, default_value_t = 120)]
    limit: u64,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    let cases = chosen(&args.case)?;
    if args.list {
        let about = |case: Case| (case.name, format!("{}: {}", case.group, case.about));
        print(context, &cases.into_iter().map(about).collect::<Vec<_>>());
        return Ok(());
    }
    let subjects = subjects(context, args)?;
    let options = Options {
        folder: args.out.clone(),
        size: args.size,
        set: args.set.iter().map(|(path, value)| (path.clone(), value.to_argument())).collect(),
        // A pixel is what its centre sees, as in a G-buffer: in a frame of few pixels its mean is another thing.
        set_reference: vec![("filter".to_owned(), "centre".to_owned())],
        samples: args.samples,
        limit: Duration::from_secs(args.limit),
    };
    let root = context.catalog.assets().root().map(|root| root.display().to_string());
    let child = Child {
        path: std::env::current_exe().context("the program that runs does not know where it is")?,
        before: root.map_or_else(Vec::new, |root| vec!["--root".to_owned(), root]),
    };
    let count: usize = subjects.iter().map(|subject| cases.len() + subject.cases.len()).sum();
    let report = Report::new(args, &cases);
    let bar = progress(count as u64, "stress");
    let (mut finished, mut written) = (Vec::new(), Instant::now());
    let cells = stress::run(&child, &subjects, &cases, &options, &mut |event| match event {
        Event::Reference(case) => bar.set_message(format!("reference of {case}")),
        Event::Done(cell) => {
            bar.set_message(format!("{} {}", cell.pipeline, cell.case));
            bar.inc(1);
            if cell.is_defect() && !context.json {
                bar.suspend(|| stdout!("{:<11} {} · {}", cell.verdict.word(), cell.pipeline, cell.case));
            }
            // A run that ends early leaves a report. A report that cannot be written is an error at the end.
            finished.push(cell.clone());
            if bar.is_hidden() {
                stderr!("{}/{count} {} · {}", finished.len(), cell.pipeline, cell.case);
            }
            if written.elapsed() > BETWEEN_REPORTS {
                let _ = report.write(&finished);
                written = Instant::now();
            }
        }
    })?;
    bar.finish_and_clear();
    let page = report.write(&cells)?;
    let record = stress::json(&cells);
    let defects = cells.iter().filter(|cell| cell.is_defect()).count();
    if context.json {
        output::json(&json!({ "report": page, "verdicts": record["verdicts"], "cells": record["cells"] }));
    } else {
        let count = |verdict| cells.iter().filter(|cell| cell.verdict == verdict).count();
        stdout!(
            "{} of {} held, {} refused with a reason, {} took too long, {defects} did not hold",
            count(Verdict::Held),
            cells.len(),
            count(Verdict::Refused),
            count(Verdict::TimedOut)
        );
        stdout!("{}", page.display());
    }
    if defects > 0 {
        bail!("{defects} of {} cells did not hold; {} has the command for each", cells.len(), page.display());
    }
    Ok(())
}

/// The report of the finished cells.
struct Report<'a> {
    folder: &'a Path,
    cases: Vec<Case>,
    about: String,
}

impl<'a> Report<'a> {
    fn new(args: &'a Args, cases: &[Case]) -> Report<'a> {
        let long = args.long.map(|frames| stress::long(frames, false));
        let about = format!(
            "Lightloom {}; frames of {}×{}; {}; references of {} samples per pixel.",
            env!("CARGO_PKG_VERSION"),
            args.size.0,
            args.size.1,
            args.set.iter().map(set_text).collect::<Vec<_>>().join(", "),
            args.samples
        );
        let cases = cases.iter().cloned().chain(long.into_iter().flatten()).collect();
        Report { folder: &args.out, cases, about }
    }

    /// Writes the table as JSON and as a page; returns the path of the page.
    fn write(&self, cells: &[Cell]) -> Result<PathBuf> {
        let page = self.folder.join("report.html");
        write(&self.folder.join("cells.json"), &format!("{:#}\n", stress::json(cells)))?;
        write(&page, &stress::html(cells, &self.cases, &self.about))?;
        Ok(page)
    }
}

/// Returns the cases of these names; all if there are none. `far*` stands for all that begin with `far`.
fn chosen(names: &[String]) -> Result<Vec<Case>> {
    let all = stress::cases();
    let is = |name: &str, case: &Case| match name.strip_suffix('*') {
        Some(beginning) => case.name.starts_with(beginning),
        None => case.name == name,
    };
    for name in names {
        if !all.iter().any(|case| is(name, case)) {
            let known: Vec<String> = all.iter().map(|case| case.name.clone()).collect();
            return Err(unknown("case", name, &known, "stress --list"));
        }
    }
    let wanted = |case: &Case| names.is_empty() || names.iter().any(|name| is(name, case));
    Ok(all.into_iter().filter(wanted).collect())
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
