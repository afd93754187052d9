use std::path::PathBuf;
use std::time::Duration;
use x11rb::errors::{ConnectionError, ReplyError};

/// Why a window cannot be driven.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// No window of this title was mapped in time.
    #[error("no window whose title contains `{title}` after {timeout:?}; there are: {}", list(.titles))]
    NoWindow {
        /// What the title was to contain.
        title: String,
        /// How long it was waited for.
        timeout: Duration,
        /// Titles of the windows that there are.
        titles: Vec<String>,
    },
    /// What was waited for was not seen in time.
    #[error("not seen after {timeout:?}; the last screenshot is {}", .screenshot.display())]
    NotSeen {
        /// How long it was waited for.
        timeout: Duration,
        /// The last screenshot, which stays on disk.
        screenshot: PathBuf,
    },
    /// A key that has no name here, or that the server's keyboard lacks.
    #[error(
        "the keyboard has no key `{key}`; expected one character of a US keyboard, or one of: {}",
        crate::keyboard::names()
    )]
    UnknownKey {
        /// The key.
        key: String,
    },
    /// A chord whose first parts are not modifiers.
    #[error("`{modifier}` in `{chord}` is not a modifier; expected ctrl, shift, alt or super")]
    UnknownModifier {
        /// The part that is none.
        modifier: String,
        /// The whole chord.
        chord: String,
    },
    /// Part of the window lies outside the screen, and the server keeps no pixels there.
    #[error("the window ({size:?} pixels at {position:?}) reaches outside the screen of {screen:?} pixels")]
    Outside {
        /// Where its upper left corner is \[pixels\].
        position: [i16; 2],
        /// Its size \[pixels\].
        size: [u16; 2],
        /// The size of the screen \[pixels\].
        screen: [u16; 2],
    },
    /// The server sent pixels of a layout other than 32 bits each, of which 24 are used.
    #[error("the server's pixels are not of 24 bits in 32")]
    PixelLayout,
    /// The picture could not be made or written.
    #[error(transparent)]
    Image(#[from] metrics::ImageError),
    /// A file could not be made for a screenshot.
    #[error("cannot keep the screenshot")]
    Keep(#[source] std::io::Error),
    /// The server refused a request: most often the window is gone.
    #[error("the X server refused; is the window gone?")]
    Refused(#[source] ReplyError),
    /// The server is gone.
    #[error("the connection to the X server broke")]
    Broken(#[from] ConnectionError),
}

impl From<ReplyError> for Error {
    fn from(error: ReplyError) -> Self {
        match error {
            ReplyError::ConnectionError(error) => Self::Broken(error),
            refused @ ReplyError::X11Error(_) => Self::Refused(refused),
        }
    }
}

fn list(titles: &[String]) -> String {
    if titles.is_empty() { "none".to_owned() } else { titles.join(", ") }
}
