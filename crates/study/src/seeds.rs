//! Measures that are one value for all seeds: bias² and variance, computed from the pictures of the cells.

use crate::error::StudyError;
use crate::measure::Measure;
use crate::record::{Cell, Outcome, Results};
use metrics::Image;
use metrics::seeds::Decomposition;
use std::path::Path;

/// Adds bias² and variance to the first finished cell of each group of seeds; the others have no value.
pub(crate) fn add(results: &mut Results, folder: &Path) -> Result<(), StudyError> {
    let wanted: Vec<Measure> = [Measure::Bias2, Measure::Variance]
        .into_iter()
        .filter(|measure| results.study.measures.iter().any(|info| info.key == measure.key()))
        .collect();
    if wanted.is_empty() {
        return Ok(());
    }
    for group in groups(&results.cells) {
        let done: Vec<usize> =
            group.iter().copied().filter(|index| results.cells[*index].outcome == Outcome::Done).collect();
        let found = decompose(&results.cells, &done, folder)?;
        for (place, index) in group.iter().enumerate() {
            let first = done.first().map_or(place == 0, |first| first == index);
            for measure in &wanted {
                let value = found.filter(|_| first).map(|found| match measure {
                    Measure::Bias2 => found.bias_squared,
                    _ => found.variance,
                });
                results.cells[*index].measures.insert(measure.key().to_owned(), value);
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
pub(crate) fn groups(cells: &[Cell]) -> Vec<Vec<usize>> {
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
