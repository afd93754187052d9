//! The description of a study, as its file states it.

mod claim;
mod consistency;
mod read;

use crate::codes;
use crate::external::External;
use crate::laboratory::Registry;
use crate::measure::Measure;
use crate::plan::Plan;
use crate::record::AxisValue;
use data_file::codes::Code;
use data_file::grammar::Expected;
use data_file::{Diagnostic, Diagnostics, Source, Span};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::sync::Arc;

pub use claim::{Claim, Pick, Pins, Relation};

/// A value and its place in the file. Records hold the value alone; values are compared without their places.
#[derive(Clone, Debug)]
pub struct At<T> {
    /// The value.
    pub value: T,
    /// Its place in the file.
    pub span: Span,
}

impl<T> At<T> {
    /// Begins an error about the value.
    pub(crate) fn error(&self, code: &'static Code, message: impl Into<String>) -> Diagnostic {
        Diagnostic::new(code, message).label(self.span.clone(), "")
    }
}

impl At<String> {
    /// Begins the error that there is nothing of this name, with the nearest of `known`, which are called `what`.
    pub(crate) fn unknown<'a>(
        &self,
        code: &'static Code,
        message: impl Into<String>,
        what: &str,
        known: impl IntoIterator<Item = &'a str>,
    ) -> Diagnostic {
        self.error(code, message).suggest(what, &self.value, known)
    }
}

impl<T> From<T> for At<T> {
    /// Wraps a value that is in no file.
    fn from(value: T) -> At<T> {
        At { value, span: Span { source: Source::new("", ""), start: 0, end: 0 } }
    }
}

impl<T: PartialEq> PartialEq for At<T> {
    fn eq(&self, other: &At<T>) -> bool {
        self.value == other.value
    }
}

impl<T: Serialize> Serialize for At<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.value.serialize(serializer)
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for At<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<At<T>, D::Error> {
        T::deserialize(deserializer).map(At::from)
    }
}

/// A study file.
#[derive(Clone, Debug)]
pub struct Study {
    /// The file.
    pub source: Arc<Source>,
    /// Name of the file, without its ending.
    pub name: String,
    /// The title of its report; empty for its name.
    pub title: String,
    /// What it shows, in one line.
    pub about: String,
    /// The paper's table or figure.
    pub paper: String,
    /// Scenes by name or path.
    pub scenes: Vec<At<String>>,
    /// The pipelines.
    pub pipelines: Pipelines,
    /// The output that is measured.
    pub output: At<String>,
    /// Size of frames \[px\].
    pub size: (u32, u32),
    /// Number of the first frame that runs, warm-up included.
    pub first_frame: u32,
    /// Number of the frame in which the light changes suddenly, for the measure `lag`.
    pub jump: Option<At<u32>>,
    /// Values for all pipelines.
    pub set: Vec<Set>,
    /// The axes: the cells are the product of the groups.
    pub vary: Vec<Group>,
    /// How much each cell may spend.
    pub budget: Budget,
    /// Frames before those that are measured.
    pub warm_up: u32,
    /// The seeds.
    pub seeds: Vec<u32>,
    /// The measures, in order.
    pub measures: Vec<At<Measure>>,
    /// Groups of passes whose GPU times are added up, in order.
    pub phases: Vec<Phase>,
    /// Figures of passes that are measured, in order.
    pub figures: Vec<StudyFigure>,
    /// What errors are measured against.
    pub reference: Reference,
    /// The claims of the paper on the measures, in order.
    pub claims: Vec<Claim>,
    /// Parts of pictures that the report enlarges, in shares of the sides: left, top, width, height.
    pub crops: Vec<[f64; 4]>,
}

/// The pipelines of a study.
#[derive(Clone, Debug)]
pub enum Pipelines {
    /// The listed ones.
    These(Vec<Variant>),
    /// All pipelines that have the output, except these.
    All {
        /// The excluded ones.
        except: Vec<At<String>>,
        /// Its place in the file.
        span: Span,
    },
}

