//! `lightloom judge`: frames that another engine has made, measured as those of a study are.

mod files;
mod laboratory;

use crate::command::study::{Progress, above_zero, failures, failures_json, print_failures};
use crate::context::Context;
use crate::output::{self, stderr, stdout};
use anyhow::{Context as _, Result, bail};
use files::{Sequence, Times, rows_of};
use frame_graph::Source;
use laboratory::FileLaboratory;
use metrics::{Image, Pair, misalignment};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::PathBuf;
use study::{
    Cell, Interval, Outcome, PipelineRecord, Plan, Results, Run, RunOptions, RunRequest, SceneFacts,
    SceneRecord,
};

/// Measure frames of another engine: error, energy, flicker, lag, equal time.
///
/// Frames are EXR, PFM or HDR files with numbers in their names. A folder of folders holds several runs of the same, with
/// other random numbers each: then means have intervals.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  lightloom judge out/engine reference.exr
  lightloom judge out/engine out/reference --change-at 12 --ms times.csv
  lightloom judge out/engine-a out/engine-b out/reference --ms 8.3 --ms 11.2 -o out/judged")]
pub(crate) struct Args {
    /// Folders of frames, one for each engine; or the frames of one
    #[arg(required = true)]
    frames: Vec<PathBuf>,
    /// The reference: a picture where nothing moves, or a folder of as many as there are frames
    reference: PathBuf,
    /// The folder for the report, tables and pictures
    #[arg(short, long = "out", value_name = "DIR", default_value = "out/judge")]
    out: PathBuf,
    /// Number of the first frame under a new light, for the lag
    #[arg(long, value_name = "FRAME")]
    change_at: Option<u32>,
    /// Milliseconds that a frame took, or a CSV file with a line for each frame; one for each engine, in order
    #[arg(long, value_name = "MS|FILE")]
    ms: Vec<Times>,
    /// Frames per second, for what changes with time
    #[arg(long, default_value_t = 30.0, value_parser = above_zero)]
    fps: f64,
}

/// Frames of one engine.
struct Row {
    name: String,
    /// Its runs, each with other random numbers.
    runs: Vec<Sequence>,
    /// Milliseconds of each frame, where they are known.
    ms: Vec<f64>,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    let reference = Sequence::of(&args.reference)?;
    let rows = rows(args, &reference)?;
    let first = &rows[0].runs[0];
    if let Some(change) = args.change_at
        && !(first.first() + 1..=first.last()).contains(&change)
    {
        bail!(
            "--change-at {change}: expected the number of a frame with one before it, from {} to {}",
            first.first() + 1,
            first.last()
        );
    }
    let truth = Image::read(&reference.files[0])?;
    let size = (truth.width() as u32, truth.height() as u32);
    for row in &rows {
        look_at(row, &reference, &truth)?;
    }
    let plan = plan(args, &rows, &reference, size)?;
    let options = RunOptions { command: command(args), ..RunOptions::default() };
    let mut lab = FileLaboratory { rows: &rows, reference: &reference };
    let mut progress = Progress::new();
    let ran = study::run(&plan, &mut lab, &args.out, &options, &mut |event| progress.report(event));
    progress.finish();
    let results = ran?.results;
    report(context, &results, &args.out)?;
    match failures(&results).len() {
        0 => Ok(()),
        count => bail!("{count} of {} could not be measured", results.cells.len()),
    }
}

/// Returns the frames of each engine, with their times.
fn rows(args: &Args, reference: &Sequence) -> Result<Vec<Row>> {
    let found = rows_of(&args.frames)?;
    if args.ms.len() > 1 && args.ms.len() != found.len() {
        bail!("--ms is given {} times for {} engines; expected one for each", args.ms.len(), found.len());
    }
    let count = found[0].1[0].files.len();
    let mut rows = Vec::new();
    for (index, (name, runs)) in found.into_iter().enumerate() {
        for run in &runs {
            let own = run.files.len();
            if own != count {
                bail!(
                    "{}: expected as many frames as the others have, {count}; found {own}",
                    run.path.display()
                );
            }
        }
        let ms = args.ms.get(index).or(args.ms.first()).map(|times| times.of(&runs[0])).transpose()?;
        rows.push(Row { name, runs, ms: ms.unwrap_or_default() });
    }
    if ![1, count].contains(&reference.files.len()) {
        bail!(
            "{}: expected one picture, or as many as there are frames, {count}; found {}",
            reference.path.display(),
            reference.files.len()
        );
    }
    Ok(rows)
}

/// Compares the first frame of an engine with its reference: it has another size, or may be of another camera.
fn look_at(row: &Row, reference: &Sequence, truth: &Image) -> Result<()> {
    for run in &row.runs {
        let file = &run.files[0];
        let image = Image::read(file)?;
        let pair = Pair::new(&image, truth)
            .with_context(|| format!("{} and {}", file.display(), reference.files[0].display()))?;
        if let Some(sign) = misalignment(&pair) {
            stderr!("warning: {} may be of another camera: {sign}", file.display());
        }
    }
    Ok(())
}

