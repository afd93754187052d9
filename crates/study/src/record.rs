//! The results of a study: plain data, stored in `study.json` and `cells/*.json`, from which tables and the
//! report are generated.

use crate::description::Claim;
use crate::report::distinct;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

/// A whole study as read back from its folder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// The study.
    pub study: StudyRecord,
    /// The cells that are finished or failed, in the order of the study: scene, pipeline, axes, seed.
    pub cells: Vec<Cell>,
}

/// The description of a study, with every name resolved: `study.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StudyRecord {
    /// Name of the file, without its ending.
    pub name: String,
    /// The title of the report; empty for the name.
    #[serde(default)]
    pub title: String,
    /// A description, in one line.
    pub about: String,
    /// The paper's table or figure; empty for none.
    pub paper: String,
    /// The text of the study file.
    pub source: String,
    /// Size of frames \[px\].
    pub size: (u32, u32),
    /// The output of the pipelines that is measured; empty if the cells are no pictures.
    pub output: String,
    /// What its scenes and pipelines are called.
    #[serde(default)]
    pub words: Words,
    /// The budget, as a line of text: "8 frames", "20 ms a frame by `lights`".
    pub budget: String,
    /// Whether the budget is one of time: then errors depend on the adapter as well.
    #[serde(default)]
    pub budget_of_time: bool,
    /// Frames before those that are measured.
    pub warm_up: u32,
    /// The seeds.
    pub seeds: Vec<u32>,
    /// Scenes, in order.
    pub scenes: Vec<SceneRecord>,
    /// Pipelines, in order.
    pub pipelines: Vec<PipelineRecord>,
    /// The axes, in order.
    pub axes: Vec<Axis>,
    /// The measures, in order.
    pub measures: Vec<MeasureInfo>,
    /// References: one per scene, or several if they follow an axis or the size of frames.
    pub references: Vec<ReferenceRecord>,
    /// The differences of each pipeline from the first, as `lightloom diff` prints them.
    pub differences: Vec<Difference>,
    /// The number of cells of all shards together.
    pub cell_count: usize,
    /// Adapter and driver of the last run. Those of each cell are in [`Cell::node`].
    pub adapter: String,
    /// Version of Lightloom.
    pub version: String,
    /// The time when it began, RFC 3339 in UTC.
    pub started: String,
    /// The command that repeats the run; empty if it was not run by the program.
    #[serde(default)]
    pub command: String,
    /// The claims of the paper, in order.
    #[serde(default)]
    pub claims: Vec<Claim>,
    /// Parts of pictures that the report enlarges, in shares of the sides: left, top, width, height.
    #[serde(default)]
    pub crops: Vec<[f64; 4]>,
}

impl Results {
    /// Returns the adapters that ran the study: those of the finished cells, or of the last run where there is none.
    pub(crate) fn ran_by(&self) -> Vec<&str> {
        let mut all = self.adapters();
        // Records of earlier versions do not have it.
        all.retain(|adapter| !adapter.is_empty());
        if all.is_empty() { vec![&self.study.adapter] } else { all }
    }

    /// Returns the adapters of the finished cells, each once. Their times are not comparable.
    pub fn adapters(&self) -> Vec<&str> {
        let done = self.cells.iter().filter(|cell| cell.outcome == Outcome::Done);
        distinct(done.map(|cell| cell.node.adapter.as_str()))
    }
}

/// The measure in which the noise of references is estimated.
const NOISE: &str = "rel-mse";

impl StudyRecord {
    /// Returns the title of the report.
    pub(crate) fn heading(&self) -> &str {
        if self.title.is_empty() { &self.name } else { &self.title }
    }

    /// Returns the error of the reference of a scene itself, of the worst one if there are several; `None` for other
    /// measures than that of [`ReferenceRecord::noise`], and if it is unknown. Errors below it are alike.
    pub fn noise(&self, scene: &str, measure: &str) -> Option<f64> {
        let references = self.references.iter().filter(|r| measure == NOISE && r.scene == scene);
        references.filter_map(|r| r.noise).filter(|noise| noise.is_finite() && *noise > 0.0).reduce(f64::max)
    }
}

/// What the cases of a study and that which is compared in them are called in tables and on pages. In records they are scenes
/// and pipelines.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Words {
    /// A case, in lower case: "scene".
    pub case: String,
    /// That which is compared, likewise: "pipeline".
    pub subject: String,
}

impl Default for Words {
    fn default() -> Words {
        Words { case: "scene".to_owned(), subject: "pipeline".to_owned() }
    }
}

