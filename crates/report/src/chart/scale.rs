//! Maps values to positions along an axis, and chooses the ticks.

use crate::number::order;

/// An axis is logarithmic if the ratio between its greatest and smallest value is greater than this.
const DECADE: f64 = 10.0;

/// The range of values of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scale {
    /// From `low` to `high`, linearly.
    Linear { low: f64, high: f64 },
    /// From `low` > 0 to `high`, logarithmically. Values that are not above 0 are placed at the low end.
    Log { low: f64, high: f64 },
    /// Choices 0, 1, … `count` − 1, each in the middle of its band.
    Bands { count: usize },
}

/// A tick.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tick {
    pub(super) value: f64,
    /// `None` for a minor tick.
    pub(super) label: Option<Label>,
}

/// The label of a tick: `0.5`, or `2·10` with an exponent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Label {
    pub(super) text: String,
    pub(super) exponent: Option<i32>,
}

impl Scale {
    /// Returns a scale for finite values: logarithmic if they span more than a decade and none is negative.
    pub(super) fn fit(values: impl Iterator<Item = f64> + Clone) -> Scale {
        let finite = values.filter(|value| value.is_finite());
        let (low, high) = extent(finite.clone());
        if low > high {
            return Scale::Linear { low: 0.0, high: 1.0 };
        }
        let (least, _) = extent(finite.filter(|&value| value > 0.0));
        if low >= 0.0 && least < high && high / least > DECADE {
            let margin = (high / least).powf(0.05);
            return Scale::Log { low: least / margin, high: high * margin };
        }
        if low == high {
            let margin = if low == 0.0 { 1.0 } else { 0.2 * low.abs() };
            return Scale::Linear { low: (low - margin).min(0.0), high: (high + margin).max(0.0) };
        }
        let margin = 0.06 * (high - low);
        // A range begins at zero if it comes near zero.
        let from = if low >= 0.0 && low <= 0.6 * high { 0.0 } else { low - margin };
        Scale::Linear { low: from, high: high + margin }
    }

    /// Returns a linear scale from the least to the greatest of finite values.
    pub(super) fn across(values: impl Iterator<Item = f64>) -> Scale {
        let (low, high) = extent(values.filter(|value| value.is_finite()));
        if low > high {
            return Scale::Linear { low: 0.0, high: 1.0 };
        }
        let margin = if low == high { 1.0 } else { 0.02 * (high - low) };
        Scale::Linear { low: low - margin, high: high + margin }
    }

    /// Returns a linear scale from 0, for bars.
    pub(super) fn from_zero(high: f64) -> Scale {
        Scale::Linear { low: 0.0, high: if high > 0.0 && high.is_finite() { high } else { 1.0 } }
    }

    /// Returns the position of a value, 0..=1 for those within the range.
    pub(super) fn place(&self, value: f64) -> f64 {
        match *self {
            Scale::Linear { low, high } => (value - low) / (high - low),
            Scale::Log { low, .. } if value <= low => 0.0,
            Scale::Log { low, high } => (value / low).ln() / (high / low).ln(),
            Scale::Bands { count } => (value + 0.5) / count.max(1) as f64,
        }
    }

    /// Returns whether a value has its own position.
    pub(super) fn holds(&self, value: f64) -> bool {
        !matches!(self, Scale::Log { .. }) || value > 0.0
    }

    /// Returns the ticks in order, about `most` of them with labels. Bands have none.
    pub(super) fn ticks(&self, most: usize) -> Vec<Tick> {
        match *self {
            Scale::Linear { low, high } => linear_ticks(low, high, most.max(1)),
            Scale::Log { low, high } => log_ticks(low, high, most.max(1)),
            Scale::Bands { .. } => Vec::new(),
        }
    }
}

/// Returns multiples of 1, 2 or 5 times a power of ten.
fn linear_ticks(low: f64, high: f64, most: usize) -> Vec<Tick> {
    let rough = (high - low) / most as f64;
    let power = 10_f64.powi(order(rough));
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|s| *s >= rough * 0.999);
    let step = step.unwrap_or(10.0 * power);
    let (first, last) = ((low / step - 1e-9).ceil() as i64, (high / step + 1e-9).floor() as i64);
    let greatest = low.abs().max(high.abs());
    (first..=last)
        .map(|index| {
            let value = index as f64 * step;
            Tick { value, label: Some(Label::new(value, step, greatest)) }
        })
        .collect()
}

/// Returns powers of ten, and multiples of 2 and 5 if there are few of them. The other multiples are minor
/// ticks.
fn log_ticks(low: f64, high: f64, most: usize) -> Vec<Tick> {
    let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
    let inside = |value: f64| value >= low * 0.999 && value <= high * 1.001;
    let powers = (first..=last).filter(|&power| inside(10_f64.powi(power))).count();
    let every = powers.div_ceil(most).max(1) as i32;
    let labelled: &[u32] = match powers {
        0 | 1 => &[1, 2, 3, 5, 7],
        2 if most >= 6 => &[1, 2, 5],
        _ => &[1],
    };
    let multiples: u32 = if last - first <= 8 { 9 } else { 1 };
    let mut ticks = Vec::new();
    for power in first..=last {
        for multiple in 1..=multiples {
            // Small powers are computed by division: 3·10⁻¹ is 0.3 and not 0.30000000000000004.
            let decade = 10_f64.powi(power.abs());
            let value = if power < 0 { f64::from(multiple) / decade } else { f64::from(multiple) * decade };
            if inside(value) {
                let shown = labelled.contains(&multiple) && power.rem_euclid(every) == 0;
                let label = shown.then(|| Label::of_power(multiple, power, first < -3 || last > 4));
                ticks.push(Tick { value, label });
            }
        }
    }
    ticks
}

