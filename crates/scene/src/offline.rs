//! Imports scenes of offline renderers as a [`Model`]: those of pbrt-v4 (`.pbrt`), and of Mitsuba 3 (`.xml`).
//!
//! What a material or a light of these renderers has no counterpart for is left out, or replaced by what is nearest, and noted
//! with its place. What is malformed is an error. `docs/scenes.md` has a table of both.

mod collector;
mod mitsuba;
mod obj;
mod paint;
mod pbrt;
mod ply;
mod report;
mod shapes;
mod sky;
mod spectrum;
mod spot;
mod surface;
mod triangles;
mod view;

use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use data_file::Span;

use crate::budget::Budget;
use crate::error::SceneError;
use crate::import::Imported;
use collector::Collector;
use report::Report;

/// The formats of offline renderers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// pbrt-v4.
    Pbrt,
    /// Mitsuba 3 in XML.
    Mitsuba,
}

/// Reads a scene, with the files that it names.
///
/// Its bytes in memory are counted in `budget`; its files are in its own folder or in `roots`.
pub(crate) fn import(
    path: &Path,
    format: Format,
    roots: &[PathBuf],
    budget: &Budget,
) -> Result<Imported, SceneError> {
    let mut report = Report::new(roots, budget);
    let source = report.first(path)?;
    let whole = Span { source: Arc::clone(&source), start: 0, end: 0 };
    let collector = Collector::new(report, format == Format::Pbrt);
    let collector = match format {
        Format::Pbrt => pbrt::read(source, collector),
        Format::Mitsuba => mitsuba::read(source, collector),
    }?;
    let (model, report) = collector.finish(&whole)?;
    Ok(Imported { model: Rc::new(model), files: report.files })
}
