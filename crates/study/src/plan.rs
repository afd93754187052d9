//! Derives the cells of a study: every name is looked up and every value checked before anything runs.

mod check;
mod external;
mod names;

use crate::description::{
    At, Budget, Group, Phase, Reference, SEED, SIZE, Study, StudyFigure, Vary, size_of,
};
use crate::external::External;
use crate::laboratory::{PipelineFacts, Registry, RunRequest, SceneFacts, Values};
use crate::measure::Measure;
use crate::record::{Axis, AxisValue, Difference, MeasureInfo, PipelineRecord};
use check::Checker;
use frame_graph::{Diagnostics, Setting};
use names::located;
use std::collections::{BTreeMap, HashSet};

/// A study with all names resolved.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The study, as described.
    pub study: Study,
    /// The scenes, in order.
    pub scenes: Vec<SceneFacts>,
    /// The pipelines, in order.
    pub pipelines: Vec<PipelineRecord>,
    /// The axes, in order.
    pub axes: Vec<Axis>,
    /// The measures, in order.
    pub measures: Vec<Measure>,
    /// The differences of each pipeline from the first.
    pub differences: Vec<Difference>,
    /// Names that mean a file beside the study, and could mean one of the roots.
    pub notes: Diagnostics,
    /// The cells, ordered by scene, pipeline, axes, seed.
    pub cells: Vec<PlannedCell>,
    pub(crate) references: Vec<PlannedReference>,
    /// The files that names of scenes, of the reference's pipeline and of its pictures mean, where they are others.
    meant: BTreeMap<String, String>,
}

/// A run of a plan that its study does not list.
#[derive(Clone, Debug)]
pub struct Run {
    /// Index of its scene.
    pub scene: usize,
    /// Index of its pipeline.
    pub pipeline: usize,
    /// The request.
    pub request: RunRequest,
    /// A description of its reference, and the request.
    pub reference: Option<(String, RunRequest)>,
}

/// A cell before it runs.
#[derive(Clone, Debug)]
pub struct PlannedCell {
    /// Index into [`Plan::scenes`].
    pub scene: usize,
    /// Index into [`Plan::pipelines`].
    pub pipeline: usize,
    /// Value of each axis that the pipeline has.
    pub axes: BTreeMap<String, AxisValue>,
    /// The request that is run.
    pub request: RunRequest,
    pub(crate) search: Option<Search>,
    /// Index into [`Plan::references`].
    pub(crate) reference: Option<usize>,
}

/// The setting whose value a budget of time determines.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Search {
    pub(crate) setting: Setting,
    pub(crate) path: String,
    /// Time per frame \[ms\].
    pub(crate) ms: f64,
}

/// A reference before it is rendered.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlannedReference {
    /// Index into [`Plan::scenes`].
    pub(crate) scene: usize,
    pub(crate) size: (u32, u32),
    /// A description of its source.
    pub(crate) from: String,
    pub(crate) origin: Origin,
}

/// The source of a reference.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Origin {
    /// Reads this file.
    Picture(String),
    /// Runs requests: one for all frames, or one per frame.
    Run(Vec<RunRequest>),
}

impl Origin {
    /// Returns the pixels × frames × samples of its runs.
    pub(crate) fn work(&self) -> f64 {
        match self {
            Origin::Picture(_) => 0.0,
            Origin::Run(requests) => requests.iter().map(RunRequest::work).sum(),
        }
    }
}

/// The greatest number of cells of a study.
const MOST_CELLS: usize = 100_000;

impl Plan {
    /// Returns the runs of cells and of references that differ in more than their frames and seeds: in pipeline, values,
    /// scene or size. Whatever compiles for these compiles for all. External programs are not among them.
    pub fn distinct_runs(&self) -> Vec<&RunRequest> {
        let references = self.references.iter().flat_map(|reference| match &reference.origin {
            Origin::Run(requests) => &requests[..],
            Origin::Picture(_) => &[],
        });
        let mut seen = HashSet::new();
        let all = self.cells.iter().map(|cell| &cell.request).chain(references);
        all.filter(|run| run.external.is_none() && seen.insert(compiled(run))).collect()
    }

    /// Returns the external programs that the cells run, each once.
    pub fn externals(&self) -> Vec<&External> {
        let mut all: Vec<&External> = Vec::new();
        for external in self.cells.iter().filter_map(|cell| cell.request.external.as_ref()) {
            if !all.contains(&external) {
                all.push(external);
            }
        }
        all
    }

