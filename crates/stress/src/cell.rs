//! The result of one case by one pipeline.

use crate::case::Expect;
use crate::isolated::Details;
use crate::table::PLAIN;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;
use study::{End, Interval, Measure, Outcome};

/// Greatest difference of energy from the plain scene, where only units or the place differ.
const SAME: f64 = 0.05;

/// Allowed share of the path tracer's energy, over that share in the plain scene. Light that a pipeline leaves out or blurs
/// differs between scenes; a difference beyond this range is a defect.
pub(crate) const ALIKE: RangeInclusive<f64> = 0.5..=2.0;

/// The measure of the energy as a share of the expected one.
pub(crate) const SHARE: &str = "share";

/// Greatest light that counts as black, as a share of the mean of the plain scene.
const NOTHING: f64 = 1e-6;

/// The verdict on a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// As expected.
    Held,
    /// The program reported why it does not render this, and ended with its exit code for errors.
    Refused,
    /// The picture is finite, but has another energy than expected.
    Off,
    /// A long run that drifts, grows, slows down, or changes where nothing does.
    Unsteady,
    /// Values that are negative.
    Negative,
    /// Values that are NaN or infinite.
    NotFinite,
    /// It did not end in time, and was killed.
    TimedOut,
    /// It ended by a signal, a panic, or without a picture.
    Crashed,
}

impl Verdict {
    /// The word in tables.
    pub fn word(self) -> &'static str {
        match self {
            Verdict::Held => "held",
            Verdict::Refused => "refused",
            Verdict::Off => "off",
            Verdict::Unsteady => "unsteady",
            Verdict::Negative => "negative",
            Verdict::NotFinite => "not finite",
            Verdict::TimedOut => "timed out",
            Verdict::Crashed => "crashed",
        }
    }
}

/// One case by one pipeline.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cell {
    /// The pipeline.
    pub pipeline: String,
    /// The case.
    pub case: String,
    /// The verdict.
    pub verdict: Verdict,
    /// Mean of the indirect light \[W/(m² sr)\].
    pub mean: Option<f64>,
    /// That mean as a share of the expected one; if that is the path tracer's, over the same share in the plain scene.
    /// The mean over `seeds`, if there are any.
    pub energy: Option<f64>,
    /// The energy by further seeds, if that of the first was off from the path tracer's: without the first, which was chosen
    /// for being off.
    pub seeds: Option<Interval>,
    /// The energy of the first picture, if there are further seeds.
    pub first: Option<f64>,
    /// The energy by each seed that it is judged by.
    #[serde(skip)]
    pub by_seed: Vec<(u32, f64)>,
    /// The measure that is as expected within a range, if there is one.
    #[serde(skip)]
    pub expected: Option<(&'static str, RangeInclusive<f64>)>,
    /// relMSE to the picture of the path tracer.
    pub error: Option<f64>,
    /// What the run reported beside its picture.
    #[serde(flatten)]
    pub details: Details,
    /// The file of the picture, in the folder of the run.
    pub image: Option<String>,
    /// The first line of the error if the program failed; the unexpected findings of a long run.
    pub message: String,
    /// From the start of the program to its end \[s\].
    pub seconds: f64,
    /// The command that renders it again.
    pub command: String,
}

impl Cell {
    /// Returns whether this is a defect. A timeout is none, nor is a refusal, except of the plain scene.
    pub fn is_defect(&self) -> bool {
        match self.verdict {
            Verdict::Held | Verdict::TimedOut => false,
            Verdict::Refused => self.case == PLAIN,
            Verdict::Off | Verdict::Unsteady | Verdict::Negative | Verdict::NotFinite | Verdict::Crashed => {
                true
            }
        }
    }
}

