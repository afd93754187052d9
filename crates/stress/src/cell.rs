//! The result of one case by one pipeline.

use crate::case::Expect;
use crate::child::{Ended, Guard, Ran};
use crate::long::{self, Line, Long, Seen};
use crate::seeds::Seeds;
use crate::shown::Shown;
use crate::table::PLAIN;
use metrics::{Epsilon, Glance, Image, Pair};
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// Greatest difference of energy from the plain scene, where only units or the place differ.
const SAME: f64 = 0.05;

/// Allowed share of the path tracer's energy, over that share in the plain scene. Light that a pipeline leaves out or blurs
/// differs between scenes; a difference beyond this range is a defect.
pub(crate) const ALIKE: RangeInclusive<f64> = 0.5..=2.0;

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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// The pipeline.
    pub pipeline: String,
    /// The case.
    pub case: String,
    /// The verdict.
    pub verdict: Verdict,
    /// Mean luminance of the indirect light \[W/(m² sr)\], over its finite pixels.
    pub mean: Option<f64>,
    /// That mean as a share of the expected one; if that is the path tracer's, over the same share in the plain scene.
    /// The mean over `seeds`, if there are any.
    pub energy: Option<f64>,
    /// Further seeds, if the energy of the first was off from the path tracer's.
    #[serde(default)]
    pub seeds: Option<Seeds>,
    /// relMSE to the expected picture.
    pub error: Option<f64>,
    /// Number of pixels with a value that is not finite.
    pub not_finite: usize,
    /// Number of pixels with a negative value.
    pub negative: usize,
    /// Guards that acted.
    pub guards: Vec<Guard>,
    /// The result of a long run.
    pub long: Option<Long>,
    /// The rendered and the expected picture of a defect.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pictures: Vec<Shown>,
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

/// A picture with its mean and counts.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// The picture.
    pub image: Image,
    /// Mean and counts.
    pub glance: Glance,
}

impl Picture {
    /// Measures a picture.
    pub fn new(image: Image) -> Picture {
        Picture { glance: image.glance(), image }
    }

    /// Returns the picture times a factor.
    fn times(&self, factor: f64) -> Image {
        let mut image = self.image.clone();
        for pixel in image.pixels_mut() {
            pixel[..3].iter_mut().for_each(|x| *x = (f64::from(*x) * factor) as f32);
        }
        image
    }
}

/// Pictures with which a case is compared.
#[derive(Clone, Copy, Debug, Default)]
pub struct Known<'a> {
    /// The plain scene by the same pipeline.
    pub plain: Option<&'a Picture>,
    /// The plain scene by the path tracer.
    pub plain_truth: Option<&'a Picture>,
    /// The case by the path tracer.
    pub truth: Option<&'a Picture>,
    /// The frames of a long run.
    pub lines: &'a [Line],
}

