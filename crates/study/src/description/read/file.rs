//! The types of a study file that serde reads.

use super::claims::ClaimFile;
use data_file::grammar::{Entries, Number, Spanned};
use serde::Deserialize;

pub(super) type Text = Spanned<String>;
pub(super) type Whole = Spanned<i128>;
pub(super) type Names = Spanned<Vec<Text>>;
pub(super) type Sets = Entries<Given<Spanned<ValueFile>>>;

#[derive(Deserialize)]
#[serde(rename = "Study")]
pub(super) struct StudyFile {
    pub(super) title: Option<String>,
    pub(super) about: Option<String>,
    pub(super) paper: Option<String>,
    pub(super) scenes: Names,
    pub(super) pipelines: Spanned<PipelinesFile>,
    pub(super) output: Option<Text>,
    pub(super) size: Option<SizeFile>,
    pub(super) first_frame: Option<Whole>,
    pub(super) jump: Option<Whole>,
    pub(super) set: Sets,
    pub(super) vary: Option<VaryFile>,
    pub(super) budget: Option<BudgetFile>,
    pub(super) warm_up: Option<Whole>,
    pub(super) seeds: Option<SeedsFile>,
    pub(super) measures: Names,
    pub(super) phases: Option<Spanned<Entries<Names>>>,
    pub(super) figures: Option<Spanned<Entries<FigureFile>>>,
    pub(super) reference: Option<Spanned<ReferenceFile>>,
    pub(super) claims: Option<Spanned<Vec<Spanned<ClaimFile>>>>,
    pub(super) crops: Option<Spanned<Vec<Spanned<Crop>>>>,
}

#[derive(Deserialize)]
#[serde(rename = "$shape")]
pub(super) enum PipelinesFile {
    List(Vec<VariantFile>),
    Other(All),
}

#[derive(Deserialize)]
#[serde(expecting = "a list of pipelines, or `All(except: […])`")]
pub(super) struct All {
    pub(super) except: Option<Names>,
}

#[derive(Deserialize)]
#[serde(rename = "$shape")]
pub(super) enum VariantFile {
    Text(Text),
    Other(NamedVariant),
}

#[derive(Deserialize)]
#[serde(
    expecting = "the name of a pipeline, `Variant(name: \"…\", pipeline: \"…\", set: {…})` or `External(name: \"…\", command: \"…\")`"
)]
pub(super) enum NamedVariant {
    Variant { name: Text, pipeline: Text, set: Sets },
    External { name: Text, command: Text, limit: Option<Whole> },
}

#[derive(Deserialize)]
#[serde(expecting = "a size in pixels: (width, height)")]
pub(super) struct SizeFile(pub(super) [Whole; 2]);

#[derive(Deserialize)]
#[serde(rename = "$shape", expecting = "a truth value, a finite number or text")]
pub(super) enum ValueFile {
    Bool(bool),
    Number(f64),
    Text(String),
    /// A size, where the axis is that.
    Tuple(Vec<Whole>),
}

/// A value, which may stand in `Optional(…)`.
#[derive(Deserialize)]
#[serde(rename = "$shape")]
pub(super) enum Given<T> {
    Form(Optional<T>),
    Other(T),
}

#[derive(Deserialize)]
pub(super) enum Optional<T> {
    Optional(T),
}

impl<T> Given<T> {
    /// Returns the value, and whether it is optional.
    pub(super) fn value(self) -> (T, bool) {
        match self {
            Given::Form(Optional::Optional(value)) => (value, true),
            Given::Other(value) => (value, false),
        }
    }
}

#[derive(Deserialize)]
#[serde(rename = "$shape")]
pub(super) enum VaryFile {
    List(Vec<GroupFile>),
    Other(GroupFile),
}

pub(super) type Axes = Spanned<Entries<Given<Spanned<Vec<Spanned<ValueFile>>>>>>;

#[derive(Deserialize)]
#[serde(expecting = "`Grid({ \"name\": [values] })`, `Paired({ \"name\": [values] })`, or a list of them")]
pub(super) enum GroupFile {
    Grid(Axes),
    Paired(Axes),
}

#[derive(Deserialize)]
#[serde(expecting = "`Frames(8)`, `Time(ms: 20.0, by: \"lights\")`, `Time(ms: 500.0)` or `Lights(1024)`")]
pub(super) enum BudgetFile {
    Frames(Whole),
    Time { ms: Spanned<Number>, by: Option<Text>, frames: Option<Whole> },
    Lights(LightsFile),
}

#[derive(Deserialize)]
#[serde(rename = "$shape")]
pub(super) enum LightsFile {
    Form(NamedLights),
    Other(Whole),
}

#[derive(Deserialize)]
pub(super) struct NamedLights {
    pub(super) count: Whole,
    pub(super) by: Option<Text>,
    pub(super) frames: Option<Whole>,
}

#[derive(Deserialize)]
#[serde(rename = "$shape")]
pub(super) enum SeedsFile {
    List(Spanned<Vec<Whole>>),
    Other(Whole),
}

#[derive(Deserialize)]
#[serde(
    expecting = "`Pipeline(pipeline: \"reference\", set: {…})`, `Picture(\"file.exr\")`, `Pictures({ \"scene\": \"file.exr\" })` or `None`"
)]
pub(super) enum ReferenceFile {
    Pipeline { pipeline: Text, set: Sets, follow: Option<Names>, frames: Option<Whole> },
    Picture(Text),
    Pictures(Entries<Text>),
}

#[derive(Deserialize)]
#[serde(expecting = "the name of a figure: \"pass.port.figure\"")]
pub(super) struct FigureFile(pub(super) Text);

#[derive(Deserialize)]
#[serde(expecting = "a part of the picture, in shares of its sides: (left, top, width, height)")]
pub(super) struct Crop(pub(super) [Number; 4]);
