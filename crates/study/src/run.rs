//! Runs the cells of a study that are not finished.

use crate::budget::{Domain, search};
use crate::cost::Costs;
use crate::description::Budget;
use crate::error::{Failure, StudyError};
use crate::evaluator::{Evaluator, Measurements};
use crate::folder::{Folder, Index, Sharing, images, now, read_study};
use crate::key::{self, Taken, VERSION};
use crate::laboratory::{CellRun, Laboratory, Observed, RunRequest, Step};
use crate::plan::{Plan, PlannedCell, Search};
use crate::record::{AxisValue, Cell, Node, Outcome, Results, StudyRecord, Words};
use crate::reference::{Part, References, Truth};
use crate::shard::{Shard, Work};
use metrics::statistics::median;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Options of a run.
#[derive(Clone, Debug, Default)]
pub struct RunOptions {
    /// The shard of the study to run, if not all of it.
    pub shard: Option<Shard>,
    /// The expected costs of cells, by which a shard is cut.
    pub costs: Costs,
    /// A folder in which references of other studies are looked up and stored.
    pub references: Option<PathBuf>,
    /// The command that started the run, for the record.
    pub command: String,
}

/// Progress of a running study.
#[derive(Debug)]
pub enum Event<'a> {
    /// Before the first cell.
    Begin {
        /// Number of cells of this shard.
        cells: usize,
        /// Number of cells that are finished already.
        finished: usize,
        /// Records in the folder that do not belong to the current version of the study.
        stale: usize,
    },
    /// A reference is being rendered.
    Reference {
        /// A description of the reference.
        name: String,
    },
    /// A frame of the reference that is being rendered has come further.
    Step {
        /// A description of the reference.
        name: &'a str,
        /// The frame, from 1, of `frames`; a scene that stands still has one for all.
        frame: usize,
        /// Number of frames that have a reference of their own.
        frames: usize,
        /// The progress of the frame.
        step: Step,
    },
    /// A cell is being rendered.
    Cell {
        /// A description of the cell.
        name: String,
    },
    /// A cell has ended.
    Ended {
        /// Its record.
        cell: &'a Cell,
        /// Number of cells of this shard that are finished or failed.
        ended: usize,
        /// Estimate of the remaining time.
        left: Duration,
    },
    /// A message that is reported once.
    Note(String),
}

/// The result of a run.
#[derive(Debug)]
pub struct Ran {
    /// The current content of the study's folder; for a shard, its own cells, and nothing that follows from those of others.
    pub results: Results,
    /// Number of cells that ran now.
    pub run: usize,
    /// Number of cells of this shard that failed.
    pub failed: usize,
}