/// A pipeline with values of its own.
#[derive(Clone, Debug)]
pub struct Variant {
    /// The name in tables.
    pub name: At<String>,
    /// Name or path of the pipeline; of another renderer, its command.
    pub pipeline: At<String>,
    /// Values that hold in all its cells.
    pub set: Vec<Set>,
    /// The other renderer in place of a pipeline.
    pub external: Option<External>,
}

/// Passes whose GPU times are added up.
#[derive(Clone, Debug)]
pub struct Phase {
    /// The name in tables.
    pub name: At<String>,
    /// Names of passes; the name of a sub-graph stands for all passes in it.
    pub passes: Vec<At<String>>,
}

/// A figure of a pass, as a measure.
#[derive(Clone, Debug)]
pub struct StudyFigure {
    /// The name in tables.
    pub name: At<String>,
    /// `pass.port.figure`.
    pub of: At<String>,
}

/// A value for a parameter or a setting.
#[derive(Clone, Debug)]
pub struct Set {
    /// `parameter`, `sub-graph.parameter` or `pass.setting`.
    pub path: At<String>,
    /// The value.
    pub value: At<AxisValue>,
    /// Whether the value is left out for pipelines that have no such path.
    pub optional: bool,
}

/// An axis: a path and the values that it takes.
#[derive(Clone, Debug)]
pub struct Vary {
    /// `parameter`, `sub-graph.parameter`, `pass.setting`, or `size`.
    pub path: At<String>,
    /// The values, in order; at least one.
    pub values: Vec<At<AxisValue>>,
    /// Whether pipelines that have no such path run once, without it.
    pub optional: bool,
}

/// Axes that vary together.
#[derive(Clone, Debug)]
pub enum Group {
    /// Every combination.
    Grid(Vec<Vary>),
    /// The first values, the second values, and so on.
    Paired(Vec<Vary>),
}

/// How much each cell may spend.
#[derive(Clone, Debug)]
pub enum Budget {
    /// A number of measured frames.
    Frames(u32),
    /// An amount of GPU time.
    Time {
        /// \[ms\]; > 0.
        ms: f64,
        /// The integer setting that is chosen so that one frame takes `ms`; without it, frames run until `ms`
        /// are spent in all.
        by: Option<At<String>>,
        /// Number of measured frames; without `by`, the greatest number.
        frames: u32,
    },
    /// A number of virtual lights.
    Lights {
        /// How many.
        count: At<u32>,
        /// The parameter that sets the number of lights.
        by: At<String>,
        /// Measured frames.
        frames: u32,
    },
}

/// What errors are measured against.
#[derive(Clone, Debug)]
pub enum Reference {
    /// Nothing.
    None,
    /// Pictures: one for all scenes (`None`), or one for each named scene.
    Pictures(Vec<(Option<At<String>>, At<String>)>),
    /// A pipeline.
    Pipeline {
        /// Name or path.
        pipeline: At<String>,
        /// Its values.
        set: Vec<Set>,
        /// Axes whose values the reference takes from the cell; `seed` is one.
        follow: Vec<At<String>>,
        /// The greatest number of frames that it accumulates.
        frames: u32,
        /// Its place in the file.
        span: Span,
    },
}

/// The name of the axis that is the size of frames.
pub const SIZE: &str = "size";
/// The axis that a reference may follow besides those of the study.
pub const SEED: &str = "seed";
/// What a claim of growth may be over besides the axes of the study: the number of triangles of its scenes.
pub const TRIANGLES: &str = "triangles";

/// Returns which fields and forms may stand at a byte of a study file.
pub fn expected(text: &str, at: usize) -> Expected {
    read::expected(text, at)
}

/// Reads a study. All errors of the file are reported at once.
///
/// # Errors
/// If the text is not RON, or not a study.
pub fn parse(source: Arc<Source>) -> Result<Study, Diagnostics> {
    read::parse(source)
}

