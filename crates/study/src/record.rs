//! What a study leaves behind: plain data, in `study.json` and `cells/*.json`, from which tables and the report
//! are made.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

/// A whole study as read back from its folder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// What was asked.
    pub study: StudyRecord,
    /// The cells that are finished or failed, in the order of the study: scene, pipeline, axes, seed.
    pub cells: Vec<Cell>,
}

/// What was asked, with every name resolved: `study.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StudyRecord {
    /// Name of the file, without its ending.
    pub name: String,
    /// What it shows, in a line.
    pub about: String,
    /// The paper's table or figure; empty for none.
    pub paper: String,
    /// The description's text.
    pub source: String,
    /// Size of frames \[px\].
    pub size: (u32, u32),
    /// The output of the pipelines that is judged.
    pub output: String,
    /// The budget, as a line to read: "8 frames", "20 ms a frame by `lights`".
    pub budget: String,
    /// Frames before those that are measured.
    pub warm_up: u32,
    /// The seeds.
    pub seeds: Vec<u32>,
    /// Scenes, in order.
    pub scenes: Vec<SceneRecord>,
    /// Pipelines, in order.
    pub pipelines: Vec<PipelineRecord>,
    /// What is varied, in order.
    pub axes: Vec<Axis>,
    /// What is measured, in order.
    pub measures: Vec<MeasureInfo>,
    /// References: one a scene, or several where they follow an axis or the frame's size.
    pub references: Vec<ReferenceRecord>,
    /// What each pipeline differs in from the first, in the words of `lightloom diff`.
    pub differences: Vec<Difference>,
    /// How many cells there are in all, of every shard.
    pub cell_count: usize,
    /// Adapter and driver.
    pub adapter: String,
    /// Version of Lightloom.
    pub version: String,
    /// When it began, RFC 3339 in UTC.
    pub started: String,
    /// The command that makes it again; empty where it was not run by the program.
    #[serde(default)]
    pub command: String,
    /// What the paper says of the measures, in order.
    #[serde(default)]
    pub claims: Vec<ClaimRecord>,
}

/// A scene of a study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneRecord {
    /// As the study names it.
    pub name: String,
    /// What it shows.
    pub about: String,
    /// Hash of its content, hexadecimal.
    pub hash: String,
    /// Triangles.
    pub triangles: usize,
}

/// A pipeline of a study, with values of its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PipelineRecord {
    /// As tables and charts name it.
    pub name: String,
    /// Name or path of the pipeline.
    pub pipeline: String,
    /// What it renders.
    pub about: String,
    /// Its paper; empty for none.
    pub paper: String,
    /// Values that hold in all its cells.
    pub set: BTreeMap<String, AxisValue>,
}

/// Something that varies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// Path of the parameter or setting: `lights`, `gather.clamp`.
    pub name: String,
    /// What it is, from its declaration.
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
    /// A switch.
    Bool(bool),
    /// A number, whole or not.
    Number(f64),
    /// A choice.
    Text(String),
}

impl fmt::Display for AxisValue {
    /// Writes it as it is typed: `true`, `64`, `0.01`, `flux`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            AxisValue::Bool(truth) => write!(f, "{truth}"),
            AxisValue::Number(number) => write!(f, "{number}"),
            AxisValue::Text(text) => f.write_str(text),
        }
    }
}

/// Which way a measure improves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Better {
    /// Less is better: errors, times, bytes.
    Lower,
    /// More is better: SSIM.
    Higher,
    /// Nearer to 1: energy.
    One,
    /// Neither.
    Neither,
}

/// A measure, as tables and charts show it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeasureInfo {
    /// Its key in [`Cell::measures`]: `rel-mse`, `gpu-ms`.
    pub key: String,
    /// As it is printed: "relMSE".
    pub label: String,
    /// Unit; empty for none.
    pub unit: String,
    /// Which way it improves.
    pub better: Better,
    /// What it is and where it is defined.
    pub doc: String,
    /// Whether it is an error that can stand on the y axis of a chart over time.
    pub is_error: bool,
}

