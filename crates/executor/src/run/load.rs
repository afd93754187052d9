//! Loads a plan in place of another: what is kept, what is created, and what remains if that fails.

use super::{Executor, LoadReport, Loaded, allocation_usages};
use crate::current::LayerViews;
use crate::error::ExecutorError;
use crate::fill::copy;
use crate::object::{Object, ObjectUsage, check_limits};
use crate::pipeline::TargetFormats;
use crate::step::{LoadedStep, bound_bytes};
use crate::timing::Timers;
use crate::uniforms::Uniforms;
use frame_graph::frame::FrameState;
use frame_graph::plan::{AllocationId, PassId, Plan};
use frame_graph::{Change, Name, Succession, Value};
use pass::LinkedSteps;
use std::collections::{HashMap, HashSet};
use std::sync::{Arc, PoisonError};

/// An object that is kept for another plan, with its content.
struct Carried {
    from: AllocationId,
    to: AllocationId,
    /// Whether its content is copied, because the object does not allow the usage of the new plan.
    copied: bool,
}

/// A pass and its steps, built.
type Built = (PassId, Vec<LoadedStep>);

/// Objects by allocation; `None` for one that was released.
type Objects = Vec<Option<(ObjectUsage, Object)>>;

impl Executor {
    /// Loads a plan with the linked steps of its passes, in place of the loaded one. If anything fails, the
    /// loaded one stays.
    ///
    /// If both have the same [structure](Plan::structure), only values change: objects, history buffers, and
    /// the pipelines and bind groups of all steps with the same bindings are kept, and the passes whose
    /// values differ run in the next frame. A pass whose steps are the very ones that are loaded costs nothing.
    /// Otherwise history buffers with the same name, description and initial value are kept (see
    /// [`Succession`]), and all passes run in the next frame. Objects are released before others are created,
    /// so that no more memory than the larger of both plans needs is held at once.
    ///
    /// # Errors
    /// A feature that the adapter lacks, a pipeline that the driver rejects, an exceeded limit, or
    /// insufficient memory, with the pass and the bytes. If memory is insufficient, the objects of the plan
    /// before are created again; if that fails too, no plan is loaded any more
    /// ([`ExecutorError::NothingLeft`]).
    pub fn load(&mut self, plan: Arc<Plan>, steps: Vec<LinkedSteps>) -> Result<LoadReport, ExecutorError> {
        let (report, reloaded) = self.exchange_plan(plan, steps)?;
        self.pending.passes.extend(reloaded);
        Ok(report)
    }

    /// Loads a plan that differs by values that were set between frames: as [`Executor::load`], but for history buffers this
    /// is a [`ResetCause::Setting`].
    ///
    /// # Errors
    /// As [`Executor::load`].
    ///
    /// [`ResetCause::Setting`]: frame_graph::ResetCause::Setting
    pub fn load_values(
        &mut self,
        plan: Arc<Plan>,
        steps: Vec<LinkedSteps>,
    ) -> Result<LoadReport, ExecutorError> {
        let (report, reloaded) = self.exchange_plan(plan, steps)?;
        self.pending.values.extend(reloaded);
        Ok(report)
    }

    /// Loads a plan; also returns the passes whose settings, shaders or links changed.
    fn exchange_plan(
        &mut self,
        plan: Arc<Plan>,
        steps: Vec<LinkedSteps>,
    ) -> Result<(LoadReport, Vec<PassId>), ExecutorError> {
        self.gpu.check()?;
        self.check_features(&plan, &steps)?;
        self.check_sizes(&plan, &steps)?;
        let usages = allocation_usages(&plan, steps.iter().flatten().map(|step| &**step));
        let succession = self.loaded.as_ref().map(|old| Succession::between(&old.plan, &plan));
        let kept = self.loaded.as_ref().is_some_and(|old| {
            old.plan.structure == plan.structure
                && old.objects.iter().zip(&usages).all(|((old, _), new)| old.covers(*new))
        });
        let (others, pipelines) = self.build(&plan, steps, kept)?;
        let differs = self.compare(&plan, &others, succession.as_ref());
        let mut report = LoadReport { pipelines, kept, ..LoadReport::default() };
        match succession {
            Some(_) if kept => {
                report.histories = plan.histories.len();
                report.steps = self.exchange_values(plan, others);
            }
            succession => {
                let steps: Vec<_> = others.into_iter().map(|(_, steps)| steps).collect();
                report.histories = succession.iter().flat_map(|s| &s.histories).filter(|h| h.is_ok()).count();
                report.steps = steps.iter().map(Vec::len).sum();
                self.exchange(plan, steps, &usages, succession.as_ref())?;
            }
        }
        self.pending.again.extend(&differs.changed);
        report.changed = differs.changed;
        let loaded = self.loaded.iter().flat_map(|loaded| loaded.steps.iter().flatten());
        let used: HashSet<u128> = loaded.map(LoadedStep::shader_hash).collect();
        self.pipelines.lock().unwrap_or_else(PoisonError::into_inner).trim(&used);
        Ok((report, differs.reloaded))
    }

