//! Why history buffers are reset.

use std::fmt;

/// Why a history buffer was reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Deserialize)]
#[serde(expecting = "one of `Resize`, `Cut`, `Scene`, `Reload`, `Setting`, `Moved`, `MovedUpstream`")]
pub enum ResetCause {
    /// There was no frame before.
    #[serde(skip)]
    FirstFrame,
    /// The size of the frame changed.
    Resize,
    /// The camera jumped.
    Cut,
    /// Another scene, or one that changed by more than movement.
    Scene,
    /// A file brought another shader, setting or link of the pass that writes the history buffer, or of what feeds that
    /// pass; or the pipeline before had no such history buffer.
    Reload,
    /// A value was set, between frames, that the pass that writes the history buffer depends on.
    Setting,
    /// A scene binding changed that the pass that writes the history buffer reads, other than the frame's number and
    /// time: the camera moved, or a light, or geometry.
    Moved,
    /// The same for a scene binding that any pass reads from which the history buffer follows. Reported as
    /// [`ResetCause::Moved`].
    MovedUpstream,
}

impl ResetCause {
    /// The causes that reset a history buffer whose pass says nothing else. [`ResetCause::MovedUpstream`] is for passes
    /// that accumulate a still picture, and [`ResetCause::Setting`] for those whose old content would be wrong with another
    /// value: anything else goes on while a slider is moved.
    pub const DEFAULT: [ResetCause; 4] =
        [ResetCause::Resize, ResetCause::Cut, ResetCause::Scene, ResetCause::Reload];
    /// The causes that `history:` of a pass can name.
    pub const NAMED: [ResetCause; 7] = [
        ResetCause::Resize,
        ResetCause::Cut,
        ResetCause::Scene,
        ResetCause::Reload,
        ResetCause::Setting,
        ResetCause::Moved,
        ResetCause::MovedUpstream,
    ];
}

impl fmt::Display for ResetCause {
    /// Writes the name, as in RON.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self, f)
    }
}
