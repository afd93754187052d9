//! `lightloom stress`: every pipeline at the extremes.

use crate::context::{Context, parse_size};
use crate::output::{self, Pace, progress, say, tell, write};
use anyhow::{Context as _, Result, bail};
use frame_graph::{LinkContext, Overrides, Value, nearest};
use indicatif::HumanDuration;
use renderer::{Compiled, compile_options};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use stress::{Case, Cell, Child, Event, Options, REFERENCE, Subject, Verdict};

/// How often the report is written while cells are run.
const BETWEEN_REPORTS: Duration = Duration::from_secs(20);

/// Render extremes by every pipeline, and say what becomes of them.
///
/// Each case is rendered in a process of its own. Cases are scenes at the ends of scale, place, light, camera, geometry and
/// frames; with --settings also both ends of the range of each setting. Exits with 1 where a picture is not finite, is
/// negative or has another energy than expected, or where a run crashes. Where the energy is off from the path tracer's, that
/// of further seeds is looked at, and their mean judged.
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
    /// A pipeline, by name or .ron file; all unless given. Any number of times
    #[arg(long)]
    pipeline: Vec<String>,
    /// A case by name, or several as far*; all unless given. Any number of times
    #[arg(long)]
    case: Vec<String>,
    /// List the cases
    #[arg(long)]
    list: bool,
    /// Try both ends of the range of each setting, too
    #[arg(long)]
    settings: bool,
    /// Try this many pairs of settings at an end of their ranges, drawn at random
    #[arg(long, default_value_t = 0)]
    pairs: usize,
    /// Also run pipelines that keep something between frames for this many, at least 500: with a light that moves, and
    /// with nothing that does
    #[arg(long, value_name = "FRAMES", value_parser = clap::value_parser!(u32).range(i64::from(stress::SHORTEST)..))]
    long: Option<u32>,
    /// Seed of the choice of pairs
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Size of frames in pixels, where a case has none of its own
    #[arg(long, default_value = "64x64", value_parser = parse_size)]
    size: (u32, u32),
    /// A value for all pipelines that have the name, where a case sets no other. Any number of times
    #[arg(long, value_name = "NAME=VALUE", value_parser = crate::context::parse_set, default_values = ["lights=256", "map=32", "rsm.size=64"])]
    set: Vec<String>,
    /// Samples per pixel of the path tracer; where a case has fewer pixels, as many in all
    #[arg(long, default_value_t = 256)]
    samples: u32,
    /// How long one picture may take, in seconds
    #[arg(long, default_value_t = 120)]
    limit: u64,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    let cases = chosen(&args.case)?;
    if args.list {
        return list(context, &cases);
    }
    let subjects = subjects(context, args)?;
    let values = |texts: &[String]| -> Result<Vec<(String, String)>> {
        let values = crate::context::overrides(texts)?;
        Ok(values.0.into_iter().map(|(path, value)| (path, value.to_argument())).collect())
    };
    let options = Options {
        folder: args.out.clone(),
        size: args.size,
        set: values(&args.set)?,
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
    let (start, mut pace) = (Instant::now(), Pace::new());
    let cells = stress::run(&child, &subjects, &cases, &options, &mut |event| match event {
        Event::Reference(case) => {
            bar.set_message(format!("reference of {case}"));
            if pace.is_due() {
                tell!("{}/{count} reference of {case}", finished.len());
            }
        }
        Event::Done(cell) => {
            bar.set_message(format!("{} {}", cell.pipeline, cell.case));
            bar.inc(1);
            if cell.is_defect() && !context.json {
                bar.suspend(|| say!("{:<11} {} · {}", cell.verdict.word(), cell.pipeline, cell.case));
            }
            // A run of hours that ends early leaves what it found. That it cannot be written is told at the end.
            finished.push(cell.clone());
            if pace.is_due() {
                let rest = count.saturating_sub(finished.len()) as f64 / finished.len() as f64;
                let (done, left) = (finished.len(), HumanDuration(start.elapsed().mul_f64(rest)));
                tell!("{done}/{count} {} · {}, about {left} left", cell.pipeline, cell.case);
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
        say!(
            "{} of {} held, {} refused with a reason, {} took too long, {defects} did not hold",
            count(Verdict::Held),
            cells.len(),
            count(Verdict::Refused),
            count(Verdict::TimedOut)
        );
        say!("{}", page.display());
    }
    if defects > 0 {
        bail!("{defects} of {} cells did not hold; {} has the command for each", cells.len(), page.display());
    }
    Ok(())
}

/// What is written of the cells that are done.
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
            args.set.join(", "),
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

/// The cases of these names; all where there are none. `far*` is all that begin with `far`.
fn chosen(names: &[String]) -> Result<Vec<Case>> {
    let all = stress::cases();
    let is = |name: &str, case: &Case| match name.strip_suffix('*') {
        Some(beginning) => case.name.starts_with(beginning),
        None => case.name == name,
    };
    for name in names {
        if !all.iter().any(|case| is(name, case)) {
            let near = nearest(name, all.iter().map(|case| case.name.as_str()));
            let near = near.map_or(String::new(), |near| format!("; did you mean `{near}`?"));
            bail!("there is no case `{name}`{near} `lightloom stress --list` lists all");
        }
    }
    let wanted = |case: &Case| names.is_empty() || names.iter().any(|name| is(name, case));
    Ok(all.into_iter().filter(wanted).collect())
}

fn list(context: &Context, cases: &[Case]) -> Result<()> {
    if context.json {
        let cases: Vec<_> = cases
            .iter()
            .map(|case| json!({ "name": case.name, "group": case.group, "about": case.about }))
            .collect();
        output::json(&json!(cases));
        return Ok(());
    }
    for case in cases {
        say!("{:<18} {:<10} {}", case.name, case.group, case.about);
    }
    Ok(())
}

/// The pipelines, with what can be set in each. Without names, all that output indirect light and are not the reference.
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

/// A pipeline, and whether it outputs indirect light.
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
