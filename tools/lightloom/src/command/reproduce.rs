//! `lightloom reproduce`: the findings of a paper, each with what was measured.

use super::study::{CatalogRegistry, GpuLaboratory, Progress, names, source};
use crate::context::{Context, unknown};
use crate::output::{self, stderr, stdout, write};
use anyhow::{Context as _, Result, anyhow, bail};
use report::{Column, Entry, Table};
use serde_json::{Value as Json, json};
use std::path::PathBuf;
use std::sync::Arc;
use study::description::Budget;
use study::{Edits, Finding, Laboratory as _, Outcome, Plan, Results, RunOptions, Verdict};

/// The papers, by the names that commands take and that studies give.
const PAPERS: [(&str, &str); 4] =
    [("ism", "ISM"), ("tcas", "TCAS"), ("acrsm", "ACRSM"), ("smc-ir", "SMC-IR")];

/// Seeds and frames at the quick scale: as few as an interval takes, and as flicker does.
const QUICK_SEEDS: u32 = 3;
const QUICK_FRAMES: u32 = 4;

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Scale {
    /// A quarter of each side of the frame, three seeds, four frames, first and last value of each axis
    Quick,
    /// The studies as they are
    Paper,
}

/// Run the studies of a paper, and print a line for each of its findings.
///
/// A line has where the paper says it, what it says, what was measured, and whether it holds. Each study has a folder with its report in
/// that of the paper, and goes on where it was stopped.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  lightloom reproduce tcas
  lightloom reproduce ism --scale paper -o out/ism
  lightloom reproduce smc-ir --only smc-ir-fig-8 --only smc-ir-tab-1")]
pub(crate) struct Args {
    /// The paper: ism, tcas, acrsm or smc-ir
    paper: String,
    /// How much is run
    #[arg(long, value_enum, default_value_t = Scale::Quick)]
    scale: Scale,
    /// A study of the paper, in place of all. May be repeated
    #[arg(long, value_name = "STUDY")]
    only: Vec<String>,
    /// List the studies of the paper, and run none
    #[arg(long)]
    list: bool,
    /// The folder for the findings and the studies [default: out/PAPER]
    #[arg(short, long = "out", value_name = "DIR")]
    out: Option<PathBuf>,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    let studies = chosen(context, args)?;
    if args.list {
        let listed: Vec<(String, String)> = studies
            .iter()
            .map(|study| (study.name.clone(), format!("{}: {}", study.paper, study.about)))
            .collect();
        super::lists::print(context, &listed);
        return Ok(());
    }
    let out = args.out.clone().unwrap_or_else(|| PathBuf::from("out").join(&args.paper));
    std::fs::create_dir_all(&out).with_context(|| format!("the folder {} cannot be made", out.display()))?;
    let registry = CatalogRegistry::new(Arc::clone(&context.catalog));
    let mut lab = GpuLaboratory::open(Arc::clone(&context.catalog), None)?;
    let adapter = lab.adapter();
    let (mut table, mut found, mut failed) = (empty(args, &adapter), Vec::new(), 0);
    for mut study in studies {
        let (name, paper) = (study.name.clone(), study.paper.clone());
        if args.scale == Scale::Quick {
            study = quick(study)?;
        }
        let plan = Plan::new(study, &registry)?;
        let (folder, mut progress) = (out.join(&name), Progress::new());
        stderr!("{name}: {paper}");
        let scale = if args.scale == Scale::Quick { "quick" } else { "paper" };
        let command = format!("lightloom reproduce {} --scale {scale} --only {name} -o DIR", args.paper);
        let options = RunOptions { command, ..RunOptions::default() };
        let ran = study::run(&plan, &mut lab, &folder, &options, &mut |event| progress.report(event));
        progress.finish();
        let results =
            ran.with_context(|| format!("`{name}` stopped; the same command goes on from there"))?.results;
        study::report(&results, &folder)?;
        failed += results.cells.iter().filter(|cell| cell.outcome != Outcome::Done).count();
        found.extend(results.findings().iter().map(|finding| row(&results, finding)));
        add(&mut table, &results);
        // After each study, so that what is finished can be read.
        write(&out.join("findings.md"), &table.markdown())?;
        let record = json!({ "paper": args.paper, "scale": scale, "adapter": adapter, "findings": found });
        write(&out.join("findings.json"), &format!("{record:#}\n"))?;
    }
    let count = |verdict: &str| found.iter().filter(|row| row["verdict"] == verdict).count();
    if context.json {
        output::json(
            &json!({ "paper": args.paper, "findings": found, "failed": failed, "written": out.join("findings.md") }),
        );
    } else {
        stdout!("{}", table.text());
        stdout!(
            "{} of {} findings hold, {} do not, {} are not decided",
            count("holds"),
            found.len(),
            count("fails"),
            count("undecided")
        );
        stdout!("{}", out.join("findings.md").display());
    }
    if failed > 0 {
        bail!("{failed} cells failed; the same command tries them again");
    }
    Ok(())
}

