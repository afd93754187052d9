//! `lightloom tune`: the best settings for a time, or for an error.

mod measure;
mod space;

use crate::context::{Context, Sort, Values, parse_size};
use crate::output::{self, progress, stdout, write};
use anyhow::{Context as _, Result, bail};
use frame_graph::{LinkContext, Overrides, Value, resolve, variant};
use measure::Measurer;
use metrics::{Display, Epsilon, PIXELS_PER_DEGREE, Pair, flip};
use renderer::parse_value;
use report::{Column, Entry, Measured, Table};
use serde_json::{Value as Json, json};
use space::Space;
use std::path::PathBuf;
use tune::{Axis, Candidate, Options, Outcome, Target, front, full, search};

/// Search settings for the least error in a time, or the least time for an error.
///
/// The parameters of the pipeline are tried at 1/4 to 4 times their defaults, or at all values that they may have, and what passes
/// declare as exact beside what approximates it. From the best point that is known the search goes on to those beside it; the best
/// are tried with more seeds, half of them each time, and the last ones are judged by seeds that no choice was made by. The winner is
/// written as a pipeline. What was measured is kept in the folder, and is not measured again.
#[derive(clap::Args)]
#[command(group = clap::ArgGroup::new("target").required(true), after_help = "Examples:
  lightloom tune ism-invtm atrium-spot --target-ms 40
  lightloom tune acrsm hall.glb nave.glb --target-error 0.02 -o out/acrsm
  lightloom tune ism cornell-box --target-ms 20 --vary lights=64,256,1024 --vary map=32,64 --fix filter")]
pub(crate) struct Args {
    /// A pipeline by name, or a .ron file
    pipeline: String,
    /// Scenes by name, or .ron, .glb, .gltf, .pbrt or .xml files: the error is the mean over them, and so is the time
    #[arg(required = true)]
    scenes: Vec<String>,
    /// The GPU time that a frame may take, in milliseconds
    #[arg(long, value_name = "MS", value_parser = positive, group = "target")]
    target_ms: Option<f64>,
    /// The error that a picture may have, by the measure
    #[arg(long, value_name = "ERROR", value_parser = positive, group = "target")]
    target_error: Option<f64>,
    /// The measure of error
    #[arg(long, value_enum, default_value_t = Measure::RelMse)]
    measure: Measure,
    /// The folder for the winner, and for what was measured
    #[arg(short, long = "out", value_name = "DIR", default_value = "out/tune")]
    out: PathBuf,
    /// Values of a parameter or a setting that are tried, in place of those around its default. May be repeated
    #[arg(long, value_name = "NAME=VALUE,…", value_parser = parse_vary)]
    vary: Vec<(String, Vec<Value>)>,
    /// A parameter, or something that is approximated, that stays as it is. May be repeated
    #[arg(long, value_name = "NAME")]
    fix: Vec<String>,
    /// The most points that are tried
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    points: u32,
    /// Try all points, each with the seeds that judge: what the search is compared with
    #[arg(long, conflicts_with = "points")]
    full: bool,
    /// Seeds that judge the last ones
    #[arg(long, default_value_t = 6, value_parser = clap::value_parser!(u32).range(2..=1000))]
    judges: u32,
    /// Size of the frame in pixels
    #[arg(long, default_value = "96x72", allow_hyphen_values = true, value_parser = parse_size)]
    size: (u32, u32),
    /// Samples per pixel of the references
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(1..))]
    samples: u32,
    /// The output that is looked at
    #[arg(long, default_value = "indirect")]
    output: String,
    /// Number of the frame, and so the time of animations
    #[arg(long, default_value_t = 0)]
    frame: u32,
    #[command(flatten)]
    values: Values,
}

/// A measure of the error of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Measure {
    /// relMSE
    RelMse,
    /// MAPE
    Mape,
    /// ꟻLIP
    Flip,
}

