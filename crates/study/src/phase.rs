//! GPU time of groups of passes.

use crate::description::Phase;
use crate::measure::Measure;
use crate::record::{Better, MeasureInfo};

impl Phase {
    /// Returns the key of its measure: `gpu-ms:NAME`.
    pub fn key(&self) -> String {
        format!("{}:{}", Measure::GpuMs.key(), self.name.value)
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
