//! A study as its file says it.

mod claim;
mod consistency;
mod read;

use crate::measure::Measure;
use crate::record::AxisValue;
use frame_graph::{Diagnostics, Source, Span};
use std::sync::Arc;

pub use claim::{Claim, Pick, Pins, Relation};

/// A value and its place in the file.
#[derive(Clone, Debug)]
pub struct At<T> {
    /// The value.
    pub value: T,
    /// Where it stands.
    pub span: Span,
}

/// A study file.
#[derive(Clone, Debug)]
pub struct Study {
    /// The file.
    pub source: Arc<Source>,
    /// Name of the file, without its ending.
    pub name: String,
    /// What it shows, in a line.
    pub about: String,
    /// The paper's table or figure.
    pub paper: String,
    /// Scenes by name or path.
    pub scenes: Vec<At<String>>,
    /// The pipelines.
    pub pipelines: Pipelines,
    /// The output that is judged.
    pub output: At<String>,
    /// Size of frames \[px\].
    pub size: (u32, u32),
    /// Number of the first frame that runs, warm-up included.
    pub first_frame: u32,
    /// Number of the frame in which the light jumps, for the measure `lag`.
    pub jump: Option<At<u32>>,
    /// Values for all pipelines.
    pub set: Vec<Set>,
    /// What varies: the cells are the product of the groups.
    pub vary: Vec<Group>,
    /// How much each cell may spend.
    pub budget: Budget,
    /// Frames before those that are measured.
    pub warm_up: u32,
    /// The seeds.
    pub seeds: Vec<u32>,
    /// The measures, in order.
    pub measures: Vec<At<Measure>>,
    /// Passes whose GPU time is taken together, in order.
    pub phases: Vec<Phase>,
    /// What errors are measured against.
    pub reference: Reference,
    /// What the paper says of the measures, in order.
    pub claims: Vec<Claim>,
}

/// The pipelines of a study.
#[derive(Clone, Debug)]
pub enum Pipelines {
    /// These.
    These(Vec<Variant>),
    /// All that there are and that have the output, except these.
    All {
        /// Left out.
        except: Vec<At<String>>,
        /// Where it stands.
        span: Span,
    },
}

/// A pipeline with values of its own.
#[derive(Clone, Debug)]
pub struct Variant {
    /// As tables name it.
    pub name: At<String>,
    /// Name or path of the pipeline.
    pub pipeline: At<String>,
    /// Values that hold in all its cells.
    pub set: Vec<Set>,
}

/// Passes whose GPU time is taken together.
#[derive(Clone, Debug)]
pub struct Phase {
    /// As tables name it.
    pub name: At<String>,
    /// Passes; a sub-graph stands for all passes in it.
    pub passes: Vec<At<String>>,
}

/// A value for a parameter or a setting.
#[derive(Clone, Debug)]
pub struct Set {
    /// `parameter`, `part.parameter` or `pass.setting`.
    pub path: At<String>,
    /// The value.
    pub value: At<AxisValue>,
    /// Whether pipelines that have no such path go without it.
    pub optional: bool,
}

/// An axis.
#[derive(Clone, Debug)]
pub struct Vary {
    /// `parameter`, `part.parameter`, `pass.setting`, or `size`.
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
    /// So many measured frames.
    Frames(u32),
    /// So much GPU time.
    Time {
        /// \[ms\]; > 0.
        ms: f64,
        /// The whole number that is chosen so that a frame takes the time; without it, frames run until the time is
        /// spent.
        by: Option<At<String>>,
        /// Measured frames; without `by`, the most.
        frames: u32,
    },
    /// So many virtual lights.
    Lights {
        /// How many.
        count: At<u32>,
        /// The parameter that says so.
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
    /// Pictures: of every scene, or of each.
    Pictures(Vec<(Option<At<String>>, At<String>)>),
    /// A pipeline.
    Pipeline {
        /// Name or path.
        pipeline: At<String>,
        /// Its values.
        set: Vec<Set>,
        /// Axes whose values it takes from the cell; `seed` is one.
        follow: Vec<At<String>>,
        /// The most frames that it accumulates.
        frames: u32,
        /// Where it stands.
        span: Span,
    },
}

/// The axis that is the size of frames.
pub const SIZE: &str = "size";
/// The axis that a reference may follow beside those of the study.
pub const SEED: &str = "seed";

/// Reads a study. All errors of the file are reported at once.
///
/// # Errors
/// If the text is not RON, or not a study.
pub fn parse(source: Arc<Source>) -> Result<Study, Diagnostics> {
    read::read(source)
}

impl Budget {
    /// Returns the measured frames, at most.
    pub fn frames(&self) -> u32 {
        match self {
            Budget::Frames(frames) | Budget::Time { frames, .. } | Budget::Lights { frames, .. } => *frames,
        }
    }

    /// Returns what it sets in pipelines.
    pub fn by(&self) -> Option<&At<String>> {
        match self {
            Budget::Time { by, .. } => by.as_ref(),
            Budget::Lights { by, .. } => Some(by),
            Budget::Frames(_) => None,
        }
    }

    /// Writes it as a line to read.
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
    /// Returns its axes.
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

/// A size as the value of the axis [`SIZE`]: `640x480`.
pub(crate) fn size_value((width, height): (u32, u32)) -> AxisValue {
    AxisValue::Text(format!("{width}x{height}"))
}

/// The size that a value of the axis [`SIZE`] is.
pub(crate) fn size_of(value: &AxisValue) -> Option<(u32, u32)> {
    let AxisValue::Text(text) = value else { return None };
    let (width, height) = text.split_once('x')?;
    Some((width.parse().ok()?, height.parse().ok()?))
}