/// Evaluates a case by what was measured of it, and of the plain scene by the same pipeline.
pub(crate) fn evaluate(
    (case, expect): (&str, Expect),
    found: &study::Cell,
    plain: Option<&study::Cell>,
    command: String,
) -> Cell {
    let measure = |cell: &study::Cell, measure: Measure| cell.measures.get(measure.key()).copied().flatten();
    let details: Option<Details> = serde_json::from_value(found.details.clone()).ok();
    let has_picture = details.is_some();
    let (mean, of_plain) =
        (measure(found, Measure::Mean), plain.and_then(|cell| measure(cell, Measure::Mean)));
    let darkness = NOTHING * of_plain.unwrap_or(1.0);
    let mut cell = Cell {
        pipeline: found.pipeline.clone(),
        case: case.to_owned(),
        verdict: Verdict::Held,
        mean,
        energy: None,
        seeds: None,
        first: None,
        by_seed: Vec::new(),
        expected: match expect {
            Expect::Plain(_) => Some((SHARE, 1.0 - SAME..=1.0 + SAME)),
            Expect::Truth => Some((SHARE, ALIKE)),
            Expect::Black => Some((Measure::Mean.key(), 0.0..=darkness)),
            _ => None,
        },
        error: measure(found, Measure::RelMse),
        details: details.unwrap_or_default(),
        image: found.images.image.clone(),
        message: match &found.outcome {
            Outcome::Done => String::new(),
            Outcome::Failed { error } => error.clone(),
        },
        seconds: found.seconds,
        command,
    };
    let mean = mean.unwrap_or(0.0);
    let is_near = has_picture
        && match expect {
            Expect::Plain(factor) => {
                cell.energy = of_plain.filter(|plain| *plain > 0.0).map(|plain| mean / (plain * factor));
                cell.energy.is_none_or(|energy| (energy - 1.0).abs() <= SAME)
            }
            Expect::Truth => {
                let share =
                    plain.and_then(|plain| measure(plain, Measure::Energy)).filter(|share| *share > 0.0);
                cell.energy = measure(found, Measure::Energy).map(|energy| energy / share.unwrap_or(1.0));
                // Without light in the reference there is no ratio.
                cell.energy.map_or(mean == 0.0, |energy| ALIKE.contains(&energy))
            }
            Expect::Black => mean <= darkness,
            Expect::Finite => true,
            Expect::Refused => false,
            Expect::Steady(_) => {
                cell.energy = cell.details.long.as_ref().map(|long| long.energy);
                cell.message = cell.details.long.as_ref().map_or_else(
                    || "the log has too few frames to evaluate".to_owned(),
                    |long| long.wrong.join("; "),
                );
                cell.message.is_empty()
            }
        };
    cell.by_seed = cell.energy.map(|energy| (found.seed, energy)).into_iter().collect();
    cell.verdict = match found.end {
        End::TimedOut if !has_picture => Verdict::TimedOut,
        End::Reported if !has_picture => Verdict::Refused,
        _ if !has_picture => Verdict::Crashed,
        _ if cell.details.not_finite > 0 => Verdict::NotFinite,
        _ if cell.details.negative > 0 => Verdict::Negative,
        _ if is_near => Verdict::Held,
        _ if matches!(expect, Expect::Steady(_)) => Verdict::Unsteady,
        _ => Verdict::Off,
    };
    cell
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::long::Steady;

    fn found(mean: f64, energy: Option<f64>, details: &Details) -> study::Cell {
        let measures = [("mean", Some(mean)), ("energy", energy)];
        study::Cell {
            measures: measures.map(|(key, value)| (key.to_owned(), value)).into(),
            details: serde_json::to_value(details).unwrap(),
            ..study::Cell::default()
        }
    }

    fn verdict(
        expect: Expect,
        (mean, energy): (f64, Option<f64>),
        plain: Option<&study::Cell>,
    ) -> (Verdict, Option<f64>) {
        let cell = found(mean, energy, &Details::default());
        let cell = evaluate(("case", expect), &cell, plain, String::new());
        (cell.verdict, cell.energy)
    }

    #[test]
    fn energy_is_compared_with_the_expectation() {
        // Half the truth in the plain scene.
        let plain = found(0.5, Some(0.5), &Details::default());
        let plain = Some(&plain);
        assert_eq!(verdict(Expect::Plain(4.0), (2.0, None), plain), (Verdict::Held, Some(1.0)));
        assert_eq!(verdict(Expect::Plain(4.0), (2.2, None), plain).0, Verdict::Off);
        assert_eq!(verdict(Expect::Truth, (1.0, Some(0.5)), plain), (Verdict::Held, Some(1.0)));
        assert_eq!(verdict(Expect::Truth, (2.5, Some(1.25)), plain).0, Verdict::Off);
        assert_eq!(verdict(Expect::Truth, (0.3, Some(0.15)), plain).0, Verdict::Off);
        assert_eq!(verdict(Expect::Truth, (0.0, None), plain).0, Verdict::Held, "both are black");
        assert_eq!(verdict(Expect::Truth, (0.1, None), plain).0, Verdict::Off);
        assert_eq!(verdict(Expect::Black, (0.0, None), plain).0, Verdict::Held);
        assert_eq!(verdict(Expect::Black, (0.01, None), plain).0, Verdict::Off);
        assert_eq!(verdict(Expect::Refused, (0.01, None), plain).0, Verdict::Off);
    }

    #[test]
    fn values_that_are_not_finite_or_negative_are_defects_whatever_is_expected() {
        let verdict = |not_finite, negative| {
            let details = Details { not_finite, negative, ..Details::default() };
            evaluate(("case", Expect::Finite), &found(3.0, None, &details), None, String::new()).verdict
        };
        assert_eq!(verdict(1, 0), Verdict::NotFinite);
        assert_eq!(verdict(1, 1), Verdict::NotFinite);
        assert_eq!(verdict(0, 1), Verdict::Negative);
        assert_eq!(verdict(0, 0), Verdict::Held);
    }

    #[test]
    fn how_the_process_ended_comes_first() {
        let of = |expect, case: &str, end| {
            let outcome = Outcome::Failed { error: "too large".to_owned() };
            let cell = study::Cell { outcome, end, ..study::Cell::default() };
            evaluate((case, expect), &cell, None, String::new())
        };
        let ended = |case, end| of(Expect::Finite, case, end);
        let refused = ended("case", End::Reported);
        assert_eq!((refused.verdict, refused.message.as_str()), (Verdict::Refused, "too large"));
        assert!(!refused.is_defect());
        assert!(ended(PLAIN, End::Reported).is_defect());
        assert_eq!(ended("case", End::Crashed).verdict, Verdict::Crashed);
        assert_eq!(ended("case", End::TimedOut).verdict, Verdict::TimedOut);
        let long = of(Expect::Steady(Steady::Still), "long-still", End::Crashed);
        assert_eq!((long.verdict, long.message.as_str()), (Verdict::Crashed, "too large"));
    }
}