    /// Checks objects, and what steps bind of buffers, against the limits of the adapter.
    fn check_sizes(&self, plan: &Plan, steps: &[LinkedSteps]) -> Result<(), ExecutorError> {
        let mut bound = vec![0; plan.allocations.len()];
        for step in steps.iter().flatten() {
            bound_bytes(step, plan, &mut |id, bytes| {
                let most = &mut bound[plan.resources[id.0 as usize].allocation.0 as usize];
                *most = bytes.max(*most);
            });
        }
        for (allocation, bound) in plan.allocations.iter().zip(bound) {
            let from = || size_from(plan, allocation);
            check_limits(&self.gpu, name_of(plan, allocation), (&allocation.desc, bound), from)?;
        }
        let bytes = plan.allocations.iter().map(|allocation| allocation.desc.bytes()).sum();
        let largest = plan.allocations.iter().max_by_key(|allocation| allocation.desc.bytes());
        match (largest, self.gpu.memory()) {
            (Some(largest), Some(memory)) if bytes > memory => Err(ExecutorError::Memory {
                bytes,
                memory,
                largest: name_of(plan, largest).to_owned(),
                most: largest.desc.bytes(),
            }),
            _ => Ok(()),
        }
    }

    /// Builds the steps of all passes, or, where the structure is `kept`, of those whose steps are not the loaded ones;
    /// also returns how many pipelines were created.
    fn build(
        &mut self,
        plan: &Plan,
        steps: Vec<LinkedSteps>,
        kept: bool,
    ) -> Result<(Vec<Built>, usize), ExecutorError> {
        let loaded = self.loaded.as_ref().filter(|_| kept);
        let mut others: Vec<(usize, LinkedSteps)> = steps.into_iter().enumerate().collect();
        others.retain(|(i, steps)| !loaded.is_some_and(|loaded| holds(&loaded.steps[*i], steps)));
        let of_pass = others.iter().flat_map(|(i, steps)| {
            let name = plan.passes[*i].name.as_str();
            steps.iter().map(move |step| (name, &**step, TargetFormats::of(plan, step)))
        });
        let mut pipelines = self.pipelines.lock().unwrap_or_else(PoisonError::into_inner);
        let created = pipelines.create(&self.gpu, of_pass)?;
        let build = |(i, steps): (usize, LinkedSteps)| {
            let pass = &plan.passes[i];
            let steps = steps.into_iter();
            let row = steps.map(|step| LoadedStep::new(&self.gpu, &pipelines, plan, pass, step));
            (PassId(i as u32), row.collect())
        };
        Ok((others.into_iter().map(build).collect(), created))
    }

    /// Compares passes whose steps were built with the loaded ones, by name.
    fn compare(&self, plan: &Plan, built: &[Built], succession: Option<&Succession>) -> Differences {
        let mut found = Differences::default();
        let old: HashMap<&Name, &Vec<LoadedStep>> =
            self.loaded.as_ref().map_or_else(HashMap::new, |loaded| {
                loaded.plan.passes.iter().map(|pass| &pass.name).zip(&loaded.steps).collect()
            });
        let shaders =
            |steps: &[LoadedStep]| -> HashSet<u128> { steps.iter().map(LoadedStep::shader_hash).collect() };
        for (id, steps) in built {
            let (id, before) = (*id, old.get(&plan.passes[id.0 as usize].name));
            let relinked = succession.is_some_and(|succession| succession.changed.contains(&id));
            let reloaded = relinked || before.is_some_and(|before| shaders(before) != shaders(steps));
            let same_work = before.is_some_and(|before| {
                before.len() == steps.len() && before.iter().zip(steps).all(|(a, b)| a.same_work(b))
            });
            if reloaded {
                found.reloaded.push(id);
            }
            if reloaded || !same_work {
                found.changed.push(id);
            }
        }
        found
    }

    /// Takes the values of a plan with the same structure, with the steps of passes that differ; returns the number
    /// of steps whose bind groups must be created again.
    fn exchange_values(&mut self, plan: Arc<Plan>, others: Vec<Built>) -> usize {
        let Some(loaded) = &mut self.loaded else { return 0 };
        let mut renewed = 0;
        for (id, new) in others {
            let old = &mut loaded.steps[id.0 as usize];
            if old.len() != new.len() {
                renewed += new.len();
                *old = new;
                continue;
            }
            for (old, new) in old.iter_mut().zip(new) {
                if let Err(new) = old.take_values(new) {
                    renewed += 1;
                    *old = *new;
                }
            }
        }
        if renewed > 0 {
            loaded.uniforms = Uniforms::new(&self.gpu, &plan, &mut loaded.steps);
        } else if let Some(uniforms) = &mut loaded.uniforms {
            uniforms.fill(&loaded.steps);
        }
        loaded.plan = plan;
        renewed
    }