/// Evaluates a case: how the program ended, the indirect light and the whole picture that it wrote, and the known pictures.
pub fn evaluate(
    (pipeline, case, expect): (&str, &str, Expect),
    ran: &Ran,
    pictures: Option<(&Picture, &Picture)>,
    known: Known<'_>,
) -> Cell {
    let mut cell = Cell {
        pipeline: pipeline.to_owned(),
        case: case.to_owned(),
        verdict: Verdict::Crashed,
        mean: None,
        energy: None,
        seeds: None,
        error: None,
        not_finite: 0,
        negative: 0,
        guards: ran.guards(),
        long: None,
        pictures: Vec::new(),
        message: ran.message(),
        seconds: ran.seconds,
        command: ran.command.clone(),
    };
    let is_written = |(indirect, whole): &(&Picture, &Picture)| {
        ran.ended == Ended::Exit(0)
            || (ran.ended == Ended::Exit(1) && indirect.glance.not_finite + whole.glance.not_finite > 0)
    };
    let Some((indirect, whole)) = pictures.filter(is_written) else {
        cell.verdict = match ran.ended {
            Ended::TimedOut => Verdict::TimedOut,
            // A reported error contains the word; a panic does not.
            Ended::Exit(1) if ran.errors.contains("error") && !ran.errors.contains("panicked") => {
                Verdict::Refused
            }
            _ => Verdict::Crashed,
        };
        return cell;
    };
    cell.mean = Some(indirect.glance.mean);
    cell.not_finite = indirect.glance.not_finite.max(whole.glance.not_finite);
    cell.negative = indirect.glance.negative.max(whole.glance.negative);
    let measure = |expected: &Image| {
        let pair = Pair::new(&indirect.image, expected).ok();
        pair.and_then(|pair| pair.rel_mse(Epsilon::default()))
    };
    let share = |of: &Picture, mean: f64| (mean > 0.0).then(|| of.glance.mean / mean);
    let near = match expect {
        Expect::Plain(factor) => {
            cell.energy = known.plain.and_then(|plain| share(indirect, plain.glance.mean * factor));
            cell.error = known.plain.and_then(|plain| measure(&plain.times(factor)));
            cell.energy.is_none_or(|energy| (energy - 1.0).abs() <= SAME)
        }
        Expect::Truth => {
            cell.energy = known.truth.and_then(|truth| {
                let plain = known.plain.zip(known.plain_truth).and_then(|(p, t)| share(p, t.glance.mean));
                Some(share(indirect, truth.glance.mean)? / plain.unwrap_or(1.0))
            });
            cell.error = known.truth.and_then(|truth| measure(&truth.image));
            // Without light in the reference there is no ratio.
            match known.truth.map_or(0.0, |truth| truth.glance.mean) {
                0.0 => indirect.glance.mean == 0.0,
                _ => cell.energy.is_some_and(|energy| ALIKE.contains(&energy)),
            }
        }
        Expect::Black => indirect.glance.mean <= NOTHING * known.plain.map_or(1.0, |plain| plain.glance.mean),
        Expect::Finite => true,
        Expect::Refused => false,
        Expect::Steady(steady) => {
            let most = |of: fn(&Seen) -> usize| {
                let of_line = |line: &Line| of(&line.outputs.indirect).max(of(&line.outputs.image));
                known.lines.iter().map(of_line).max().unwrap_or(0)
            };
            cell.not_finite = cell.not_finite.max(most(|seen| seen.glance.not_finite));
            cell.negative = cell.negative.max(most(|seen| seen.glance.negative));
            cell.long = long::evaluate(steady, known.lines);
            cell.energy = cell.long.as_ref().map(|long| long.energy);
            cell.message = cell.long.as_ref().map_or_else(
                || format!("the log has {} frames, too few to evaluate", known.lines.len()),
                |long| long.wrong.join("; "),
            );
            cell.message.is_empty()
        }
    };
    cell.verdict = if cell.not_finite > 0 {
        Verdict::NotFinite
    } else if cell.negative > 0 {
        Verdict::Negative
    } else if near {
        Verdict::Held
    } else if matches!(expect, Expect::Steady(_)) {
        Verdict::Unsteady
    } else {
        Verdict::Off
    };
    cell
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(value: f32) -> Picture {
        Picture::new(Image::from_fn(4, 4, |_, _| [value, value, value, 1.0]).unwrap())
    }

    fn ran(ended: Ended, errors: &str) -> Ran {
        Ran {
            ended,
            output: String::new(),
            errors: errors.to_owned(),
            seconds: 0.1,
            command: "lightloom render".to_owned(),
        }
    }

    fn verdict(expect: Expect, value: f32, known: Known<'_>) -> (Verdict, Option<f64>) {
        let picture = picture(value);
        let cell =
            evaluate(("ism", "case", expect), &ran(Ended::Exit(0), ""), Some((&picture, &picture)), known);
        (cell.verdict, cell.energy)
    }

    #[test]
    fn energy_is_compared_with_the_expectation() {
        let [half, one, two] = [0.5, 1.0, 2.0].map(picture);
        let plain =
            Known { plain: Some(&half), plain_truth: Some(&one), truth: Some(&two), ..Known::default() };
        assert_eq!(verdict(Expect::Plain(4.0), 2.0, plain), (Verdict::Held, Some(1.0)));
        assert_eq!(verdict(Expect::Plain(4.0), 2.2, plain).0, Verdict::Off);
        // Half the truth in the plain scene, and half of it here.
        assert_eq!(verdict(Expect::Truth, 1.0, plain), (Verdict::Held, Some(1.0)));
        assert_eq!(verdict(Expect::Truth, 2.5, plain).0, Verdict::Off);
        assert_eq!(verdict(Expect::Truth, 0.3, plain).0, Verdict::Off);
        assert_eq!(verdict(Expect::Black, 0.0, plain).0, Verdict::Held);
        assert_eq!(verdict(Expect::Black, 0.01, plain).0, Verdict::Off);
        assert_eq!(verdict(Expect::Refused, 0.01, plain).0, Verdict::Off);
    }

    #[test]
    fn values_that_are_not_finite_or_negative_are_defects_whatever_is_expected() {
        let known = Known::default();
        assert_eq!(verdict(Expect::Finite, f32::NAN, known).0, Verdict::NotFinite);
        assert_eq!(verdict(Expect::Finite, f32::INFINITY, known).0, Verdict::NotFinite);
        assert_eq!(verdict(Expect::Finite, -1e-9, known).0, Verdict::Negative);
        assert_eq!(verdict(Expect::Finite, 3.0, known).0, Verdict::Held);
    }

    #[test]
    fn how_the_program_ended_comes_first() {
        let end = |ended, errors| {
            evaluate(("ism", "case", Expect::Finite), &ran(ended, errors), None, Known::default())
        };
        assert_eq!(end(Ended::Exit(1), "error: too large\n").verdict, Verdict::Refused);
        assert_eq!(end(Ended::Exit(1), "error: too large\n").message, "error: too large");
        assert!(!end(Ended::Exit(1), "error: too large\n").is_defect());
        let plain =
            evaluate(("ism", PLAIN, Expect::Truth), &ran(Ended::Exit(1), "error"), None, Known::default());
        assert!(plain.is_defect(), "{plain:?}");
        assert_eq!(end(Ended::Exit(101), "thread 'main' panicked at src/main.rs").verdict, Verdict::Crashed);
        assert_eq!(end(Ended::Signal(6), "").verdict, Verdict::Crashed);
        assert_eq!(end(Ended::TimedOut, "").verdict, Verdict::TimedOut);
        assert_eq!(end(Ended::Exit(0), "").verdict, Verdict::Crashed, "no picture");
    }
}