    /// Resolves the names of a study, and derives its cells.
    ///
    /// # Errors
    /// All errors of its names and values, each with its place in the file.
    pub fn new(study: Study, registry: &dyn Registry) -> Result<Plan, Diagnostics> {
        let mut checker = Checker::new(&study, registry);
        let scenes = checker.scenes();
        let pipelines = checker.pipelines();
        let axes = checker.axes(&pipelines);
        checker.sets(&pipelines);
        let reference = checker.reference(&scenes);
        checker.budget(&scenes, &pipelines);
        checker.phases_and_figures(&pipelines);
        checker.claims(&pipelines);
        let combinations =
            checker.combinations(MOST_CELLS, scenes.len() * pipelines.len() * study.seeds.len());
        let notes = checker.finish()?;
        let measures = study.measures.iter().map(|at| at.value).collect();
        let records: Vec<PipelineRecord> = pipelines.iter().map(|pipeline| pipeline.record.clone()).collect();
        let differences = differences(registry, &pipelines);
        let scenes = scenes.into_iter().map(|(_, facts)| facts).collect();
        let meant = meant(&study, registry);
        let mut plan = Plan {
            study,
            scenes,
            pipelines: records,
            axes,
            measures,
            differences,
            notes,
            cells: Vec::new(),
            references: Vec::new(),
            meant,
        };
        for scene in 0..plan.scenes.len() {
            for (index, pipeline) in pipelines.iter().enumerate() {
                plan.add_cells((scene, index), pipeline, reference.as_ref(), &combinations);
            }
        }
        Ok(plan)
    }

    /// Makes the plan of runs that a study does not list: of it, this takes the measures.
    pub fn of_runs(
        study: Study,
        scenes: Vec<SceneFacts>,
        pipelines: Vec<PipelineRecord>,
        runs: Vec<Run>,
    ) -> Plan {
        let mut plan = Plan {
            measures: study.measures.iter().map(|at| at.value).collect(),
            scenes,
            pipelines,
            axes: Vec::new(),
            differences: Vec::new(),
            notes: Diagnostics::default(),
            cells: Vec::new(),
            references: Vec::new(),
            meant: BTreeMap::new(),
            study,
        };
        let study = &mut plan.study;
        study.scenes = plan.scenes.iter().map(|scene| scene.record.name.clone().into()).collect();
        study.seeds = runs.iter().map(|run| run.request.seed).collect();
        study.seeds.sort_unstable();
        study.seeds.dedup();
        for Run { scene, pipeline, request, reference } in runs {
            let reference = reference.map(|(from, request)| {
                let size = request.size;
                plan.planned(PlannedReference { scene, size, from, origin: Origin::Run(vec![request]) })
            });
            let axes = BTreeMap::new();
            plan.cells.push(PlannedCell { scene, pipeline, axes, request, search: None, reference });
        }
        plan
    }

    /// The file that a name means.
    fn meant(&self, name: &At<String>) -> String {
        self.meant.get(&name.value).unwrap_or(&name.value).clone()
    }

    /// Returns all measures, with phases and figures last, as tables show them.
    pub(crate) fn infos(&self) -> impl Iterator<Item = MeasureInfo> {
        let measures = self.measures.iter().map(|measure| measure.info());
        let phases = self.study.phases.iter().map(Phase::info);
        measures.chain(phases).chain(self.study.figures.iter().map(StudyFigure::info))
    }

    fn add_cells(
        &mut self,
        (scene, index): (usize, usize),
        pipeline: &Resolved,
        reference: Option<&PipelineFacts>,
        combinations: &[Values],
    ) {
        let mut seen: Vec<BTreeMap<String, AxisValue>> = Vec::new();
        for combination in combinations {
            let has = |path: &str| path == SIZE || pipeline.has(path);
            let axes: BTreeMap<String, AxisValue> =
                combination.iter().filter(|(path, _)| has(path)).cloned().collect();
            // Skips combinations that differ only in axes that this pipeline does not have.
            if seen.contains(&axes) {
                continue;
            }
            seen.push(axes.clone());
            for seed in self.study.seeds.clone() {
                let (request, search) = self.request((scene, pipeline), &axes, combination, seed);
                let reference = self.reference_of(scene, &request, combination, reference);
                self.cells.push(PlannedCell {
                    scene,
                    pipeline: index,
                    axes: axes.clone(),
                    request,
                    search,
                    reference,
                });
            }
        }
    }

