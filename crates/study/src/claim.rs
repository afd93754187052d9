//! Checks whether the measurements of a study agree with the claims of its paper.

use crate::description::{Claim, Pick, Pins, Relation};
use crate::interval::Interval;
use crate::record::{AxisValue, Cell, ClaimRecord, Outcome, PickRecord, RelationRecord, Results};
use std::collections::BTreeMap;

/// The result of a claim for one scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding<'a> {
    /// The claim.
    pub claim: &'a ClaimRecord,
    /// The scene.
    pub scene: &'a str,
    /// Mean of the measure over the cells of each pick, in the order of [`RelationRecord::picks`]; `None` if
    /// no cell has the measure.
    pub means: Vec<Option<f64>>,
    /// Whether the claim holds; `None` if that was not measured.
    pub holds: Option<bool>,
}

impl Finding<'_> {
    /// Returns the ratio of the two means; `None` for an order, and if the denominator is not above 0.
    pub fn ratio(&self) -> Option<f64> {
        match (&self.claim.relation, self.means.as_slice()) {
            (RelationRecord::Ratio { .. }, [Some(of), Some(to)]) if *to > 0.0 => Some(of / to),
            _ => None,
        }
    }
}

impl Results {
    /// Returns the result of each claim for each scene that it is about, in the order of the study. Means are
    /// over all finished cells that have the measure.
    pub fn findings(&self) -> Vec<Finding<'_>> {
        let mut findings = Vec::new();
        for claim in &self.study.claims {
            let scenes = self.study.scenes.iter().map(|scene| scene.name.as_str());
            let about =
                scenes.filter(|name| claim.scenes.is_empty() || claim.scenes.iter().any(|s| s == name));
            findings.extend(about.map(|scene| self.finding(claim, scene)));
        }
        findings
    }

    fn finding<'a>(&'a self, claim: &'a ClaimRecord, scene: &'a str) -> Finding<'a> {
        let picks = claim.relation.picks();
        let means = picks.into_iter().map(|pick| self.mean(claim, pick, scene)).collect();
        let mut finding = Finding { claim, scene, means, holds: None };
        finding.holds = match &claim.relation {
            RelationRecord::Order(_) => {
                let means: Option<Vec<f64>> = finding.means.iter().copied().collect();
                means.map(|means| means.windows(2).all(|pair| pair[0] < pair[1]))
            }
            RelationRecord::Ratio { at_least, at_most, .. } => finding.ratio().map(|ratio| {
                at_least.is_none_or(|least| ratio >= least) && at_most.is_none_or(|most| ratio <= most)
            }),
        };
        finding
    }

    fn mean(&self, claim: &ClaimRecord, pick: &PickRecord, scene: &str) -> Option<f64> {
        let cells = self.cells.iter().filter(|cell| {
            cell.outcome == Outcome::Done
                && (cell.scene.as_str(), &cell.pipeline) == (scene, &pick.pipeline)
                && lies_at(cell, &claim.at)
                && lies_at(cell, &pick.at)
        });
        let values: Vec<f64> =
            cells.filter_map(|cell| cell.measures.get(&claim.measure).copied().flatten()).collect();
        Interval::of(&values).map(|interval| interval.mean)
    }
}

/// Returns whether a cell has these values; an axis that its pipeline does not have matches any value.
fn lies_at(cell: &Cell, at: &BTreeMap<String, AxisValue>) -> bool {
    at.iter().all(|(axis, value)| cell.axes.get(axis).is_none_or(|own| own == value))
}

impl RelationRecord {
    /// Returns the picks whose means are compared, in the order of the text.
    pub fn picks(&self) -> Vec<&PickRecord> {
        match self {
            RelationRecord::Order(rising) => rising.iter().collect(),
            RelationRecord::Ratio { of, to, .. } => vec![of, to],
        }
    }
}

impl Claim {
    /// Converts the claim to its form in the study's record.
    pub(crate) fn record(&self) -> ClaimRecord {
        let values =
            |at: &Pins| at.iter().map(|(axis, value)| (axis.value.clone(), value.value.clone())).collect();
        let pick = |pick: &Pick| PickRecord { pipeline: pick.pipeline.value.clone(), at: values(&pick.at) };
        let relation = match &self.relation {
            Relation::Order(rising) => RelationRecord::Order(rising.iter().map(pick).collect()),
            Relation::Ratio { of, to, at_least, at_most } => {
                RelationRecord::Ratio { of: pick(of), to: pick(to), at_least: *at_least, at_most: *at_most }
            }
        };
        ClaimRecord {
            measure: self.measure.value.clone(),
            relation,
            at: values(&self.at),
            scenes: self.scenes.iter().map(|at| at.value.clone()).collect(),
            says: self.says.clone(),
        }
    }
}
