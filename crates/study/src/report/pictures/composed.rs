//! The figures of papers: a reference, its crops by several methods, and the error under each.

use super::insets::Files;
use crate::MeasureInfo;
use crate::report::digest::{Digest, Row};
use report::{Composed, FigureColumn, Measured, Raster};

/// The greatest number of methods in a figure; there is another one for more.
const MOST_COLUMNS: usize = 6;

/// The figures of one reference, or of a scene without one.
pub(super) struct Figures<'a> {
    scene: &'a str,
    /// The measure that stands under each method: the first error of the study.
    measure: Option<&'a MeasureInfo>,
    /// The whole picture: the reference, or the first method's.
    pub(super) picture: Option<Raster>,
    reference: Option<Vec<Raster>>,
    columns: Vec<FigureColumn>,
}

impl<'a> Figures<'a> {
    pub(super) fn new(digest: &Digest<'a>, scene: &'a str) -> Figures<'a> {
        let measure = digest.measured().find(|measure| measure.is_error);
        Figures { scene, measure, picture: None, reference: None, columns: Vec::new() }
    }

    /// Adds crops: of the reference, or of a row with its pipeline and values.
    pub(super) fn add(&mut self, crops: Vec<Raster>, row: Option<([&str; 2], &Row<'_>)>) {
        let Some((names, row)) = row else {
            self.reference = Some(crops);
            return;
        };
        let error = self.measure.and_then(|measure| row.summary(&measure.key));
        let error = error.map(|error| Measured::new(error.mean, error.half));
        let value = error.map_or_else(Default::default, |error| (error.text(), error.latex()));
        self.columns.push(FigureColumn { crops, names: names.map(str::to_owned), value });
    }

    /// Adds the files of the figures.
    pub(super) fn write(self, digest: &Digest<'_>, files: &mut Files) {
        let Figures { scene, measure, picture: Some(picture), reference, columns } = self else { return };
        let has_reference = reference.is_some();
        // It stands first in each figure, above the name of what is measured.
        let first = reference.map(|crops| {
            let measured = measure.map_or_else(String::new, |measure| measure.label.clone());
            FigureColumn {
                crops,
                names: ["Reference".to_owned(), String::new()],
                value: (measured, String::new()),
            }
        });
        for columns in columns.chunks(MOST_COLUMNS) {
            let name = match (has_reference, columns) {
                (false, [column, ..]) => format!("{scene}, {}", column.names[0]),
                _ => scene.to_owned(),
            };
            let figure = Composed {
                picture: picture.clone(),
                name,
                crops: digest.results.study.crops.clone(),
                columns: first.iter().chain(columns).cloned().collect(),
            };
            let name = files.figure(&[scene, "figure"]);
            files.add(&name.replace(".pdf", ".tex"), figure.tex().into_bytes());
            files.add(&name, figure.pdf());
        }
    }
}
