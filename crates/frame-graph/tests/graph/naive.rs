//! What frames are by definition: everything runs in each, and contents are numbers that stand for all that went into them.

use frame_graph::frame::FrameSchedule;
use frame_graph::plan::{Plan, ResourceId};
use std::collections::HashMap;

/// The content of a resource: a number that stands for all that went into it.
pub(super) type Content = u64;

pub(super) fn mix(parts: impl IntoIterator<Item = u64>) -> Content {
    parts.into_iter().fold(0xcbf2_9ce4_8422_2325, |hash, part| {
        (hash ^ part).wrapping_mul(0x0100_0000_01b3).rotate_left(23)
    })
}

/// What changed so far: revisions of the scene bindings and of passes.
#[derive(Default)]
pub(super) struct Revisions {
    pub(super) scene_bindings: [u64; 4],
    pub(super) passes: HashMap<u32, u64>,
}

/// What a pass makes of what it reads.
pub(super) fn make(
    plan: &Plan,
    pass: usize,
    revisions: &Revisions,
    reads: &[Content],
    member: usize,
) -> Content {
    let bits = plan.passes[pass].scene_bindings.0;
    let own = (0..4).filter(|bit| bits & (1 << bit) != 0).map(|bit| revisions.scene_bindings[bit]);
    let own: Vec<u64> = own.collect();
    let revision = revisions.passes.get(&(pass as u32)).copied().unwrap_or(0);
    mix([pass as u64, member as u64, revision].into_iter().chain(own).chain(reads.iter().copied()))
}

/// Runs everything in every frame; returns what each pass read and each output is.
pub(super) struct Naive {
    pub(super) contents: Vec<Content>,
    past: Vec<Content>,
    /// What was read of each history buffer, and for how many frames it would not have changed without others that rest.
    read: Vec<Content>,
    still: Vec<u32>,
}

pub(super) const INIT: Content = 7;

impl Naive {
    pub(super) fn new(plan: &Plan) -> Naive {
        let histories = plan.histories.len();
        Naive {
            contents: vec![0; plan.resources.len()],
            past: vec![INIT; histories],
            read: vec![INIT; histories],
            still: vec![0; histories],
        }
    }

    /// Runs a frame, without the passes that wait: none where `only` is empty, else those that it does not have.
    pub(super) fn frame(
        &mut self,
        plan: &Plan,
        revisions: &Revisions,
        resets: &[bool],
        only: &[bool],
    ) -> Vec<Vec<Content>> {
        // By the definition: what would the frame be if those that can rest were read as in the frame before?
        let mut rests: Vec<bool> =
            plan.histories.iter().zip(resets).map(|(h, reset)| h.rest.is_some() && !reset).collect();
        self.wake(plan, revisions, resets, &mut rests);
        for (still, rests) in self.still.iter_mut().zip(&mut rests) {
            *still = if *rests { *still + 1 } else { 0 };
            *rests = *still > 2;
        }
        // And what if those that do not rest yet are read as they are?
        let slept = rests.clone();
        self.wake(plan, revisions, resets, &mut rests);
        for h in (0..rests.len()).filter(|h| slept[*h] && !rests[*h]) {
            self.still[h] = 0;
        }
        self.read = self.pasts(resets, &rests);
        let mut contents = self.contents.clone();
        let all = self.run(plan, revisions, &self.read, &mut contents);
        let waits = |id: usize| only.get(plan.resources[id].producer.0 as usize) == Some(&false);
        for (id, content) in contents.into_iter().enumerate().filter(|(id, _)| !waits(*id)) {
            self.contents[id] = content;
        }
        for (past, id) in self.past.iter_mut().zip(plan.histories.iter().map(|h| h.resource.0 as usize)) {
            if !waits(id) {
                *past = self.contents[id];
            }
        }
        all
    }

    /// Wakes those that would change.
    fn wake(&self, plan: &Plan, revisions: &Revisions, resets: &[bool], rests: &mut [bool]) {
        loop {
            let mut tried = self.contents.clone();
            self.run(plan, revisions, &self.pasts(resets, rests), &mut tried);
            let changed = |h: &usize| {
                let resource = plan.histories[*h].resource.0 as usize;
                rests[*h] && tried[resource] != self.contents[resource]
            };
            let changed: Vec<usize> = (0..rests.len()).filter(changed).collect();
            if changed.is_empty() {
                return;
            }
            changed.into_iter().for_each(|h| rests[h] = false);
        }
    }

    /// What is read of each history buffer.
    fn pasts(&self, resets: &[bool], rests: &[bool]) -> Vec<Content> {
        let read = |h: usize| match (resets[h], rests[h]) {
            (true, _) => INIT,
            (_, true) => self.read[h],
            _ => self.past[h],
        };
        (0..resets.len()).map(read).collect()
    }

    fn run(
        &self,
        plan: &Plan,
        revisions: &Revisions,
        pasts: &[Content],
        contents: &mut [Content],
    ) -> Vec<Vec<Content>> {
        let mut all = Vec::new();
        for (i, pass) in plan.passes.iter().enumerate() {
            let mut reads = Vec::new();
            for input in &pass.inputs {
                for (m, (_, id)) in input.members.iter().enumerate() {
                    reads.push(match &input.history {
                        Some(past) => pasts[past[m].0 as usize],
                        None => contents[id.0 as usize],
                    });
                }
            }
            let written = pass.outputs.iter().flat_map(|port| &port.members);
            for (m, (_, id)) in written.enumerate() {
                contents[id.0 as usize] = make(plan, i, revisions, &reads, m);
            }
            all.push(reads);
        }
        all
    }
}

/// Runs what is scheduled, with contents in objects, as an executor does.
pub(super) fn scheduled(
    plan: &Plan,
    schedule: &FrameSchedule,
    revisions: &Revisions,
    objects: &mut [Content],
) -> Vec<Option<Vec<Content>>> {
    for (history, slot) in plan.histories.iter().zip(&schedule.histories) {
        let producer = plan.producer(history.resource);
        let runs = schedule.runs[producer.0 as usize];
        if slot.reset.is_some() && (runs || !history.in_place) {
            objects[history.copies[slot.previous].0 as usize] = INIT;
        }
    }
    let object = |id: ResourceId| {
        let resource = &plan.resources[id.0 as usize];
        match resource.history {
            Some(history) => {
                plan.histories[history.0 as usize].copies[schedule.histories[history.0 as usize].current].0
                    as usize
            }
            None => resource.allocation.0 as usize,
        }
    };
    let mut all = Vec::new();
    for (i, pass) in plan.passes.iter().enumerate() {
        if !schedule.runs[i] {
            all.push(None);
            continue;
        }
        let mut reads = Vec::new();
        for input in &pass.inputs {
            for (m, (_, id)) in input.members.iter().enumerate() {
                reads.push(match &input.history {
                    Some(past) => {
                        let slot = schedule.histories[past[m].0 as usize];
                        objects[plan.histories[past[m].0 as usize].copies[slot.previous].0 as usize]
                    }
                    None => objects[object(*id)],
                });
            }
        }
        for (m, (_, id)) in pass.outputs.iter().flat_map(|port| &port.members).enumerate() {
            objects[object(*id)] = make(plan, i, revisions, &reads, m);
        }
        all.push(Some(reads));
    }
    all
}
