//! Keys: hashes of all that a cell or a reference depends on.

use crate::description::Phase;
use crate::laboratory::{Laboratory, RunRequest};
use crate::measure::{DEFINITIONS, Measure};
use crate::plan::{Made, PlannedCell};
use std::fmt;
use xxhash_rust::xxh3::xxh3_128;

/// A hash of everything that something depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Key(u128);

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

/// The key of parts: each with its length before it, so that no two lists of parts read alike.
fn of(parts: &[&str]) -> Key {
    let text: String = parts.iter().map(|part| format!("{}:{part}\n", part.len())).collect();
    Key(xxh3_128(text.as_bytes()))
}

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// What is taken of the frames of a cell.
pub(crate) struct Taken<'a> {
    pub(crate) measures: &'a [Measure],
    pub(crate) phases: &'a [Phase],
    /// Whether values are kept frame by frame.
    pub(crate) by_frame: bool,
}

impl Taken<'_> {
    /// What does not occur leaves no trace: cells from before it could be taken stay valid without it.
    fn text(&self) -> String {
        let mut text = format!("{DEFINITIONS} {:?}", self.measures);
        for phase in self.phases {
            let passes: Vec<&str> = phase.passes.iter().map(|at| at.value.as_str()).collect();
            text += &format!(" {:?}: {passes:?}", phase.name.value);
        }
        if self.by_frame {
            text += " by frame";
        }
        text
    }
}

/// The key of a cell, whose pipeline has that name in the study. Where the pipeline cannot be made, that is what the
/// cell depends on.
pub(crate) fn of_cell(
    cell: &PlannedCell,
    pipeline: &str,
    taken: &Taken<'_>,
    reference: &str,
    lab: &mut dyn Laboratory,
) -> Key {
    let identity = identity(&cell.request, lab).unwrap_or_else(|why| format!("none: {why}"));
    // What a request is written as in Debug is all its fields.
    let (request, search) = (format!("{:?}", cell.request), format!("{:?}", cell.search));
    of(&[VERSION, &lab.adapter(), pipeline, &identity, &request, &search, &taken.text(), reference])
}

/// The key of a reference, or why it cannot be made.
pub(crate) fn of_reference(made: &Made, lab: &mut dyn Laboratory) -> Result<Key, String> {
    match made {
        Made::Picture(file) => {
            let bytes = std::fs::read(file).map_err(|error| format!("{file}: {error}"))?;
            Ok(of(&[VERSION, "picture", file, &format!("{:032x}", xxh3_128(&bytes))]))
        }
        Made::Run(requests) => {
            let mut parts = vec![VERSION.to_owned(), lab.adapter()];
            for request in requests {
                parts.push(identity(request, lab)?);
                parts.push(format!("{request:?}"));
            }
            Ok(of(&parts.iter().map(String::as_str).collect::<Vec<_>>()))
        }
    }
}

fn identity(request: &RunRequest, lab: &mut dyn Laboratory) -> Result<String, String> {
    Ok(format!("{:032x}", lab.identity(request)?.hash))
}

#[cfg(test)]
mod tests {
    use super::{Measure, Taken};

    /// Keys of cells without phases and series are those from before there were any.
    #[test]
    fn what_is_not_taken_leaves_no_trace() {
        let taken = Taken { measures: &[Measure::Rmse, Measure::Tid], phases: &[], by_frame: false };
        assert_eq!(taken.text(), "1 [Rmse, Tid]");
        assert_eq!(Taken { by_frame: true, ..taken }.text(), "1 [Rmse, Tid] by frame");
    }
}
