//! The claims of a paper about the measures of a study.

use super::At;
use crate::record::AxisValue;
use serde::{Deserialize, Serialize};

/// Values of axes, by name.
pub type Pins = Vec<(At<String>, At<AxisValue>)>;

/// A statement about the means of a measure, checked for each scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Claim {
    /// Key of a measure or of a phase.
    pub measure: At<String>,
    /// The relation that should hold.
    pub relation: Relation,
    /// Values of axes: cells with other values are left out, but those without the axis count.
    #[serde(with = "pins")]
    pub at: Pins,
    /// The scenes that it is about, each checked separately, except where a growth is over their triangles; all if
    /// empty.
    pub scenes: Vec<At<String>>,
    /// Where the paper makes the claim; may be empty.
    pub says: String,
    /// Why it does not hold, where an experiment has shown it; may be empty.
    #[serde(default)]
    pub because: String,
}

/// A relation between means over cells, or of them to an axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
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
    /// A mean lies within bounds, of which there is at least one.
    Bound {
        /// Whose mean.
        of: Pick,
        /// The least mean.
        at_least: Option<f64>,
        /// The greatest mean.
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pick {
    /// Name of the pipeline in the study.
    pub pipeline: At<String>,
    /// Values of axes, in addition to those of the claim.
    #[serde(with = "pins")]
    pub at: Pins,
}

impl Claim {
    /// Creates a claim about a measure in one case, which nobody has published.
    pub fn new(measure: &str, relation: Relation, case: &str, says: &str) -> Claim {
        Claim {
            measure: measure.to_owned().into(),
            relation,
            at: Vec::new(),
            scenes: vec![case.to_owned().into()],
            says: says.to_owned(),
            because: String::new(),
        }
    }
}

impl Pick {
    /// Creates the pick of all cells of a pipeline.
    pub fn all(pipeline: &str) -> Pick {
        Pick { pipeline: pipeline.to_owned().into(), at: Vec::new() }
    }
}

impl Relation {
    /// Returns the picks that it is about, in the order of the text.
    pub fn picks(&self) -> Vec<&Pick> {
        match self {
            Relation::Order(rising) => rising.iter().collect(),
            Relation::Ratio { of, to, .. } => vec![of, to],
            Relation::Bound { of, .. } | Relation::Growth { of, .. } => vec![of],
        }
    }
}

/// Values of axes in records: a map.
mod pins {
    use super::{At, AxisValue, Pins};
    use serde::{Deserialize, Deserializer, Serialize, Serializer};
    use std::collections::BTreeMap;

    pub(super) fn serialize<S: Serializer>(pins: &Pins, serializer: S) -> Result<S::Ok, S::Error> {
        let map: BTreeMap<&str, &AxisValue> =
            pins.iter().map(|(axis, value)| (axis.value.as_str(), &value.value)).collect();
        map.serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Pins, D::Error> {
        let map = BTreeMap::<String, At<AxisValue>>::deserialize(deserializer)?;
        Ok(map.into_iter().map(|(axis, value)| (axis.into(), value)).collect())
    }
}
