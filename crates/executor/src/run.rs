//! The executor: encodes frames of the plan that is loaded.

mod load;

use crate::error::ExecutorError;
use crate::fill::{copy, fill, poison_buffer, poison_object};
use crate::gpu::Gpu;
use crate::object::{Object, ObjectUsage, Pool, SceneBinding};
use crate::pipeline::Pipelines;
use crate::readback;
use crate::step::{LoadedStep, StepContext};
use crate::timing::Timers;
use frame_graph::frame::{FrameSchedule, FrameState};
use frame_graph::plan::{AllocationId, Begins, HistoryId, PassId, Plan, ResourceId};
use frame_graph::{Change, ResetCause, ResourceDesc};
use load::Pending;
use pass::{LinkedStep, PastFact, Source, pass_seed};
use std::collections::HashMap;
use std::sync::Arc;

/// How frames run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameOptions {
    /// Time each pass on the GPU.
    pub timed: bool,
    /// Fill what a pass writes with NaN before it runs: pictures must not change.
    pub poison: bool,
}

/// What loading a plan did.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LoadReport {
    /// Passes whose steps are new or changed.
    pub changed: Vec<PassId>,
    /// Pipelines that had to be made.
    pub pipelines: usize,
    /// Whether the plan has the structure of the one before, so that all objects and histories were kept.
    pub kept: bool,
    /// Histories that go on.
    pub histories: usize,
    /// Steps whose bindings have to be made again.
    pub steps: usize,
}

/// What a frame did.
#[derive(Clone, Debug, Default)]
pub struct FrameReport {
    /// One entry a pass: did it run?
    pub ran: Vec<bool>,
    /// Milliseconds on the GPU, one entry a pass; 0 for those that did not run. Empty where not timed.
    pub times: Vec<f64>,
}

/// Runs plans on a device.
#[derive(Debug)]
pub struct Executor {
    gpu: Gpu,
    pool: Pool,
    pipelines: Pipelines,
    scene_bindings: HashMap<&'static str, SceneBinding>,
    scene_indices: u32,
    seed: u32,
    loaded: Option<Loaded>,
    pending: Pending,
}

#[derive(Debug)]
struct Loaded {
    plan: Arc<Plan>,
    objects: Vec<(ObjectUsage, Object)>,
    /// One entry a pass.
    steps: Vec<Vec<LoadedStep>>,
    uniforms: Option<wgpu::Buffer>,
    state: FrameState,
    /// What the last frame did.
    schedule: FrameSchedule,
    timers: Option<Timers>,
    poison: Option<wgpu::Buffer>,
}

impl Executor {
    /// Creates an executor on a device, with nothing loaded.
    pub fn new(gpu: Gpu) -> Executor {
        Executor {
            gpu,
            pool: Pool::default(),
            pipelines: Pipelines::default(),
            scene_bindings: HashMap::new(),
            scene_indices: 0,
            seed: 0,
            loaded: None,
            pending: Pending::default(),
        }
    }

    /// Returns the device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Returns the plan that is loaded.
    pub fn plan(&self) -> Option<&Arc<Plan>> {
        self.loaded.as_ref().map(|loaded| &loaded.plan)
    }

    /// Returns the bytes of all objects that the executor holds.
    pub fn held_bytes(&self) -> u64 {
        self.pool.held
    }

    /// Returns the most bytes of objects that the executor has held at once.
    pub fn most_held_bytes(&self) -> u64 {
        self.pool.most_held
    }

    /// Binds scene bindings. The name is one of [`pass::scene_bindings::GLOBALS`].
    pub fn set_scene_binding(&mut self, name: &'static str, external: SceneBinding) {
        self.scene_bindings.insert(name, external);
        for step in self.loaded.iter_mut().flat_map(|loaded| loaded.steps.iter_mut().flatten()) {
            step.forget_bindings();
        }
    }

    /// Sets how many indices a draw of the scene has.
    pub fn set_scene_indices(&mut self, count: u32) {
        self.scene_indices = count;
    }

    /// Sets the run's seed; passes run again where it is another.
    pub fn set_seed(&mut self, seed: u32) {
        if self.seed != seed {
            self.seed = seed;
            self.pending.all = true;
        }
    }