    fn request(
        &self,
        (scene, pipeline): (usize, &Resolved),
        axes: &BTreeMap<String, AxisValue>,
        combination: &[(String, AxisValue)],
        seed: u32,
    ) -> (RunRequest, Option<Search>) {
        let study = &self.study;
        let mut set = pipeline.set.clone();
        set.extend(
            axes.iter().filter(|(path, _)| *path != SIZE).map(|(path, value)| (path.clone(), value.clone())),
        );
        let mut search = None;
        match &study.budget {
            Budget::Frames(_) | Budget::Time { by: None, .. } => {}
            Budget::Lights { count, by, .. } => {
                set.push((by.value.clone(), AxisValue::Number(f64::from(count.value))));
            }
            Budget::Time { ms, by: Some(by), .. } => {
                search = pipeline.setting(&by.value).map(|setting| Search {
                    setting: setting.clone(),
                    path: by.value.clone(),
                    ms: *ms,
                });
            }
        }
        let needs = |what: fn(&crate::measure::Needs) -> bool| {
            self.measures.iter().any(|measure| what(&measure.needs()))
        };
        let stop_after_ms = match &study.budget {
            Budget::Time { ms, by: None, .. } => Some(*ms),
            Budget::Time { ms, .. } if pipeline.external.is_some() => Some(*ms),
            _ => None,
        };
        // A program is given the time that frames take to accumulate, and makes one of them; and all frames of a scene that
        // stands still would be the same to a program that makes one at a time.
        let one_frame = pipeline.external.as_ref().is_some_and(|external| {
            let accumulates = matches!(study.budget, Budget::Time { by: None, .. });
            accumulates || !(self.scenes[scene].moves || external.takes("frames"))
        });
        let request = RunRequest {
            scene: self.meant(&study.scenes[scene]),
            pipeline: pipeline.record.pipeline.clone(),
            set,
            output: study.output.value.clone(),
            size: size_in(combination).unwrap_or(study.size),
            seed,
            first_frame: study.first_frame,
            warm_up: study.warm_up,
            frames: if one_frame { 1 } else { study.budget.frames() },
            timed: needs(|needs| needs.timed)
                || !study.phases.is_empty()
                || matches!(study.budget, Budget::Time { .. }),
            views: needs(|needs| needs.views),
            lights: needs(|needs| needs.lights),
            figures: study.figures.iter().map(|figure| figure.of.value.clone()).collect(),
            stop_after_ms,
            until_done: false,
            external: pipeline.external.clone(),
        };
        (request, search)
    }

    /// Returns the index of the reference for a request, and adds it if it is new.
    fn reference_of(
        &mut self,
        scene: usize,
        request: &RunRequest,
        combination: &[(String, AxisValue)],
        facts: Option<&PipelineFacts>,
    ) -> Option<usize> {
        if !self.measures.iter().any(|measure| measure.needs().reference) {
            return None;
        }
        let reference = match &self.study.reference {
            Reference::None => return None,
            Reference::Pictures(files) => {
                let name = &self.study.scenes[scene].value;
                let of = |at: &Option<At<String>>| at.as_ref().is_none_or(|scene| scene.value == *name);
                let (_, file) = files.iter().find(|(scene, _)| of(scene))?;
                PlannedReference {
                    scene,
                    size: request.size,
                    from: file.value.clone(),
                    origin: Origin::Picture(self.meant(file)),
                }
            }
            Reference::Pipeline { pipeline, set, follow, frames, .. } => {
                let mut values: Values =
                    set.iter().map(|set| (set.path.value.clone(), set.value.value.clone())).collect();
                let followed = |name: &str| follow.iter().any(|at| at.value == name);
                let axes = combination.iter().filter(|(path, _)| *path != SIZE);
                values.extend(axes.filter(|(path, _)| followed(path)).cloned());
                let accumulates =
                    facts.is_some_and(|facts| facts.outputs.iter().any(|name| name == "progress"));
                let moves = self.scenes[scene].moves;
                let first = request.first_frame + request.warm_up;
                let base = RunRequest {
                    pipeline: self.meant(pipeline),
                    set: values.clone(),
                    seed: if followed(SEED) { request.seed } else { 0 },
                    timed: false,
                    views: false,
                    lights: false,
                    figures: Vec::new(),
                    stop_after_ms: None,
                    until_done: accumulates,
                    external: None,
                    frames: if moves { request.frames } else { 1 },
                    ..request.clone()
                };
                let at = |frame: u32| RunRequest {
                    first_frame: frame,
                    warm_up: 0,
                    frames: *frames,
                    ..base.clone()
                };
                let requests = match (accumulates, moves) {
                    (false, _) => vec![base],
                    (true, false) => vec![at(first)],
                    (true, true) => (first..first + request.frames).map(at).collect(),
                };
                let mut values: Vec<String> =
                    values.iter().map(|(path, value)| format!("{path} = {value}")).collect();
                values.extend(followed(SEED).then(|| format!("seed = {}", request.seed)));
                let (width, height) = request.size;
                values.extend(size_in(combination).map(|_| format!("{width}x{height}")));
                PlannedReference {
                    scene,
                    size: request.size,
                    from: [vec![format!("pipeline {}", pipeline.value)], values].concat().join(", "),
                    origin: Origin::Run(requests),
                }
            }
        };
        Some(self.planned(reference))
    }