impl Measure {
    fn name(self) -> &'static str {
        match self {
            Measure::RelMse => "relMSE",
            Measure::Mape => "MAPE",
            Measure::Flip => "ꟻLIP",
        }
    }

    /// Returns the error of the first picture of a pair; `None` where there is none.
    fn of(self, pair: &Pair<'_>) -> Option<f64> {
        match self {
            Measure::RelMse => pair.rel_mse(Epsilon::default()),
            Measure::Mape => pair.mape(Epsilon::default()),
            Measure::Flip => Some(flip(pair, Display::default(), PIXELS_PER_DEGREE).mean()),
        }
    }
}

fn positive(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("`{text}` is no number"))?;
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(format!("must be above 0; found `{text}`")) }
}

/// Parses `name=value,value`.
fn parse_vary(text: &str) -> Result<(String, Vec<Value>), String> {
    let (name, values) =
        text.split_once('=').ok_or("expected `parameter=value,value` or `pass.setting=value,value`")?;
    Ok((name.trim().to_owned(), values.split(',').map(parse_value).collect()))
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    context.expect(Sort::Pipeline, &args.pipeline)?;
    args.scenes.iter().try_for_each(|scene| context.expect(Sort::Scene, scene))?;
    let target = match (args.target_ms, args.target_error) {
        (Some(ms), _) => Target::Ms(ms),
        (None, Some(error)) => Target::Error(error),
        (None, None) => bail!("give --target-ms or --target-error"),
    };
    let first = renderer::load_scene(&context.catalog, &args.scenes[0])?;
    let link = LinkContext { frame: args.size, traits: first.traits() };
    let space = Space::new(context, args, &link)?;
    std::fs::create_dir_all(&args.out)
        .with_context(|| format!("the folder {} cannot be made", args.out.display()))?;
    let count = if args.full { space.points() as u64 } else { u64::from(args.points) };
    let bar = progress(count, "tune");
    let mut measurer = Measurer::new(context, args, &space, &bar)?;
    let axes: Vec<Axis> = space.axes.iter().map(|axis| axis.axis.clone()).collect();
    let points = args.points as usize;
    let options = Options { points, kept: (points / 4).clamp(4, 16), judges: args.judges };
    let outcome = if args.full {
        full(&axes, target, args.judges, &mut measurer)?
    } else {
        search(&axes, target, &options, &mut measurer)?
    };
    bar.finish_and_clear();
    if outcome.tried.is_empty() {
        bail!("`{}` cannot be rendered with any of the values that were tried", args.pipeline);
    }
    let adapter = measurer.adapter();
    let table = table(&space, &outcome, target);
    let winner = outcome.winner.map(|winner| &outcome.tried[winner]);
    let file = args.out.join("winner.ron");
    if let Some(winner) = winner {
        write(&file, &pipeline(context, args, &space, winner, (target, &adapter), &link)?)?;
    }
    let record = json!({
        "pipeline": args.pipeline, "scenes": args.scenes, "target": in_words(target), "adapter": adapter,
        "grid": space.points(), "tried": outcome.tried.len(), "runs": outcome.runs,
        "winner": winner.map(|winner| row(&space, winner)),
        "front": on_front(&outcome).map(|candidate| row(&space, candidate)).collect::<Vec<_>>(),
    });
    write(&args.out.join("tune.json"), &format!("{record:#}\n"))?;
    if context.json {
        output::json(&json!({ "tune": record, "written": winner.map(|_| &file) }));
    } else {
        stdout!("{}", table.text());
        stdout!("{} of {} points were tried, in {} runs", outcome.tried.len(), space.points(), outcome.runs);
    }
    if winner.is_none() {
        let best = &outcome.tried[0];
        bail!(
            "nothing that was tried reaches {}; nearest is an error of {:.3} in {:.2} ms",
            in_words(target),
            best.error().0,
            best.ms()
        );
    }
    if !context.json {
        stdout!("{}", file.display());
    }
    Ok(())
}

