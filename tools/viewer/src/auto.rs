//! The resolution that the window chooses by itself: small at first where the processor renders.

use crate::app::App;
use crate::engine::{SideId, SideView};

/// The least resolution that is chosen \[pixels of a frame per pixel of the screen, in each direction\].
const LEAST: f32 = 0.125;

/// The greatest one.
const MOST: f32 = 0.5;

/// A frame that takes less leaves time for one of twice the resolution \[ms\].
const QUICK: f32 = 60.0;

/// A frame that takes more is too slow while something moves, and too slow to be followed by a larger one \[ms\].
const SLOW: f32 = 1000.0;

/// A resolution, and the picture after which it was chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Auto {
    scale: f32,
    seen: (u64, bool),
}

impl Default for Auto {
    fn default() -> Auto {
        Auto { scale: LEAST, seen: (0, false) }
    }
}

/// Returns the resolution after a frame that took so long \[ms\]; `None` where that is not known, as of the first frame, in
/// which the driver compiles. `idle` says that nothing changes.
fn next(scale: f32, ms: Option<f32>, idle: bool) -> f32 {
    match ms {
        None if idle => (2.0 * scale).min(MOST),
        Some(ms) if ms < QUICK || (idle && ms < SLOW) => (2.0 * scale).min(MOST),
        Some(ms) if !idle && ms > SLOW => (0.5 * scale).max(LEAST),
        _ => scale,
    }
}

impl Auto {
    fn follow(&mut self, side: &SideView) {
        if self.seen == (side.version, side.idle) {
            return;
        }
        self.seen = (side.version, side.idle);
        let ms = side.whole.last().filter(|_| side.frames > 1);
        self.scale = next(self.scale, ms, side.idle);
    }
}

impl App {
    /// Returns the pixels of a frame per pixel of the screen, in each direction.
    pub(crate) fn resolution(&self) -> f32 {
        match self.remembered.resolution {
            chosen if chosen > 0.0 => chosen,
            // A processor takes a hundred times as long.
            _ if self.now.on_cpu => self.auto.scale,
            _ => 1.0,
        }
    }

    /// Chooses the resolution by the newest frame, once the engine has done all that it was asked for.
    pub(crate) fn follow_auto(&mut self) {
        let settled = self.engine.sent() == self.now.executed;
        let Some(side) = self.now.side(SideId::A).filter(|_| settled) else { return };
        let of_size = side.picture.as_ref().is_some_and(|picture| {
            let (width, height) = side.plan.frame;
            picture.size == [width as usize, height as usize]
        });
        if of_size {
            self.auto.follow(side);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quick_frames_grow_and_slow_ones_shrink_while_something_moves() {
        assert_eq!(Auto::default().scale, LEAST);
        assert_eq!(next(0.125, Some(10.0), false), 0.25);
        assert_eq!(next(0.5, Some(10.0), true), 0.5);
        assert_eq!(next(0.25, Some(500.0), false), 0.25);
        assert_eq!(next(0.25, Some(3000.0), false), 0.125);
        assert_eq!(next(0.125, Some(3000.0), false), 0.125);
    }

    #[test]
    fn what_rests_is_refined_unless_that_takes_too_long() {
        assert_eq!(next(0.25, Some(500.0), true), 0.5);
        assert_eq!(next(0.25, Some(5000.0), true), 0.25);
        // The first frame says nothing about the next.
        assert_eq!((next(0.125, None, true), next(0.125, None, false)), (0.25, 0.125));
    }
}
