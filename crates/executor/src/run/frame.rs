//! Encodes and submits a frame.

use super::{Executor, FrameOptions, FrameReport, Loaded};
use crate::current::{FrameObjects, LayerViews};
use crate::error::ExecutorError;
use crate::fill::{copy, fill, poison_buffer, poison_object};
use crate::gpu::Gpu;
use crate::step::{Dispatch, LoadedStep, OpenPass, StepContext};
use crate::timing::{Timers, TimingTarget, Timings};
use frame_graph::plan::{Begins, HistoryId, Plan, PlannedPass};
use frame_graph::{Change, Clear};
use std::time::Instant;

impl Executor {
    /// Runs a frame: encodes what `change` and pending earlier changes require, and submits it. A frame that
    /// is like the one before allocates no memory, except within wgpu.
    ///
    /// # Errors
    /// The driver's error for the commands of the frame, a lost device, or no loaded plan.
    ///
    /// # Panics
    /// Panics if a scene binding that a shader reads is not set, which is a defect of the application.
    pub fn frame(&mut self, change: &Change, options: FrameOptions) -> Result<&FrameReport, ExecutorError> {
        let Executor {
            gpu,
            scene_bindings,
            chosen_lights,
            scene_indices,
            sample,
            loaded,
            pending,
            report,
            frames,
            ..
        } = self;
        let Some(loaded) = loaded else { return Err(ExecutorError::NotLoaded) };
        let Loaded { plan, objects, steps, prepares, uniforms, state, timers, poison, views } = loaded;
        let (gpu, plan): (&Gpu, &Plan) = (gpu, plan);
        gpu.check()?;
        pending.add(change);
        let schedule = state.begin(plan, pending);
        report.partial = !pending.only.is_empty();
        pending.clear();
        if let Some(uniforms) = uniforms {
            uniforms.write(gpu, plan, schedule, *sample);
        }
        if let Some(byte) = options.poison
            && poison.as_ref().is_none_or(|(of, _)| *of != byte)
        {
            *poison = Some((byte, poison_buffer(gpu, plan, byte)));
        }
        let target = timers.as_mut().and_then(|timers| match options {
            FrameOptions { timed: true, .. } => Some(TimingTarget::Exact),
            FrameOptions { monitored: true, .. } => timers.free_slot(gpu),
            _ => None,
        });
        report.frame = *frames;
        *frames += 1;
        report.ran.clone_from(&schedule.runs);
        let resets = schedule.histories.iter().enumerate();
        let resets = resets.filter_map(|(h, slot)| Some((HistoryId(h as u32), slot.reset?)));
        report.resets.clear();
        report.resets.extend(resets);
        report.times.clear();
        report.encoding.clear();
        if target.is_none() && report.resets.is_empty() && schedule.runs.iter().all(|runs| !runs) {
            // Pending writes to buffers must reach the GPU even so: otherwise they would accumulate.
            gpu.submit(None);
            return found_no_fault(gpu).map(|()| &*report);
        }
        let context = StepContext {
            gpu,
            scene_bindings,
            chosen_lights,
            scene_indices: *scene_indices,
            uniforms: uniforms.as_ref().map(|uniforms| &uniforms.buffer),
            objects: FrameObjects { plan, schedule, objects },
        };
        let descriptor = wgpu::CommandEncoderDescriptor { label: Some("frame") };
        let mut frame = FrameEncoder {
            context,
            views,
            encoder: gpu.device.create_command_encoder(&descriptor),
            open: None,
            timers: timers.as_ref().filter(|_| target.is_some()),
            poison: poison.as_ref().filter(|_| options.poison.is_some()).map(|(_, buffer)| buffer),
        };
        frame.begin_pasts();
        if let Some(timers) = frame.timers {
            timers.start(&mut frame.encoder);
        }
        let passes = steps.iter_mut().zip(prepares.iter()).enumerate();
        if target.is_some() {
            report.encoding.resize(plan.passes.len(), 0.0);
        }
        for (index, (steps, prepares)) in passes.filter(|(index, _)| schedule.runs[*index]) {
            let begun = target.map(|_| Instant::now());
            let pass = plan.passes[index].name.as_str();
            let _encoding = tracing::trace_span!(target: "frame", "encode", pass).entered();
            // A resource whose pass has no steps is written by the application before the frame.
            let poison = frame.poison.filter(|_| !steps.is_empty());
            if *prepares || poison.is_some() {
                frame.prepare(&plan.passes[index], poison);
            }
            frame.encode(index, steps);
            if let Some(begun) = begun {
                report.encoding[index] = begun.elapsed().as_secs_f64() * 1e3;
            }
        }
        // A compute pass is ended by dropping it, before its encoder is finished.
        frame.open = None;
        if let (Some(timers), Some(target)) = (frame.timers, target) {
            timers.resolve(&mut frame.encoder, target);
        }
        let submitting = tracing::trace_span!(target: "frame", "submit").entered();
        gpu.submit(Some(frame.encoder.finish()));
        drop(submitting);
        found_no_fault(gpu)?;
        let stamped =
            || schedule.runs.iter().zip(steps.iter()).map(|(runs, steps)| *runs && !steps.is_empty());
        match (timers, target) {
            (Some(timers), Some(TimingTarget::Exact)) => {
                timers.read(gpu, report.frame, stamped(), &mut report.times)?;
            }
            (Some(timers), Some(TimingTarget::Slot(slot))) => timers.request(slot, report.frame, stamped()),
            _ => {}
        }
        Ok(report)
    }

