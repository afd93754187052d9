//! Keys: hashes of everything on which a cell or a reference depends.

use crate::description::{Phase, StudyFigure};
use crate::error::Failure;
use crate::laboratory::{Laboratory, RunRequest};
use crate::measure::{DEFINITIONS, Measure};
use crate::plan::{Origin, PlannedCell};
use crate::record::{Cell, StudyRecord};
use std::fmt;
use xxhash_rust::xxh3::{xxh3_64, xxh3_128};

/// A hash of everything that something depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Key(u128);

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}

/// Returns the key of several texts, each preceded by its length, so that different lists give different
/// keys.
fn of(parts: &[&str]) -> Key {
    let text: String = parts.iter().map(|part| format!("{}:{part}\n", part.len())).collect();
    Key(xxh3_128(text.as_bytes()))
}

pub(crate) const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The measurements that are taken in the frames of a cell.
pub(crate) struct Taken<'a> {
    pub(crate) measures: &'a [Measure],
    pub(crate) phases: &'a [Phase],
    pub(crate) figures: &'a [StudyFigure],
    /// Whether the values of single frames are stored.
    pub(crate) by_frame: bool,
}

impl Taken<'_> {
    /// Formats what is measured. What does not occur adds no text, so that keys of cells from before it
    /// existed stay valid.
    fn text(&self) -> String {
        let mut text = format!("{DEFINITIONS} {:?}", self.measures);
        for phase in self.phases {
            let passes: Vec<&str> = phase.passes.iter().map(|at| at.value.as_str()).collect();
            text += &format!(" {:?}: {passes:?}", phase.name.value);
        }
        for figure in self.figures {
            text += &format!(" {:?}: {}", figure.name.value, figure.of.value);
        }
        if self.by_frame {
            text += " by frame";
        }
        text
    }
}

/// Returns the content of a cell, whose pipeline has the name `pipeline` in the study: the key of the cell without the adapter
/// that runs it, which is the same on all machines. If the pipeline is broken, it depends on its error.
pub(crate) fn content(
    cell: &PlannedCell,
    pipeline: &str,
    identity: &str,
    taken: &Taken<'_>,
    reference: &str,
) -> String {
    let (request, search) = (cell.request.text(), format!("{:?}", cell.search));
    of(&[VERSION, pipeline, identity, &request, &search, &taken.text(), reference]).to_string()
}

/// Returns the content of a cell that is no picture.
pub(crate) fn of_case(study: &StudyRecord, cell: &Cell) -> String {
    let place = format!("{:?} {}", cell.axes, cell.seed);
    of(&[VERSION, &study.name, &study.source, &cell.scene, &cell.pipeline, &place]).to_string()
}

/// Returns the key of a cell of some content on an adapter: `CONTENT-ADAPTER`.
pub(crate) fn on_adapter(content: &str, adapter: &str) -> String {
    format!("{content}-{:016x}", xxh3_64(adapter.as_bytes()))
}

/// Returns the content in a key.
pub(crate) fn content_of(key: &str) -> &str {
    key.split_once('-').map_or(key, |(content, _)| content)
}

/// Returns the key of a reference, or why there is none. It has no adapter: one reference serves the cells of all.
pub(crate) fn of_reference(origin: &Origin, lab: &mut dyn Laboratory) -> Result<Key, Failure> {
    match origin {
        Origin::Picture(file) => {
            let bytes = std::fs::read(file)
                .map_err(|error| Failure::Read { file: file.clone(), source: error.into() })?;
            Ok(of(&[VERSION, "picture", file, &format!("{:032x}", xxh3_128(&bytes))]))
        }
        Origin::Run(requests) => {
            let mut parts = vec![VERSION.to_owned()];
            for request in requests {
                parts.push(identity(request, lab)?);
                parts.push(request.text());
            }
            Ok(of(&parts.iter().map(String::as_str).collect::<Vec<_>>()))
        }
    }
}

/// Returns the hash of plan, shaders and scene of a request.
pub(crate) fn identity(request: &RunRequest, lab: &mut dyn Laboratory) -> Result<String, Failure> {
    Ok(format!("{:032x}", lab.identity(request)?))
}

#[cfg(test)]
mod tests {
    use super::{Measure, Taken};
    use crate::external::External;
    use crate::laboratory::RunRequest;

    /// Keys of cells without phases and series are the same as those from before these existed.
    #[test]
    fn what_is_not_taken_leaves_no_trace() {
        let taken =
            Taken { measures: &[Measure::Rmse, Measure::Tid], phases: &[], figures: &[], by_frame: false };
        assert_eq!(taken.text(), "1 [Rmse, Tid]");
        assert_eq!(Taken { by_frame: true, ..taken }.text(), "1 [Rmse, Tid] by frame");
        let own = RunRequest::default();
        assert!(own.text().ends_with("stop_after_ms: None, until_done: false }"), "{}", own.text());
        let external = Some(External { command: "true {out}".to_owned(), limit: 9 });
        assert!(RunRequest { external, ..own }.text().contains("true {out}"));
    }
}
