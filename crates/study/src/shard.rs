//! The part of a study that a process runs.

use crate::cost::Costs;
use crate::error::StudyError;
use crate::plan::Plan;
use std::fmt;
use std::ops::Range;

/// The part of a study that a process runs. Its text is `2/8`, `cells:1-60/240` or `references:1-3/3`, where numbers count from 1;
/// `references` are all.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Shard {
    /// A part of all cells, cut by their expected cost: the runs of all parts must have the same costs.
    Part {
        /// The number of the part, from 1.
        part: u32,
        /// At least `part`.
        parts: u32,
    },
    /// Cells by their places in the study.
    Cells {
        /// The places.
        places: Range<usize>,
        /// The number of cells of the study.
        of: usize,
    },
    /// References by their places in the study, and no cell.
    References {
        /// The places and the number of references of the study; `None` for all.
        places: Option<(Range<usize>, usize)>,
    },
}

/// What a process is to run, as places in the plan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Work {
    pub(crate) cells: Range<usize>,
    /// References that are rendered though no cell of the process needs them.
    pub(crate) references: Range<usize>,
}

impl Shard {
    /// Returns what a shard runs of a plan.
    ///
    /// # Errors
    /// Where it names places of another plan.
    pub(crate) fn work(&self, plan: &Plan, costs: &Costs) -> Result<Work, StudyError> {
        let check = |what: &'static str, of: usize, found: usize| {
            let shard = self.to_string();
            if of == found { Ok(()) } else { Err(StudyError::Shard { shard, what, of, found }) }
        };
        Ok(match self {
            Shard::Part { part, parts } => {
                let cells = plan.parts(costs, *parts).swap_remove(*part as usize - 1);
                Work { cells, references: 0..0 }
            }
            Shard::Cells { places, of } => {
                check("cells", *of, plan.cells.len())?;
                Work { cells: places.clone(), references: 0..0 }
            }
            Shard::References { places } => {
                let found = plan.references.len();
                let (references, of) = places.clone().unwrap_or((0..found, found));
                check("references", of, found)?;
                Work { cells: 0..0, references }
            }
        })
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let places = |f: &mut fmt::Formatter<'_>, what: &str, places: &Range<usize>, of: usize| {
            write!(f, "{what}:{}-{}/{of}", places.start + 1, places.end)
        };
        match self {
            Shard::Part { part, parts } => write!(f, "{part}/{parts}"),
            Shard::Cells { places: range, of } => places(f, "cells", range, *of),
            Shard::References { places: Some((range, of)) } => places(f, "references", range, *of),
            Shard::References { places: None } => f.write_str("references"),
        }
    }
}

/// A text that names no shard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{0}` is not a shard: expected i/n with i from 1 to n, such as 2/8; `references`; or places as a Snakefile has them, such as cells:1-60/240"
)]
pub struct ShardError(String);

impl std::str::FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Shard, ShardError> {
        read(text).ok_or_else(|| ShardError(text.to_owned()))
    }
}

fn read(text: &str) -> Option<Shard> {
    if text == "references" {
        return Some(Shard::References { places: None });
    }
    let Some((what, places)) = text.split_once(':') else {
        let (part, parts) = text.split_once('/')?;
        let (part, parts) = (part.parse().ok()?, parts.parse().ok()?);
        return (1..=parts).contains(&part).then_some(Shard::Part { part, parts });
    };
    let (places, of) = places.split_once('/')?;
    let (first, last) = places.split_once('-')?;
    let (first, last, of): (usize, usize, usize) =
        (first.parse().ok()?, last.parse().ok()?, of.parse().ok()?);
    let places = (1 <= first && first <= last && last <= of).then(|| first - 1..last)?;
    match what {
        "cells" => Some(Shard::Cells { places, of }),
        "references" => Some(Shard::References { places: Some((places, of)) }),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_read_strictly() {
        let shards = [
            ("2/8", Shard::Part { part: 2, parts: 8 }),
            ("cells:1-60/240", Shard::Cells { places: 0..60, of: 240 }),
            ("references:3-3/3", Shard::References { places: Some((2..3, 3)) }),
            ("references", Shard::References { places: None }),
        ];
        for (text, shard) in shards {
            assert_eq!(text.parse(), Ok(shard.clone()));
            assert_eq!(shard.to_string(), text);
        }
        let wrong = [
            "0/2",
            "3/2",
            "1",
            "a/b",
            "1/0",
            "-1/2",
            "cells:0-2/3",
            "cells:3-2/3",
            "cells:1-4/3",
            "rows:1-1/1",
            "cells",
        ];
        for wrong in wrong {
            assert!(wrong.parse::<Shard>().unwrap_err().to_string().contains("i/n"), "{wrong}");
        }
    }
}
