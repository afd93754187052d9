//! Undo and redo: the states of what the user changed, one for each gesture.

use crate::app::App;
use crate::edits::{Edits, changed_paths};
use eframe::egui::Context;
use std::time::{Duration, Instant};

/// The time without changes after which a change counts as finished: turns of a wheel are one step.
const QUIET: Duration = Duration::from_millis(500);

/// The most steps that are kept.
const MOST: usize = 200;

/// The states before and after the one that is shown.
#[derive(Debug, Default)]
pub(crate) struct History {
    past: Vec<Edits>,
    future: Vec<Edits>,
    /// The state after the last step.
    now: Option<Edits>,
    /// A state that is not a step yet, and the time since which it stands.
    pending: Option<(Edits, Instant)>,
}

impl History {
    /// Takes note of the state at a time, while a gesture goes on or not. Returns how long a change must still stand to be a
    /// step.
    pub(crate) fn observe(&mut self, edits: &Edits, busy: bool, at: Instant) -> Option<Duration> {
        let now = self.now.get_or_insert_with(|| edits.clone());
        if now == edits {
            self.pending = None;
            return None;
        }
        let since = match &self.pending {
            Some((pending, since)) if pending == edits && !busy => *since,
            _ => {
                self.pending = Some((edits.clone(), at));
                at
            }
        };
        let left = QUIET.saturating_sub(at.duration_since(since));
        if left.is_zero() {
            self.step(edits);
            return None;
        }
        Some(left)
    }

    fn step(&mut self, edits: &Edits) {
        self.pending = None;
        if let Some(before) = self.now.replace(edits.clone()).filter(|before| before != edits) {
            self.past.push(before);
            self.future.clear();
            let old = self.past.len().saturating_sub(MOST);
            self.past.drain(..old);
        }
    }

    /// Returns the state before the last step.
    pub(crate) fn undo(&mut self, edits: &Edits) -> Option<Edits> {
        self.step(edits);
        let before = self.past.pop()?;
        self.future.extend(self.now.replace(before.clone()));
        Some(before)
    }

    /// Returns the state that was undone last.
    pub(crate) fn redo(&mut self, edits: &Edits) -> Option<Edits> {
        self.step(edits);
        let after = self.future.pop()?;
        self.past.extend(self.now.replace(after.clone()));
        Some(after)
    }

    /// Returns what the last step changed, in words; `None` where there is no step.
    pub(crate) fn last(&self, edits: &Edits) -> Option<String> {
        let now = self.now.as_ref()?;
        if now != edits { Some(difference(now, edits)) } else { Some(difference(self.past.last()?, now)) }
    }

    /// Returns what would be done again, in words; `None` where nothing was undone.
    pub(crate) fn next(&self, edits: &Edits) -> Option<String> {
        let now = self.now.as_ref().filter(|now| *now == edits)?;
        Some(difference(now, self.future.last()?))
    }
}

/// Returns the names of what differs.
fn difference(a: &Edits, b: &Edits) -> String {
    let mut names = Vec::new();
    for (side, name, overrides) in &b.settings {
        match a.settings.iter().find(|(known, ..)| known == side) {
            Some((_, other, before)) if other == name => {
                names.extend(changed_paths(before, overrides).into_iter().take(3));
            }
            _ => names.push(format!("pipeline {}", side.name())),
        }
    }
    if a.settings.len() > b.settings.len() {
        names.push("pipeline B".to_owned());
    }
    let others =
        [(a.camera != b.camera, "camera"), (a.lights != b.lights, "lights"), (a.keys != b.keys, "keys")];
    names.extend(others.into_iter().filter(|(differs, _)| *differs).map(|(_, name)| name.to_owned()));
    names.join(", ")
}

impl App {
    /// Takes note of what was changed.
    pub(crate) fn remember_steps(&mut self, context: &Context) {
        let pressed = context.input(|input| input.pointer.any_down());
        let busy = pressed || self.pilot.is_moving();
        if let Some(left) = self.history.observe(&self.edits(), busy, Instant::now()) {
            context.request_repaint_after(left);
        }
    }

    /// Goes a step back.
    pub(crate) fn undo(&mut self) {
        if let Some(before) = self.history.undo(&self.edits()) {
            self.restore(before);
        }
    }