impl Label {
    /// Creates the label of a multiple of `step` on an axis whose values reach `greatest`.
    fn new(value: f64, step: f64, greatest: f64) -> Label {
        let power = order(greatest);
        if value != 0.0 && !(-3..6).contains(&power) {
            let places = (power - order(step)).clamp(0, 9) as usize;
            let scaled = value / 10_f64.powi(power);
            return Label { text: minus(format!("{scaled:.places$}·10")), exponent: Some(power) };
        }
        let places = if value == 0.0 { 0 } else { (-order(step * 1.000_1)).clamp(0, 9) as usize };
        Label { text: minus(format!("{value:.places$}")), exponent: None }
    }

    /// Creates a label with the number as given.
    pub(super) fn plain(text: &str) -> Label {
        Label { text: text.to_owned(), exponent: None }
    }

    fn of_power(multiple: u32, power: i32, as_power: bool) -> Label {
        if as_power {
            let text = if multiple == 1 { "10".to_owned() } else { format!("{multiple}·10") };
            return Label { text, exponent: Some(power) };
        }
        let places = (-power).max(0) as usize;
        Label { text: format!("{:.places$}", f64::from(multiple) * 10_f64.powi(power)), exponent: None }
    }
}

fn minus(text: String) -> String {
    text.replace('-', "−")
}

fn extent(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(ticks: &[Tick]) -> Vec<String> {
        let text = |label: &Label| match label.exponent {
            Some(exponent) => format!("{}^{exponent}", label.text),
            None => label.text.clone(),
        };
        ticks.iter().filter_map(|tick| tick.label.as_ref()).map(text).collect()
    }

    #[test]
    fn linear_ticks_are_round() {
        assert_eq!(labels(&linear_ticks(0.0, 1.0, 5)), ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(&linear_ticks(-3.0, 7.0, 4)), ["0", "5"]);
        assert_eq!(labels(&linear_ticks(12.1, 14.9, 6)), ["12.5", "13.0", "13.5", "14.0", "14.5"]);
        assert_eq!(labels(&linear_ticks(0.0, 4e-7, 4)), ["0", "1·10^-7", "2·10^-7", "3·10^-7", "4·10^-7"]);
        assert_eq!(labels(&linear_ticks(-0.02, 0.02, 4)), ["−0.02", "−0.01", "0", "0.01", "0.02"]);
    }

    #[test]
    fn log_ticks_are_decades_with_minor_ones_between() {
        let ticks = log_ticks(0.05, 200.0, 6);
        assert_eq!(labels(&ticks), ["0.1", "1", "10", "100"]);
        assert_eq!(ticks.first().map(|tick| tick.value), Some(0.05));
        assert_eq!(ticks.len(), 5 + 9 * 3 + 2);
        assert_eq!(labels(&log_ticks(0.9, 30.0, 6)), ["1", "2", "5", "10", "20"]);
        assert_eq!(labels(&log_ticks(1e-6, 1e-2, 6)), ["10^-6", "10^-5", "10^-4", "10^-3", "10^-2"]);
        assert_eq!(labels(&log_ticks(1e-12, 1.0, 5)).len(), 5);
    }

    #[test]
    fn more_than_a_decade_is_a_matter_of_ratios() {
        assert!(matches!(Scale::fit([1.0, 11.0].into_iter()), Scale::Log { .. }));
        assert!(matches!(Scale::fit([1.0, 9.0].into_iter()), Scale::Linear { low: 0.0, .. }));
        assert!(matches!(Scale::fit([-1.0, 1000.0].into_iter()), Scale::Linear { .. }));
        let zero = Scale::fit([0.0, 1.0, 100.0].into_iter());
        assert!(matches!(zero, Scale::Log { low, .. } if low > 0.5));
        assert_eq!((zero.place(0.0), zero.holds(0.0), zero.holds(1.0)), (0.0, false, true));
    }

    #[test]
    fn odd_values_have_an_axis() {
        assert_eq!(Scale::fit(std::iter::empty()), Scale::Linear { low: 0.0, high: 1.0 });
        assert_eq!(Scale::fit([f64::NAN, f64::INFINITY].into_iter()), Scale::Linear { low: 0.0, high: 1.0 });
        assert_eq!(Scale::fit([0.0].into_iter()), Scale::Linear { low: -1.0, high: 1.0 });
        for values in [[5.0, 5.0], [-5.0, -5.0], [0.0, 1e-300], [1e300, 1e301]] {
            let scale = Scale::fit(values.into_iter());
            let places = values.map(|value| scale.place(value));
            assert!(places.iter().all(|place| (0.0..=1.0).contains(place)), "{scale:?} {places:?}");
            assert!(scale.ticks(5).len() < 100, "{scale:?}");
        }
    }

    #[test]
    fn places_run_from_end_to_end() {
        let log = Scale::Log { low: 1.0, high: 100.0 };
        assert!((log.place(10.0) - 0.5).abs() < 1e-12);
        let linear = Scale::Linear { low: 2.0, high: 4.0 };
        assert_eq!((linear.place(2.0), linear.place(3.0), linear.place(4.0)), (0.0, 0.5, 1.0));
        assert_eq!(Scale::Bands { count: 2 }.place(1.0), 0.75);
    }
}
