//! The folder of a study: the lock that only one process holds, and files that are complete or absent.
//!
//! ```text
//! study.json  index.json  cells/KEY.json  images/KEY.exr, KEY-flip.png  references/KEY.json, KEY-N.exr
//! cells.csv  summary.csv  frames.csv  report.html
//! ```

use crate::error::{StudyError, io};
use crate::record::{Cell, Results, StudyRecord};
use metrics::{Display, Image};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fs::{File, TryLockError};
use std::io::{Read as _, Seek as _, Write as _};
use std::path::{Path, PathBuf};

const STUDY: &str = "study.json";
const INDEX: &str = "index.json";
pub(crate) const CELLS: &str = "cells";
pub(crate) const IMAGES: &str = "images";
pub(crate) const REFERENCES: &str = "references";
/// A folder, locked by this process.
#[derive(Debug)]
pub(crate) struct Folder {
    pub(crate) path: PathBuf,
    /// The lock: held until the folder is dropped or the process ends in any way.
    _lock: File,
}

/// Returns the current time, RFC 3339 in UTC: `2026-11-21T13:52:39Z`.
pub(crate) fn now() -> String {
    humantime::format_rfc3339_seconds(std::time::SystemTime::now()).to_string()
}

/// The keys of the cells of all shards, in the order of the study.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Index {
    pub(crate) cells: Vec<String>,
}

impl Folder {
    /// Creates the folder if it is missing, and locks it for this process.
    pub(crate) fn open(path: &Path) -> Result<Folder, StudyError> {
        for part in [CELLS, IMAGES, REFERENCES] {
            let part = path.join(part);
            std::fs::create_dir_all(&part).map_err(io(&part, "cannot make the folder"))?;
        }
        let file = path.join("lock");
        let mut lock = File::options()
            .create(true)
            .truncate(false)
            .read(true)
            .write(true)
            .open(&file)
            .map_err(io(&file, "cannot open"))?;
        match lock.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let mut by = String::new();
                // The holder of the lock is reported if it can be read.
                let _ = lock.read_to_string(&mut by);
                let by =
                    if by.trim().is_empty() { "an unknown process".to_owned() } else { by.trim().to_owned() };
                return Err(StudyError::Locked { folder: path.to_owned(), by });
            }
            Err(TryLockError::Error(error)) => return Err(io(&file, "cannot lock")(error)),
        }
        let write = |lock: &mut File| {
            lock.set_len(0)?;
            lock.rewind()?;
            writeln!(lock, "process {} since {}", std::process::id(), now())
        };
        write(&mut lock).map_err(io(&file, "cannot write"))?;
        let folder = Folder { path: path.to_owned(), _lock: lock };
        folder.sweep();
        Ok(folder)
    }

    /// Removes files that an interrupted run left half written.
    fn sweep(&self) {
        for part in ["", CELLS, IMAGES, REFERENCES] {
            whole_file::sweep(&self.path.join(part));
        }
    }

    /// Returns the record of a cell, if it is there and complete.
    pub(crate) fn cell(&self, key: &str) -> Option<Cell> {
        read_json(&self.path.join(CELLS).join(format!("{key}.json"))).ok()
    }

    pub(crate) fn write_cell(&self, cell: &Cell) -> Result<(), StudyError> {
        self.write_json(&format!("{CELLS}/{}.json", cell.key), cell)
    }

    pub(crate) fn write_study(&self, study: &StudyRecord, index: &Index) -> Result<(), StudyError> {
        self.write_json(INDEX, index)?;
        self.write_json(STUDY, study)
    }

    pub(crate) fn write_json(&self, name: &str, value: &impl Serialize) -> Result<(), StudyError> {
        let path = self.path.join(name);
        let text = serde_json::to_string_pretty(value)
            .map_err(|error| StudyError::Damaged { path: path.clone(), reason: error.to_string() })?;
        write(&path, (text + "\n").as_bytes())
    }

    pub(crate) fn write_image(
        &self,
        name: &str,
        image: &Image,
        provenance: Option<&str>,
    ) -> Result<(), StudyError> {
        Ok(image.write(self.path.join(name), Display::AS_IS, provenance)?)
    }

    /// Returns the number of records of cells that the study does not have.
    pub(crate) fn stale(&self, index: &Index) -> usize {
        let entries = std::fs::read_dir(self.path.join(CELLS)).into_iter().flatten().flatten();
        let keys = entries.filter_map(|entry| {
            Some(Path::new(&entry.file_name()).file_stem()?.to_string_lossy().into_owned())
        });
        let known: std::collections::HashSet<&str> = index.cells.iter().map(String::as_str).collect();
        keys.filter(|key| !known.contains(key.as_str())).count()
    }
}

/// Returns the record of the study in a folder, and its index.
pub(crate) fn read_study(folder: &Path) -> Result<(StudyRecord, Index), StudyError> {
    if !folder.join(STUDY).is_file() {
        let reason = "there is no study here: `lightloom study FILE -o DIR` makes one".to_owned();
        return Err(StudyError::Damaged { path: folder.to_owned(), reason });
    }
    Ok((read_json(&folder.join(STUDY))?, read_json(&folder.join(INDEX))?))
}

impl Results {
    /// Reads the results of a study from its folder: the cells that are there, in the order of the study.
    /// Measures over seeds are computed from the pictures.
    ///
    /// # Errors
    /// Where there is no study, or a file of it is damaged.
    pub fn read(folder: &Path) -> Result<Results, StudyError> {
        let (study, index) = read_study(folder)?;
        let cells = index.cells.iter().map(|key| folder.join(CELLS).join(format!("{key}.json")));
        let cells: Vec<Cell> =
            cells.filter(|path| path.is_file()).filter_map(|path| read_json(&path).ok()).collect();
        let mut results = Results { study, cells };
        crate::seeds::add(&mut results, folder)?;
        Ok(results)
    }
}

pub(crate) fn read_json<T: DeserializeOwned>(path: &Path) -> Result<T, StudyError> {
    let text = std::fs::read_to_string(path).map_err(io(path, "cannot read"))?;
    serde_json::from_str(&text).map_err(|error| StudyError::Damaged {
        path: path.to_owned(),
        reason: format!("cannot be read: {error}"),
    })
}

/// Writes a file that is whole or absent.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), StudyError> {
    whole_file::write(path, bytes).map_err(io(path, "cannot write"))
}

/// Copies a file in the same way, and creates missing folders.
pub(crate) fn copy(from: &Path, to: &Path) -> Result<(), StudyError> {
    if let Some(folder) = to.parent() {
        std::fs::create_dir_all(folder).map_err(io(folder, "cannot make the folder"))?;
    }
    let bytes = std::fs::read(from).map_err(io(from, "cannot read"))?;
    write(to, &bytes)
}