    /// Goes a step forward again.
    pub(crate) fn redo(&mut self) {
        if let Some(after) = self.history.redo(&self.edits()) {
            self.restore(after);
        }
    }

    fn restore(&mut self, to: Edits) {
        let now = self.edits();
        for (side, name, overrides) in &to.settings {
            let shown = now.settings.iter().find(|(known, ..)| known == side);
            // A control shows what was typed for a while.
            self.controls.forget(*side);
            match shown.filter(|(_, shown, _)| shown == name) {
                Some((.., shown)) => {
                    for path in changed_paths(shown, overrides) {
                        match overrides.0.iter().rev().find(|(known, _)| *known == path) {
                            Some((_, value)) => self.set_value(*side, &path, value.clone()),
                            None => self.reset_value(*side, &path),
                        }
                    }
                }
                None => self.open_pipeline(*side, name, overrides.clone()),
            }
        }
        if to.settings.len() < now.settings.len() {
            self.close_other();
        }
        match to.camera {
            Some(camera) => self.pilot.take(&self.engine, camera, true),
            None if now.camera.is_some() => self.pilot.release(&self.engine),
            None => {}
        }
        if to.lights != now.lights {
            match to.lights {
                Some(lights) => self.pilot.set_lights(&self.engine, lights),
                None => self.pilot.release_lights(&self.engine),
            }
        }
        self.scene_panel.set_keys(to.keys);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::SideId;
    use frame_graph::{Overrides, Value};

    fn state(lights: u32) -> Edits {
        let overrides = Overrides(vec![("lights".to_owned(), Value::U32(lights))]);
        Edits { settings: vec![(SideId::A, "ism".to_owned(), overrides)], ..Edits::default() }
    }

    /// Makes a step of a state.
    fn set(history: &mut History, lights: u32, at: Instant) {
        history.observe(&state(lights), false, at);
        history.observe(&state(lights), false, at + QUIET);
    }

    #[test]
    fn steps_go_back_and_forward() {
        let (mut history, at) = (History::default(), Instant::now());
        history.observe(&state(1), false, at);
        assert_eq!(history.undo(&state(1)), None);
        set(&mut history, 2, at);
        set(&mut history, 3, at);
        assert_eq!(history.last(&state(3)).as_deref(), Some("lights"));
        assert_eq!(history.undo(&state(3)), Some(state(2)));
        assert_eq!(history.undo(&state(2)), Some(state(1)));
        assert_eq!(history.undo(&state(1)), None);
        assert_eq!(history.redo(&state(1)), Some(state(2)));
        // A change ends what could be done again.
        set(&mut history, 9, at);
        assert_eq!((history.redo(&state(9)), history.next(&state(9))), (None, None));
        assert_eq!(history.undo(&state(9)), Some(state(2)));
        assert_eq!(history.next(&state(2)).as_deref(), Some("lights"));
    }

    #[test]
    fn a_gesture_is_one_step() {
        let (mut history, at) = (History::default(), Instant::now());
        history.observe(&state(1), false, at);
        // A slider that is held still for long, and then turns of a wheel.
        for lights in 2..50 {
            assert!(history.observe(&state(lights), true, at + QUIET * lights).is_some());
        }
        for lights in 50..60 {
            assert!(history.observe(&state(lights), false, at + QUIET * 50 + QUIET / 100 * lights).is_some());
        }
        assert_eq!(history.observe(&state(59), false, at + QUIET * 60), None);
        assert_eq!(history.undo(&state(59)), Some(state(1)));
        assert_eq!(history.undo(&state(1)), None);
    }

    #[test]
    fn what_is_not_a_step_yet_can_be_undone() {
        let (mut history, at) = (History::default(), Instant::now());
        history.observe(&state(1), false, at);
        history.observe(&state(2), false, at);
        assert_eq!(history.undo(&state(2)), Some(state(1)));
        assert_eq!(history.redo(&state(1)), Some(state(2)));
    }

    #[test]
    fn old_steps_are_forgotten() {
        let (mut history, at) = (History::default(), Instant::now());
        for lights in 0..=2 * MOST as u32 {
            set(&mut history, lights, at);
        }
        let mut back = 2 * MOST as u32;
        while let Some(before) = history.undo(&state(back)) {
            back -= 1;
            assert_eq!(before, state(back));
        }
        assert_eq!(back, MOST as u32);
    }
}