    fn check_features(&self, plan: &Plan, steps: &[Vec<LinkedStep>]) -> Result<(), ExecutorError> {
        let first = |wants: fn(&LinkedStep) -> bool| {
            let found = plan.passes.iter().zip(steps).find(|(_, steps)| steps.iter().any(wants));
            found.map(|(pass, _)| pass.name.to_string())
        };
        let adapter = || self.gpu.info.name.clone();
        if let Some(pass) = first(LinkedStep::queries_rays).filter(|_| !self.gpu.has_ray_queries()) {
            return Err(ExecutorError::NoRayQueries { pass, adapter: adapter() });
        }
        if let Some(pass) = first(LinkedStep::draws_indirectly).filter(|_| !self.gpu.has_first_instance()) {
            return Err(ExecutorError::NoFirstInstance { pass, adapter: adapter() });
        }
        Ok(())
    }

    /// Runs a frame: what `change` and what followed from earlier ones ask for, and submits it.
    ///
    /// # Errors
    /// What the driver said of the frame's commands; the device gone; no plan loaded.
    ///
    /// # Panics
    /// Where an external that a shader reads is not set: defects of the application.
    pub fn frame(&mut self, mut change: Change, options: FrameOptions) -> Result<FrameReport, ExecutorError> {
        let Some(loaded) = &mut self.loaded else { return Err(ExecutorError::NotLoaded) };
        change.passes.append(&mut self.pending.changed);
        change.again.append(&mut self.pending.again);
        change.all |= std::mem::take(&mut self.pending.all);
        let plan = Arc::clone(&loaded.plan);
        let schedule = loaded.state.begin(&plan, &change);
        loaded.write_uniforms(&self.gpu, &schedule, self.seed);
        if options.poison && loaded.poison.is_none() {
            loaded.poison = Some(poison_buffer(&self.gpu, &plan));
        }
        let mut encoder =
            self.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
        for (history, slot) in plan.histories.iter().zip(&schedule.histories) {
            let resource = &plan.resources[history.resource.0 as usize];
            // Where the past lies in the object that holds the newest version, it ends when the pass runs.
            let runs = resource.producer.is_some_and(|pass| schedule.runs[pass.0 as usize]);
            if slot.reset.is_some() && (runs || !history.in_place) {
                let desc = &resource.desc;
                fill(
                    &mut encoder,
                    &loaded.objects[history.copies[slot.previous].0 as usize].1,
                    desc,
                    history.init,
                );
            }
        }
        let timed = options.timed && loaded.timers.is_some();
        let Loaded { objects, steps, uniforms, timers, poison, .. } = loaded;
        let object_of = |source: &Source| -> Option<(AllocationId, &Object)> {
            let allocation = match source {
                Source::Resource(id) => current_allocation(&plan, &schedule, *id),
                Source::Past(id) => past_allocation(&plan, &schedule, *id),
                Source::SceneBinding(_) | Source::Uniform(_) => return None,
            };
            Some((allocation, &objects[allocation.0 as usize].1))
        };
        let context = StepContext {
            gpu: &self.gpu,
            scene_bindings: &self.scene_bindings,
            scene_indices: self.scene_indices,
            uniforms: uniforms.as_ref(),
            object_of: &object_of,
        };
        let timers = timers.as_ref().filter(|_| timed);
        if let Some(timers) = timers {
            timers.start(&mut encoder);
        }
        let mut open: Option<wgpu::ComputePass<'static>> = None;
        for (index, pass) in plan.passes.iter().enumerate().filter(|(index, _)| schedule.runs[*index]) {
            // What has no steps is written by the application, before the frame.
            let poisoned = poison.as_ref().filter(|_| options.poison && !steps[index].is_empty());
            if !pass.clears.is_empty() || !pass.continues.is_empty() || poisoned.is_some() {
                open = None;
            }
            if let Some(poison) = poisoned {
                let written = pass.outputs.iter().flat_map(|output| output.members.iter().map(|(_, id)| *id));
                for id in written.filter(|id| pass.continues.iter().all(|c| c.resource != *id)) {
                    let allocation = current_allocation(&plan, &schedule, id);
                    poison_object(
                        &mut encoder,
                        poison,
                        &plan.resources[id.0 as usize].desc,
                        &objects[allocation.0 as usize],
                    );
                }
            }
            for (id, clear) in &pass.clears {
                let allocation = current_allocation(&plan, &schedule, *id);
                fill(
                    &mut encoder,
                    &objects[allocation.0 as usize].1,
                    &plan.resources[id.0 as usize].desc,
                    *clear,
                );
            }
            for continued in &pass.continues {
                let from = match continued.from {
                    Begins::InPlace(_) => continue,
                    Begins::CopyOfPast(history) => past_allocation(&plan, &schedule, history),
                    Begins::Copy(id) => current_allocation(&plan, &schedule, id),
                };
                let to = current_allocation(&plan, &schedule, continued.resource);
                let (from, to) = (&objects[from.0 as usize].1, &objects[to.0 as usize].1);
                copy(&mut encoder, from, to, &plan.resources[continued.resource.0 as usize].desc);
            }
            let count = steps[index].len();
            for (i, step) in steps[index].iter_mut().enumerate() {
                let end = (i + 1 == count).then(|| Timers::end_of(index));
                let queries = timers.map(|timers| (&timers.queries, end));
                step.encode(&context, &mut encoder, &mut open, queries);
            }
            if let Some(timers) = timers.filter(|_| count > 0) {
                open = None;
                timers.settle(&mut encoder);
            }
        }
        drop(open);
        if let Some(timers) = timers {
            timers.resolve(&mut encoder);
        }
        self.gpu.queue.submit([encoder.finish()]);
        if let Some(message) = self.gpu.take_fault() {
            return Err(ExecutorError::Pass { pass: "of this frame".to_owned(), message });
        }
        let times = match timers {
            Some(timers) => {
                let stamped =
                    schedule.runs.iter().zip(steps.iter()).map(|(runs, steps)| *runs && !steps.is_empty());
                timers.read(&self.gpu, &stamped.collect::<Vec<_>>())?
            }
            None => Vec::new(),
        };
        loaded.schedule = schedule;
        Ok(FrameReport { ran: loaded.schedule.runs.clone(), times })
    }

