//! Values frame by frame.

use crate::record::FrameSeries;
use std::collections::BTreeMap;

/// Collects values of the frames of a scene that moves.
#[derive(Debug, Default)]
pub(super) struct Series {
    values: BTreeMap<String, Vec<Option<f64>>>,
}

impl Series {
    /// Adds the value of measured frame number `index`; frames come in order.
    pub(super) fn put(&mut self, key: &str, index: usize, value: Option<f64>) {
        let column = self.values.entry(key.to_owned()).or_default();
        column.resize(index, None);
        column.push(value.filter(|value| value.is_finite()));
    }

    /// Returns the series of this many frames. Measures without any value are left out, and all of them for a
    /// single frame.
    pub(super) fn finish(mut self, first: u32, frames: u32) -> FrameSeries {
        self.values.retain(|_, column| frames > 1 && column.iter().any(Option::is_some));
        if self.values.is_empty() {
            return FrameSeries::default();
        }
        self.values.values_mut().for_each(|column| column.resize(frames as usize, None));
        FrameSeries { first, values: self.values }
    }
}

#[cfg(test)]
mod tests {
    use super::Series;
    use crate::record::FrameSeries;

    #[test]
    fn frames_without_a_value_keep_their_place() {
        let mut series = Series::default();
        for (key, index, value) in [
            ("tid", 1, Some(3.0)),
            ("rmse", 0, Some(1.0)),
            ("rmse", 2, Some(f64::NAN)),
            ("clamped-energy", 0, None),
        ] {
            series.put(key, index, value);
        }
        let found = series.finish(5, 4);
        assert_eq!(found.first, 5);
        let columns: Vec<(&str, &[Option<f64>])> =
            found.values.iter().map(|(key, column)| (key.as_str(), &column[..])).collect();
        assert_eq!(
            columns,
            [("rmse", &[Some(1.0), None, None, None][..]), ("tid", &[None, Some(3.0), None, None])]
        );
        let mut single = Series::default();
        single.put("rmse", 0, Some(1.0));
        assert_eq!(single.finish(5, 1), FrameSeries::default());
    }
}