/// A reference of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReferenceRecord {
    /// The scene.
    pub scene: String,
    /// What made it: "pipeline reference, bounces = 1, 4096 samples", or the file.
    pub from: String,
    /// The picture (of the measured frame), relative to the study's folder; `None` where it failed.
    pub image: Option<String>,
    /// Seconds that it took to make; 0 for a file.
    pub seconds: f64,
    /// Estimated relMSE of the reference itself; `None` where unknown.
    pub noise: Option<f64>,
    /// Why there is none; empty where there is.
    pub error: String,
    /// Provenance, as in pictures; empty where unknown.
    pub provenance: String,
}

/// What a pipeline differs in from the first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Difference {
    /// The first pipeline's name.
    pub from: String,
    /// The other's.
    pub to: String,
    /// Lines of `lightloom diff`; empty where they are the same.
    pub lines: Vec<String>,
}

/// What a paper says of a measure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClaimRecord {
    /// Key of the measure.
    pub measure: String,
    /// What is to hold.
    pub relation: RelationRecord,
    /// Values of axes: cells with others take no part, those without the axis do.
    pub at: BTreeMap<String, AxisValue>,
    /// Names of the scenes that it is about, each by itself; empty for all.
    pub scenes: Vec<String>,
    /// Where it is said; empty where nowhere.
    pub says: String,
}

/// What is to hold of means over cells.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RelationRecord {
    /// Each is less than the next.
    Order(Vec<PickRecord>),
    /// One over another lies within bounds.
    Ratio {
        /// The numerator.
        of: PickRecord,
        /// The denominator.
        to: PickRecord,
        /// The least ratio.
        at_least: Option<f64>,
        /// The greatest ratio.
        at_most: Option<f64>,
    },
}

/// Cells of a pipeline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PickRecord {
    /// Its name in the study.
    pub pipeline: String,
    /// Values of axes, beside those of the claim.
    pub at: BTreeMap<String, AxisValue>,
}

/// One cell: one pipeline with one set of values on one scene with one seed. `cells/KEY.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Hash of everything it depends on, hexadecimal.
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
    /// What was measured, by [`MeasureInfo::key`]; a measure that does not exist here is `None`, never NaN.
    pub measures: BTreeMap<String, Option<f64>>,
    /// GPU time of each pass: median over the measured frames, in the order of the plan.
    pub passes: Vec<PassTime>,
    /// The frames one by one, of a scene that moves.
    #[serde(default)]
    pub series: FrameSeries,
    /// Memory of the plan.
    pub memory: Memory,
    /// Values that the budget chose: `lights` of an equal-time study.
    pub chosen: BTreeMap<String, AxisValue>,
    /// Measured frames.
    pub frames: u32,
    /// Seconds that the cell took, all in all.
    pub seconds: f64,
    /// Pictures of the last frame.
    pub images: CellImages,
    /// What the reader of its figures must know, a sentence each: a budget that could not be met.
    #[serde(default)]
    pub notes: Vec<String>,
    /// Provenance, as in pictures: plan, flattened RON, shaders, scene, seed, adapter, version.
    pub provenance: String,
}

/// What was measured of each frame; empty of a scene that stands still, and of a single frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FrameSeries {
    /// Number of the first measured frame.
    pub first: u32,
    /// By [`MeasureInfo::key`], a value a frame: `[frames]`; `None` where there is none, as of a difference to the
    /// frame before in the first.
    pub values: BTreeMap<String, Vec<Option<f64>>>,
}

/// How a cell ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// Every measure was taken.
    Done,
    /// It failed; the others go on.
    Failed {
        /// What was wrong, for the user to read.
        error: String,
    },
}

/// GPU time of a pass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PassTime {
    /// Name of the pass.
    pub pass: String,
    /// Median over the measured frames \[ms\].
    pub gpu_ms: f64,
}

/// Bytes of a plan.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Memory {
    /// With memory of its own for each resource.
    pub unshared: u64,
    /// As it is.
    pub shared: u64,
    /// The largest sum alive at once.
    pub bound: u64,
    /// Of all objects that frames work on, histories too, the scene's apart.
    pub held: u64,
}

/// Pictures of a cell, relative to the study's folder; `None` where not wanted or not made.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CellImages {
    /// The judged output: EXR, linear.
    pub image: Option<String>,
    /// The ꟻLIP map beside the reference: PNG.
    pub flip: Option<String>,
    /// The reference by which it was judged: EXR. One scene has several where the frame's size varies.
    #[serde(default)]
    pub reference: Option<String>,
}