    /// Returns the bytes of a resource as the last frame left it: rows and layers without padding. Resources that share
    /// their object may have been overwritten; outputs of the pipeline never are.
    ///
    /// # Errors
    /// Where there is no such resource, or the device is gone.
    pub fn read(&self, resource: ResourceId) -> Result<Vec<u8>, ExecutorError> {
        let found = self.loaded.as_ref().and_then(|loaded| loaded.plan.resources.get(resource.0 as usize));
        let (Some(planned), Some(object)) = (found, self.object(resource)) else {
            return Err(ExecutorError::ReadBack {
                resource: format!("resource {}", resource.0),
                message: "the loaded plan has none of that number".to_owned(),
            });
        };
        readback::read(&self.gpu, &planned.name, &planned.desc, object)
    }

    /// Returns the object of a resource, for an application that draws with it.
    pub fn object(&self, resource: ResourceId) -> Option<&Object> {
        let loaded = self.loaded.as_ref()?;
        let planned = loaded.plan.resources.get(resource.0 as usize)?;
        let allocation = planned.history.map_or(planned.allocation, |history| {
            loaded.plan.histories[history.0 as usize].copies[loaded.state.current(history)]
        });
        Some(&loaded.objects[allocation.0 as usize].1)
    }

    /// Writes a resource's bytes, as a test or an application that feeds a pass does: of a resource whose past is read,
    /// both copies. The resource must not be written by the steps of a pass.
    pub fn write(&self, resource: ResourceId, bytes: &[u8]) {
        let Some(loaded) = &self.loaded else { return };
        let planned = &loaded.plan.resources[resource.0 as usize];
        let copies = planned.history.map(|history| loaded.plan.histories[history.0 as usize].copies);
        let allocations = copies.as_ref().map_or(std::slice::from_ref(&planned.allocation), |copies| copies);
        for allocation in allocations {
            write(&self.gpu, &loaded.objects[allocation.0 as usize].1, &planned.desc, bytes);
        }
    }
}