    /// Takes a plan with another structure.
    fn exchange(
        &mut self,
        plan: Arc<Plan>,
        mut steps: Vec<Vec<LoadedStep>>,
        usages: &[ObjectUsage],
        succession: Option<&Succession>,
    ) -> Result<(), ExecutorError> {
        let mut old = self.loaded.take();
        let carried = match (&old, succession) {
            (Some(old), Some(succession)) => carry(old, &plan, usages, succession),
            _ => Vec::new(),
        };
        let mut before: Objects = Vec::new();
        let mut before_usages = Vec::new();
        if let Some(old) = &mut old {
            // Bind groups and views hold objects too.
            old.steps.iter_mut().flatten().for_each(LoadedStep::forget_bindings);
            old.views.clear();
            before_usages.extend(old.objects.iter().map(|(usage, _)| *usage));
            before.extend(old.objects.drain(..).map(Some));
            for (i, (object, allocation)) in before.iter_mut().zip(&old.plan.allocations).enumerate() {
                if carried.iter().all(|carried| carried.from.0 as usize != i)
                    && let Some((usage, object)) = object.take()
                {
                    self.pool.give(allocation.desc.clone(), usage, object);
                }
            }
        }
        let mut usages = usages.to_vec();
        let mut objects: Objects = vec![None; usages.len()];
        for carried in &carried {
            let to = carried.to.0 as usize;
            match carried.copied {
                true => usages[to].filled = true,
                false => objects[to].clone_from(&before[carried.from.0 as usize]),
            }
        }
        let objects = match self.complete(&plan, &usages, objects) {
            Ok(objects) => objects,
            Err(error) => return Err(self.restore(old, before, &before_usages, error)),
        };
        self.copy_carried(&plan, &objects, &before, &carried);
        let uniforms = Uniforms::new(&self.gpu, &plan, &mut steps);
        let timers = Timers::new(&self.gpu, plan.passes.len() as u32);
        let state = match (&old, succession) {
            (Some(old), Some(succession)) => old.state.succeed(&plan, succession),
            _ => FrameState::new(&plan),
        };
        if let Some(old) = old {
            for carried in carried.iter().filter(|carried| carried.copied) {
                if let Some((usage, object)) = before[carried.from.0 as usize].take() {
                    let desc = old.plan.allocations[carried.from.0 as usize].desc.clone();
                    self.pool.give(desc, usage, object);
                }
            }
            self.pool.trim();
            follow(&mut self.pending, &old.plan, &plan);
        }
        let prepares =
            plan.passes.iter().map(|pass| !pass.clears.is_empty() || !pass.continues.is_empty()).collect();
        self.loaded = Some(Loaded {
            plan,
            objects,
            steps,
            prepares,
            uniforms,
            state,
            timers,
            poison: None,
            views: LayerViews::default(),
        });
        Ok(())
    }

    /// Creates the missing objects of a plan: first from those that were released, then, once the rest of
    /// these are freed, as new ones.
    fn complete(
        &mut self,
        plan: &Plan,
        usages: &[ObjectUsage],
        mut objects: Objects,
    ) -> Result<Vec<(ObjectUsage, Object)>, ExecutorError> {
        let mut lent = Vec::new();
        for (i, allocation) in plan.allocations.iter().enumerate() {
            if objects[i].is_none()
                && let Some(object) = self.pool.find(&allocation.desc, usages[i])
            {
                objects[i] = Some((usages[i], object));
                lent.push(i);
            }
        }
        if self.pool.trim() {
            // Objects live until the frames that use them have finished.
            self.gpu.wait()?;
        }
        for (i, allocation) in plan.allocations.iter().enumerate() {
            if objects[i].is_some() {
                continue;
            }
            // Textures may be asked to be poisoned later on; buffers always can be.
            match self.pool.make(&self.gpu, name_of(plan, allocation), &allocation.desc, usages[i]) {
                Ok(object) => {
                    objects[i] = Some((usages[i], object));
                    lent.push(i);
                }
                Err(error) => {
                    for i in lent {
                        if let Some((usage, object)) = objects[i].take() {
                            self.pool.give(plan.allocations[i].desc.clone(), usage, object);
                        }
                    }
                    return Err(error);
                }
            }
        }
        Ok(objects.into_iter().flatten().collect())
    }