/// Reads a study as [`parse`] does. Where something is wrong in the text, the names of scenes, pipelines and values are
/// looked up all the same, so that a file with errors of both sorts has them at once.
///
/// # Errors
/// If the text is not RON, or not a study.
pub fn parse_with(source: Arc<Source>, registry: &dyn Registry) -> Result<Study, Diagnostics> {
    parse(Arc::clone(&source)).map_err(|mut errors| {
        let looked_up = read::parse_broken(&source).and_then(|study| Plan::new(study, registry).err());
        // What else is wrong may follow from what stands in for that which could not be read.
        let names = [&codes::SCENE, &codes::PIPELINE, &codes::PATH, &codes::OUTPUT].map(|code| code.code);
        let meets = |a: &Span, b: &Span| a.start < b.end.max(b.start + 1) && b.start < a.end.max(a.start + 1);
        let known: Vec<Span> =
            errors.0.iter().flat_map(|error| &error.labels).map(|label| label.span.clone()).collect();
        let is_written = |span: &Span| {
            Arc::ptr_eq(&span.source, &source) && source.text[span.start as usize..].starts_with('"')
        };
        let is_new = |error: &Diagnostic| {
            let mut spans = error.labels.iter().map(|label| &label.span);
            names.contains(&error.code)
                && spans.all(|span| is_written(span) && !known.iter().any(|other| meets(other, span)))
        };
        errors.0.extend(looked_up.into_iter().flat_map(|found| found.0).filter(is_new));
        Diagnostics::sorted(errors.0)
    })
}

impl Budget {
    /// Returns the number of measured frames, or its upper limit.
    pub fn frames(&self) -> u32 {
        match self {
            Budget::Frames(frames) | Budget::Time { frames, .. } | Budget::Lights { frames, .. } => *frames,
        }
    }

    /// Returns the path that the budget sets in pipelines.
    pub fn by(&self) -> Option<&At<String>> {
        match self {
            Budget::Time { by, .. } => by.as_ref(),
            Budget::Lights { by, .. } => Some(by),
            Budget::Frames(_) => None,
        }
    }

    /// Formats the budget as a line of text.
    pub fn line(&self) -> String {
        let plural =
            |frames: u32| if frames == 1 { "1 frame".to_owned() } else { format!("{frames} frames") };
        match self {
            Budget::Frames(frames) => plural(*frames),
            Budget::Time { ms, by: Some(by), frames } => {
                format!("{ms} ms a frame by `{}`, {}", by.value, plural(*frames))
            }
            Budget::Time { ms, by: None, .. } => format!("{ms} ms of frames"),
            Budget::Lights { count, by, frames } => {
                format!("{} {}, {}", count.value, by.value, plural(*frames))
            }
        }
    }
}

impl Group {
    /// Returns the axes of the group.
    pub fn axes(&self) -> &[Vary] {
        match self {
            Group::Grid(axes) | Group::Paired(axes) => axes,
        }
    }

    pub(crate) fn axes_mut(&mut self) -> &mut Vec<Vary> {
        match self {
            Group::Grid(axes) | Group::Paired(axes) => axes,
        }
    }
}

/// Converts a size to a value of the axis [`SIZE`]: `640x480`.
pub(crate) fn size_value((width, height): (u32, u32)) -> AxisValue {
    AxisValue::Text(format!("{width}x{height}"))
}

/// Returns the place of a value on an axis of numbers; that of a size is its number of pixels.
pub(crate) fn place_of(value: &AxisValue) -> Option<f64> {
    match value {
        AxisValue::Number(number) => Some(*number),
        _ => size_of(value).map(|(width, height)| f64::from(width) * f64::from(height)),
    }
}

/// Converts a value of the axis [`SIZE`] to a size.
pub(crate) fn size_of(value: &AxisValue) -> Option<(u32, u32)> {
    let AxisValue::Text(text) = value else { return None };
    let (width, height) = text.split_once('x')?;
    Some((width.parse().ok()?, height.parse().ok()?))
}
