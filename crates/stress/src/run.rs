//! Runs cases by pipelines, as cells of a study.

use crate::case::{Case, Expect};
use crate::cell::{ALIKE, Cell, Verdict, evaluate};
use crate::child::Program;
use crate::isolated::{Isolated, arguments};
use crate::seeds;
use frame_graph::Source;
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::time::Duration;
use study::{
    AxisValue, Event, Interval, Laboratory, PipelineRecord, Plan, Results, Run, RunOptions, RunRequest,
    SceneFacts, SceneRecord, StudyError,
};

/// A pipeline with its properties.
#[derive(Clone, Debug)]
pub struct Subject {
    /// Its name or path.
    pub name: String,
    /// The paths of all parameters and settings.
    pub settable: Vec<String>,
    /// Bounces of indirect light; the path tracer has as many.
    pub bounces: u32,
    /// Whether each frame is a new sample, spread over the area of pixels.
    pub sampled: bool,
    /// Cases of its own, in addition to those of the table.
    pub cases: Vec<Case>,
}

/// Options of a run.
#[derive(Clone, Debug)]
pub struct Options {
    /// The folder for scenes, cells and pictures.
    pub folder: PathBuf,
    /// The size of frames in pixels for cases without a size.
    pub size: (u32, u32),
    /// Values for all pipelines that have the parameter or setting; those of a case have precedence.
    pub set: Vec<(String, String)>,
    /// Samples per pixel of the path tracer in frames of the run's size. Smaller frames have the same total, so that their
    /// energy is known as well.
    pub samples: u32,
    /// Other values for the path tracer.
    pub set_reference: Vec<(String, String)>,
    /// Time limit of one picture, and of each 200 frames of a long run.
    pub limit: Duration,
    /// Options of the study.
    pub study: RunOptions,
}

/// The study of all runs, but for what the cases say.
const STUDY: &str = "Study(
    title: \"Extremes\", scenes: [\"plain\"], pipelines: All, size: (64, 64), budget: Frames(1), warm_up: 0,
    measures: [\"mean\", \"energy\", \"rel-mse\"], reference: Pipeline(pipeline: \"reference\"),
)";

/// The pipeline with which others are compared.
pub const REFERENCE: &str = "reference";

/// The most samples per pixel that a frame of few pixels takes: one pixel of the room is then known to 1 %.
const MOST_SAMPLES: u32 = 1 << 17;

/// Samples per pixel and frame of the path tracer: more are no slower in frames of few pixels.
const SAMPLES_PER_FRAME: u32 = 32;

/// Time limit of the seeds of a cell, in limits of one picture.
const LIMITS_OF_SEEDS: f64 = 5.0;

/// Runs each case by each pipeline, and the cases of single pipelines. What is finished does not run again. `known` states
/// what pipelines and scenes depend on. Calls `report` with the progress.
///
/// # Errors
/// Fails if a file cannot be written. A failed case is no error.
pub fn run(
    (program, known): (&dyn Program, &mut dyn Laboratory),
    subjects: &[Subject],
    cases: &[Case],
    options: &Options,
    report: &mut dyn FnMut(Event<'_>),
) -> Result<(Results, Vec<Cell>), StudyError> {
    let plain = crate::table::plain();
    let mut all = vec![&plain];
    for case in cases.iter().chain(subjects.iter().flat_map(|subject| &subject.cases)) {
        if all.iter().all(|other| other.name != case.name) {
            all.push(case);
        }
    }
    let mut long = HashMap::new();
    for case in &all {
        let scene = options.write(case)?;
        if let Expect::Steady(steady) = case.expect {
            long.insert(scene, steady);
        }
    }
    let (folder, limit, identities) = (&*options.folder, options.limit, HashMap::new());
    let mut lab = Isolated { program, known, folder, limit, long, identities };
    let mut cells = Cells { subjects, all, options, seeds: BTreeMap::new() };
    loop {
        let results = study::run(&cells.plan(), &mut lab, &options.folder, &options.study, report)?.results;
        let found = cells.evaluate(&results, cases);
        // A part does not know what all seeds give.
        if options.study.shard.is_some() || !cells.add_seeds(&found) {
            return Ok((results, found.into_iter().map(|(cell, _)| cell).collect()));
        }
    }
}

/// The cells of a run.
struct Cells<'a> {
    subjects: &'a [Subject],
    /// All cases; the first is the plain scene.
    all: Vec<&'a Case>,
    options: &'a Options,
    /// The number of further seeds, by pipeline and case.
    seeds: BTreeMap<(String, String), u32>,
}

