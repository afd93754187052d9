//! The grammar of claims.

use super::{Checks, Text, ValueFile};
use crate::codes;
use crate::description::{Claim, Pick, Pins, Relation, SIZE};
use data_file::grammar::{Entries, Number, Spanned};
use data_file::{Diagnostic, Place};
use serde::Deserialize;

type PinsFile = Entries<Spanned<ValueFile>>;
type Bound = Option<Spanned<Number>>;

#[derive(Deserialize)]
#[serde(
    expecting = "`Order(measure: \"tid\", rising: [\"a\", \"b\"])`, `Ratio(measure: \"gpu-ms\", of: \"a\", to: \"b\", at_most: 0.5)`, `Bound(measure: \"gpu-ms\", of: \"a\", at_most: 20)` or `Growth(measure: \"gpu-ms\", of: \"a\", over: \"lights\", at_most: 1)`"
)]
pub(super) enum ClaimFile {
    Order {
        measure: Text,
        rising: Spanned<Vec<PickFile>>,
        at: PinsFile,
        scenes: Option<Spanned<Vec<Text>>>,
        says: Option<String>,
        because: Option<String>,
    },
    Ratio {
        measure: Text,
        of: PickFile,
        to: PickFile,
        at_least: Bound,
        at_most: Bound,
        at: PinsFile,
        scenes: Option<Spanned<Vec<Text>>>,
        says: Option<String>,
        because: Option<String>,
    },
    Bound {
        measure: Text,
        of: PickFile,
        at_least: Bound,
        at_most: Bound,
        at: PinsFile,
        scenes: Option<Spanned<Vec<Text>>>,
        says: Option<String>,
        because: Option<String>,
    },
    Growth {
        measure: Text,
        of: PickFile,
        over: Text,
        at_least: Bound,
        at_most: Bound,
        at: PinsFile,
        scenes: Option<Spanned<Vec<Text>>>,
        says: Option<String>,
        because: Option<String>,
    },
}

#[derive(Deserialize)]
#[serde(rename = "$shape", expecting = "the name of a pipeline, or `At(\"name\", { \"axis\": value })`")]
pub(super) enum PickFile {
    Text(Text),
    Other(PickAt),
}

#[derive(Deserialize)]
pub(super) enum PickAt {
    At(Text, PinsFile),
}

impl Checks<'_, '_> {
    pub(super) fn claims(&mut self, claims: Spanned<Vec<Spanned<ClaimFile>>>) -> Vec<Claim> {
        self.filled(&claims, "a list of claims");
        claims.value.into_iter().map(|claim| self.claim(claim)).collect()
    }

    fn claim(&mut self, file: Spanned<ClaimFile>) -> Claim {
        let place = self.reader.head(file.place);
        let (measure, relation, at, scenes, says, because) = match file.value {
            ClaimFile::Order { measure, rising, at, scenes, says, because } => {
                (measure, self.order(rising), at, scenes, says, because)
            }
            ClaimFile::Ratio { measure, of, to, at_least, at_most, at, scenes, says, because } => {
                let (of, to) = (self.pick(of), self.pick(to));
                let help = ("a ratio needs a bound", "add `at_most: 0.5` or `at_least: 2.0`");
                let (at_least, at_most) = self.bounds(at_least, at_most, place, help, Self::positive);
                (measure, Relation::Ratio { of, to, at_least, at_most }, at, scenes, says, because)
            }
            ClaimFile::Bound { measure, of, at_least, at_most, at, scenes, says, because } => {
                let of = self.pick(of);
                let help = ("a bound needs a number", "add `at_most: 20` or `at_least: 0.5`");
                let (at_least, at_most) = self.bounds(at_least, at_most, place, help, Self::finite);
                (measure, Relation::Bound { of, at_least, at_most }, at, scenes, says, because)
            }
            ClaimFile::Growth { measure, of, over, at_least, at_most, at, scenes, says, because } => {
                let (of, over) = (self.pick(of), self.at(over));
                let help = ("an exponent needs a bound", "add `at_most: 1.0` or `at_least: 0.5`");
                let (at_least, at_most) = self.bounds(at_least, at_most, place, help, Self::finite);
                (measure, Relation::Growth { of, over, at_least, at_most }, at, scenes, says, because)
            }
        };
        Claim {
            measure: self.at(measure),
            relation,
            at: self.pins(at),
            scenes: scenes.map(|names| self.names(names, "a scene")).unwrap_or_default(),
            says: says.unwrap_or_default(),
            because: because.unwrap_or_default(),
        }
    }

    fn order(&mut self, rising: Spanned<Vec<PickFile>>) -> Relation {
        self.filled(&rising, "a list: [the name of a pipeline, or `At(\"name\", { \"axis\": value })`, …]");
        if rising.len() == 1 {
            self.reader.error(&codes::CLAIM, rising.place, "an order is of two pipelines at least");
        }
        Relation::Order(rising.value.into_iter().map(|pick| self.pick(pick)).collect())
    }

    /// Returns the bounds, of which there must be one; `missing` is reported otherwise, with a note.
    fn bounds(
        &mut self,
        at_least: Bound,
        at_most: Bound,
        place: Place,
        (missing, note): (&str, &str),
        read: fn(&mut Self, Spanned<Number>) -> f64,
    ) -> (Option<f64>, Option<f64>) {
        let least = at_least.map(|bound| read(self, bound));
        let most = at_most.map(|bound| read(self, bound));
        match (least, most) {
            (None, None) => {
                let error = self.reader.at(&codes::CLAIM, place, missing);
                self.reader.report(error.note(note));
            }
            (Some(least), Some(most)) if least > most => {
                let message = format!("nothing is at least {least} and at most {most}");
                let mut error = Diagnostic::new(&codes::CLAIM, message);
                for bound in [at_most, at_least].into_iter().flatten() {
                    error = error.label(self.reader.span(bound.place), "");
                }
                self.reader.report(error);
            }
            _ => {}
        }
        (least, most)
    }

    /// Returns a number, which may be negative: measures fall as well.
    fn finite(&mut self, number: Spanned<Number>) -> f64 {
        if !number.as_f64().is_finite() {
            self.reader.wrong(number.place, "a finite number");
        }
        number.as_f64()
    }

    fn pick(&mut self, file: PickFile) -> Pick {
        match file {
            PickFile::Text(pipeline) => Pick { pipeline: self.at(pipeline), at: Vec::new() },
            PickFile::Other(PickAt::At(pipeline, at)) => {
                Pick { pipeline: self.at(pipeline), at: self.pins(at) }
            }
        }
    }

    /// Returns values of axes.
    fn pins(&mut self, pins: PinsFile) -> Pins {
        let pin = |(axis, value): (Text, _)| {
            let is_size = axis.value == SIZE;
            (self.at(axis), self.value(value, is_size))
        };
        pins.into_iter().map(pin).collect()
    }
}
