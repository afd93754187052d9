//! Measures that need the pictures of all seeds: bias² and variance.

use crate::error::StudyError;
use crate::measure::Measure;
use crate::record::{Cell, Outcome, Results};
use metrics::Image;
use metrics::seeds::Decomposition;
use std::path::Path;

/// Adds bias² and variance to the finished cells of each group of seeds: to each its jackknife pseudo-value, so
/// that means, intervals and differences seed by seed are formed as those of other measures.
pub(crate) fn add(results: &mut Results, folder: &Path) -> Result<(), StudyError> {
    let wanted: Vec<Measure> = [Measure::Bias2, Measure::Variance]
        .into_iter()
        .filter(|measure| results.study.measures.iter().any(|info| info.key == measure.key()))
        .collect();
    if wanted.is_empty() {
        return Ok(());
    }
    for group in groups(&results.cells) {
        let rendered = |index: &usize| {
            let cell = &results.cells[*index];
            cell.outcome == Outcome::Done && cell.images.image.is_some()
        };
        let done: Vec<usize> = group.iter().copied().filter(rendered).collect();
        let found = decompose(&results.cells, &done, folder)?;
        for index in group {
            let place = done.iter().position(|other| *other == index);
            let own = place.and_then(|place| found.as_ref()?.by_seed.get(place));
            for measure in &wanted {
                let value = own.map(|own| match measure {
                    Measure::Bias2 => own.bias_squared,
                    _ => own.variance,
                });
                results.cells[index].measures.insert(measure.key().to_owned(), value);
            }
        }
    }
    Ok(())
}

fn decompose(cells: &[Cell], done: &[usize], folder: &Path) -> Result<Option<Decomposition>, StudyError> {
    let picture =
        |path: &Option<String>| path.as_ref().map(|path| Image::read(folder.join(path))).transpose();
    let Some(reference) =
        done.first().map(|first| picture(&cells[*first].images.reference)).transpose()?.flatten()
    else {
        return Ok(None);
    };
    let mut pictures = Vec::with_capacity(done.len());
    for index in done {
        pictures.extend(picture(&cells[*index].images.image)?);
    }
    if pictures.len() < 2 {
        return Ok(None);
    }
    Ok(Some(Decomposition::of(&pictures, &reference)?))
}

/// Returns the indices of cells that differ only in their seeds, in order.
fn groups(cells: &[Cell]) -> Vec<Vec<usize>> {
    let same = |a: &Cell, b: &Cell| a.scene == b.scene && a.pipeline == b.pipeline && a.axes == b.axes;
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (index, cell) in cells.iter().enumerate() {
        // Seeds vary fastest, so a cell belongs to the last group or starts a new one.
        match groups.last_mut().filter(|group| same(&cells[group[0]], cell)) {
            Some(group) => group.push(index),
            None => groups.push(vec![index]),
        }
    }
    groups
}
