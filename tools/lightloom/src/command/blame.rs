//! `lightloom blame`: who owes the error of a picture.

mod experiment;

pub(crate) use experiment::{bounces, changed, declared, reference, reference_values};

use crate::context::{Context, Sort, Values, parse_size, set_text};
use crate::output::{self, progress, stdout, write};
use anyhow::{Context as _, Result, bail};
use blame::{Cell, Change, Heading, Map, Pictures, References, Shares, Stage, Subset, Weights};
use experiment::{Experiment, Halves, IRRADIANCE};
use frame_graph::LinkContext;
use metrics::Image;
use renderer::{Gpu, SharedScene};
use serde::Deserialize as _;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Share the error of a picture out between what its pipeline approximates.
///
/// Each approximation is replaced by what is exact in its place, as passes declare it, in all combinations. The share of one is
/// its Shapley value: the mean over all orders in which they can be made exact of what the error falls by at its turn. Shares,
/// and what is left when all are exact, add up to the error of the picture: squared, relative to the path tracer, as bias² and
/// variance over seeds. The page shows the picture colored by whom its error is owed to.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  lightloom blame ism-invtm atrium-spot
  lightloom blame acrsm sponza.glb --size 160x120 --seeds 8 -o out/acrsm
  lightloom blame ism-2008 cornell-box --set lights=256 --json")]
pub(crate) struct Args {
    /// A pipeline by name, or a .ron file
    pipeline: String,
    /// A scene by name, or a .ron, .glb, .gltf, .pbrt or .xml file
    scene: String,
    /// The folder for the page and its record
    #[arg(short, long = "out", value_name = "DIR", default_value = "out/blame")]
    out: PathBuf,
    /// Size of the frame in pixels
    #[arg(long, default_value = "64x48", allow_hyphen_values = true, value_parser = parse_size)]
    size: (u32, u32),
    /// Seeds: frames with random numbers of their own, by which bias² and variance are told apart
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u32).range(3..=1000))]
    seeds: u32,
    /// Samples per pixel of each of the two references
    #[arg(long, default_value_t = 512, value_parser = clap::value_parser!(u32).range(1..))]
    samples: u32,
    /// The output that is looked at
    #[arg(long, default_value = "indirect")]
    output: String,
    /// Number of the frame, and so the time of animations
    #[arg(long, default_value_t = 0)]
    frame: u32,
    /// Frames that run before it, for pipelines that remember the frames before
    #[arg(long, default_value_t = 0)]
    warm_up: u32,
    /// A shares.json of an earlier run, of the same scene, size and seeds: which pass owes what has changed since
    #[arg(long, value_name = "FILE")]
    against: Option<PathBuf>,
    #[command(flatten)]
    values: Values,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    context.expect(Sort::Pipeline, &args.pipeline)?;
    context.expect(Sort::Scene, &args.scene)?;
    let scene = renderer::load_scene(&context.catalog, &args.scene)?;
    let link = LinkContext { frame: args.size, traits: scene.traits() };
    let before = args.against.as_deref().map(|file| earlier(file, args)).transpose()?;
    let experiment = Experiment::new(context, args, &link)?;
    let gpu = Gpu::open()?;
    let adapter = gpu.describe();
    let scene = SharedScene::new(&gpu, scene)?;
    let bar = progress(experiment.steps(args), "blame");
    let references = experiment.render_references(context, args, &scene, &bar)?;
    let pictures = experiment.render(context, args, &scene, &bar)?;
    bar.finish_and_clear();
    let found = Found::new(&experiment, &args.output, &pictures, &references)?;

    std::fs::create_dir_all(&args.out)
        .with_context(|| format!("the folder {} cannot be made", args.out.display()))?;
    let page = args.out.join("report.html");
    let set = args.values.overrides().0.iter().map(set_text).collect::<Vec<_>>().join(", ");
    let facts = [
        ("Output", args.output.clone()),
        ("Values", if set.is_empty() { "defaults".to_owned() } else { set }),
        ("Size", format!("{}×{} px", args.size.0, args.size.1)),
        ("Seeds", args.seeds.to_string()),
        ("Reference", format!("{} samples per pixel", 2 * args.samples)),
        ("Adapter", adapter.clone()),
        ("Version", env!("CARGO_PKG_VERSION").to_owned()),
    ];
    let title = format!("{} in {}", args.pipeline, args.scene);
    let shown = [
        ("The picture", &found.picture),
        ("All approximations exact", &found.exact),
        ("The reference", &found.reference),
    ];
    let heading = Heading { title: &title, facts: &facts };
    write(&page, &blame::page(heading, &found.shares, &experiment.players, &found.map, &shown))?;
    let changes = before.map(|before| found.shares.changes(&before));
    let mut record = described(args);
    record["adapter"] = json!(adapter);
    record["shares"] = json!(found.shares);
    write(&args.out.join("shares.json"), &format!("{record:#}\n"))?;
    if context.json {
        output::json(
            &json!({ "report": page, "blame": record, "changes": changes, "blamed": changes.as_deref().map(blame::blamed) }),
        );
    } else {
        stdout!("{}", blame::rows(&found.shares, false).text());
        if let (Some(changes), Some(file)) = (&changes, &args.against) {
            stdout!("{}", in_words(changes, file));
        }
        stdout!("{}", page.display());
    }
    Ok(())
}

