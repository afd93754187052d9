//! The laboratory of extremes: each run is a process of its own.

use crate::child::{Ended, Program, Ran};
use crate::long::{self, Line, Long, Seen, Steady};
use metrics::{Glance, Image};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::path::Path;
use std::time::Duration;
use study::{CellRun, Failure, Laboratory, Observed, Occluded, RunRequest, Step};

/// Frames of a long run for which the time limit of one picture holds.
const FRAMES_IN_LIMIT: u32 = 200;

/// What a run reports beside its picture.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Details {
    /// Number of pixels with a value that is not finite, of the indirect light or of the whole picture.
    pub not_finite: usize,
    /// Number of pixels with a negative value, likewise.
    pub negative: usize,
    /// Guards that acted: values that were too large, too small or missing, each with its extent.
    pub guards: Vec<String>,
    /// The result of a long run; `None` if it was too short to be evaluated, or the run is no long one.
    pub long: Option<Long>,
}

/// Runs requests by the command `render`.
pub(crate) struct Isolated<'a> {
    /// Starts the processes.
    pub(crate) program: &'a dyn Program,
    /// States what runs depend on.
    pub(crate) known: &'a mut dyn Laboratory,
    /// The folder of the study, in which the scenes are. Cells do not depend on where it is.
    pub(crate) folder: &'a Path,
    /// Time limit of one picture, and of each 200 frames of a long run.
    pub(crate) limit: Duration,
    /// The long runs, by their scenes.
    pub(crate) long: HashMap<String, Steady>,
    /// Identities of requests, which do not depend on seeds.
    pub(crate) identities: HashMap<String, Result<u128, Failure>>,
}

/// Returns the command that renders a request of the study in a folder, to files of this stem.
pub(crate) fn arguments(folder: &Path, request: &RunRequest, out: &str) -> Vec<String> {
    let (width, height) = request.size;
    let scene = folder.join(&request.scene).display().to_string();
    let mut words: Vec<String> = ["render", &request.pipeline, &scene, "-o", out].map(str::to_owned).into();
    words.extend(["--output", "indirect", "--output", "image", "--size"].map(str::to_owned));
    words.push(format!("{width}x{height}"));
    let mut option = |name: &str, value: String| words.extend([name.to_owned(), value]);
    if request.frames + request.warm_up > 1 {
        option("--frames", (request.frames + request.warm_up).to_string());
    }
    if request.seed > 0 {
        option("--seed", request.seed.to_string());
    }
    request.set.iter().for_each(|(path, value)| option("--set", format!("{path}={value}")));
    words
}

impl Laboratory for Isolated<'_> {
    fn adapter(&self) -> String {
        self.known.adapter()
    }

    fn identity(&mut self, request: &RunRequest) -> Result<u128, Failure> {
        let RunRequest { pipeline, scene, set, size, .. } = request;
        let key = format!("{pipeline} {scene} {set:?} {size:?}");
        self.identities
            .entry(key)
            .or_insert_with(|| {
                let scene = self.folder.join(scene).display().to_string();
                self.known.identity(&RunRequest { scene, ..request.clone() })
            })
            .clone()
    }

    fn run(
        &mut self,
        request: &RunRequest,
        observe: &mut dyn FnMut(Observed) -> Result<(), Failure>,
        _: &mut dyn FnMut(Step),
    ) -> Result<CellRun, Failure> {
        let path = |name: &str| self.folder.join(name);
        let (files, log) = ([path("run-indirect.exr"), path("run-image.exr")], path("frames.jsonl"));
        for file in files.iter().chain([&log]) {
            // A file of the run before must not pass for this one's.
            let _ = std::fs::remove_file(file);
        }
        let mut words = vec!["--json".to_owned()];
        words.extend(arguments(self.folder, request, &path("run.exr").display().to_string()));
        let steady = self.long.get(&request.scene);
        let mut limit = self.limit;
        if steady.is_some() {
            words.extend(["--log".to_owned(), log.display().to_string()]);
            limit *= (request.frames + request.warm_up).div_ceil(FRAMES_IN_LIMIT);
        }
        let ran = self.program.run(&words, limit).map_err(|error| {
            Failure::Crashed(format!("the program that renders cannot be started: {error}"))
        })?;
        if let Some(why) = ran.unwritten() {
            return Err(Failure::Crashed(format!("a picture could not be written: {why}")));
        }
        let pictures = files.each_ref().map(|file| Image::read(file).ok());
        let ([Some(indirect), Some(image)], Ended::Exit(0 | 1)) = (pictures, ran.ended) else {
            return Err(failure(&ran, limit));
        };
        let mut seen = vec![indirect.glance(), image.glance()];
        // A run whose picture is not finite writes it, and fails.
        if ran.ended == Ended::Exit(1) && seen.iter().all(|glance| glance.not_finite == 0) {
            return Err(failure(&ran, limit));
        }
        let lines = long::lines(&std::fs::read_to_string(&log).unwrap_or_default());
        let of_line =
            |line: &Line| [&line.outputs.indirect, &line.outputs.image].map(|Seen { glance, .. }| *glance);
        seen.extend(lines.iter().flat_map(of_line));
        let most = |of: fn(&Glance) -> usize| seen.iter().map(of).max().unwrap_or(0);
        let details = Details {
            not_finite: most(|glance| glance.not_finite),
            negative: most(|glance| glance.negative),
            guards: ran.guards(),
            long: steady.and_then(|steady| long::evaluate(*steady, &lines)),
        };
        let last = request.first_frame + request.warm_up + request.frames - 1;
        observe(Observed::picture(last, indirect))?;
        let details = serde_json::to_value(details).map_err(|error| Failure::render(error.to_string()))?;
        Ok(CellRun { details, ..CellRun::default() })
    }

    fn occluded(&mut self, scene: &str, frame: u32) -> Result<Occluded, Failure> {
        self.known.occluded(scene, frame)
    }
}

/// Returns why there is no picture.
fn failure(ran: &Ran, limit: Duration) -> Failure {
    match ran.ended {
        Ended::TimedOut => Failure::TimedOut(limit),
        // A reported error contains the word; a panic does not.
        Ended::Exit(1) if ran.errors.contains("error") && !ran.errors.contains("panicked") => {
            Failure::render(ran.message())
        }
        _ => Failure::Crashed(ran.message()),
    }
}
