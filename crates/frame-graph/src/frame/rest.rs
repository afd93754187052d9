//! Loops that stop while nothing changes.

use super::{Change, FrameState, ReadFrom, ResetCause, asked};
use crate::plan::Plan;
use crate::port::SceneBindings;

impl FrameState {
    /// Finds which history buffers rest: those that follow, for long enough, from nothing new but each other.
    pub(super) fn find_rests(
        &mut self,
        plan: &Plan,
        change: &Change,
        resets: &[Option<ResetCause>],
        first: bool,
    ) {
        let Some(rest) = self.rest else { return };
        for (h, history) in plan.histories.iter().enumerate() {
            // One that goes on for ever is news in each frame.
            self.histories[h].rests = history.rest.is_some() && resets[h].is_none();
        }
        self.wake(plan, change, resets, first);
        for held in &mut self.histories {
            held.still = if held.rests { held.still.saturating_add(1) } else { 0 };
            held.rests = held.still > rest;
        }
        // One that does not rest yet is news for those that do.
        self.wake(plan, change, resets, first);
        // Another sample is news for all, unless all rest.
        if change.is_sample() && !self.all_rest() {
            self.histories.iter_mut().for_each(|held| held.rests = false);
        }
    }

    /// Returns whether there are history buffers, and all of them rest.
    pub(super) fn all_rest(&self) -> bool {
        !self.histories.is_empty() && self.histories.iter().all(|held| held.rests)
    }

    /// Returns whether what is read is a history buffer at rest.
    pub(super) fn is_at_rest(&self, from: ReadFrom) -> bool {
        matches!(from, ReadFrom::Past(history) if self.histories[history.0 as usize].rests)
    }

    /// Wakes the history buffers at rest whose producers have something new to read, until none has.
    fn wake(&mut self, plan: &Plan, change: &Change, resets: &[Option<ResetCause>], first: bool) {
        let mut moved = std::mem::take(&mut self.moved);
        loop {
            asked(change, first, !change.is_sample(), &self.waiting, &mut moved);
            let changed = change.scene_bindings.and(SceneBindings::FRAME);
            for (i, pass) in plan.passes.iter().enumerate() {
                let follows =
                    |at: usize| matches!(self.reads[at].from, ReadFrom::Pass(p) if moved[p.0 as usize]);
                moved[i] =
                    moved[i] || self.reads_of(i).any(follows) || self.has_news(i, pass, changed, resets);
            }
            let mut more = false;
            for (held, history) in self.histories.iter_mut().zip(&plan.histories) {
                let producer = plan.producer(history.resource);
                if held.rests && moved[producer.0 as usize] {
                    (held.rests, held.still) = (false, 0);
                    more = true;
                }
            }
            if !more {
                break;
            }
        }
        self.moved = moved;
    }
}
