//! Decides which passes a frame must run: what changed, what depends on it, and what the objects still hold.

mod cause;
mod rest;

use crate::plan::{AllocationId, HistoryId, PassId, Plan, PlannedPass, ResourceId};
use crate::port::SceneBindings;
use crate::succession::Succession;
use std::ops::Range;

pub use cause::ResetCause;

/// The changes since the frame before.
#[derive(Clone, Debug, Default)]
pub struct Change {
    /// The scene bindings that changed. [`SceneBindings::FRAME`] is always taken as changed.
    pub scene_bindings: SceneBindings,
    /// The scene bindings that changed in the sample that the frame is, and in nothing else: what reads them runs, but
    /// nothing has moved.
    pub resampled: SceneBindings,
    /// Passes whose settings, shaders or links changed. They run; and for the history buffers that they, or passes that
    /// depend on them, write, this is a [`ResetCause::Reload`].
    pub passes: Vec<PassId>,
    /// Passes that were given other values. They run, and this is a [`ResetCause::Setting`] in the same way.
    pub values: Vec<PassId>,
    /// Passes that are to run again for another reason.
    pub again: Vec<PassId>,
    /// Passes whose random numbers are others. Where the frame is another sample, nothing has moved.
    pub reseeded: Vec<PassId>,
    /// Events that may reset history buffers.
    pub events: Vec<ResetCause>,
    /// Whether everything runs, even if nothing has changed: for measurements.
    pub all: bool,
    /// For each pass of the plan, whether it runs in this frame if it has to; empty where all do. The others wait for a frame that
    /// lets them run: what changes until then is not lost. None of these may depend on one that waits, as those of
    /// [`Plan::upstream`] never do.
    pub only: Vec<bool>,
}

impl Change {
    /// Adds the changes of another one.
    pub fn add(&mut self, other: &Change) {
        self.scene_bindings = self.scene_bindings.and(other.scene_bindings);
        self.resampled = self.resampled.and(other.resampled);
        self.passes.extend_from_slice(&other.passes);
        self.values.extend_from_slice(&other.values);
        self.again.extend_from_slice(&other.again);
        self.reseeded.extend_from_slice(&other.reseeded);
        self.events.extend_from_slice(&other.events);
        self.all |= other.all;
        self.only.clone_from(&other.only);
    }

    /// Returns whether the frame is another sample than the one before.
    fn is_sample(&self) -> bool {
        self.resampled != SceneBindings::NONE
    }

    /// Removes all changes, and keeps the memory for the next frame.
    pub fn clear(&mut self) {
        self.scene_bindings = SceneBindings::NONE;
        self.resampled = SceneBindings::NONE;
        self.passes.clear();
        self.values.clear();
        self.again.clear();
        self.reseeded.clear();
        self.events.clear();
        self.all = false;
        self.only.clear();
    }

    /// Returns whether a pass waits for another frame.
    fn makes_wait(&self, pass: usize) -> bool {
        self.only.get(pass) == Some(&false)
    }
}

/// The schedule of a frame: returned by [`FrameState::begin`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameSchedule {
    /// Whether each pass of the plan runs: one entry per pass.
    pub runs: Vec<bool>,
    /// The state of each history buffer: one entry per history buffer.
    pub histories: Vec<HistorySlot>,
}

/// The state of a history buffer in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HistorySlot {
    /// Which copy holds this frame's version.
    pub current: usize,
    /// Which copy a `prev` link reads: it holds the version of the frame before, or must be filled with zeros where `reset`
    /// is set. Equal to `current` where the producer does not run and the history buffer is neither reset nor at rest.
    pub previous: usize,
    /// Frames since the last reset, without those at rest; 0 where there is no history and zeros are read.
    pub age: u32,
    /// Why the history buffer was reset; `None` where it was not.
    pub reset: Option<ResetCause>,
}