fn in_words(target: Target) -> String {
    match target {
        Target::Ms(ms) => format!("{ms} ms"),
        Target::Error(error) => format!("an error of {error}"),
    }
}

/// The points that no other one beats.
fn on_front(outcome: &Outcome) -> impl Iterator<Item = &Candidate> {
    let points: Vec<(f64, f64)> =
        outcome.tried.iter().map(|candidate| (candidate.ms(), candidate.error().0)).collect();
    front(&points).into_iter().map(|at| &outcome.tried[at])
}

fn row(space: &Space, candidate: &Candidate) -> Json {
    let values: serde_json::Map<String, Json> =
        space.words(&candidate.point).into_iter().map(|(name, value)| (name, json!(value))).collect();
    let (error, half) = candidate.error();
    json!({
        "values": values, "error": error, "half": half, "ms": candidate.ms(),
        "judged": !candidate.judged_by.is_empty(), "seeds": candidate.seeds(),
    })
}

fn table(space: &Space, outcome: &Outcome, target: Target) -> Table {
    let mut columns = vec![Column::text("", ""), Column::number("ms", ""), Column::number("error", "")];
    columns.extend(space.axes.iter().map(|axis| Column::text(&axis.name, "")));
    let winner = outcome.winner.map(|winner| &outcome.tried[winner]);
    let mut shown: Vec<&Candidate> = on_front(outcome).collect();
    if let Some(winner) = winner.filter(|winner| !shown.contains(winner)) {
        shown.push(winner);
        shown.sort_by(|a, b| a.ms().total_cmp(&b.ms()));
    }
    let row = |candidate: &&Candidate| {
        let (error, half) = candidate.error();
        let is_winner = winner.is_some_and(|winner| winner.point == candidate.point);
        let mark = match (is_winner, candidate.meets(target)) {
            (true, _) => "winner",
            (_, true) => "reaches it",
            (_, false) => "",
        };
        let mut entries = vec![
            Entry::Text(mark.to_owned()),
            Entry::Text(Measured::new(candidate.ms(), None).text()),
            Entry::Text(Measured::new(error, half).text()),
        ];
        entries.extend(space.words(&candidate.point).into_iter().map(|(_, value)| Entry::Text(value)));
        entries
    };
    Table {
        name: "front".to_owned(),
        caption: "What no other point beats in both time and error.".to_owned(),
        columns,
        rows: shown.iter().map(row).collect(),
    }
}

/// Returns the winner as a pipeline: a variant where it has other values alone, else the whole pipeline.
fn pipeline(
    context: &Context,
    args: &Args,
    space: &Space,
    winner: &Candidate,
    (target, adapter): (Target, &str),
    link: &LinkContext,
) -> Result<String> {
    let (error, half) = winner.error();
    let error = Measured::new(error, half).text();
    let (scenes, words) = (args.scenes.join(", "), in_words(target));
    let evidence = format!(
        "// Found by `lightloom tune` {} for {words}: {} {error} in {:.2} ms a frame of {}×{},\n// over {} seeds, on {scenes}.\n// {adapter}\n",
        env!("CARGO_PKG_VERSION"),
        args.measure.name(),
        winner.ms(),
        args.size.0,
        args.size.1,
        winner.judged_by.len(),
    );
    let about = format!("{}, tuned for {words} on {scenes}", args.pipeline);
    if space.is_plain(&winner.point) {
        let base = resolve(&args.pipeline, context.catalog.pipelines(), &Overrides::default())?;
        let values = space.overrides(&winner.point);
        return Ok(evidence + &variant(&args.pipeline, &about, &base, &*context.catalog, &values));
    }
    let found = space.pipeline(context, args, &winner.point, link)?;
    let (_, resolved) = found.context("the winner can be rendered no more")?;
    Ok(evidence + &resolved.to_ron(&*context.catalog, false))
}