/// Returns a word with its first letter in upper case, for headings.
pub(crate) fn heading(word: &str) -> String {
    let mut letters = word.chars();
    letters
        .next()
        .map_or_else(String::new, |first| first.to_uppercase().collect::<String>() + letters.as_str())
}

/// A scene of a study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneRecord {
    /// The name in the study.
    pub name: String,
    /// A description.
    pub about: String,
    /// Hash of its content, hexadecimal.
    pub hash: String,
    /// Triangles.
    pub triangles: usize,
}

/// A pipeline of a study, with its own values.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PipelineRecord {
    /// The name in tables and charts.
    pub name: String,
    /// Name or path of the pipeline.
    pub pipeline: String,
    /// A description.
    pub about: String,
    /// Its paper; empty for none.
    pub paper: String,
    /// Values that hold in all its cells.
    pub set: BTreeMap<String, AxisValue>,
}

/// An axis: a parameter or setting that varies.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// Path of the parameter or setting: `lights`, `gather.clamp`.
    pub name: String,
    /// Its description, from its declaration.
    pub doc: String,
    /// Unit; empty for none.
    pub unit: String,
    /// The values, in order.
    pub values: Vec<AxisValue>,
}

/// A value of an axis.
#[derive(Clone, Debug, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(untagged)]
pub enum AxisValue {
    /// A boolean.
    Bool(bool),
    /// A number, integer or real.
    Number(f64),
    /// A text, such as a choice.
    Text(String),
}

impl fmt::Display for AxisValue {
    /// Formats the value as it is typed: `true`, `64`, `0.01`, `flux`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            AxisValue::Bool(truth) => write!(f, "{truth}"),
            AxisValue::Number(number) => write!(f, "{number}"),
            AxisValue::Text(text) => f.write_str(text),
        }
    }
}

/// The direction in which a measure improves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Better {
    /// Lower values are better: errors, times, bytes.
    Lower,
    /// Higher values are better: SSIM.
    Higher,
    /// Values nearer to 1 are better: energy.
    One,
    /// No value is better than another.
    Neither,
}

impl Better {
    /// Returns it as a word for tables: "lower", "nearer to 1".
    pub fn word(self) -> &'static str {
        match self {
            Better::Lower => "lower",
            Better::Higher => "higher",
            Better::One => "nearer to 1",
            Better::Neither => "neither",
        }
    }
}

/// The description of a measure for tables and charts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeasureInfo {
    /// Its key in [`Cell::measures`]: `rel-mse`, `gpu-ms`.
    pub key: String,
    /// The printed name: "relMSE".
    pub label: String,
    /// Unit; empty for none.
    pub unit: String,
    /// The direction in which it improves.
    pub better: Better,
    /// Its definition and source.
    pub doc: String,
    /// Whether it is an error that can be plotted against time.
    pub is_error: bool,
}

impl SceneRecord {
    /// Creates the record of a case that is no scene.
    pub fn case(name: &str, about: impl Into<String>) -> SceneRecord {
        SceneRecord { name: name.to_owned(), about: about.into(), hash: String::new(), triangles: 0 }
    }
}

impl PipelineRecord {
    /// Creates the record of what is compared in such cases.
    pub fn subject(name: &str, about: &str) -> PipelineRecord {
        let [name, pipeline] = [name; 2].map(str::to_owned);
        PipelineRecord { name, pipeline, about: about.to_owned(), ..PipelineRecord::default() }
    }
}

impl MeasureInfo {
    /// Creates the description of a measure that is no error of a picture, and has no unit.
    pub fn new(key: &str, label: &str, doc: &str) -> MeasureInfo {
        MeasureInfo {
            key: key.to_owned(),
            label: label.to_owned(),
            unit: String::new(),
            better: Better::Neither,
            doc: doc.to_owned(),
            is_error: false,
        }
    }
}

/// A reference of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReferenceRecord {
    /// The scene.
    pub scene: String,
    /// Its source: "pipeline reference, bounces = 1, 4096 samples", or the file.
    pub from: String,
    /// The picture (of the last measured frame), relative to the study's folder; `None` if rendering failed.
    pub image: Option<String>,
    /// Seconds that rendering took; 0 for a file.
    pub seconds: f64,
    /// Pixels × frames × samples that took them; 0 if unknown.
    #[serde(default)]
    pub work: f64,
    /// Estimated relMSE of the reference itself; `None` if unknown.
    pub noise: Option<f64>,
    /// The reason why there is none; empty if there is one.
    pub error: String,
    /// Provenance, as stored in pictures; empty if unknown.
    pub provenance: String,
}