fn write(gpu: &Gpu, object: &Object, desc: &ResourceDesc, bytes: &[u8]) {
    match (object, desc) {
        (Object::Buffer(buffer), _) => gpu.queue.write_buffer(buffer, 0, bytes),
        (Object::Texture { texture, .. }, ResourceDesc::Texture(desc)) => gpu.queue.write_texture(
            texture.as_image_copy(),
            bytes,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(desc.size.0 * desc.format.bytes() as u32),
                rows_per_image: Some(desc.size.1),
            },
            texture.size(),
        ),
        _ => {}
    }
}

impl Loaded {
    fn write_uniforms(&mut self, gpu: &Gpu, schedule: &FrameSchedule, seed: u32) {
        let Some(buffer) = &self.uniforms else { return };
        let runs =
            self.plan.passes.iter().zip(&mut self.steps).zip(&schedule.runs).filter(|(_, runs)| **runs);
        for ((pass, steps), _) in runs {
            let seed = pass_seed(seed, &pass.name);
            for step in steps {
                step.write_uniforms(gpu, buffer, seed, |history: HistoryId, fact| {
                    let slot = &schedule.histories[history.0 as usize];
                    match fact {
                        PastFact::Age => slot.age,
                        PastFact::Reset => slot.reset.map_or(0, reset_code),
                    }
                });
            }
        }
    }
}

fn reset_code(cause: ResetCause) -> u32 {
    match cause {
        ResetCause::FirstFrame => 1,
        ResetCause::Resize => 2,
        ResetCause::Cut => 3,
        ResetCause::Scene => 4,
        ResetCause::Reload => 5,
        ResetCause::Moved => 6,
    }
}

fn current_allocation(plan: &Plan, schedule: &FrameSchedule, id: ResourceId) -> AllocationId {
    let resource = &plan.resources[id.0 as usize];
    match resource.history {
        Some(history) => {
            plan.histories[history.0 as usize].copies[schedule.histories[history.0 as usize].current]
        }
        None => resource.allocation,
    }
}

fn past_allocation(plan: &Plan, schedule: &FrameSchedule, id: HistoryId) -> AllocationId {
    plan.histories[id.0 as usize].copies[schedule.histories[id.0 as usize].previous]
}

/// What every object is used for, from the steps and clears of the plan.
fn allocation_usages(plan: &Plan, steps: &[Vec<LoadedStep>]) -> Vec<ObjectUsage> {
    let mut usages = vec![ObjectUsage::default(); plan.allocations.len()];
    let mut add = |id: ResourceId, usage: ObjectUsage| {
        let resource = &plan.resources[id.0 as usize];
        let histories = resource.history.map(|history| plan.histories[history.0 as usize].copies);
        for allocation in histories.iter().flatten().chain([&resource.allocation]) {
            let entry = &mut usages[allocation.0 as usize];
            *entry = entry.or(usage);
        }
    };
    for step in steps.iter().flatten() {
        step.usages(plan, &mut add);
    }
    let attachment = ObjectUsage { attachment: true, ..ObjectUsage::default() };
    for pass in &plan.passes {
        pass.clears.iter().for_each(|(id, _)| add(*id, attachment));
        let copied = pass.continues.iter().filter(|c| !matches!(c.from, Begins::InPlace(_)));
        copied.for_each(|c| add(c.resource, ObjectUsage { filled: true, ..ObjectUsage::default() }));
    }
    for (index, resource) in plan.resources.iter().enumerate() {
        if resource.constant.is_some() || resource.history.is_some() {
            add(ResourceId(index as u32), attachment);
        }
        // Filled by tests, by hosts, and with poison; depth formats cannot be copied to.
        if resource.desc.texture().is_some_and(|texture| texture.format != frame_graph::Format::Depth32Float)
        {
            add(ResourceId(index as u32), ObjectUsage { filled: true, ..ObjectUsage::default() });
        }
    }
    usages
}

/// Gives every uniform of the steps its place in one buffer.
fn lay_out_uniforms(gpu: &Gpu, steps: &mut [Vec<LoadedStep>]) -> Option<wgpu::Buffer> {
    let alignment = u64::from(gpu.limits().min_uniform_buffer_offset_alignment);
    let mut size = 0;
    for step in steps.iter_mut().flatten() {
        size = step.place_uniforms(size, alignment);
    }
    (size > 0).then(|| {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("uniforms"),
            size,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    })
}
