//! Joins the folders of the shards of a study.

use crate::error::StudyError;
use crate::folder::{Folder, REFERENCES, Sharing, copy, images, read_json, read_study, row, rows};
use crate::key::content_of;
use crate::record::{Cell, Outcome, Results};
use crate::run::name_of;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// A merged study.
#[derive(Debug)]
pub struct Merged {
    /// Its results.
    pub results: Results,
    /// The records of cells that were not taken, each with its file and the reason.
    pub refused: Vec<String>,
}

/// Merges the folders of the shards of a study into a folder, which may be one of them: cells, pictures,
/// references and tables. If two folders have a cell with the same key, a finished one has precedence over a
/// failed one. The shards may have run on different adapters. Records of cells of another plan or version are not taken.
///
/// # Errors
/// Fails for folders that are not studies, or belong to another study or version, and if writing to
/// `into` fails.
pub fn merge(parts: &[PathBuf], into: &Path) -> Result<Merged, StudyError> {
    let mut studies = Vec::with_capacity(parts.len());
    for part in parts {
        studies.push((part, read_study(part)?));
    }
    let Some((first, (study, index))) = studies.first().cloned() else {
        return Err(StudyError::Damaged { path: into.to_owned(), reason: "no parts were named".to_owned() });
    };
    let known = index.contents();
    for (part, (other, other_index)) in &studies[1..] {
        let foreign =
            |reason: String| StudyError::Foreign { folder: part.to_path_buf(), first: first.clone(), reason };
        if other.version != study.version {
            return Err(foreign(format!("the version is {}, not {}", other.version, study.version)));
        }
        if other.name != study.name {
            return Err(foreign(format!("the study is `{}`, not `{}`", other.name, study.name)));
        }
        if *other_index != index {
            let common = other_index.cells.iter().filter(|cell| known.contains(cell.as_str())).count();
            return Err(foreign(format!(
                "{common} of its {} cells are among the {} there; the pipelines, shaders, scenes or values of the others \
                 differ",
                other_index.cells.len(),
                index.cells.len()
            )));
        }
    }
    let folder = Folder::open(into, Sharing::Shared)?;
    let mut record = study;
    record.references.clear();
    let mut refused = Vec::new();
    for (part, (other, _)) in &studies {
        for reference in &other.references {
            let same = record
                .references
                .iter_mut()
                .find(|known| known.scene == reference.scene && known.from == reference.from);
            match same {
                // A rendered reference has precedence over a failed one.
                Some(known) if known.image.is_none() => known.clone_from(reference),
                Some(_) => {}
                None => record.references.push(reference.clone()),
            }
        }
        let (own, others) = sorted(part, &known, &record.version);
        refused.extend(others);
        if *part != into {
            take(part, &folder, own)?;
        }
    }
    folder.write_study(&record, &index)?;
    let results = Results::read(into)?;
    crate::table::write(&results, into)?;
    Ok(Merged { results, refused })
}

/// Returns the records of cells in a folder that belong to a plan, and the reasons why the others do not.
fn sorted(folder: &Path, known: &HashSet<&str>, version: &str) -> (Vec<Cell>, Vec<String>) {
    let (mut own, mut others) = (Vec::new(), Vec::new());
    for key in rows(folder) {
        let path = row(folder, &key);
        let reason = match read_json::<Cell>(&path) {
            Err(error) => error.to_string(),
            Ok(cell) if cell.key != key => format!("{}: it is the record of {}", path.display(), cell.key),
            Ok(cell) if known.contains(content_of(&key)) => {
                own.push(cell);
                continue;
            }
            Ok(cell) => {
                let why = match cell.version.as_str() {
                    "" => "it is of an earlier version".to_owned(),
                    other if other != version => format!("its version is {other}, not {version}"),
                    _ => "it is of another plan: of other values, shaders, frames or measures".to_owned(),
                };
                format!("{} ({}): {why}", path.display(), name_of(&cell))
            }
        };
        others.push(reason);
    }
    (own, others)
}

/// Copies the files that another folder has: pictures and references first, records of cells last.
fn take(from: &Path, folder: &Folder, cells: Vec<Cell>) -> Result<(), StudyError> {
    let images = cells.iter().flat_map(|cell| images(&cell.key));
    let mut files: Vec<PathBuf> = images.map(PathBuf::from).collect();
    let entries = std::fs::read_dir(from.join(REFERENCES)).into_iter().flatten().flatten();
    let mut references: Vec<PathBuf> =
        entries.map(|entry| Path::new(REFERENCES).join(entry.file_name())).collect();
    // The pictures of a reference are copied before its record, which states that they are complete.
    references.sort_by_key(|path| path.extension().is_some_and(|extension| extension == "json"));
    files.extend(references);
    for file in files {
        let (from, to) = (from.join(&file), folder.path.join(&file));
        if !to.exists() && from.exists() {
            copy(&from, &to)?;
        }
    }
    for cell in cells {
        let keep = folder
            .cell(&cell.key)
            .is_some_and(|kept| kept.outcome == Outcome::Done || cell.outcome != Outcome::Done);
        if !keep {
            folder.write_cell(&cell)?;
        }
    }
    Ok(())
}
