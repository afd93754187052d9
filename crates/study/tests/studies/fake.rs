//! A laboratory whose pictures and times are closed forms.

use frame_graph::{Settable, Setting, Source, Value, ValueType};
use metrics::Image;
use metrics::temporal::Pinhole;
use metrics::virtual_lights::VirtualLight;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use study::{
    AxisValue, CellRun, Event, Failure, Laboratory, Memory, Observed, Occluded, PipelineFacts, Plan, Ran,
    Registry, RunOptions, RunRequest, SceneFacts, SceneRecord, Step, Study, StudyError, Values,
};

/// What there is: `box` stands still, `walk` moves, and `grid-N` has N triangles, which add to the time of `exact` as
/// much as lights do. `fast` has `lights` and `map`; `exact` has `lights`; `broken`
/// fails; `nan` gives one pixel that is no number; `truth` accumulates; `direct`, which is not listed, has no `indirect`.
pub(crate) struct Shelf;

/// Error of a picture of `fast` is ±`1 / lights`, by the seed, about a bias of 0.5 / `lights`.
pub(crate) const TRUTH: f32 = 2.0;

fn whole(name: &str, default: u32, one_of: &[u32]) -> Settable {
    let one_of = one_of.iter().map(|value| Value::U32(*value)).collect();
    let setting = Setting {
        name: name.to_owned(),
        ty: ValueType::U32,
        default: Value::U32(default),
        min: Some(1.0),
        max: Some(4096.0),
        one_of,
        unit: String::new(),
        doc: format!("Number of {name}"),
        declared: String::new(),
    };
    Settable { path: name.to_owned(), setting, value: Value::U32(default) }
}

impl Registry for Shelf {
    fn scenes(&self) -> Vec<String> {
        vec!["box".to_owned(), "walk".to_owned()]
    }

    fn roots(&self) -> Vec<PathBuf> {
        vec![std::env::temp_dir()]
    }

    fn beside(&self, _: &str, name: &str) -> Option<String> {
        match name {
            "here" => Some("box".to_owned()),
            "neighbour" => Some("fast".to_owned()),
            _ => None,
        }
    }

    fn shadowed(&self, folder: &str, name: &str, own: &str) -> Option<String> {
        (name == "neighbour" && own == "fast").then(|| format!("{folder}/neighbour.ron"))
    }

    fn scene(&self, name: &str) -> Result<SceneFacts, Failure> {
        let triangles = triangles(name);
        if triangles.is_none() && !self.scenes().contains(&name.to_owned()) {
            return Err(Failure::render(format!("there is no scene `{name}`")));
        }
        Ok(SceneFacts {
            record: SceneRecord {
                name: name.to_owned(),
                about: String::new(),
                hash: "0".to_owned(),
                triangles: triangles.unwrap_or(2),
            },
            moves: name == "walk",
            seconds_per_frame: 0.5,
            small_length: 1e-6,
        })
    }

    fn pipelines(&self) -> Vec<String> {
        ["broken", "exact", "fast", "nan", "truth"].map(str::to_owned).to_vec()
    }

    fn pipeline(&self, name: &str) -> Result<PipelineFacts, Failure> {
        let settings = match name {
            "fast" | "nan" => vec![whole("lights", 64, &[]), whole("map", 32, &[32, 64])],
            "exact" | "broken" => vec![whole("lights", 64, &[])],
            "truth" => vec![whole("samples", 16, &[])],
            "direct" => Vec::new(),
            _ => return Err(Failure::render(format!("there is no pipeline `{name}`"))),
        };
        let outputs: &[&str] = match name {
            "truth" => &["indirect", "progress"],
            "direct" => &["image"],
            _ => &["image", "indirect"],
        };
        Ok(PipelineFacts {
            about: format!("The pipeline {name}"),
            paper: String::new(),
            outputs: outputs.iter().map(|output| (*output).to_owned()).collect(),
            passes: passes(name).map(str::to_owned).to_vec(),
            figures: if name == "exact" { vec!["rays/trace.counters.hits".to_owned()] } else { Vec::new() },
            settings,
        })
    }

