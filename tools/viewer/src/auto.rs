//! The resolution that the window chooses by itself where the processor renders: small while something moves, and larger with
//! every picture once nothing does.

use crate::app::App;
use crate::engine::SideId;
use eframe::egui::Context;
use std::time::{Duration, Instant};

/// The least resolution that is chosen \[pixels of a frame per pixel of the screen, in each direction\].
const LEAST: f32 = 0.125;

/// The greatest one while something moves.
const MOST: f32 = 0.5;

/// The greatest one at rest.
const FULL: f32 = 1.0;

/// A frame that takes less leaves time for one of twice the resolution \[ms\].
const QUICK: f32 = 60.0;

/// A frame that takes more is too slow while something moves \[ms\].
const SLOW: f32 = 1000.0;

/// A resolution, and what it was chosen after.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Auto {
    /// While something moves.
    moving: f32,
    /// Since nothing moves any more; `None` while something does.
    resting: Option<f32>,
    seen: Seen,
    /// When that was seen.
    since: Option<Instant>,
    /// The picture after which the resolution grew last.
    grown: u64,
    /// What the user had moved by then.
    moves: u64,
}

/// The newest picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Seen {
    version: u64,
    /// The time that it took \[ms\]; `None` where that is not known, as of the first frame, in which the driver compiles.
    ms: Option<f32>,
    /// Whether nothing changes.
    idle: bool,
}

impl Default for Auto {
    fn default() -> Auto {
        Auto { moving: LEAST, resting: None, seen: Seen::default(), since: None, grown: 0, moves: 0 }
    }
}

/// Returns the resolution while something moves, after a frame that took so long.
fn next(scale: f32, seen: Seen) -> f32 {
    match seen.ms {
        Some(ms) if ms < QUICK => (2.0 * scale).min(MOST),
        Some(ms) if !seen.idle && ms > SLOW => (0.5 * scale).max(LEAST),
        _ => scale,
    }
}

impl Auto {
    fn scale(&self) -> f32 {
        self.resting.unwrap_or(self.moving)
    }

    /// Notes how much the user has moved by now; where that is more than before, the resolution is that of what moves.
    fn move_on(&mut self, moves: u64) {
        if self.moves != moves {
            (self.moves, self.resting) = (moves, None);
        }
    }

    /// Follows the newest picture. At rest the resolution doubles after each picture, once it has been left alone for as long
    /// as it took: a frame that has begun does not make way. Returns the time until then.
    fn follow(&mut self, seen: Seen) -> Option<Duration> {
        if self.seen != seen {
            (self.seen, self.since) = (seen, Some(Instant::now()));
            if self.resting.is_none() {
                self.moving = next(self.moving, seen);
            }
        }
        let grows = seen.idle && self.grown != seen.version && self.scale() < FULL;
        let since = self.since.filter(|_| grows)?;
        let wait = Duration::try_from_secs_f32(seen.ms.unwrap_or(0.0) / 1000.0).unwrap_or(Duration::MAX);
        let left = wait.saturating_sub(since.elapsed());
        if !left.is_zero() {
            return Some(left);
        }
        self.grown = seen.version;
        self.resting = Some((2.0 * self.scale()).min(FULL));
        None
    }
}

impl App {
    /// Returns the pixels of a frame per pixel of the screen, in each direction.
    pub(crate) fn resolution(&self) -> f32 {
        match self.remembered.resolution {
            chosen if chosen > 0.0 => chosen,
            // A processor takes a hundred times as long.
            _ if self.now.on_cpu => self.auto.scale(),
            _ => FULL,
        }
    }

    /// Returns the resolution to which frames return before something moves; `None` if it is the one that they have.
    pub(crate) fn resolution_of_moves(&self) -> Option<f32> {
        let is_chosen = self.remembered.resolution > 0.0 || !self.now.on_cpu;
        self.auto.resting.filter(|_| !is_chosen).map(|_| self.auto.moving)
    }

    /// Chooses the resolution by the newest frame, once the engine has done all that it was asked for.
    pub(crate) fn follow_auto(&mut self, ctx: &Context) {
        self.auto.move_on(self.engine.moves());
        let settled = self.engine.sent() == self.now.executed;
        let Some(side) = self.now.side(SideId::A).filter(|_| settled) else { return };
        let of_size = side.picture.as_ref().is_some_and(|picture| {
            let (width, height) = side.plan.frame;
            picture.size == [width as usize, height as usize]
        });
        if of_size {
            let ms = side.whole.last().filter(|_| side.frames > 1);
            let idle = side.idle && !self.now.playing;
            if let Some(left) = self.auto.follow(Seen { version: side.version, ms, idle }) {
                ctx.request_repaint_after(left);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(version: u64, ms: impl Into<Option<f32>>, idle: bool) -> Seen {
        Seen { version, ms: ms.into(), idle }
    }

    #[test]
    fn quick_frames_grow_and_slow_ones_shrink_while_something_moves() {
        assert_eq!(Auto::default().scale(), LEAST);
        assert_eq!(next(0.125, seen(1, 10.0, false)), 0.25);
        assert_eq!(next(0.5, seen(1, 10.0, false)), 0.5);
        assert_eq!(next(0.25, seen(1, 500.0, false)), 0.25);
        assert_eq!(next(0.25, seen(1, 3000.0, false)), 0.125);
        assert_eq!(next(0.125, seen(1, 3000.0, false)), 0.125);
        // The first frame says nothing about the next.
        assert_eq!(next(0.125, seen(1, None, false)), 0.125);
    }

    /// However long a frame takes.
    #[test]
    fn what_rests_comes_to_full_size() {
        let mut auto = Auto::default();
        for (version, expected) in [(1, 0.25), (2, 0.5), (3, 1.0), (4, 1.0)] {
            let slow = seen(version, 5000.0, true);
            let waits = auto.follow(slow);
            assert_eq!(waits.is_some(), version < 4, "it is left alone first");
            // As if that time had passed.
            auto.since = auto.since.and_then(|since| since.checked_sub(Duration::from_secs(6)));
            assert_eq!(auto.follow(slow), None);
            assert_eq!(auto.scale(), expected);
            assert_eq!((auto.follow(slow), auto.scale()), (None, expected), "once after each picture");
        }
        // What moves is as small as it was, at once.
        auto.move_on(1);
        assert_eq!(auto.scale(), LEAST);
    }

    /// A pipeline that accumulates is not idle in between.
    #[test]
    fn frames_at_rest_do_not_change_the_resolution_of_what_moves() {
        let mut auto = Auto::default();
        auto.follow(seen(1, None, true));
        assert_eq!(auto.scale(), 0.25);
        auto.follow(seen(2, 3000.0, false));
        assert_eq!((auto.scale(), auto.moving), (0.25, LEAST));
    }
}
