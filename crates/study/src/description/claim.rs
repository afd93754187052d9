//! What a paper says of the measures of a study.

use super::At;
use crate::record::AxisValue;

/// Values of axes.
pub type Pins = Vec<(At<String>, At<AxisValue>)>;

/// A statement on the means of a measure, checked for each scene.
#[derive(Clone, Debug)]
pub struct Claim {
    /// Key of a measure or phase.
    pub measure: At<String>,
    /// What is to hold.
    pub relation: Relation,
    /// Values of axes: cells with others take no part.
    pub at: Pins,
    /// The scenes that it is about; empty for all.
    pub scenes: Vec<At<String>>,
    /// Where it is said; empty where nowhere.
    pub says: String,
}

/// What is to hold.
#[derive(Clone, Debug)]
pub enum Relation {
    /// Each mean is less than the next; at least two.
    Order(Vec<Pick>),
    /// One mean over another lies within bounds, of which there is at least one.
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
}

/// The cells of a pipeline that a claim is about.
#[derive(Clone, Debug)]
pub struct Pick {
    /// Name of the pipeline in the study.
    pub pipeline: At<String>,
    /// Values of axes, beside those of the claim.
    pub at: Pins,
}

impl Relation {
    /// Returns whose means are compared, in the order of the text.
    pub fn picks(&self) -> Vec<&Pick> {
        match self {
            Relation::Order(rising) => rising.iter().collect(),
            Relation::Ratio { of, to, .. } => vec![of, to],
        }
    }
}