    /// Returns whether no frame of the loaded plan has run.
    pub fn is_fresh(&self) -> bool {
        self.loaded.as_ref().is_some_and(|loaded| loaded.state.is_fresh())
    }

    /// Returns the report of the last frame; empty before the first.
    pub fn report(&self) -> &FrameReport {
        &self.report
    }

    /// Returns the GPU times of the newest frame of the loaded plan that was [timed](FrameOptions::timed), or
    /// [monitored](FrameOptions::monitored) and has finished, usually one to three frames ago. Never waits.
    /// `None` until there is one, and if the adapter has no timestamps.
    pub fn timings(&mut self) -> Option<&Timings> {
        let timers = self.loaded.as_mut()?.timers.as_mut()?;
        timers.newest(&self.gpu)
    }

    /// Returns the dispatches of the passes that the last frame ran, without those whose size is on the GPU.
    /// This serves to measure the cost of encoding them in another way.
    pub fn dispatches(&self) -> impl Iterator<Item = Dispatch<'_>> {
        let passes =
            self.loaded.iter().flat_map(|loaded| loaded.state.schedule().runs.iter().zip(&loaded.steps));
        passes.filter(|(ran, _)| **ran).flat_map(|(_, steps)| steps).filter_map(LoadedStep::dispatch)
    }
}

/// Returns the error of the frame that was just submitted.
fn found_no_fault(gpu: &Gpu) -> Result<(), ExecutorError> {
    gpu.check()?;
    match gpu.take_fault() {
        Some(message) => Err(ExecutorError::Pass { pass: "of this frame".to_owned(), message }),
        None => Ok(()),
    }
}

/// A frame that is being encoded.
struct FrameEncoder<'a> {
    context: StepContext<'a>,
    views: &'a mut LayerViews,
    encoder: wgpu::CommandEncoder,
    /// The compute pass that the next dispatch joins.
    open: Option<OpenPass>,
    timers: Option<&'a Timers>,
    poison: Option<&'a wgpu::Buffer>,
}

impl FrameEncoder<'_> {
    /// Fills history buffers that were reset with zeros.
    fn begin_pasts(&mut self) {
        let FrameObjects { plan, schedule, .. } = self.context.objects;
        for (history, slot) in plan.histories.iter().zip(&schedule.histories) {
            let resource = &plan.resources[history.resource.0 as usize];
            // If the history buffer is in the object that holds the newest version, it is reset when the pass
            // runs.
            let runs = schedule.runs[resource.producer.0 as usize];
            if slot.reset.is_some() && (runs || !history.in_place) {
                let id = history.copies[slot.previous];
                let object = self.context.objects.object(id);
                fill(&mut self.encoder, self.views, (id, object), &resource.desc, Clear::Zero);
            }
        }
    }

    /// Poisons, clears and copies the resources that a pass writes.
    fn prepare(&mut self, pass: &PlannedPass, poison: Option<&wgpu::Buffer>) {
        self.open = None;
        if let Some(poison) = poison {
            self.poison(poison, pass);
        }
        let objects = self.context.objects;
        for (resource, clear) in &pass.clears {
            let id = objects.current(*resource);
            let desc = &objects.plan.resources[resource.0 as usize].desc;
            fill(&mut self.encoder, self.views, (id, objects.object(id)), desc, *clear);
        }
        for continued in &pass.continues {
            let from = match continued.from {
                Begins::InPlace(_) => continue,
                Begins::CopyOfPast(history) => objects.past(history),
                Begins::Copy(id) => objects.current(id),
            };
            let to = objects.current(continued.resource);
            let desc = &objects.plan.resources[continued.resource.0 as usize].desc;
            copy(&mut self.encoder, objects.object(from), objects.object(to), desc);
        }
    }

    fn encode(&mut self, index: usize, steps: &mut [LoadedStep]) {
        let count = steps.len();
        for (i, step) in steps.iter_mut().enumerate() {
            let end = (i + 1 == count).then(|| Timers::end_of(index));
            let queries = self.timers.map(|timers| (&timers.queries, end));
            step.encode(self.context, self.views, &mut self.encoder, &mut self.open, queries);
        }
        if let Some(timers) = self.timers.filter(|_| count > 0) {
            self.open = None;
            timers.take(&mut self.encoder);
        }
    }

    /// Fills the resources that a pass writes.
    fn poison(&mut self, poison: &wgpu::Buffer, pass: &PlannedPass) {
        let objects = self.context.objects;
        let written = pass.outputs.iter().flat_map(|output| output.members.iter().map(|(_, id)| *id));
        for id in written.filter(|id| pass.continues.iter().all(|c| c.resource != *id)) {
            let desc = &objects.plan.resources[id.0 as usize].desc;
            let object = &objects.objects[objects.current(id).0 as usize];
            poison_object(&mut self.encoder, poison, desc, object);
        }
    }
}