/// Returns the plan of a study in which each engine is a row.
fn plan(args: &Args, rows: &[Row], reference: &Sequence, size: (u32, u32)) -> Result<Plan> {
    let (first, runs) = (&rows[0].runs[0], rows.iter().map(|row| row.runs.len()).max().unwrap_or(1));
    let frames = first.files.len();
    let moves = reference.files.len() > 1;
    let mut measures = vec!["rel-mse", "flip", "energy"];
    let mut add = |is_there: bool, names: &[&'static str]| measures.extend(names.iter().filter(|_| is_there));
    add(moves, &["tone-error"]);
    add(moves && frames > 1, &["tone-change"]);
    add(!moves && frames > 1 && args.change_at.is_none(), &["static-deviation"]);
    add(args.change_at.is_some() && frames > 2, &["lag"]);
    add(runs > 1, &["bias2", "variance"]);
    add(!args.ms.is_empty(), &["gpu-ms"]);
    let names: Vec<&str> = rows.iter().map(|row| &*row.name).collect();
    let jump = args.change_at.map(|change| format!("jump: {change}, ")).unwrap_or_default();
    let text = format!(
        "Study(\n    title: \"Frames of other engines\",\n    scenes: [{:?}],\n    pipelines: {names:?},\n    size: {size:?},\n    \
         budget: Frames({frames}), warm_up: 0, first_frame: {}, {jump}seeds: {runs},\n    measures: {measures:?},\n    \
         reference: Pipeline(pipeline: \"reference\"),\n)\n",
        reference.name,
        first.first(),
    );
    let study = study::parse(Source::new("judge.ron", text))?;
    let scene = SceneFacts {
        record: SceneRecord {
            name: reference.name.clone(),
            about: format!("{} frames", frames),
            hash: String::new(),
            triangles: 0,
        },
        moves,
        seconds_per_frame: 1.0 / args.fps,
        small_length: 0.0,
    };
    let pipelines = rows.iter().map(|row| PipelineRecord {
        name: row.name.clone(),
        pipeline: row.runs[0].path.display().to_string(),
        about: "frames of another engine".to_owned(),
        paper: String::new(),
        set: BTreeMap::new(),
    });
    let request = RunRequest {
        scene: reference.name.clone(),
        size,
        first_frame: first.first(),
        frames: frames as u32,
        timed: !args.ms.is_empty(),
        ..RunRequest::default()
    };
    let mut all = Vec::new();
    for (pipeline, row) in rows.iter().enumerate() {
        for seed in 1..=row.runs.len() as u32 {
            let request = RunRequest { pipeline: row.name.clone(), seed, ..request.clone() };
            let truth = RunRequest {
                output: "reference".to_owned(),
                frames: reference.files.len() as u32,
                ..request.clone()
            };
            let truth = RunRequest { pipeline: String::new(), seed: 0, timed: false, ..truth };
            let from = reference.path.display().to_string();
            all.push(Run { scene: 0, pipeline, request, reference: Some((from, truth)) });
        }
    }
    Ok(Plan::of_runs(study, vec![scene], pipelines.collect(), all))
}

/// Returns the command that repeats the run.
fn command(args: &Args) -> String {
    let mut words: Vec<String> =
        args.frames.iter().chain([&args.reference]).map(|path| path.display().to_string()).collect();
    words.extend(args.change_at.map(|change| format!("--change-at {change}")));
    words.extend(args.ms.iter().map(|times| format!("--ms {times}")));
    format!("lightloom judge {} -o DIR", words.join(" "))
}

/// Writes the report, and prints what was measured.
fn report(context: &Context, results: &Results, out: &std::path::Path) -> Result<()> {
    let files = study::report(results, out)?;
    let page = files.first().map(|page| page.canonicalize().unwrap_or_else(|_| page.clone()));
    let failures = failures(results);
    if context.json {
        let engines: Vec<Value> =
            results.study.pipelines.iter().map(|row| engine(results, &row.name)).collect();
        output::json(&json!({ "report": page, "engines": engines, "failed": failures_json(&failures) }));
        return Ok(());
    }
    print_failures(&failures);
    study::tables(results).iter().for_each(|table| stdout!("{}", table.text()));
    if let Some(page) = page {
        stdout!("{}", page.display());
    }
    Ok(())
}

/// Returns the measures of an engine over its runs.
fn engine(results: &Results, name: &str) -> Value {
    let cells: Vec<&Cell> =
        results.cells.iter().filter(|cell| cell.pipeline == name && cell.outcome == Outcome::Done).collect();
    let measures: BTreeMap<&str, Option<Interval>> = results
        .study
        .measures
        .iter()
        .map(|info| {
            let values: Vec<f64> = cells.iter().filter_map(|cell| *cell.measures.get(&info.key)?).collect();
            (info.key.as_str(), Interval::of(&values))
        })
        .collect();
    json!({ "name": name, "measures": measures })
}