/// Returns a study at the quick scale; with all its frames where its measures need them.
fn quick(study: study::Study) -> Result<study::Study> {
    let edits =
        Edits { quick: true, seeds: Some(QUICK_SEEDS), frames: Some(QUICK_FRAMES), ..Edits::default() };
    let mut short = study.clone();
    let is_long = matches!(study.budget, Budget::Frames(frames) if frames > QUICK_FRAMES);
    if is_long && short.edit(&edits).is_ok() {
        return Ok(short);
    }
    let mut long = study;
    long.edit(&Edits { frames: None, ..edits })?;
    Ok(long)
}

/// Returns the studies of the paper, in the order of their names.
fn chosen(context: &Context, args: &Args) -> Result<Vec<study::Study>> {
    let Some((_, short)) = PAPERS.iter().find(|(name, _)| *name == args.paper) else {
        let known: Vec<String> = PAPERS.iter().map(|(name, _)| (*name).to_owned()).collect();
        return Err(match frame_graph::nearest(&args.paper, known.iter().map(String::as_str)) {
            Some(near) => anyhow!("there is no paper `{}`; did you mean `{near}`?", args.paper),
            None => anyhow!("there is no paper `{}`; there are {}", args.paper, known.join(", ")),
        });
    };
    let registry = CatalogRegistry::new(Arc::clone(&context.catalog));
    let mut studies = Vec::new();
    for name in names(context) {
        let study = study::parse_with(source(context, &name)?, &registry)?;
        if study.paper.split([' ', ';']).next() == Some(short) {
            studies.push(study);
        }
    }
    let known: Vec<String> = studies.iter().map(|study| study.name.clone()).collect();
    for name in &args.only {
        if !known.contains(name) {
            return Err(unknown(
                &format!("study of {short}"),
                name,
                &known,
                &format!("reproduce {} --list", args.paper),
            ));
        }
    }
    studies.retain(|study| args.only.is_empty() || args.only.contains(&study.name));
    Ok(studies)
}

fn empty(args: &Args, adapter: &str) -> Table {
    let scale = match args.scale {
        Scale::Quick => {
            "quick: a quarter of each side of the frame, three seeds, four frames, first and last value of each axis"
        }
        Scale::Paper => "as the studies are",
    };
    let text = |title: &str| Column::text(title, "");
    Table {
        name: "findings".to_owned(),
        caption: format!(
            "The findings of the paper, on {adapter}; {scale}. Intervals are of 95 % over seeds."
        ),
        columns: ["Where", "Study", "Claim", "The paper", "Scene", "Measured", "Result", "Why"]
            .map(text)
            .to_vec(),
        rows: Vec::new(),
    }
}

/// Adds the claims of a study; one without claims has a row that says so.
fn add(table: &mut Table, results: &Results) {
    let study = &results.study;
    let own = || [Entry::Text(study.paper.clone()), Entry::Text(study.name.clone())];
    match study::claims(results) {
        Some(claims) => {
            table.rows.extend(claims.rows.into_iter().map(|row| {
                let mut row: Vec<Entry> = own().into_iter().chain(row).collect();
                // A study of which no reason applies has no column for them.
                row.resize(table.columns.len(), Entry::Text(String::new()));
                row
            }));
        }
        None => {
            let rest = ["no claim", "", "", "", "", ""].map(|text| Entry::Text(text.to_owned()));
            table.rows.push(own().into_iter().chain(rest).collect());
        }
    }
}

fn row(results: &Results, finding: &Finding<'_>) -> Json {
    let verdict = match finding.verdict {
        Some(Verdict::Holds) => "holds",
        Some(Verdict::Fails) => "fails",
        Some(Verdict::Undecided) => "undecided",
        None => "not measured",
    };
    json!({
        "where": results.study.paper, "study": results.study.name, "says": finding.claim.says,
        "scenes": finding.scenes, "means": finding.means, "ratio": finding.ratio(), "verdict": verdict, "because": finding.reason(),
    })
}