/// What is held between frames for one plan: which versions the objects contain.
///
/// A version is a number that grows with every new content. A pass is a pure function of what it reads, so its
/// outputs get new versions only where something that it reads has one; run again for other reasons, it writes
/// what was there before.
#[derive(Clone, Debug)]
pub struct FrameState {
    /// The newest version, shared by all outputs of a pass.
    versions: Vec<u64>,
    /// What the passes read and write, in lists that a frame goes through from end to end: the plan itself lies
    /// scattered in memory, and is not in the caches when a frame begins.
    reads: Vec<Read>,
    writes: Vec<(AllocationId, ResourceId)>,
    /// Where the entries of each pass begin in `reads` and in `writes`; and where the last ones end.
    first: Vec<(u32, u32)>,
    /// The version of each entry of `reads` with which its pass ran last.
    seen: Vec<u64>,
    /// The resource whose newest version each object holds.
    holds: Vec<Option<ResourceId>>,
    histories: Vec<Held>,
    /// After how many still frames history buffers rest, the most that a link says; `None` where none does.
    rest: Option<u32>,
    /// What is new in the frame begun last even if history buffers that can rest are the same; empty where none can.
    moved: Vec<bool>,
    /// The last version given.
    clock: u64,
    /// Set until the first frame of the plan: nothing is held but history buffers.
    fresh: bool,
    /// For each pass, whether it has waited since it had to run.
    waiting: Vec<bool>,
    /// Why each history buffer will be reset in the next frame in any case; `None` where it will not.
    lacking: Vec<Option<ResetCause>>,
    /// Why each history buffer was reset in the frame begun last.
    resets: Vec<Option<ResetCause>>,
    /// What the frame begun last does. Its memory is used again by the next one.
    schedule: FrameSchedule,
}

/// A resource that a pass reads.
#[derive(Clone, Copy, Debug)]
struct Read {
    resource: ResourceId,
    from: ReadFrom,
}

/// Which version of a resource is read.
#[derive(Clone, Copy, Debug)]
enum ReadFrom {
    /// That of this frame, made by a pass.
    Pass(PassId),
    /// That of a frame before.
    Past(HistoryId),
}

/// What is held of a history.
#[derive(Clone, Copy, Debug)]
struct Held {
    /// The copy that holds the newest version.
    current: usize,
    /// The version at the end of the last frame; 0 where there is none.
    version: u64,
    age: u32,
    /// Frames in which nothing that it follows from had something new to read, other than history buffers that can rest.
    still: u32,
    /// Whether it rests in the frame begun last: its slot stays as it is, so that what must run again for another reason
    /// reads and writes the same copies as in the last frame that did not rest.
    rests: bool,
}

/// The version of what was never written.
const INIT: u64 = 0;
/// The clock before the first frame.
const START: u64 = 1;

impl FrameState {
    /// Creates the state in which nothing has run.
    pub fn new(plan: &Plan) -> FrameState {
        let (mut reads, mut writes) = (Vec::new(), Vec::new());
        let mut first = Vec::with_capacity(plan.passes.len() + 1);
        for pass in &plan.passes {
            first.push((reads.len() as u32, writes.len() as u32));
            for input in &pass.inputs {
                let past = |m: usize| input.history.as_ref().map(|past| past[m]);
                reads.extend(input.members.iter().enumerate().map(|(m, (_, resource))| {
                    let producer = plan.producer(*resource);
                    let from = past(m).map_or(ReadFrom::Pass(producer), ReadFrom::Past);
                    Read { resource: *resource, from }
                }));
            }
            let members = pass.outputs.iter().flat_map(|port| &port.members);
            writes.extend(members.map(|(_, id)| (plan.resources[id.0 as usize].allocation, *id)));
        }
        first.push((reads.len() as u32, writes.len() as u32));
        FrameState {
            versions: vec![INIT; plan.passes.len()],
            seen: vec![INIT; reads.len()],
            reads,
            writes,
            first,
            holds: vec![None; plan.allocations.len()],
            histories: vec![
                Held { current: 0, version: INIT, age: 0, still: 0, rests: false };
                plan.histories.len()
            ],
            rest: plan.histories.iter().filter_map(|history| history.rest).max(),
            moved: Vec::new(),
            clock: START,
            fresh: true,
            waiting: vec![false; plan.passes.len()],
            lacking: vec![Some(ResetCause::FirstFrame); plan.histories.len()],
            resets: Vec::new(),
            schedule: FrameSchedule::default(),
        }
    }

