//! Figures of passes as measures.

use crate::description::StudyFigure;
use crate::record::{Better, MeasureInfo};

impl StudyFigure {
    /// Returns the key of its measure: `figure:NAME`.
    pub fn key(&self) -> String {
        format!("figure:{}", self.name.value)
    }

    /// Returns its description for tables and charts.
    pub fn info(&self) -> MeasureInfo {
        MeasureInfo {
            key: self.key(),
            label: self.name.value.clone(),
            unit: String::new(),
            better: Better::Neither,
            doc: format!("The figure `{}`: the mean over the measured frames", self.of.value),
            is_error: false,
        }
    }
}
