//! Equal time: finds the integer value of a setting with which a frame takes a given number of milliseconds.

use frame_graph::{Setting, Value, ValueType};

/// Relative deviation from the budget at which a search has converged.
const TOLERANCE: f64 = 0.05;
const MOST_PROBES: usize = 8;
/// The largest factor by which a value is raised at once: one slow probe must not lead to a guess of a
/// million lights.
const LARGEST_STEP: f64 = 8.0;
/// Upper limit for settings without a maximum.
const LARGEST: i64 = 1 << 20;

/// The result of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Found {
    pub(crate) value: i64,
    pub(crate) ms: f64,
}

impl Found {
    /// Returns whether the cost is within 5 % of the budget.
    pub(crate) fn meets(&self, ms: f64) -> bool {
        (self.ms / ms - 1.0).abs() <= TOLERANCE
    }
}

/// The values that a setting may take, in ascending order: a range, or choices.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Domain {
    Range(i64, i64),
    Choices(Vec<i64>),
}

impl Domain {
    pub(crate) fn of(setting: &Setting) -> Domain {
        let whole = |value: &Value| match value {
            Value::U32(n) => Some(i64::from(*n)),
            Value::I32(n) => Some(i64::from(*n)),
            _ => None,
        };
        if !setting.one_of.is_empty() {
            let mut choices: Vec<i64> = setting.one_of.iter().filter_map(whole).collect();
            choices.sort_unstable();
            return Domain::Choices(choices);
        }
        let least = if setting.ty == ValueType::U32 { 0.0 } else { -(LARGEST as f64) };
        let (min, max) = (setting.min.unwrap_or(least), setting.max.unwrap_or(LARGEST as f64));
        Domain::Range(min.ceil() as i64, max.floor().min(LARGEST as f64) as i64)
    }

    /// Returns the first and last position.
    fn bounds(&self) -> (i64, i64) {
        match self {
            Domain::Range(min, max) => (*min, *max.max(min)),
            Domain::Choices(choices) => (0, choices.len() as i64 - 1),
        }
    }

    fn value(&self, place: i64) -> i64 {
        match self {
            Domain::Range(..) => place,
            Domain::Choices(choices) => choices[place as usize],
        }
    }

    fn place(&self, value: i64) -> i64 {
        match self {
            Domain::Range(min, max) => value.clamp(*min, *max.max(min)),
            Domain::Choices(choices) => choices.partition_point(|choice| *choice < value) as i64,
        }
    }
}

/// Searches for the value at which `cost` is nearest to `ms`, beginning at `start`. Each guess is that of the
/// secant through the two nearest probes, within the values that are not yet known to be too cheap or too
/// expensive; there are at most eight probes. `cost` must rise with the value, up to noise. A value that
/// cannot be run counts as too expensive.
///
/// # Errors
/// The error of `cost`, if no value can be run.
pub(crate) fn search<E>(
    domain: &Domain,
    start: i64,
    ms: f64,
    mut cost: impl FnMut(i64) -> Result<f64, E>,
) -> Result<Found, E> {
    let (min, max) = domain.bounds();
    let mut at = domain.place(start).clamp(min, max);
    // Sorted, the nearest first.
    let mut probes: Vec<(i64, f64)> = Vec::new();
    let mut between = Between { low: min, high: max };
    let mut refusal = None;
    for _ in 0..MOST_PROBES {
        let found = cost(domain.value(at)).map_err(|why| refusal = Some(why)).ok();
        if let Some(found) = found {
            probes.push((at, found));
            probes.sort_by(|a, b| (a.1 / ms).ln().abs().total_cmp(&(b.1 / ms).ln().abs()));
            if (Found { value: at, ms: found }).meets(ms) {
                break;
            }
        }
        match found {
            Some(found) if found < ms => between.low = between.low.max(at + 1),
            _ => between.high = between.high.min(at - 1),
        }
        if between.low > between.high {
            break;
        }
        at = match found {
            Some(_) => between.guess(&probes, ms),
            None => between.low.midpoint(between.high),
        };
    }
    let found = probes.first().map(|(at, ms)| Found { value: domain.value(*at), ms: *ms });
    found.ok_or_else(|| refusal.expect("a probe either has a cost or is refused"))
}

/// The positions that are not known to be too cheap or too expensive; never empty.
#[derive(Clone, Copy, Debug)]
struct Between {
    low: i64,
    high: i64,
}

impl Between {
    /// Returns the position at which the cost should be `ms`, by the two nearest probes.
    fn guess(self, probes: &[(i64, f64)], ms: f64) -> i64 {
        let guess = match probes {
            [(a, a_ms), (b, b_ms), ..] if (b_ms - a_ms) / (b - a) as f64 > 0.0 => {
                *a as f64 + (ms - a_ms) * (b - a) as f64 / (b_ms - a_ms)
            }
            // With one probe, the cost is taken to be at most proportional to the value.
            [(at, found)] => (*at).max(1) as f64 * ms / found,
            _ => self.low.midpoint(self.high) as f64,
        };
        let largest = probes.iter().map(|(at, _)| *at).max().unwrap_or(1).max(1) as f64 * LARGEST_STEP;
        (guess.min(largest).round() as i64).clamp(self.low, self.high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(domain: &Domain, start: i64, ms: f64, cost: impl Fn(i64) -> f64) -> (Found, usize) {
        let mut probes = 0;
        let found = search(domain, start, ms, |value| {
            probes += 1;
            Ok::<_, ()>(cost(value))
        });
        (found.unwrap(), probes)
    }

    #[test]
    fn an_affine_cost_is_met_in_a_few_probes() {
        let domain = Domain::Range(1, LARGEST);
        for ms in [12.0, 20.0, 100.0, 5000.0] {
            let (found, probes) = counted(&domain, 256, ms, |n| 10.0 + 0.02 * n as f64);
            assert!(found.meets(ms) && probes <= 6, "{ms}: {found:?} after {probes}");
        }
        // A quadratic one too.
        let (found, probes) = counted(&domain, 16, 400.0, |n| 1.0 + (n as f64 / 50.0).powi(2));
        assert!(found.meets(400.0) && probes <= MOST_PROBES, "{found:?} after {probes}");
    }

    #[test]
    fn what_cannot_be_met_gives_the_nearest() {
        let domain = Domain::Range(1, 512);
        let cost = |n: i64| 10.0 + 0.02 * n as f64;
        let (found, _) = counted(&domain, 256, 5.0, cost);
        assert_eq!((found.value, found.meets(5.0)), (1, false));
        let (found, _) = counted(&domain, 256, 50.0, cost);
        assert_eq!((found.value, found.meets(50.0)), (512, false));
        // Among choices, the nearer one: 3.2 is nearer to 5 than 12.8.
        let choices = Domain::Choices(vec![32, 64, 128, 256]);
        let (found, _) = counted(&choices, 256, 5.0, |n| (n * n) as f64 * 1e-3 * 0.78125);
        assert_eq!(found.value, 64);
    }

    #[test]
    fn values_that_cannot_run_are_too_dear() {
        let domain = Domain::Range(1, LARGEST);
        let run = |n: i64| if n > 600 { Err("out of memory".to_owned()) } else { Ok(n as f64 * 0.01) };
        let found = search(&domain, 100, 100.0, run).unwrap();
        assert!((400..=600).contains(&found.value), "{found:?}");
        let never = search(&domain, 100, 1.0, |_| Err("no device".to_owned()));
        assert_eq!(never, Err("no device".to_owned()));
    }
}