    fn differences(&self, first: (&str, &Values), second: (&str, &Values)) -> Vec<String> {
        if first == second { Vec::new() } else { vec![format!("{} is not {}", second.0, first.0)] }
    }
}

/// The triangles of `grid-N`.
fn triangles(scene: &str) -> Option<usize> {
    scene.strip_prefix("grid-")?.parse().ok()
}

/// What a pipeline runs: `exact` has a part `rays`.
fn passes(pipeline: &str) -> [&str; 2] {
    ["view", if pipeline == "exact" { "rays/trace" } else { "gather" }]
}

/// Renders by formulas, and keeps what it was asked.
#[derive(Default)]
pub(crate) struct Fake {
    /// Pipelines of the requests that ran, probes too.
    pub(crate) ran: Vec<RunRequest>,
    /// The device is gone after this many runs.
    pub(crate) dies_after: Option<usize>,
    /// Part of every identity: stands for edits of shaders.
    pub(crate) shaders: BTreeMap<String, u128>,
    /// Whether `truth` fails.
    pub(crate) no_truth: bool,
    /// Another adapter than paper and pencil, and how much slower it is.
    pub(crate) adapter: Option<(&'static str, f64)>,
}

pub(crate) fn number(request: &RunRequest, path: &str, default: f64) -> f64 {
    let value = request.set.iter().rev().find(|(name, _)| name == path).map(|(_, value)| value);
    match value {
        Some(AxisValue::Number(number)) => *number,
        _ => default,
    }
}

impl Laboratory for Fake {
    fn adapter(&self) -> String {
        self.adapter.map_or("paper and pencil", |(name, _)| name).to_owned()
    }

    fn identity(&mut self, request: &RunRequest) -> Result<u128, Failure> {
        Ok(self.shaders.get(&request.pipeline).copied().unwrap_or_default())
    }

    fn run(
        &mut self,
        request: &RunRequest,
        observe: &mut dyn FnMut(Observed) -> Result<(), Failure>,
        step: &mut dyn FnMut(Step),
    ) -> Result<CellRun, Failure> {
        if self.dies_after.is_some_and(|runs| self.ran.len() >= runs) {
            panic!("killed");
        }
        self.ran.push(request.clone());
        if request.pipeline == "broken" || (request.pipeline == "truth" && self.no_truth) {
            return Err(Failure::render("the device was lost"));
        }
        if request.until_done {
            step(Step { step: 8, steps: 16, noise: None });
            step(Step { step: 16, steps: 16, noise: Some(1e-6) });
        }
        let lights = number(request, "lights", 64.0);
        let per_light = if request.pipeline == "exact" { 0.1 } else { 0.01 };
        let triangles = triangles(&request.scene).filter(|_| request.pipeline == "exact").unwrap_or(0);
        let slower = self.adapter.map_or(1.0, |(_, slower)| slower);
        let ms = slower * (2.0 + per_light * (lights + triangles as f64));
        let sign = if request.seed.is_multiple_of(2) { -1.0 } else { 1.0 };
        let error = if request.pipeline == "truth" { 0.0 } else { (0.5 + sign) / lights };
        let first =
            if request.until_done { request.first_frame } else { request.first_frame + request.warm_up };
        let mut spent = 0.0;
        for frame in first..first + if request.until_done { 1 } else { request.frames } {
            // The light of `walk` grows by the number of the frame.
            let truth = if request.scene == "walk" { TRUTH + frame as f32 } else { TRUTH };
            let (width, height) = (request.size.0 as usize, request.size.1 as usize);
            let mut pixels =
                vec![[truth + error as f32, truth + error as f32, truth + error as f32, 1.0]; width * height];
            if request.pipeline == "nan" {
                pixels[0][1] = f32::NAN;
            }
            observe(Observed {
                frame,
                image: Image::new(width, height, pixels).unwrap(),
                passes: if request.timed {
                    let [view, other] = passes(&request.pipeline).map(str::to_owned);
                    vec![(view, 2.0), (other, ms - 2.0)]
                } else {
                    Vec::new()
                },
                depth: request
                    .views
                    .then(|| Image::new(width, height, vec![[1.0; 4]; width * height]).unwrap()),
                normal: None,
                camera: camera(),
                lights: request.lights.then(|| lights_of(frame)),
                figures: request
                    .figures
                    .iter()
                    .filter(|_| request.pipeline == "exact")
                    .map(|name| (name.clone(), f64::from(frame)))
                    .collect(),
                // For each unit that is kept, clamping removed the number of the frame.
                irradiance: Image::new(width, height, vec![[1.0, 1.0, 1.0, frame as f32]; width * height])
                    .ok(),
            })?;
            spent += ms;
            if request.stop_after_ms.is_some_and(|most| spent >= most) {
                break;
            }
        }
        Ok(CellRun {
            memory: Memory { unshared: 4 << 20, shared: 3 << 20, bound: 2 << 20, held: 3 << 20 },
            provenance: format!("{{\"pipeline\":\"{}\"}}", request.pipeline),
            noise: (request.pipeline == "truth").then_some(1e-6),
            ..CellRun::default()
        })
    }