impl Cells<'_> {
    fn plan(&self) -> Plan {
        let scenes = self.all.iter().map(|case| SceneFacts {
            record: SceneRecord::case(&case.name, case.about.clone()),
            moves: false,
            seconds_per_frame: 0.0,
            small_length: 0.0,
        });
        let pipelines = self.subjects.iter().map(|subject| PipelineRecord::subject(&subject.name, ""));
        let mut runs = Vec::new();
        for (pipeline, subject) in self.subjects.iter().enumerate() {
            for (scene, case) in self.all.iter().enumerate().filter(|(_, case)| self.has(subject, case)) {
                let id = (subject.name.clone(), case.name.clone());
                for seed in 0..=self.seeds.get(&id).copied().unwrap_or(0) {
                    let request = RunRequest { seed, ..self.options.request(subject, case) };
                    let reference = match case.expect {
                        Expect::Truth => {
                            let request = self.options.reference(subject, case);
                            Some((format!("pipeline {}", request.pipeline), request))
                        }
                        _ => None,
                    };
                    runs.push(Run { scene, pipeline, request, reference });
                }
            }
        }
        let study = study::parse(Source::new("extremes.ron", STUDY)).expect("it is a study");
        Plan::of_runs(study, scenes.collect(), pipelines.collect(), runs)
    }

    /// Returns whether a pipeline runs a case: those of settings are each of some pipelines.
    fn has(&self, subject: &Subject, case: &Case) -> bool {
        let is_own = |subject: &Subject| subject.cases.iter().any(|own| own.name == case.name);
        is_own(subject) || !self.subjects.iter().any(is_own)
    }

    /// Evaluates what is there of the cases that are asked for, each with its pictures' seconds.
    fn evaluate(&self, results: &Results, cases: &[Case]) -> Vec<(Cell, f64)> {
        let of = |subject: &Subject, case: &Case| -> Vec<&study::Cell> {
            let is = |cell: &&study::Cell| cell.pipeline == subject.name && cell.scene == case.name;
            results.cells.iter().filter(is).collect()
        };
        let mut found = Vec::new();
        for subject in self.subjects {
            let plain = of(subject, self.all[0]).first().copied();
            for case in cases.iter().chain(&subject.cases) {
                let cells = of(subject, case);
                let Some((first, seeds)) = cells.split_first() else { continue };
                let command = |seed| {
                    let request = RunRequest { seed, ..self.options.request(subject, case) };
                    format!(
                        "lightloom {}",
                        arguments(&self.options.folder, &request, "picture.exr").join(" ")
                    )
                };
                let one =
                    |cell: &study::Cell| evaluate((&case.name, case.expect), cell, plain, command(cell.seed));
                let mut cell = one(first);
                let again: Vec<Cell> = seeds.iter().map(|cell| one(cell)).collect();
                let is_defect = |cell: &Cell| cell.is_defect() && cell.verdict != Verdict::Off;
                if let Some(worse) = again.iter().find(|cell| is_defect(cell)) {
                    cell = worse.clone();
                } else {
                    cell.seconds += again.iter().map(|cell| cell.seconds).sum::<f64>();
                    let energies: Vec<f64> = again.iter().filter_map(|cell| cell.energy).collect();
                    if let Some(mean) = Interval::of(&energies) {
                        let is_alike = ALIKE.contains(&mean.mean);
                        cell.verdict = if is_alike { Verdict::Held } else { Verdict::Off };
                        cell.first = cell.energy.replace(mean.mean);
                        cell.by_seed = again.iter().flat_map(|cell| cell.by_seed.iter().copied()).collect();
                        cell.seeds = Some(mean);
                    }
                }
                found.push((cell, first.seconds));
            }
        }
        found
    }

    /// Adds seeds to the cells whose energy is off, until their mean decides. Returns whether there are new ones.
    fn add_seeds(&mut self, found: &[(Cell, f64)]) -> bool {
        let mut more = false;
        for (cell, seconds) in
            found.iter().filter(|(cell, _)| cell.verdict == Verdict::Off || cell.seeds.is_some())
        {
            let case = self.all.iter().find(|case| case.name == cell.case);
            let count = self.seeds.entry((cell.pipeline.clone(), cell.case.clone())).or_default();
            let is_decided = cell.seeds.is_some_and(|mean| seeds::is_decided(&mean, &ALIKE));
            let most = LIMITS_OF_SEEDS * self.options.limit.as_secs_f64() / seconds.max(1e-3);
            let most = seeds::MOST.min(most as u32);
            if case.is_some_and(|case| case.expect == Expect::Truth) && !is_decided && *count < most {
                *count = most.min(*count + seeds::FEWEST);
                more = true;
            }
        }
        more
    }
}

