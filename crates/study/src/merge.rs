//! Merges the folders of the shards of a study.

use crate::error::StudyError;
use crate::folder::{CELLS, Folder, IMAGES, REFERENCES, copy, read_json, read_study};
use crate::record::{Cell, Outcome, Results};
use std::path::{Path, PathBuf};

/// Merges the folders of the shards of a study into a folder, which may be one of them: cells, pictures,
/// references and tables. If two folders have a cell with the same key, a finished one has precedence over a
/// failed one.
///
/// # Errors
/// Fails for folders that are not studies, or belong to another study, adapter or version, and if writing to
/// `into` fails.
pub fn merge(parts: &[PathBuf], into: &Path) -> Result<Results, StudyError> {
    let mut studies = Vec::with_capacity(parts.len());
    for part in parts {
        studies.push((part, read_study(part)?));
    }
    let Some((first, (study, index))) = studies.first().cloned() else {
        return Err(StudyError::Damaged { path: into.to_owned(), reason: "no parts were named".to_owned() });
    };
    for (part, (other, other_index)) in &studies[1..] {
        let foreign =
            |reason: String| StudyError::Foreign { folder: part.to_path_buf(), first: first.clone(), reason };
        let was = |what: &str, a: &str, b: &str| format!("{what} is {b}, not {a}");
        if other.adapter != study.adapter {
            return Err(foreign(was("the adapter", &study.adapter, &other.adapter)));
        }
        if other.version != study.version {
            return Err(foreign(was("the version", &study.version, &other.version)));
        }
        if other.name != study.name || *other_index != index {
            return Err(foreign(format!(
                "`{}` with {} cells is not `{}` with {} cells, or its pipelines, scenes or values differ",
                other.name,
                other_index.cells.len(),
                study.name,
                index.cells.len()
            )));
        }
    }
    let folder = Folder::open(into)?;
    let mut record = study;
    record.references.clear();
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
        if *part != into {
            take(part, &folder, &index.cells)?;
        }
    }
    folder.write_study(&record, &index)?;
    let results = Results::read(into)?;
    crate::table::write(&results, into)?;
    Ok(results)
}

/// Copies the files that another folder has: pictures and references first, records of cells last.
fn take(from: &Path, folder: &Folder, keys: &[String]) -> Result<(), StudyError> {
    for name in [IMAGES, REFERENCES] {
        let mut entries: Vec<PathBuf> = std::fs::read_dir(from.join(name))
            .into_iter()
            .flatten()
            .flatten()
            .map(|entry| entry.path())
            .collect();
        // The pictures of a reference are copied before its record, which states that they are complete.
        entries.sort_by_key(|path| path.extension().is_some_and(|extension| extension == "json"));
        for entry in entries {
            if let Some(file) = entry.file_name() {
                let to = folder.path.join(name).join(file);
                if !to.exists() {
                    copy(&entry, &to)?;
                }
            }
        }
    }
    for key in keys {
        let path = from.join(CELLS).join(format!("{key}.json"));
        if !path.is_file() {
            continue;
        }
        let cell: Cell = read_json(&path)?;
        let keep = folder
            .cell(key)
            .is_some_and(|kept| kept.outcome == Outcome::Done || cell.outcome != Outcome::Done);
        if !keep {
            folder.write_cell(&cell)?;
        }
    }
    Ok(())
}
