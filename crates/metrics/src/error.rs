use std::path::PathBuf;

/// An error of an image: of its file, or of a comparison for which it is not suited.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// The ending of the file name is not that of a format that this crate can read or write.
    #[error("{}: cannot {verb} this format; expected a name that ends in {expected}", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// "read" or "write".
        verb: &'static str,
        /// The supported endings.
        expected: &'static str,
    },
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
    /// The folder for a new file does not exist.
    #[error("{}: the folder {} does not exist; make it first", path.display(), folder.display())]
    NoFolder {
        /// The file that was to be written.
        path: PathBuf,
        /// Its missing folder.
        folder: PathBuf,
    },
    /// The content does not have the format of the ending, or is damaged.
    #[error("{}: expected {expected}, but {found}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// The expected content.
        expected: &'static str,
        /// The content that was found.
        found: String,
    },
    /// The pixels could not be encoded.
    #[error("{}: cannot encode the picture: {reason}", path.display())]
    Encode {
        /// The file that was to be written.
        path: PathBuf,
        /// The encoder's reason.
        reason: String,
    },
    /// The number of pixels is not width × height, or one of the two is 0.
    #[error("an image of {width}x{height} needs {expected} pixels (at least 1), got {found}")]
    PixelCount {
        /// Width in pixels.
        width: usize,
        /// Height in pixels.
        height: usize,
        /// width × height.
        expected: usize,
        /// The length that was given.
        found: usize,
    },
    /// Images that belong together have different sizes.
    #[error(
        "the sizes differ: {what} is {}x{}, {other} {}x{}; all need one size",
        found.0, found.1, expected.0, expected.1
    )]
    SizesDiffer {
        /// The image that does not fit.
        what: &'static str,
        /// Its width and height in pixels.
        found: (usize, usize),
        /// The image it should fit.
        other: &'static str,
        /// Width and height of that one in pixels.
        expected: (usize, usize),
    },
    /// A measure over several images was given fewer than it needs.
    #[error("this takes at least {expected} {what}, got {found}")]
    TooFew {
        /// The missing items, in the plural.
        what: &'static str,
        /// The least number.
        expected: usize,
        /// The number that was given.
        found: usize,
    },
    /// Every pixel is NaN or infinite in at least one of the images.
    #[error("nothing to compare: each of the {pixels} pixels is NaN or infinite in one of the images")]
    NoFinitePixels {
        /// Number of pixels.
        pixels: usize,
    },
}
