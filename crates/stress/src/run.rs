//! Runs cases by pipelines.

use crate::case::{Case, Expect};
use crate::cell::{ALIKE, Cell, Known, Picture, Verdict, evaluate};
use crate::child::{Ended, Program, Ran};
use crate::long::{self, Line};
use crate::seeds::{self, Seeds};
use crate::shown::Shown;
use metrics::Image;
use std::collections::HashMap;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// An error that ends a run.
#[derive(Debug, thiserror::Error)]
pub enum StressError {
    /// A file or folder could not be written.
    #[error("{}: {error}", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// The system's reason.
        #[source]
        error: io::Error,
    },
    /// The program could not write its pictures: the result of the case is unknown.
    #[error("a picture could not be written: {0}")]
    Picture(String),
    /// The program could not be started.
    #[error("the program that renders cannot be started: {0}")]
    Start(#[source] io::Error),
}

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
    /// The folder for scenes, pictures and the report.
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
}

/// Progress of a run.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// The path tracer renders a picture for a case.
    Reference(&'a str),
    /// A cell is done.
    Done(&'a Cell),
}

/// The pipeline with which others are compared.
pub const REFERENCE: &str = "reference";

/// The most samples per pixel that a frame of few pixels takes: one pixel of the room is then known to 1 %.
const MOST_SAMPLES: u32 = 1 << 17;

/// Samples per pixel and frame of the path tracer: more are no slower in frames of few pixels.
const SAMPLES_PER_FRAME: u32 = 32;

/// Names of files of pictures: of the first of a cell, of those of further seeds, and of the path tracer's.
const FIRST: &str = "picture";
const OF_SEED: &str = "seed";
const OF_REFERENCE: &str = "reference";

/// Time limit of the seeds of a cell, in limits of one picture.
const LIMITS_OF_SEEDS: f64 = 5.0;

/// Frames of a long run for which the time limit of one picture holds.
const FRAMES_IN_LIMIT: u32 = 200;

/// Pictures by the path tracer, by scene, size, bounces and whether pixels are averaged over; `None` if rendering failed.
type References = HashMap<(String, (u32, u32), u32, bool), Option<Picture>>;

/// Runs each case by each pipeline, and the cases of single pipelines. Calls `report` with the progress.
///
/// # Errors
/// Fails if a file cannot be written or the program cannot be started. A failed case is no error.
pub fn run(
    program: &dyn Program,
    subjects: &[Subject],
    cases: &[Case],
    options: &Options,
    report: &mut dyn FnMut(Event<'_>),
) -> Result<Vec<Cell>, StressError> {
    let mut bench = Bench { program, options, references: References::new() };
    let plain = crate::table::plain();
    let mut cells = Vec::new();
    for subject in subjects {
        bench.write(&plain)?;
        let (ran, pictures) = bench.render(subject, &plain, None)?;
        let plain_truth = bench.reference(subject, &plain, report)?;
        let plain_picture = pictures.as_ref().map(|(indirect, _)| indirect.clone());
        let plain_known = Known {
            plain: plain_picture.as_ref(),
            plain_truth: plain_truth.as_ref(),
            truth: plain_truth.as_ref(),
            lines: &[],
        };
        for case in cases.iter().chain(&subject.cases) {
            let identity = (subject.name.as_str(), case.name.as_str(), case.expect);
            let (mut cell, expected) = if *case == plain {
                (evaluate(identity, &ran, both(&pictures), plain_known), plain_truth.clone())
            } else {
                bench.write(case)?;
                let (ran, pictures) = bench.render(subject, case, None)?;
                let truth = match case.expect {
                    Expect::Truth => bench.reference(subject, case, report)?,
                    _ => None,
                };
                let lines = match case.expect {
                    Expect::Steady(_) => bench.log(),
                    _ => Vec::new(),
                };
                let known = Known { truth: truth.as_ref(), lines: &lines, ..plain_known };
                let cell = evaluate(identity, &ran, both(&pictures), known);
                let expected = known.truth.or(known.plain).cloned();
                (bench.by_seeds(subject, case, cell, known)?, expected)
            };
            bench.keep_picture(&mut cell, expected.as_ref());
            report(Event::Done(&cell));
            cells.push(cell);
        }
    }
    Ok(cells)
}

type Pictures = Option<(Picture, Picture)>;

fn both(pictures: &Pictures) -> Option<(&Picture, &Picture)> {
    pictures.as_ref().map(|(indirect, whole)| (indirect, whole))
}

struct Bench<'a> {
    program: &'a dyn Program,
    options: &'a Options,
    references: References,
}

impl Bench<'_> {
    fn scene_of(&self, case: &Case) -> PathBuf {
        // Cases of settings are all of the plain scene.
        let name = if case.name.contains('=') { "plain" } else { &case.name };
        self.options.folder.join("scenes").join(format!("{name}.ron"))
    }

    /// Writes the scene of a case.
    fn write(&self, case: &Case) -> Result<(), StressError> {
        let scene = self.scene_of(case);
        let folder = scene.parent().unwrap_or(Path::new("."));
        std::fs::create_dir_all(folder)
            .map_err(|error| StressError::Write { path: folder.to_owned(), error })?;
        let beside = case.files.iter().map(|(name, text)| (folder.join(name), text));
        for (path, text) in beside.chain([(scene.clone(), &case.scene)]) {
            whole_file::write(&path, text).map_err(|error| StressError::Write { path, error })?;
        }
        Ok(())
    }

    /// Renders further seeds of a cell whose energy is off from the path tracer's until their mean decides. Returns the cell
    /// with their mean, or the seed that has another defect.
    fn by_seeds(
        &self,
        subject: &Subject,
        case: &Case,
        cell: Cell,
        known: Known<'_>,
    ) -> Result<Cell, StressError> {
        let (Expect::Truth, Verdict::Off, Some(first)) = (case.expect, cell.verdict, cell.energy) else {
            return Ok(cell);
        };
        let mut energies = Vec::new();
        let mut sum = None;
        let mut seconds = 0.0;
        for seed in 1..=seeds::MOST {
            let (ran, pictures) = self.render(subject, case, Some(seed))?;
            seconds += ran.seconds;
            let identity = (subject.name.as_str(), case.name.as_str(), case.expect);
            let again = evaluate(identity, &ran, both(&pictures), known);
            match (again.verdict, again.energy) {
                (Verdict::Held | Verdict::Off, Some(energy)) => energies.push(energy),
                (Verdict::TimedOut, _) => break,
                _ => {
                    // The picture with the defect is kept.
                    let _ = std::fs::rename(self.file(OF_SEED, "indirect"), self.file(FIRST, "indirect"));
                    return Ok(again);
                }
            }
            sum = Seeds::of(first, &energies);
            let is_decided = sum.is_some_and(|sum| sum.is_decided(&ALIKE));
            if is_decided || seconds > LIMITS_OF_SEEDS * self.options.limit.as_secs_f64() {
                break;
            }
        }
        let Some(sum) = sum else { return Ok(cell) };
        let verdict = if ALIKE.contains(&sum.energy) { Verdict::Held } else { Verdict::Off };
        let seconds = cell.seconds + seconds;
        Ok(Cell { verdict, energy: Some(sum.energy), seeds: Some(sum), seconds, ..cell })
    }

    /// Renders a case by a pipeline: the indirect light and the whole picture; `None` if it failed.
    fn render(
        &self,
        subject: &Subject,
        case: &Case,
        seed: Option<u32>,
    ) -> Result<(Ran, Pictures), StressError> {
        let given = case.set.iter().chain(self.options.set.iter().filter(|(path, _)| !sets(case, path)));
        let known = given.filter(|(path, _)| subject.settable.iter().any(|known| known == path));
        let seeds = seed.map(|seed| ["--seed".to_owned(), seed.to_string()]);
        // The first picture of a cell is kept where there is a defect.
        let stem = if seed.is_some() { OF_SEED } else { FIRST };
        self.picture(&subject.name, case, stem, known.map(to_set).chain(seeds))
    }

    /// Renders a case by the path tracer, unless that was rendered before.
    fn reference(
        &mut self,
        subject: &Subject,
        case: &Case,
        report: &mut dyn FnMut(Event<'_>),
    ) -> Result<Option<Picture>, StressError> {
        let size = case.size.unwrap_or(self.options.size);
        let key = (case.scene.clone(), size, subject.bounces, subject.sampled);
        if let Some(known) = self.references.get(&key) {
            return Ok(known.clone());
        }
        report(Event::Reference(&case.name));
        let pixels = |(width, height): (u32, u32)| width.saturating_mul(height).max(1);
        let times = pixels(self.options.size).div_ceil(pixels(size));
        let least = self.options.samples;
        let samples = least.saturating_mul(times).min(MOST_SAMPLES.max(least));
        let own =
            [("bounces", subject.bounces), ("samples", samples), ("samples_per_frame", SAMPLES_PER_FRAME)]
                .map(|(path, value)| (path.to_owned(), value.to_string()));
        // A pipeline that averages over pixels is compared with a reference that does.
        let set =
            self.options.set_reference.iter().filter(|(path, _)| !(subject.sampled && path == "filter"));
        let still = Case { frames: 1, ..case.clone() };
        let given = own.iter().chain(set).map(to_set);
        let (_, pictures) = self.picture(REFERENCE, &still, OF_REFERENCE, given)?;
        let picture = pictures.map(|(indirect, _)| indirect).filter(|picture| picture.glance.not_finite == 0);
        self.references.insert(key, picture.clone());
        Ok(picture)
    }

    /// Returns the path of an output.
    fn file(&self, stem: &str, output: &str) -> PathBuf {
        self.options.folder.join(format!("{stem}-{output}.exr"))
    }

    fn log_file(&self) -> PathBuf {
        self.options.folder.join("frames.jsonl")
    }

    /// Returns the frames of the last long run.
    fn log(&self) -> Vec<Line> {
        long::lines(&std::fs::read_to_string(self.log_file()).unwrap_or_default())
    }

    fn picture(
        &self,
        pipeline: &str,
        case: &Case,
        stem: &str,
        set: impl IntoIterator<Item = [String; 2]>,
    ) -> Result<(Ran, Pictures), StressError> {
        let (width, height) = case.size.unwrap_or(self.options.size);
        let out = self.options.folder.join(format!("{stem}.exr"));
        let files = ["indirect", "image"].map(|output| self.file(stem, output));
        for file in files.iter().chain([&self.log_file()]) {
            // A file of the case before must not pass for this one's.
            let _ = std::fs::remove_file(file);
        }
        let mut arguments: Vec<String> =
            ["--json", "render", pipeline].into_iter().map(str::to_owned).collect();
        arguments.push(self.scene_of(case).display().to_string());
        arguments.extend(["-o".to_owned(), out.display().to_string()]);
        arguments.extend(["--output", "indirect", "--output", "image", "--size"].map(str::to_owned));
        arguments.push(format!("{width}x{height}"));
        if case.frames > 1 {
            arguments.extend(["--frames".to_owned(), case.frames.to_string()]);
        }
        let mut limit = self.options.limit;
        if let Expect::Steady(_) = case.expect {
            arguments.extend(["--log".to_owned(), self.log_file().display().to_string()]);
            limit *= case.frames.div_ceil(FRAMES_IN_LIMIT);
        }
        arguments.extend(set.into_iter().flatten());
        let ran = self.program.run(&arguments, limit).map_err(StressError::Start)?;
        if let Some(why) = ran.unwritten() {
            return Err(StressError::Picture(why));
        }
        let read = |path: &PathBuf| Image::read(path).ok().map(Picture::new);
        // A run whose picture is not finite writes it, and fails.
        let pictures = match ran.ended {
            Ended::Exit(0 | 1) => read(&files[0]).zip(read(&files[1])),
            _ => None,
        };
        Ok((ran, pictures))
    }

    /// Keeps the picture of a defect, for the page, beside the expected one.
    fn keep_picture(&self, cell: &mut Cell, expected: Option<&Picture>) {
        if !cell.is_defect() || matches!(cell.verdict, Verdict::Crashed | Verdict::Refused) {
            return;
        }
        let file = self.file(FIRST, "indirect");
        let rendered = Image::read(&file).ok();
        let expected = expected.map(|picture| &picture.image);
        let pictures = [("rendered", rendered.as_ref()), ("expected", expected)];
        cell.pictures = pictures.into_iter().filter_map(|(what, image)| Shown::new(what, image?)).collect();
        let folder = self.options.folder.join("pictures");
        let to = folder.join(format!("{}-{}.exr", file_name(&cell.pipeline), file_name(&cell.case)));
        // The report has the command that renders it again.
        let _ = std::fs::create_dir_all(&folder);
        let _ = std::fs::rename(file, to);
    }
}

/// Returns the arguments that set a value.
fn to_set((path, value): &(String, String)) -> [String; 2] {
    ["--set".to_owned(), format!("{path}={value}")]
}

fn sets(case: &Case, path: &str) -> bool {
    case.set.iter().any(|(known, _)| known == path)
}

fn file_name(text: &str) -> String {
    text.chars().map(|c| if c.is_ascii_alphanumeric() || c == '.' { c } else { '-' }).collect()
}