    /// Creates the state of `plan`, which replaces the plan of this state. The history buffers that continue keep their
    /// versions and ages; all passes run in the next frame.
    pub fn succeed(&self, plan: &Plan, succession: &Succession) -> FrameState {
        let mut next = FrameState::new(plan);
        next.clock = self.clock;
        // Before the first frame of all, that is the cause whatever else happened.
        let begun = self.clock > START;
        for (h, before) in succession.histories.iter().enumerate() {
            match before {
                Ok(before) => {
                    next.histories[h] = self.histories[before.0 as usize];
                    next.lacking[h] = self.lacking[before.0 as usize];
                }
                Err(cause) if begun => next.lacking[h] = Some(*cause),
                Err(_) => {}
            }
        }
        next
    }

    /// Records that objects were created again and are empty, except those that are `kept`: all passes run in the next
    /// frame, and a history buffer whose newest version is lost is reset with the cause [`ResetCause::Reload`].
    pub fn forget_objects(&mut self, plan: &Plan, kept: impl Fn(AllocationId) -> bool) {
        self.holds.fill(None);
        self.fresh = true;
        let histories = plan.histories.iter().zip(&self.histories).zip(&mut self.lacking);
        for ((history, held), lacking) in histories {
            if !kept(history.copies[held.current]) {
                lacking.get_or_insert(ResetCause::Reload);
            }
        }
    }

    /// Returns which of the two objects of a history buffer holds its newest version.
    pub fn current(&self, history: HistoryId) -> usize {
        self.histories[history.0 as usize].current
    }

    /// Returns the schedule of the frame begun last; an empty one before the first.
    pub fn schedule(&self) -> &FrameSchedule {
        &self.schedule
    }

    /// Returns whether no frame has run.
    pub fn is_fresh(&self) -> bool {
        self.fresh
    }

    /// Decides what the next frame runs, and records it as run. Where no pass changed, a frame after the first
    /// allocates nothing.
    ///
    /// A pass runs if something that it reads has a new version, if `change` names it, or if a pass that runs needs a
    /// version of its outputs that no object holds any more. Only passes that the outputs of the pipeline need are
    /// considered. A new version of a history buffer at rest is not new. Passes that [`Change::only`] leaves out wait.
    pub fn begin(&mut self, plan: &Plan, change: &Change) -> &FrameSchedule {
        let fresh = std::mem::take(&mut self.fresh);
        // Taken out, so that they can be read while the state is written.
        let mut resets = std::mem::take(&mut self.resets);
        let mut schedule = std::mem::take(&mut self.schedule);
        self.find_resets(plan, change, &mut resets);
        self.postpone(plan, change, &mut resets);
        self.find_rests(plan, change, &resets, fresh);
        self.renew(plan, change, &resets, fresh, &mut schedule.runs);
        self.restore(plan, &mut schedule.runs);
        for pass in (0..plan.passes.len()).filter(|pass| schedule.runs[*pass]) {
            for at in self.writes_of(pass) {
                let (allocation, id) = self.writes[at];
                self.holds[allocation.0 as usize] = Some(id);
            }
            for at in self.reads_of(pass) {
                let from = self.reads[at].from;
                // Of one at rest it reads what it read before, which is not the newest.
                if !self.is_at_rest(from) {
                    self.seen[at] = self.version(from, &resets);
                }
            }
        }
        self.turn(plan, &resets, &mut schedule);
        self.resets = resets;
        self.schedule = schedule;
        &self.schedule
    }

