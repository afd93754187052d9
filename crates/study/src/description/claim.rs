//! The claims of a paper about the measures of a study.

use super::At;
use crate::record::AxisValue;

/// Values of axes, by name.
pub type Pins = Vec<(At<String>, At<AxisValue>)>;

/// A statement about the means of a measure, checked for each scene.
#[derive(Clone, Debug)]
pub struct Claim {
    /// Key of a measure or of a phase.
    pub measure: At<String>,
    /// The relation that should hold.
    pub relation: Relation,
    /// Values of axes: cells with other values are left out.
    pub at: Pins,
    /// The scenes that it is about; all if empty.
    pub scenes: Vec<At<String>>,
    /// Where the paper makes the claim; may be empty.
    pub says: String,
}

/// A relation between means.
#[derive(Clone, Debug)]
pub enum Relation {
    /// Each mean is less than the next; at least two means.
    Order(Vec<Pick>),
    /// The ratio of two means lies within bounds, of which there is at least one.
    Ratio {
        /// The numerator.
        of: Pick,
        /// The denominator.
        to: Pick,
        /// The least ratio.
        at_least: Option<f64>,
        /// The greatest ratio.
        at_most: Option<f64>,
    },
    /// The exponent with which a measure grows over an axis lies within bounds, of which there is at least one.
    Growth {
        /// Whose measure grows.
        of: Pick,
        /// The axis, or [`TRIANGLES`](super::TRIANGLES).
        over: At<String>,
        /// The least exponent.
        at_least: Option<f64>,
        /// The greatest exponent.
        at_most: Option<f64>,
    },
}

/// The cells of a pipeline that a claim is about.
#[derive(Clone, Debug)]
pub struct Pick {
    /// Name of the pipeline in the study.
    pub pipeline: At<String>,
    /// Values of axes, in addition to those of the claim.
    pub at: Pins,
}

impl Relation {
    /// Returns the picks that it is about, in the order of the text.
    pub fn picks(&self) -> Vec<&Pick> {
        match self {
            Relation::Order(rising) => rising.iter().collect(),
            Relation::Ratio { of, to, .. } => vec![of, to],
            Relation::Growth { of, .. } => vec![of],
        }
    }
}