    /// Returns the index of a reference, and adds it if it is new.
    fn planned(&mut self, reference: PlannedReference) -> usize {
        let known = self.references.iter().position(|other| *other == reference);
        known.unwrap_or_else(|| {
            self.references.push(reference);
            self.references.len() - 1
        })
    }
}

/// Returns a text of what a request compiles: its pipeline with its values, for its scene and size.
pub(crate) fn compiled(run: &RunRequest) -> String {
    format!("{} {} {:?} {:?}", run.pipeline, run.scene, run.size, run.set)
}

/// A pipeline of the study with its properties.
struct Resolved {
    record: PipelineRecord,
    facts: PipelineFacts,
    set: Values,
    external: Option<External>,
}

impl Resolved {
    fn setting(&self, path: &str) -> Option<&Setting> {
        self.facts.settings.iter().find(|settable| settable.path == path).map(|settable| &settable.setting)
    }

    fn has(&self, path: &str) -> bool {
        self.setting(path).is_some()
    }
}

/// The files that names mean, where those are others than the names.
fn meant(study: &Study, registry: &dyn Registry) -> BTreeMap<String, String> {
    let of_reference: Vec<&At<String>> = match &study.reference {
        Reference::None => Vec::new(),
        Reference::Pictures(files) => files.iter().map(|(_, file)| file).collect(),
        Reference::Pipeline { pipeline, .. } => vec![pipeline],
    };
    let names = study.scenes.iter().chain(of_reference);
    let all = names.map(|name| (name.value.clone(), located(registry, name)));
    all.filter(|(name, path)| name != path).collect()
}

fn differences(registry: &dyn Registry, pipelines: &[Resolved]) -> Vec<Difference> {
    let mut own = pipelines.iter().filter(|pipeline| pipeline.external.is_none());
    let Some(first) = own.next() else { return Vec::new() };
    let of = |pipeline: &Resolved| (pipeline.record.pipeline.clone(), pipeline.set.clone());
    let (name, set) = of(first);
    own.map(|other| {
        let (other_name, other_set) = of(other);
        Difference {
            from: first.record.name.clone(),
            to: other.record.name.clone(),
            lines: registry.differences((&name, &set), (&other_name, &other_set)),
        }
    })
    .collect()
}

/// Returns the size of frames in a combination, if it varies.
fn size_in(combination: &[(String, AxisValue)]) -> Option<(u32, u32)> {
    let (_, value) = combination.iter().find(|(path, _)| *path == SIZE)?;
    size_of(value)
}

/// Returns every combination of the values of a group: the first axis varies slowest.
fn combinations_of(group: &Group) -> Vec<Values> {
    let pair = |axis: &Vary, row: usize| (axis.path.value.clone(), axis.values[row].value.clone());
    match group {
        Group::Paired(axes) => {
            let rows = axes.iter().map(|axis| axis.values.len()).min().unwrap_or(0);
            (0..rows).map(|row| axes.iter().map(|axis| pair(axis, row)).collect()).collect()
        }
        Group::Grid(axes) => axes.iter().fold(vec![Vec::new()], |rows, axis| {
            product(&rows, &(0..axis.values.len()).map(|row| vec![pair(axis, row)]).collect::<Vec<_>>())
        }),
    }
}

/// Returns every row of `slow` followed by every row of `fast`.
fn product(slow: &[Values], fast: &[Values]) -> Vec<Values> {
    slow.iter().flat_map(|row| fast.iter().map(move |tail| [&row[..], tail].concat())).collect()
}
