//! The folder of a study: files that are complete or absent.
//!
//! ```text
//! study.json  index.json  cells/KEY.json  images/KEY.exr, KEY-flip.png  references/KEY.json, KEY-N.exr
//! cells.csv  summary.csv  frames.csv  report.html
//! ```
//!
//! The key of a cell is a hash of its content, and of the adapter that ran it. So any number of processes and machines can
//! write into one folder, without locks: a cell that two of them run gets the same files from both, each whole. The lock of
//! a whole run only spares the user from starting it twice.

use crate::error::{StudyError, io};
use crate::key;
use crate::record::{Cell, Outcome, ReferenceRecord, Results, StudyRecord};
use crate::reference::{self, Listed};
use metrics::{Display, Image};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::collections::{HashMap, HashSet};
use std::fs::{File, TryLockError};
use std::io::{Read as _, Seek as _, Write as _};
use std::path::{Path, PathBuf};

const STUDY: &str = "study.json";
const INDEX: &str = "index.json";
pub(crate) const CELLS: &str = "cells";
const IMAGES: &str = "images";
pub(crate) const REFERENCES: &str = "references";

/// A folder of a study.
#[derive(Debug)]
pub(crate) struct Folder {
    pub(crate) path: PathBuf,
    /// The lock of a whole run: held until the folder is dropped or the process ends in any way. `None` for a shard, and on
    /// file systems without locks.
    _lock: Option<File>,
}

/// Whether a process has the folder of a study for itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sharing {
    /// No other whole run may begin.
    Alone,
    /// Other processes work there too.
    Shared,
}

/// Returns the current time, RFC 3339 in UTC: `2026-11-21T13:52:39Z`.
pub(crate) fn now() -> String {
    humantime::format_rfc3339_seconds(std::time::SystemTime::now()).to_string()
}

/// The plan of a study, which is the same in all shards and on all adapters.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Index {
    /// The content of each cell, in the order of the study.
    pub(crate) cells: Vec<String>,
    /// The references, in order.
    #[serde(default)]
    pub(crate) references: Vec<Listed>,
}

impl Index {
    /// Returns the contents.
    pub(crate) fn contents(&self) -> HashSet<&str> {
        self.cells.iter().map(String::as_str).collect()
    }
}

impl Folder {
    /// Creates the folder if it is missing.
    pub(crate) fn open(path: &Path, sharing: Sharing) -> Result<Folder, StudyError> {
        for part in [CELLS, IMAGES, REFERENCES] {
            let part = path.join(part);
            std::fs::create_dir_all(&part).map_err(io(&part, "cannot make the folder"))?;
        }
        let lock = match sharing {
            Sharing::Alone => lock(path)?,
            Sharing::Shared => None,
        };
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
        read_json(&row(&self.path, key)).ok()
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
        let known = index.contents();
        rows(&self.path).iter().filter(|key| !known.contains(key::content_of(key))).count()
    }
}

/// Returns the name of the study in a folder, and the text of its file.
///
/// # Errors
/// Where there is no study, or one of cases, which has no file.
pub fn source(folder: &Path) -> Result<(String, String), StudyError> {
    let (study, _) = read_study(folder)?;
    if study.source.is_empty() {
        let reason =
            format!("`{}` has no file, from which a study could be planned: its cells are cases", study.name);
        return Err(StudyError::Damaged { path: folder.to_owned(), reason });
    }
    Ok((study.name, study.source))
}

/// Returns the keys of the records of cells in a folder, in order.
pub(crate) fn rows(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder.join(CELLS)).into_iter().flatten().flatten();
    let key = |entry: std::fs::DirEntry| {
        Some(entry.file_name().to_string_lossy().strip_suffix(".json")?.to_owned())
    };
    let mut keys: Vec<String> = entries.filter_map(key).collect();
    keys.sort_unstable();
    keys
}

/// Returns the pictures of a cell, relative to the folder: of the measured output, and of its ꟻLIP errors.
pub(crate) fn images(key: &str) -> [String; 2] {
    [format!("{IMAGES}/{key}.exr"), format!("{IMAGES}/{key}-flip.png")]
}

/// Returns the path of the record of a cell.
pub(crate) fn row(folder: &Path, key: &str) -> PathBuf {
    folder.join(CELLS).join(format!("{key}.json"))
}

/// Locks a folder for this process; returns `None` where there are no locks.
fn lock(path: &Path) -> Result<Option<File>, StudyError> {
    if !whole_file::has_locks(path) {
        return Ok(None);
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
        // A file system without locks.
        Err(TryLockError::Error(_)) => return Ok(None),
    }
    let write = |lock: &mut File| {
        lock.set_len(0)?;
        lock.rewind()?;
        writeln!(lock, "process {} since {}", std::process::id(), now())
    };
    write(&mut lock).map_err(io(&file, "cannot write"))?;
    Ok(Some(lock))
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
    /// Reads the records of the references in the folder of a study.
    pub(crate) fn references(folder: &Path) -> Result<Vec<ReferenceRecord>, StudyError> {
        let (mut study, index) = read_study(folder)?;
        reference::complete(&mut study.references, &index.references, folder);
        Ok(study.references)
    }

    /// Reads the results of a study from its folder: the cells that are there, in the order of the study. Of a cell that
    /// several adapters ran there is one row: a finished one, if possible of the adapter of the last run, or else of the one
    /// that ran the most. Measures over seeds are computed from the pictures.
    ///
    /// # Errors
    /// Where there is no study, or a file of it is damaged.
    pub fn read(folder: &Path) -> Result<Results, StudyError> {
        let (mut study, index) = read_study(folder)?;
        let mut found: HashMap<String, Vec<Cell>> = HashMap::new();
        let mut counts: HashMap<String, usize> = HashMap::new();
        let known = index.contents();
        for key in rows(folder).iter().filter(|key| known.contains(key::content_of(key))) {
            if let Ok(cell) = read_json::<Cell>(&row(folder, key)) {
                *counts.entry(cell.node.adapter.clone()).or_default() += 1;
                found.entry(key::content_of(key).to_owned()).or_default().push(cell);
            }
        }
        let rank = |cell: &Cell| {
            let adapter = &cell.node.adapter;
            (cell.outcome == Outcome::Done, *adapter == study.adapter, counts[adapter])
        };
        // The last of those that are alike, which are sorted by their keys.
        let best = |content: &String| found.remove(content)?.into_iter().max_by_key(rank);
        let cells = index.cells.iter().filter_map(best).collect();
        reference::complete(&mut study.references, &index.references, folder);
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
