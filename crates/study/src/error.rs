//! What can end a study before its cells are done.

use metrics::ImageError;
use std::path::{Path, PathBuf};

/// An error of a study's folder. Cells that fail are no errors: they are reported in their records.
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
    /// Another run works on the folder.
    #[error("{}: another run works here ({by}); wait for it, or give another folder", folder.display())]
    Locked {
        /// The folder.
        folder: PathBuf,
        /// Which process, since when.
        by: String,
    },
    /// A file is not what it should be.
    #[error("{}: {reason}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// Folders that do not belong together.
    #[error("{}: not a part of the study in {}: {reason}", folder.display(), first.display())]
    Foreign {
        /// The folder.
        folder: PathBuf,
        /// The one that it was to be joined to.
        first: PathBuf,
        /// What differs.
        reason: String,
    },
}

pub(crate) fn io<'a>(path: &'a Path, action: &'static str) -> impl FnOnce(std::io::Error) -> StudyError + 'a {
    move |source| StudyError::Io { path: path.to_owned(), action, source }
}