/// Runs the unfinished cells of a study, and stores the results in a folder.
///
/// # Errors
/// Fails if a file cannot be written: what is finished is kept, and the same call continues from there. A
/// cell or reference that fails is no error: it is reported in its record.
pub fn run(
    plan: &Plan,
    lab: &mut dyn Laboratory,
    folder: &Path,
    options: &RunOptions,
    report: &mut dyn FnMut(Event<'_>),
) -> Result<Ran, StudyError> {
    let work = match &options.shard {
        Some(shard) => shard.work(plan, &options.costs)?,
        None => Work { cells: 0..plan.cells.len(), references: 0..0 },
    };
    // A job that its batch system has given up may still run beside the one that takes its place.
    let sharing = if options.shard.is_some() { Sharing::Shared } else { Sharing::Alone };
    let folder = Folder::open(folder, sharing)?;
    let scenes = plan.scenes.iter().map(|scene| scene.record.name.clone()).collect();
    let references = References::new(&plan.references, scenes, lab, options.references.clone());
    let mut session = Session { plan, lab, folder, references, chosen: HashMap::new(), refused: Vec::new() };
    session.references.recall(&session.folder);
    let index = Index { cells: session.contents(), references: session.references.listed() };
    let adapter = session.lab.adapter();
    let keys: Vec<String> = index.cells.iter().map(|content| key::on_adapter(content, &adapter)).collect();
    let mut costs = options.costs.clone();
    let mut open = Vec::new();
    for cell in work.cells.clone() {
        match session.finished(&keys[cell]) {
            Some(kept) => session.remember(cell, &kept, &mut costs),
            None => open.push(cell),
        }
    }
    // Seeds share what a search has chosen, in whichever process it did.
    let searched = |cell: &usize| !work.cells.contains(cell) && plan.cells[*cell].search.is_some();
    for cell in (0..plan.cells.len()).filter(searched) {
        if let Some(kept) = session.finished(&keys[cell]) {
            session.remember(cell, &kept, &mut costs);
        }
    }
    // All cells of one seed, then those of the next: what slows the machine for minutes then differs between the
    // seeds of a cell, and widens their interval instead of looking like growth along an axis.
    open.sort_by_key(|cell| plan.study.seeds.iter().position(|seed| *seed == plan.cells[*cell].request.seed));
    let record = session.record(options);
    session.folder.write_study(&record, &index)?;
    let finished = work.cells.len() - open.len();
    report(Event::Begin { cells: work.cells.len(), finished, stale: session.folder.stale(&index) });
    for reference in work.references {
        // A failure is reported; the cells that need it record it.
        let _ = session.truth(reference, report)?;
    }
    let (mut failed, mut run) = (0, 0);
    for (place, cell) in open.iter().enumerate() {
        // Another process may have finished it in the meantime.
        let cell = match session.finished(&keys[*cell]) {
            Some(kept) => kept,
            None => {
                let cell = match session.lab.apart(*cell) {
                    Some(ended) => session.record_of_process(*cell, &keys[*cell], ended),
                    None => session.cell(*cell, &keys[*cell], report)?,
                };
                session.folder.write_cell(&cell)?;
                run += 1;
                cell
            }
        };
        failed += usize::from(cell.outcome != Outcome::Done);
        costs.add(&cell);
        let left = costs.estimate(open[place + 1..].iter().map(|index| plan.kind(&plan.cells[*index])));
        let left = left.saturating_add(session.references.left());
        report(Event::Ended { cell: &cell, ended: finished + place + 1, left });
    }
    let record = StudyRecord { started: record.started, ..session.record(options) };
    session.folder.write_study(&record, &index)?;
    let results = if options.shard.is_some() {
        let own = work.cells.filter_map(|cell| session.folder.cell(&keys[cell])).collect();
        Results { study: record, cells: own }
    } else {
        let results = Results::read(&session.folder.path)?;
        crate::table::write(&results, &session.folder.path)?;
        results
    };
    Ok(Ran { results, run, failed })
}

/// The state of a running study.
struct Session<'a> {
    plan: &'a Plan,
    lab: &'a mut dyn Laboratory,
    folder: Folder,
    references: References<'a>,
    /// Values that budgets determined, by all properties of a cell except its seed: seeds share the value.
    chosen: HashMap<String, (AxisValue, Option<String>)>,
    /// References whose failure was reported.
    refused: Vec<usize>,
}