impl Options {
    /// Writes the scene of a case, and returns its path in the folder.
    fn write(&self, case: &Case) -> Result<String, StudyError> {
        let folder = &self.folder.join("scenes");
        let scene = scene_of(case);
        let failed = |path: &Path| {
            let path = path.to_owned();
            move |source| StudyError::Io { path, action: "cannot write", source }
        };
        std::fs::create_dir_all(folder).map_err(failed(folder))?;
        let beside = case.files.iter().map(|(name, text)| (folder.join(name), text));
        for (path, text) in beside.chain([(self.folder.join(&scene), &case.scene)]) {
            whole_file::write(&path, text).map_err(failed(&path))?;
        }
        Ok(scene)
    }

    /// Returns the request of a case: the last of its frames is measured.
    fn request(&self, subject: &Subject, case: &Case) -> RunRequest {
        let is_set = |path: &str| case.set.iter().any(|(known, _)| known == path);
        let given = case.set.iter().chain(self.set.iter().filter(|(path, _)| !is_set(path)));
        let known = given.filter(|(path, _)| subject.settable.iter().any(|known| known == path));
        RunRequest {
            scene: scene_of(case),
            pipeline: subject.name.clone(),
            set: known.map(|(path, text)| (path.clone(), value(text))).collect(),
            output: "indirect".to_owned(),
            size: case.size.unwrap_or(self.size),
            warm_up: case.frames.saturating_sub(1),
            frames: 1,
            ..RunRequest::default()
        }
    }

    /// Returns the request of the path tracer's picture of a case.
    fn reference(&self, subject: &Subject, case: &Case) -> RunRequest {
        let own = self.request(subject, case);
        let pixels = |(width, height): (u32, u32)| width.saturating_mul(height).max(1);
        let times = pixels(self.size).div_ceil(pixels(own.size));
        let samples = self.samples.saturating_mul(times).min(MOST_SAMPLES.max(self.samples));
        let set =
            [("bounces", subject.bounces), ("samples", samples), ("samples_per_frame", SAMPLES_PER_FRAME)]
                .map(|(path, number)| (path.to_owned(), AxisValue::Number(f64::from(number))));
        // A pipeline that averages over pixels is compared with a reference that does.
        let given = self.set_reference.iter().filter(|(path, _)| !(subject.sampled && path == "filter"));
        let given = given.map(|(path, text)| (path.clone(), value(text)));
        let (pipeline, set) = (REFERENCE.to_owned(), set.into_iter().chain(given).collect());
        RunRequest { pipeline, set, warm_up: 0, ..own }
    }
}

/// Returns the path of a case's scene in the folder of a run. Cases of settings are all of the plain scene.
fn scene_of(case: &Case) -> String {
    format!("scenes/{}.ron", if case.name.contains('=') { "plain" } else { &case.name })
}

/// Reads a value as `--set` takes it.
fn value(text: &str) -> AxisValue {
    match (text.parse(), text.parse()) {
        (Ok(truth), _) => AxisValue::Bool(truth),
        (_, Ok(number)) => AxisValue::Number(number),
        _ => AxisValue::Text(text.to_owned()),
    }
}