    /// Creates the released objects of the plan before again, because of `error`; returns the error to
    /// report.
    fn restore(
        &mut self,
        old: Option<Loaded>,
        before: Objects,
        usages: &[ObjectUsage],
        error: ExecutorError,
    ) -> ExecutorError {
        let Some(mut old) = old else {
            self.pool.trim();
            return error;
        };
        let held: u64 = old
            .plan
            .allocations
            .iter()
            .zip(&before)
            .filter(|(_, object)| object.is_some())
            .map(|(allocation, _)| allocation.desc.bytes())
            .sum();
        let kept: Vec<bool> = before.iter().map(Option::is_some).collect();
        match self.complete(&old.plan, usages, before) {
            Ok(objects) => {
                old.objects = objects;
                old.state.forget_objects(&old.plan, |id| kept[id.0 as usize]);
                self.loaded = Some(old);
                error
            }
            Err(again) => {
                self.pool.trim();
                self.pool.held = self.pool.held.saturating_sub(held);
                ExecutorError::NothingLeft { error: Box::new(error), again: Box::new(again) }
            }
        }
    }

    /// Copies the content that is carried over to other objects.
    fn copy_carried(
        &self,
        plan: &Plan,
        objects: &[(ObjectUsage, Object)],
        before: &Objects,
        carried: &[Carried],
    ) {
        let descriptor = wgpu::CommandEncoderDescriptor { label: Some("contents") };
        let mut encoder = self.gpu.device.create_command_encoder(&descriptor);
        for carried in carried.iter().filter(|carried| carried.copied) {
            if let Some((_, from)) = &before[carried.from.0 as usize] {
                let to = carried.to.0 as usize;
                copy(&mut encoder, from, &objects[to].1, &plan.allocations[to].desc);
            }
        }
        self.gpu.submit(Some(encoder.finish()));
    }
}

/// Whether the loaded steps of a pass are these.
fn holds(loaded: &[LoadedStep], steps: &LinkedSteps) -> bool {
    loaded.len() == steps.len() && loaded.iter().zip(steps).all(|(loaded, step)| loaded.is(step))
}

/// The differences between passes and those loaded before.
#[derive(Default)]
struct Differences {
    /// Passes whose settings, shaders or links differ.
    reloaded: Vec<PassId>,
    /// All passes whose work differs for any reason, including these.
    changed: Vec<PassId>,
}

/// Finds the passes of a change, by name, in a plan that replaces another.
fn follow(pending: &mut Change, old: &Plan, new: &Plan) {
    // All passes run anyway.
    pending.again.clear();
    pending.reseeded.clear();
    let found = pending.passes.iter().filter_map(|id| new.pass(&old.passes[id.0 as usize].name));
    pending.passes = found.collect();
}

/// Returns the objects of history buffers that are kept. Only the newest version of each is meaningful.
fn carry(old: &Loaded, plan: &Plan, usages: &[ObjectUsage], succession: &Succession) -> Vec<Carried> {
    let histories = succession.histories.iter().zip(&plan.histories);
    histories
        .filter_map(|(before, history)| {
            let before = *before.as_ref().ok()?;
            let current = old.state.current(before);
            let from = old.plan.histories[before.0 as usize].copies[current];
            let to = history.copies[current];
            let copied = !old.objects[from.0 as usize].0.covers(usages[to.0 as usize]);
            Some(Carried { from, to, copied })
        })
        .collect()
}

fn name_of<'p>(plan: &'p Plan, allocation: &frame_graph::plan::Allocation) -> &'p str {
    allocation.resources.first().map_or("unused", |id| plan.resources[id.0 as usize].name.as_str())
}

/// Returns what determines the size of a resource, for the error that it is too large: the facts of its port,
/// and the numbers among the settings of the pass that writes it.
fn size_from(plan: &Plan, allocation: &frame_graph::plan::Allocation) -> String {
    let Some(id) = allocation.resources.first() else { return String::new() };
    let pass = &plan.passes[plan.producer(*id).0 as usize];
    let port = pass.outputs.iter().find(|port| port.members.iter().any(|(_, member)| member == id));
    let number = |(name, value): (&str, &Value)| value.as_u32().map(|value| format!("{name} = {value}"));
    let facts: Vec<String> = port.iter().flat_map(|port| port.facts.iter()).filter_map(number).collect();
    let settings = pass.settings.0.iter().map(|(name, value)| (name.as_str(), value));
    let settings: Vec<String> = settings.filter_map(number).collect();
    let mut from = String::new();
    if !facts.is_empty() {
        from += &format!("\n  what it holds: {}", facts.join(", "));
    }
    if !settings.is_empty() {
        from += &format!("\n  settings of `{}`: {}", pass.name, settings.join(", "));
    }
    from
}