impl Session<'_> {
    fn contents(&mut self) -> Vec<String> {
        let plan = self.plan;
        // Frames and seeds change neither plan nor shaders.
        let mut identities: HashMap<String, String> = HashMap::new();
        plan.cells
            .iter()
            .map(|cell| {
                let reference = cell.reference.map(|index| self.references.key(index)).unwrap_or_default();
                let identity = identities.entry(crate::plan::compiled(&cell.request)).or_insert_with(|| {
                    key::identity(&cell.request, self.lab).unwrap_or_else(|why| format!("none: {why}"))
                });
                let taken = Taken {
                    measures: &plan.measures,
                    phases: &plan.study.phases,
                    figures: &plan.study.figures,
                    by_frame: plan.scenes[cell.scene].moves && cell.request.frames > 1,
                };
                let pipeline = &plan.pipelines[cell.pipeline].name;
                key::content(cell, pipeline, identity, &taken, &reference)
            })
            .collect()
    }

    /// Returns the record of a cell that is finished.
    fn finished(&self, key: &str) -> Option<Cell> {
        self.folder.cell(key).filter(|cell| cell.outcome == Outcome::Done)
    }

    fn record(&self, options: &RunOptions) -> StudyRecord {
        let (plan, study) = (self.plan, &self.plan.study);
        let before = read_study(&self.folder.path).ok().map(|(record, _)| record);
        let begun = before.filter(|before| before.name == study.name).map(|before| before.started);
        StudyRecord {
            name: study.name.clone(),
            title: study.title.clone(),
            about: study.about.clone(),
            paper: study.paper.clone(),
            source: study.source.text.clone(),
            size: study.size,
            output: study.output.value.clone(),
            words: Words::default(),
            budget: study.budget.line(),
            budget_of_time: matches!(study.budget, Budget::Time { .. }),
            warm_up: study.warm_up,
            seeds: study.seeds.clone(),
            scenes: plan.scenes.iter().map(|scene| scene.record.clone()).collect(),
            pipelines: plan.pipelines.clone(),
            axes: plan.axes.clone(),
            measures: plan.infos().collect(),
            references: self.references.records(),
            differences: plan.differences.clone(),
            cell_count: plan.cells.len(),
            adapter: self.lab.adapter(),
            version: VERSION.to_owned(),
            started: begun.unwrap_or_else(now),
            command: options.command.clone(),
            claims: study.claims.clone(),
            crops: study.crops.clone(),
        }
    }

    /// Takes over what is known from a finished cell.
    fn remember(&mut self, index: usize, kept: &Cell, costs: &mut Costs) {
        costs.add(kept);
        let planned = &self.plan.cells[index];
        if let Some(search) = &planned.search
            && let Some(value) = kept.chosen.get(&search.path)
        {
            let note = kept.notes.first().cloned();
            self.chosen.insert(without_seed(planned), (value.clone(), note));
        }
    }

    /// Returns the record of a cell that has not run.
    fn blank(&self, index: usize, key: &str) -> Cell {
        let plan = self.plan;
        let planned = &plan.cells[index];
        Cell {
            key: key.to_owned(),
            scene: plan.scenes[planned.scene].record.name.clone(),
            pipeline: plan.pipelines[planned.pipeline].name.clone(),
            axes: planned.axes.clone(),
            seed: planned.request.seed,
            measures: plan.infos().map(|info| (info.key, None)).collect(),
            node: Node { host: host(), adapter: self.lab.adapter(), clock: now() },
            work: planned.request.work(),
            version: VERSION.to_owned(),
            ..Cell::default()
        }
    }

    /// Returns the record that a process has written, or that of its failure.
    fn record_of_process(&self, index: usize, key: &str, ended: Result<(), Failure>) -> Cell {
        let record = || {
            let silent = || Failure::Crashed("it wrote no record of the cell".to_owned());
            self.folder.cell(key).ok_or_else(silent)
        };
        ended.and_then(|()| record()).unwrap_or_else(|error| Cell {
            end: error.end(),
            outcome: Outcome::Failed { error: error.to_string() },
            ..self.blank(index, key)
        })
    }

    fn cell(
        &mut self,
        index: usize,
        key: &str,
        report: &mut dyn FnMut(Event<'_>),
    ) -> Result<Cell, StudyError> {
        let (plan, mut cell) = (self.plan, self.blank(index, key));
        let planned = &plan.cells[index];
        let truth = match planned.reference {
            Some(reference) => self.truth(reference, report)?,
            None => Ok(None),
        };
        report(Event::Cell { name: name_of(&cell) });
        let start = Instant::now();
        // Cells with other measures than errors also run without a reference, and record what is missing.
        let only_errors =
            plan.study.phases.is_empty() && plan.measures.iter().all(|measure| measure.needs().reference);
        let failure = match truth {
            Err(why) if only_errors => Some(why),
            truth => {
                let (truth, missing) = match truth {
                    Ok(truth) => (truth, None),
                    Err(why) => (None, Some(why)),
                };
                match self.render(planned, truth, &mut cell) {
                    Ok(found) => self.keep(found, planned, &mut cell)?.or(missing),
                    Err(why) => Some(why),
                }
            }
        };
        if let Some(error) = failure {
            cell.end = error.end();
            cell.outcome = Outcome::Failed { error: error.to_string() };
        }
        cell.seconds = start.elapsed().as_secs_f64();
        Ok(cell)
    }

    /// Returns the reference of a cell; a failure is reported once.
    fn truth(
        &mut self,
        reference: usize,
        report: &mut dyn FnMut(Event<'_>),
    ) -> Result<Result<Option<Truth>, Failure>, StudyError> {
        let name = self.references.name(reference);
        if !self.references.is_known(reference) {
            report(Event::Reference { name: name.clone() });
        }
        let step =
            &mut |Part { frame, frames }, step| report(Event::Step { name: &name, frame, frames, step });
        match self.references.get(reference, &self.folder, self.lab, step)? {
            Ok(truth) => Ok(Ok(Some(truth))),
            Err(why) => {
                let why = why.at(format!("the reference of {name} failed"));
                if !self.refused.contains(&reference) {
                    self.refused.push(reference);
                    report(Event::Note(why.to_string()));
                }
                Ok(Err(why))
            }
        }
    }

    fn render(
        &mut self,
        planned: &PlannedCell,
        truth: Option<Truth>,
        cell: &mut Cell,
    ) -> Result<Measurements, Failure> {
        let plan = self.plan;
        let mut request = planned.request.clone();
        if let Some(search) = &planned.search {
            let (value, note) = self.choose(planned, search)?;
            cell.chosen.insert(search.path.clone(), value.clone());
            cell.notes.extend(note);
            request.set.push((search.path.clone(), value));
        }
        let facts = &plan.scenes[planned.scene];
        let first = request.first_frame + request.warm_up;
        let jump =
            plan.study.jump.as_ref().and_then(|jump| jump.value.checked_sub(first)).map(|jump| jump as usize);
        let mut evaluator =
            Evaluator::new((&plan.measures, &plan.study.phases, &plan.study.figures), facts, jump, truth);
        let run = self.lab.run(&request, &mut |frame| evaluator.observe(frame), &mut |_| {})?;
        if evaluator.frames == 0 {
            return Err(Failure::NoFrame);
        }
        if request.external.is_some()
            && let Some(sign) = evaluator.misalignment()
        {
            cell.notes.push(format!("the picture may be of another camera: {sign}"));
        }
        let over_frames = matches!(plan.study.budget, Budget::Time { by: None, .. });
        let lab = &mut *self.lab;
        let found = evaluator.finish(&run, over_frames, &mut |frame| lab.occluded(&request.scene, frame));
        let CellRun { memory, provenance, details, .. } = run;
        (cell.memory, cell.provenance, cell.details) = (memory, provenance, details);
        Ok(found)
    }

    /// Adds measurements to the record, and writes its pictures. Returns the reason if the cell failed.
    fn keep(
        &mut self,
        found: Measurements,
        planned: &PlannedCell,
        cell: &mut Cell,
    ) -> Result<Option<Failure>, StudyError> {
        cell.measures = found.measures;
        cell.passes = found.passes;
        cell.series = found.series;
        cell.frames = found.frames;
        cell.images.reference = planned.reference.and_then(|reference| self.references.image(reference));
        let [name, flip_name] = images(&cell.key);
        if let Some(image) = &found.image {
            self.folder.write_image(&name, image, Some(&cell.provenance))?;
            cell.images.image = Some(name);
        }
        if let Some(flip) = &found.flip {
            self.folder.write_image(&flip_name, flip, None)?;
            cell.images.flip = Some(flip_name);
        }
        Ok(found.failure)
    }

    /// Searches for the value with which a frame takes the budgeted time, once for all seeds; returns a note
    /// if there is none.
    fn choose(
        &mut self,
        planned: &PlannedCell,
        wanted: &Search,
    ) -> Result<(AxisValue, Option<String>), Failure> {
        let id = without_seed(planned);
        if let Some(known) = self.chosen.get(&id) {
            return Ok(known.clone());
        }
        let request = &planned.request;
        let found = search(&Domain::of(&wanted.setting), start(wanted), wanted.ms, |value| {
            let mut set = request.set.clone();
            set.push((wanted.path.clone(), AxisValue::Number(value as f64)));
            let probe = RunRequest {
                set,
                // Drivers compile shaders in the first frame.
                warm_up: request.warm_up.max(1),
                frames: request.frames.min(3),
                views: false,
                lights: false,
                figures: Vec::new(),
                ..request.clone()
            };
            let mut totals = Vec::new();
            let mut time = |frame: Observed| {
                totals.push(frame.passes.iter().map(|(_, ms)| ms).sum::<f64>());
                Ok(())
            };
            self.lab.run(&probe, &mut time, &mut |_| {})?;
            median(&mut totals).filter(|ms| *ms > 0.0).ok_or(Failure::Untimed)
        })?;
        let note = (!found.meets(wanted.ms)).then(|| {
            format!(
                "{} ms cannot be met: with `{}` = {} a frame takes {:.3} ms",
                wanted.ms, wanted.path, found.value, found.ms
            )
        });
        let known = (AxisValue::Number(found.value as f64), note);
        self.chosen.insert(id, known.clone());
        Ok(known)
    }
}

/// Returns the name of this machine: that by which Slurm knows it, or its own.
pub(crate) fn host() -> String {
    let name = std::env::var("SLURMD_NODENAME").ok();
    name.unwrap_or_else(|| gethostname::gethostname().to_string_lossy().into_owned())
}

fn start(search: &Search) -> i64 {
    match &search.setting.default {
        frame_graph::Value::I32(value) => i64::from(*value),
        value => value.as_u32().map_or(1, i64::from),
    }
}

fn without_seed(cell: &PlannedCell) -> String {
    format!("{:?} {:?}", RunRequest { seed: 0, ..cell.request.clone() }, cell.search)
}

/// Returns a description of a cell: `ism on atrium, lights = 256, seed 3`; without `on` where it has no pipeline, as a case that failed
/// before there was one.
pub fn name_of(cell: &Cell) -> String {
    let pipeline = if cell.pipeline.is_empty() { String::new() } else { format!("{} on ", cell.pipeline) };
    let axes: String = cell.axes.iter().map(|(name, value)| format!(", {name} = {value}")).collect();
    format!("{pipeline}{}{axes}, seed {}", cell.scene, cell.seed)
}