/// The differences of a pipeline from the first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Difference {
    /// The first pipeline's name.
    pub from: String,
    /// The other's.
    pub to: String,
    /// Lines of `lightloom diff`; empty if the pipelines are the same.
    pub lines: Vec<String>,
}

/// One cell: one pipeline with one set of values on one scene with one seed. `cells/KEY.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Hash of everything on which the cell depends, hexadecimal.
    pub key: String,
    /// Name of the scene.
    pub scene: String,
    /// Name of the pipeline in this study.
    pub pipeline: String,
    /// Value of each axis that its pipeline has; the others are absent.
    pub axes: BTreeMap<String, AxisValue>,
    /// Seed.
    pub seed: u32,
    /// How it ended.
    pub outcome: Outcome,
    /// How its process ended, if it failed.
    #[serde(default)]
    pub end: End,
    /// What the laboratory reports beside measures.
    #[serde(default, skip_serializing_if = "serde_json::Value::is_null")]
    pub details: serde_json::Value,
    /// The measurements, by [`MeasureInfo::key`]; `None` for a measure that has no value here, never NaN.
    pub measures: BTreeMap<String, Option<f64>>,
    /// GPU time of each pass: the median over the measured frames, in the order of the plan.
    pub passes: Vec<PassTime>,
    /// The values of single frames, for a scene that moves.
    #[serde(default)]
    pub series: FrameSeries,
    /// Memory of the plan.
    pub memory: Memory,
    /// Values that the budget determined: `lights` in an equal-time study.
    pub chosen: BTreeMap<String, AxisValue>,
    /// Measured frames.
    pub frames: u32,
    /// Seconds that the whole cell took.
    pub seconds: f64,
    /// Pixels × frames × samples that took them; 0 if unknown.
    #[serde(default)]
    pub work: f64,
    /// The machine on which it ran.
    #[serde(default)]
    pub node: Node,
    /// Version of Lightloom that ran it.
    #[serde(default)]
    pub version: String,
    /// Pictures of the last frame.
    pub images: CellImages,
    /// Notes for readers of the measurements, one sentence each: for example, that a budget could not be met.
    #[serde(default)]
    pub notes: Vec<String>,
    /// Provenance, as stored in pictures: plan, flattened RON, shaders, scene, seed, adapter, version.
    pub provenance: String,
}

/// The machine on which a cell ran, and when.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Node {
    /// Its name: that of the batch system (Slurm), or of the machine.
    pub host: String,
    /// Adapter and driver.
    pub adapter: String,
    /// The time by its clock at which the cell began, RFC 3339 in UTC.
    pub clock: String,
}

/// Measurements of single frames; empty for a scene that stands still, and for a single frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FrameSeries {
    /// Number of the first measured frame.
    pub first: u32,
    /// By [`MeasureInfo::key`], one value per frame: `[frames]`. `None` if a frame has no value, as the first
    /// one for differences from the frame before.
    pub values: BTreeMap<String, Vec<Option<f64>>>,
}

/// How a cell ended.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// Every measure was taken.
    #[default]
    Done,
    /// It failed; the others go on.
    Failed {
        /// The error, for the user to read.
        error: String,
    },
}

/// How the process of a failed cell ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// It reported the error.
    #[default]
    Reported,
    /// By a signal, a panic, or without what it was to write.
    Crashed,
    /// It was killed at its time limit.
    TimedOut,
}

/// GPU time of a pass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PassTime {
    /// Name of the pass.
    pub pass: String,
    /// Median over the measured frames \[ms\].
    pub gpu_ms: f64,
}

/// Memory of a plan, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Memory {
    /// If every resource had its own memory.
    pub unshared: u64,
    /// As allocated, with memory shared between resources.
    pub shared: u64,
    /// The lower bound: the largest sum of resources alive at once.
    pub bound: u64,
    /// The memory of all objects that frames use, with history buffers, but without the scene.
    pub held: u64,
}

/// Pictures of a cell, relative to the study's folder; `None` if not requested or not rendered.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CellImages {
    /// The measured output: EXR, linear.
    pub image: Option<String>,
    /// The ꟻLIP error map: PNG.
    pub flip: Option<String>,
    /// The reference that it was compared with: EXR. A scene has several if the size of frames varies.
    #[serde(default)]
    pub reference: Option<String>,
}