    /// Finds why each history buffer is reset in this frame.
    fn find_resets(&mut self, plan: &Plan, change: &Change, resets: &mut Vec<Option<ResetCause>>) {
        let reloaded = reached(plan, &change.passes);
        let set = reached(plan, &change.values);
        resets.clear();
        resets.extend(plan.histories.iter().zip(&mut self.lacking).map(|(history, lacking)| {
            let lacking = lacking.take().map(|cause| match cause {
                // Another scene brought another plan.
                ResetCause::Reload if change.events.contains(&ResetCause::Scene) => ResetCause::Scene,
                cause => cause,
            });
            let producer = plan.producer(history.resource);
            let changed = |reached: &[bool], cause: ResetCause| {
                let reached = reached.get(producer.0 as usize) == Some(&true);
                (reached && history.reset.contains(&cause)).then_some(cause)
            };
            let reload =
                || changed(&reloaded, ResetCause::Reload).or_else(|| changed(&set, ResetCause::Setting));
            let event = || change.events.iter().find(|e| history.reset.contains(e)).copied();
            let moved = || {
                let pass = &plan.passes[producer.0 as usize];
                let changed = |read: SceneBindings, cause: ResetCause| {
                    let changed = read.0 & change.scene_bindings.0 & !SceneBindings::FRAME.0 != 0;
                    changed && history.reset.contains(&cause)
                };
                let moved = changed(pass.scene_bindings, ResetCause::Moved)
                    || changed(pass.depends_on, ResetCause::MovedUpstream);
                moved.then_some(ResetCause::Moved)
            };
            lacking.or_else(event).or_else(reload).or_else(moved)
        }));
    }

    /// Puts off the resets of history buffers whose producers wait.
    fn postpone(&mut self, plan: &Plan, change: &Change, resets: &mut [Option<ResetCause>]) {
        for (h, history) in plan.histories.iter().enumerate() {
            if change.makes_wait(plan.producer(history.resource).0 as usize) {
                self.lacking[h] = resets[h].take();
            }
        }
    }

    /// Returns the age of a history buffer in the frame begun last, in frames.
    pub fn age(&self, history: HistoryId) -> u32 {
        self.histories[history.0 as usize].age
    }

    /// Where the entries of a pass lie in `reads` and `seen`.
    fn reads_of(&self, pass: usize) -> Range<usize> {
        self.first[pass].0 as usize..self.first[pass + 1].0 as usize
    }

    /// Where the entries of a pass lie in `writes`.
    fn writes_of(&self, pass: usize) -> Range<usize> {
        self.first[pass].1 as usize..self.first[pass + 1].1 as usize
    }

    /// Returns the version of what is read in this frame.
    fn version(&self, from: ReadFrom, resets: &[Option<ResetCause>]) -> u64 {
        match from {
            ReadFrom::Pass(pass) => self.versions[pass.0 as usize],
            ReadFrom::Past(history) if resets[history.0 as usize].is_some() => INIT,
            ReadFrom::Past(history) => self.histories[history.0 as usize].version,
        }
    }

    /// Returns whether a pass reads a scene binding that changed, or a version that it has not seen.
    fn has_news(
        &self,
        index: usize,
        pass: &PlannedPass,
        changed: SceneBindings,
        resets: &[Option<ResetCause>],
    ) -> bool {
        let is_new = |at: usize| {
            let from = self.reads[at].from;
            !self.is_at_rest(from) && self.seen[at] != self.version(from, resets)
        };
        pass.scene_bindings.0 & changed.0 != 0 || self.reads_of(index).any(is_new)
    }

    /// Forwards: what has something new to read, and so makes something new.
    fn renew(
        &mut self,
        plan: &Plan,
        change: &Change,
        resets: &[Option<ResetCause>],
        first: bool,
        runs: &mut Vec<bool>,
    ) {
        // Where all rests, the picture has samples enough.
        let takes_sample = !change.is_sample() || !self.all_rest();
        asked(change, first, takes_sample, &self.waiting, runs);
        let mut changed = change.scene_bindings.and(SceneBindings::FRAME);
        if takes_sample {
            changed = changed.and(change.resampled);
        }
        runs.iter_mut().for_each(|runs| *runs |= change.all);
        for (i, pass) in plan.passes.iter().enumerate() {
            if self.writes_of(i).is_empty() {
                // It only hands on, or gives facts: there is nothing to do.
                runs[i] = false;
                continue;
            }
            runs[i] = runs[i] || self.has_news(i, pass, changed, resets);
            let waits = change.makes_wait(i);
            self.waiting[i] = waits && runs[i];
            runs[i] &= !waits;
            if runs[i] {
                self.clock += 1;
                self.versions[i] = self.clock;
            }
        }
    }

