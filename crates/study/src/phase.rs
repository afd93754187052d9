//! GPU time of groups of passes.

use crate::description::Phase;
use crate::measure::Measure;
use crate::record::{Better, Cell, MeasureInfo};

/// Begins the keys of shares.
pub(crate) const SHARE: &str = "gpu-share:";

/// Returns the key of the GPU time of a phase.
fn time_key(phase: &str) -> String {
    format!("{}:{phase}", Measure::GpuMs.key())
}

impl Phase {
    /// Returns the key of its measure: `gpu-ms:NAME`.
    pub fn key(&self) -> String {
        time_key(&self.name.value)
    }

    /// Returns the key of its share in the GPU time of a frame, which claims may name: `gpu-share:NAME`.
    pub fn share_key(&self) -> String {
        format!("{SHARE}{}", self.name.value)
    }

    /// Returns whether a pass belongs to the phase.
    pub fn has(&self, pass: &str) -> bool {
        self.passes.iter().any(|at| names(&at.value, pass))
    }

    /// Returns its description for tables and charts.
    pub fn info(&self) -> MeasureInfo {
        let passes: Vec<String> = self.passes.iter().map(|at| format!("`{}`", at.value)).collect();
        MeasureInfo {
            key: self.key(),
            label: self.name.value.clone(),
            unit: "ms".to_owned(),
            better: Better::Lower,
            doc: format!(
                "GPU time of {} in a frame, summed: the median over the measured frames. Where a budget of time is \
                 spent over frames, the sum of all of them",
                passes.join(", ")
            ),
            is_error: false,
        }
    }
}

impl Cell {
    /// Returns its value of a measure or, of `gpu-share:NAME`, the share of a phase in the GPU time of a frame. `None` if it has
    /// none.
    pub fn measure(&self, key: &str) -> Option<f64> {
        let value = |key: &str| self.measures.get(key).copied().flatten();
        match key.strip_prefix(SHARE) {
            Some(phase) => {
                let whole = value(Measure::GpuMs.key()).filter(|ms| *ms > 0.0)?;
                Some(value(&time_key(phase))? / whole)
            }
            None => value(key),
        }
    }
}

/// Returns the description of a measure among these, or of the share of a phase among them.
pub(crate) fn info_of(measures: &[MeasureInfo], key: &str) -> Option<MeasureInfo> {
    let find = |key: &str| measures.iter().find(|info| info.key == key).cloned();
    match key.strip_prefix(SHARE) {
        Some(phase) => {
            let time = find(&time_key(phase))?;
            Some(MeasureInfo {
                key: key.to_owned(),
                label: format!("share of {phase}"),
                unit: String::new(),
                ..time
            })
        }
        None => find(key),
    }
}

/// Returns whether `name`, of a pass or a sub-graph, stands for a pass.
pub(crate) fn names(name: &str, pass: &str) -> bool {
    pass.strip_prefix(name).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

/// Returns all names that stand for some of these passes: those of sub-graphs, and of the passes themselves.
pub(crate) fn all_names<'a>(passes: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    let mut found = Vec::new();
    for pass in passes {
        let ends = pass.match_indices('/').map(|(at, _)| at).chain([pass.len()]);
        for name in ends.map(|end| &pass[..end]) {
            if !found.contains(&name) {
                found.push(name);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_stands_for_all_passes_in_it() {
        assert!(names("shadows", "shadows/splat") && names("shadows", "shadows"));
        assert!(names("shadows/splat", "shadows/splat") && !names("shadows/splat", "shadows"));
        // A name that only shares a prefix is a different one.
        assert!(!names("shadow", "shadows/splat") && !names("shadows", "shadows2"));
        assert_eq!(
            all_names(["view", "shadows/a/points", "shadows/splat"]),
            ["view", "shadows", "shadows/a", "shadows/a/points", "shadows/splat"]
        );
    }
}
