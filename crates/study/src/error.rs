//! Errors that end a study before its cells are finished.

use metrics::ImageError;
use std::path::{Path, PathBuf};

/// An error of a study's folder. Cells that fail are not errors: they are reported in their records.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The operating system refused.
    #[error("{}: {action}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was being done.
        action: &'static str,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A picture could not be written or read.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// Another run is using the folder.
    #[error("{}: another run works here ({by}); wait for it, or give another folder", folder.display())]
    Locked {
        /// The folder.
        folder: PathBuf,
        /// The process that uses it, and since when.
        by: String,
    },
    /// A file does not have the expected content.
    #[error("{}: {reason}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// Folders that do not belong to the same study.
    #[error("{}: not a part of the study in {}: {reason}", folder.display(), first.display())]
    Foreign {
        /// The folder.
        folder: PathBuf,
        /// The folder with which it was to be merged.
        first: PathBuf,
        /// What differs.
        reason: String,
    },
}

pub(crate) fn io<'a>(path: &'a Path, action: &'static str) -> impl FnOnce(std::io::Error) -> StudyError + 'a {
    move |source| StudyError::Io { path: path.to_owned(), action, source }
}
