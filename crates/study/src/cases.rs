//! Studies whose cells are no pictures: functions of shaders, costs of a machine.

use crate::error::{Failure, StudyError};
use crate::folder::{Folder, Index, Sharing, now, read_study};
use crate::key::{VERSION, content_of, of_case, on_adapter};
use crate::record::{Cell, Node, Outcome, Results, StudyRecord};
use crate::run::{Ran, host};
use std::path::Path;
use std::time::Instant;

/// Measures a case of a study by its index, and may add to the study what it finds: pipelines, measures, claims, the adapter.
pub type MeasureCase<'a> = dyn FnMut(&mut StudyRecord, usize) -> Result<Vec<Cell>, Failure> + 'a;

/// Measures the cases of a study, which are its scenes, one after the other, and stores cells and tables in a folder as
/// [`run`](crate::run()) does. `measure` returns the cells of a case with pipeline, axes, seed, measures and details. What an
/// earlier run has measured is measured again.
///
/// # Errors
/// Fails if a file cannot be written. A case that fails is a failed cell.
pub fn measure_cases(
    mut study: StudyRecord,
    folder: &Path,
    measure: &mut MeasureCase<'_>,
) -> Result<Ran, StudyError> {
    let folder = Folder::open(folder, Sharing::Alone)?;
    (study.version, study.started) = (VERSION.to_owned(), now());
    let mut cells = Vec::new();
    for case in 0..study.scenes.len() {
        let (start, clock) = (Instant::now(), now());
        let found = measure(&mut study, case).unwrap_or_else(|error| {
            let pipeline = study.pipelines.first().map_or_else(String::new, |first| first.name.clone());
            let outcome = Outcome::Failed { error: error.to_string() };
            vec![Cell { pipeline, outcome, end: error.end(), ..Cell::default() }]
        });
        let seconds = start.elapsed().as_secs_f64() / found.len().max(1) as f64;
        cells.extend(found.into_iter().map(|cell| {
            let node = Node { clock: clock.clone(), ..Node::default() };
            Cell { scene: study.scenes[case].name.clone(), seconds, node, ..cell }
        }));
    }
    // The measures and the adapter are known when all is measured.
    let (mut contents, mut failed) = (Vec::new(), 0);
    for mut cell in cells {
        for info in &study.measures {
            cell.measures.entry(info.key.clone()).or_default();
        }
        cell.node = Node { host: host(), adapter: study.adapter.clone(), ..cell.node };
        VERSION.clone_into(&mut cell.version);
        let content = of_case(&study, &cell);
        cell.key = on_adapter(&content, &study.adapter);
        folder.write_cell(&cell)?;
        failed += usize::from(cell.outcome != Outcome::Done);
        contents.push(content);
    }
    study.cell_count = contents.len();
    folder.write_study(&study, &Index { cells: contents, references: Vec::new() })?;
    let results = Results::read(&folder.path)?;
    crate::table::write(&results, &folder.path)?;
    Ok(Ran { run: results.cells.len(), failed, results })
}

/// Stores results again in the folder that they were read from, after measures, details or claims were added.
///
/// # Errors
/// Where there is no study, and if a file cannot be written.
pub fn keep(results: &Results, folder: &Path) -> Result<(), StudyError> {
    let (_, index) = read_study(folder)?;
    let folder = Folder::open(folder, Sharing::Alone)?;
    let known = index.contents();
    for cell in results.cells.iter().filter(|cell| known.contains(content_of(&cell.key))) {
        folder.write_cell(cell)?;
    }
    folder.write_study(&results.study, &index)?;
    crate::table::write(results, &folder.path)
}
