//! Errors that end a study, and failures of single cells and references.

use crate::record::End;
use metrics::{Image, ImageError};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// An error of a study's folder. Cells that fail are not errors: they are reported in their records.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The operating system refused.
    #[error("{}: {action}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// The action that failed.
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
        /// The error.
        reason: String,
    },
    /// Folders that do not belong to the same study.
    #[error("{}: not a part of the study in {}: {reason}", folder.display(), first.display())]
    Foreign {
        /// The folder.
        folder: PathBuf,
        /// The folder with which it was to be merged.
        first: PathBuf,
        /// The difference.
        reason: String,
    },
    /// A shard of another plan.
    #[error(
        "the shard {shard} is of a study with {of} {what}, and this one has {found}: cut it again (`lightloom study FILE --snakefile`)"
    )]
    Shard {
        /// Its text.
        shard: String,
        /// Cells or references.
        what: &'static str,
        /// The number that its study had.
        of: usize,
        /// The number that this one has.
        found: usize,
    },
}

/// The reason why something was not rendered or measured. It is recorded with the cell or reference; others still run.
#[derive(Clone, Debug, thiserror::Error)]
pub enum Failure {
    /// A scene, a pipeline or the device failed.
    #[error("{0}")]
    Render(Arc<dyn std::error::Error + Send + Sync>),
    /// A picture cannot be read, or does not fit another.
    #[error("{0}")]
    Image(Arc<ImageError>),
    /// A file cannot be read.
    #[error("{file}: {source}")]
    Read {
        /// The file.
        file: String,
        /// The system's reason.
        source: Arc<std::io::Error>,
    },
    /// The process of a cell ended by a signal, a panic, or without what it was to write.
    #[error("the process crashed: {0}")]
    Crashed(String),
    /// The process of a cell was killed at its time limit.
    #[error("the process did not end within {} s", .0.as_secs())]
    TimedOut(std::time::Duration),
    /// Passes have no times.
    #[error("this adapter cannot time passes, which a budget of time needs")]
    Untimed,
    /// A run ended before its first frame.
    #[error("no frame was measured")]
    NoFrame,
    /// A pipeline of references rendered nothing.
    #[error("it rendered no picture")]
    NoPicture,
    /// There are fewer references than frames.
    #[error("frame {0} has no reference")]
    NoReference(usize),
    /// A picture has pixels that are NaN or infinite.
    #[error("{count} of {pixels} pixels of {picture} are NaN or infinite")]
    NotFinite {
        /// The picture: "frame 3", "the reference".
        picture: String,
        /// Number of such pixels.
        count: usize,
        /// Number of all pixels.
        pixels: usize,
    },
    /// A reference has another size than the frames.
    #[error("the reference is {}x{}, the frames are {}x{}", found.0, found.1, expected.0, expected.1)]
    Size {
        /// Width and height of the reference \[px\].
        found: (usize, usize),
        /// Width and height of the frames \[px\].
        expected: (u32, u32),
    },
    /// A failure with the file, frame or reference in which it occurred.
    #[error("{place}: {source}")]
    At {
        /// The place.
        place: String,
        /// The failure.
        source: Box<Failure>,
    },
}

impl Failure {
    /// Returns how the process of the cell ended.
    pub(crate) fn end(&self) -> End {
        match self {
            Failure::Crashed(_) => End::Crashed,
            Failure::TimedOut(_) => End::TimedOut,
            Failure::At { source, .. } => source.end(),
            _ => End::Reported,
        }
    }

    /// Wraps an error of a scene, a pipeline or the device; or a text.
    pub fn render(error: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Failure {
        Failure::Render(error.into().into())
    }

    /// Adds the place.
    pub(crate) fn at(self, place: impl ToString) -> Failure {
        Failure::At { place: place.to_string(), source: Box::new(self) }
    }

    /// Checks that the pixels of a picture are finite.
    pub(crate) fn check_finite(image: &Image, picture: impl FnOnce() -> String) -> Result<(), Failure> {
        let count = image.pixels().iter().filter(|pixel| !pixel[..3].iter().all(|c| c.is_finite())).count();
        match count {
            0 => Ok(()),
            count => Err(Failure::NotFinite { picture: picture(), count, pixels: image.pixels().len() }),
        }
    }
}

impl From<ImageError> for Failure {
    fn from(error: ImageError) -> Failure {
        Failure::Image(Arc::new(error))
    }
}

pub(crate) fn io<'a>(path: &'a Path, action: &'static str) -> impl FnOnce(std::io::Error) -> StudyError + 'a {
    move |source| StudyError::Io { path: path.to_owned(), action, source }
}