    fn occluded(&mut self, _scene: &str, _frame: u32) -> Result<Occluded, Failure> {
        Ok(Box::new(|_, _| false))
    }
}

/// Two virtual lights: one stays, the other moves with every even frame.
fn lights_of(frame: u32) -> Vec<VirtualLight> {
    let at = |x: f32| VirtualLight { position: [x, 0.0, 0.0], normal: [0.0; 3], flux: [0.0; 3], area: 0.0 };
    vec![at(0.0), at((frame / 2) as f32)]
}

fn camera() -> Pinhole {
    Pinhole {
        position: [0.0; 3],
        right: [1.0, 0.0, 0.0],
        up: [0.0, 1.0, 0.0],
        back: [0.0, 0.0, 1.0],
        half_extent: [1.0, 1.0],
    }
}

/// A study with these fields beside scene, pipelines and size.
pub(crate) fn study(fields: &str) -> Study {
    parse(&format!("Study(scenes: [\"box\"], pipelines: [\"fast\"], size: (8, 4), {fields})"))
}

pub(crate) fn parse(text: &str) -> Study {
    study::parse(Source::new("studies/test.ron", text)).unwrap_or_else(|errors| panic!("{errors}"))
}

pub(crate) fn plan(study: Study) -> Plan {
    Plan::new(study, &Shelf).unwrap_or_else(|errors| panic!("{errors}"))
}

pub(crate) fn run(plan: &Plan, lab: &mut Fake, folder: &Path) -> Result<Ran, StudyError> {
    study::run(plan, lab, folder, &RunOptions::default(), &mut |_| {})
}

/// Runs a plan by a laboratory without faults, in a folder of its own.
pub(crate) fn done(plan: &Plan) -> (tempfile::TempDir, Ran) {
    let folder = tempfile::tempdir().unwrap();
    let ran = run(plan, &mut Fake::default(), folder.path()).unwrap_or_else(|error| panic!("{error}"));
    (folder, ran)
}

/// Returns the events of a run, as lines.
pub(crate) fn told(plan: &Plan, lab: &mut Fake, folder: &Path, options: &RunOptions) -> Vec<String> {
    let mut lines = Vec::new();
    let ran = study::run(plan, lab, folder, options, &mut |event| {
        lines.push(match event {
            Event::Begin { cells, finished, stale } => format!("begin {cells} {finished} {stale}"),
            Event::Reference { name } => format!("reference {name}"),
            Event::Step { name, frame, frames, step } => {
                format!("step {name} {frame}/{frames} {}/{} {:?}", step.step, step.steps, step.noise)
            }
            Event::Cell { name } => format!("cell {name}"),
            Event::Ended { ended, .. } => format!("ended {ended}"),
            Event::Note(note) => format!("note {note}"),
        });
    });
    ran.unwrap_or_else(|error| panic!("{error}"));
    lines
}