/// What two runs must have in common for their shares to be compared.
fn described(args: &Args) -> Value {
    json!({
        "scene": args.scene, "output": args.output, "size": [args.size.0, args.size.1], "frame": args.frame,
        "seeds": args.seeds, "samples": 2 * args.samples,
    })
}

/// Reads the shares of an earlier run.
fn earlier(file: &Path, args: &Args) -> Result<Shares> {
    let shown = file.display();
    let text = std::fs::read_to_string(file).with_context(|| format!("{shown} cannot be read"))?;
    let record: Value = serde_json::from_str(&text).with_context(|| format!("{shown} is no shares.json"))?;
    for (name, now) in described(args).as_object().into_iter().flatten() {
        if record[name] != *now {
            bail!("{shown} is of another run: its {name} is {}, and that of this run {now}", record[name]);
        }
    }
    let shares = Shares::deserialize(&record["shares"]);
    shares.with_context(|| format!("{shown} is not a record of this version of `lightloom blame`"))
}

fn in_words(changes: &[Change], file: &Path) -> String {
    let since = file.display();
    let blamed = blame::blamed(changes);
    let Some(most) = blamed.first() else { return format!("nothing has changed since {since}") };
    let rows = blamed.iter().map(|change| format!("`{}` ({})", change.name, change.passes.join(", ")));
    let (error, energy) = (most.error.mean, 100.0 * most.energy.mean);
    let rows = rows.collect::<Vec<_>>().join(" and ");
    format!(
        "since {since}, {rows} owes most of the change: of the error {error:+.3e}, of energy {energy:+.2} %"
    )
}

/// What was measured.
struct Found {
    shares: Shares,
    map: Map,
    picture: Image,
    exact: Image,
    reference: Image,
}

impl Found {
    fn new(
        experiment: &Experiment,
        output: &str,
        pictures: &BTreeMap<String, Vec<Pictures>>,
        halves: &[Halves],
    ) -> Result<Found> {
        let weights = |output: &str| -> Result<Weights> {
            Ok(Weights::relative_to(&metrics::seeds::mean_image(&halves[0][output])?))
        };
        let of_output = weights(output)?;
        let references: Vec<References> = halves
            .iter()
            .map(|halves| References::new(halves[output].clone(), &of_output))
            .collect::<Result<_, _>>()?;
        let (count, players) = (references.len(), &experiment.players);
        let cells: Vec<(&Pictures, &References)> = pictures[output]
            .iter()
            .flat_map(|pictures| references.iter().map(move |references| (pictures, references)))
            .collect();
        let place = |subset: Subset| experiment.variant(subset) * count + experiment.reference_of(subset);
        let measured: Vec<Cell> = cells
            .iter()
            .map(|(pictures, references)| pictures.cell(references, &of_output))
            .collect::<Result<_, _>>()?;
        let all = experiment.all();
        let mut stages = Vec::new();
        if let Some(pictures) = pictures.get(IRRADIANCE).filter(|_| experiment.outputs.len() > 1) {
            let weights = weights(IRRADIANCE)?;
            let reference = &halves[experiment.reference_of(all)][IRRADIANCE];
            let reference = References::new(reference.clone(), &weights)?;
            let left: Vec<Cell> = pictures
                .iter()
                .map(|pictures| pictures.cell(&reference, &weights))
                .collect::<Result<_, _>>()?;
            stages.push(Stage {
                name: "reflectance".to_owned(),
                doc: "Irradiance, which surfaces have not reflected yet.".to_owned(),
                passes: experiment.reflectance.clone(),
                cells: [measured[place(all)].clone(), left[0].clone()],
            });
            let owing = experiment.stages.iter().zip(&experiment.owing_stages);
            stages.extend(owing.zip(left.windows(2)).map(|((stage, passes), cells)| Stage {
                name: stage.name.clone(),
                doc: stage.doc.clone(),
                passes: passes.clone(),
                cells: [cells[0].clone(), cells[1].clone()],
            }));
        }
        let cell = |subset: Subset| measured[place(subset)].clone();
        let shares = blame::table(&experiment.game, players, &experiment.owing, &stages, &cell);
        let first = &pictures[output][0].images[0];
        let size = (first.width(), first.height());
        let map = Map::new(&experiment.game, players, size, &cells, &of_output, &place);
        Ok(Found {
            shares,
            map,
            picture: first.clone(),
            exact: metrics::seeds::mean_image(&pictures[output][experiment.variant(all)].images)?,
            reference: references[0].mean().clone(),
        })
    }
}