    /// Backwards: what must run again because an object no longer holds what a pass reads.
    fn restore(&self, plan: &Plan, runs: &mut [bool]) {
        loop {
            let mut more = false;
            for i in (0..plan.passes.len()).rev() {
                if !runs[i] {
                    continue;
                }
                for Read { resource, from } in &self.reads[self.reads_of(i)] {
                    let ReadFrom::Pass(producer) = from else { continue };
                    if !runs[producer.0 as usize] && !self.is_held(plan, *resource, runs) {
                        runs[producer.0 as usize] = true;
                        more = true;
                    }
                }
            }
            // What runs again may write over what was held: then look once more.
            if !more {
                return;
            }
        }
    }

    /// Returns whether an object still holds a resource when its readers come, if the producer does not run.
    fn is_held(&self, plan: &Plan, id: ResourceId, runs: &[bool]) -> bool {
        let allocation = plan.resources[id.0 as usize].allocation.0 as usize;
        if self.holds[allocation] != Some(id) {
            return false;
        }
        // Those before it in the list are written before it would be.
        let before = plan.allocations[allocation].resources.iter().take_while(|other| **other != id);
        let written = |other: &ResourceId| runs[plan.producer(*other).0 as usize];
        !before.into_iter().any(written)
    }

    /// Swaps the copies of history buffers whose producers run.
    fn turn(&mut self, plan: &Plan, resets: &[Option<ResetCause>], schedule: &mut FrameSchedule) {
        let FrameSchedule { runs, histories: slots } = schedule;
        let nothing = HistorySlot { current: 0, previous: 0, age: 0, reset: None };
        slots.resize(plan.histories.len(), nothing);
        for (i, history) in plan.histories.iter().enumerate() {
            let held = &mut self.histories[i];
            let producer = plan.producer(history.resource);
            let written = runs[producer.0 as usize];
            held.version = self.versions[producer.0 as usize];
            if held.rests {
                continue;
            }
            let mut previous = held.current;
            if written {
                held.current = 1 - held.current;
            } else if resets[i].is_some() {
                // Zeros go where nothing is held.
                previous = 1 - held.current;
            }
            held.age = if resets[i].is_some() { 0 } else { held.age.saturating_add(1) };
            slots[i] = HistorySlot { current: held.current, previous, age: held.age, reset: resets[i] };
        }
    }
}

/// Marks the passes that wait, and those that a change asks for by name, those with other random numbers if these are wanted; or
/// all at first.
fn asked(change: &Change, first: bool, reseeded: bool, waiting: &[bool], runs: &mut Vec<bool>) {
    runs.clear();
    runs.extend(waiting.iter().map(|waits| first || *waits));
    let reseeded = if reseeded { &change.reseeded[..] } else { &[] };
    for pass in change.passes.iter().chain(&change.values).chain(&change.again).chain(reseeded) {
        if let Some(run) = runs.get_mut(pass.0 as usize) {
            *run = true;
        }
    }
}

/// For each pass, whether it is one of these or reads, now or of the past, what follows from one. Empty where none
/// is.
fn reached(plan: &Plan, changed: &[PassId]) -> Vec<bool> {
    if changed.is_empty() || plan.histories.is_empty() {
        return Vec::new();
    }
    let mut reached = vec![false; plan.passes.len()];
    for pass in changed {
        if let Some(reached) = reached.get_mut(pass.0 as usize) {
            *reached = true;
        }
    }
    loop {
        let mut more = false;
        for (i, pass) in plan.passes.iter().enumerate() {
            let mut producers = pass.inputs.iter().map(|input| input.producer);
            if !reached[i] && producers.any(|producer| reached[producer.0 as usize]) {
                reached[i] = true;
                more = true;
            }
        }
        // The order follows the data of one frame; what comes out of the past may need another round.
        if !more {
            return reached;
        }
    }
}
