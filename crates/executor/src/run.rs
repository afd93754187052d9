//! The executor: the objects that it holds, and what an application reads and writes between frames.

mod frame;
mod load;

use crate::current::LayerViews;
use crate::error::ExecutorError;
use crate::gpu::Gpu;
use crate::object::{ChosenLights, Object, ObjectUsage, Pool, SceneBinding};
use crate::pipeline::Pipelines;
use crate::readback;
use crate::step::{LoadedStep, usages as usages_of};
use crate::timing::Timers;
use crate::uniforms::{Sample, Uniforms};
use frame_graph::frame::FrameState;
use frame_graph::plan::{Begins, HistoryId, PassId, Plan, ResourceId};
use frame_graph::{Change, ResetCause, ResourceDesc};
use pass::{LinkedStep, LinkedSteps};
use std::collections::HashMap;
use std::sync::{Arc, Mutex};

/// Options of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameOptions {
    /// Time each pass on the GPU, and wait for the results.
    pub timed: bool,
    /// Time each pass on the GPU without waiting: [`Executor::timings`] returns the times some frames later.
    /// Timed passes do not overlap on the GPU, with either option.
    pub monitored: bool,
    /// Fill the resources that a pass writes with this byte before it runs, such as [`FrameOptions::NAN`]: pictures must not
    /// change.
    pub poison: Option<u8>,
}

impl FrameOptions {
    /// A byte of which every float is NaN.
    pub const NAN: u8 = 0xff;
}

/// The result of loading a plan.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LoadReport {
    /// Passes whose steps are new or changed.
    pub changed: Vec<PassId>,
    /// Number of pipelines that had to be created.
    pub pipelines: usize,
    /// Whether the plan has the structure of the one before, so that all objects and history buffers were
    /// kept.
    pub kept: bool,
    /// Number of history buffers that were kept.
    pub histories: usize,
    /// Number of steps whose bind groups must be created again.
    pub steps: usize,
}

/// The result of a frame.
#[derive(Clone, Debug, Default)]
pub struct FrameReport {
    /// Number of the frame, from 0 for the executor's first.
    pub frame: u64,
    /// For each pass, whether it ran.
    pub ran: Vec<bool>,
    /// Whether passes were left out that [`Change::only`] does not have.
    pub partial: bool,
    /// Milliseconds on the GPU for each pass; 0 for those that did not run. Empty if the frame was not timed.
    pub times: Vec<f64>,
    /// Milliseconds in which this thread encoded each pass; 0 for those that did not run. Empty if the frame was neither
    /// timed nor monitored.
    pub encoding: Vec<f64>,
    /// The history buffers that were reset, and why.
    pub resets: Vec<(HistoryId, ResetCause)>,
}

/// Runs plans on a device.
#[derive(Debug)]
pub struct Executor {
    gpu: Gpu,
    pool: Pool,
    pipelines: Arc<Mutex<Pipelines>>,
    scene_bindings: HashMap<&'static str, SceneBinding>,
    chosen_lights: HashMap<ChosenLights, wgpu::Buffer>,
    scene_indices: u32,
    sample: Sample,
    loaded: Option<Loaded>,
    /// Changes for the next frame: from plans that were loaded, and from another sample.
    pending: Change,
    /// The result of the last frame.
    report: FrameReport,
    /// The number of the next frame.
    frames: u64,
}

#[derive(Debug)]
struct Loaded {
    plan: Arc<Plan>,
    objects: Vec<(ObjectUsage, Object)>,
    /// The steps of each pass.
    steps: Vec<Vec<LoadedStep>>,
    /// For each pass, whether something is cleared or copied before its steps. It is stored apart from the
    /// plan, so that a frame of many dispatches reads little memory.
    prepares: Vec<bool>,
    uniforms: Option<Uniforms>,
    state: FrameState,
    timers: Option<Timers>,
    /// The byte that it is filled with, and the buffer.
    poison: Option<(u8, wgpu::Buffer)>,
    views: LayerViews,
}

impl Executor {
    /// Creates an executor on a device, with nothing loaded.
    pub fn new(gpu: Gpu) -> Executor {
        let pipelines = gpu.pipelines();
        Executor {
            gpu,
            pool: Pool::default(),
            pipelines,
            scene_bindings: HashMap::new(),
            chosen_lights: HashMap::new(),
            scene_indices: 0,
            sample: Sample::default(),
            loaded: None,
            pending: Change::default(),
            report: FrameReport::default(),
            frames: 0,
        }
    }

    /// Returns the device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Returns the loaded plan.
    pub fn plan(&self) -> Option<&Arc<Plan>> {
        self.loaded.as_ref().map(|loaded| &loaded.plan)
    }

    /// Returns the size of all objects that the executor holds, in bytes.
    pub fn held_bytes(&self) -> u64 {
        self.pool.held
    }

    /// Returns the greatest size of all objects that the executor has held at once, in bytes.
    pub fn most_held_bytes(&self) -> u64 {
        self.pool.most_held
    }

    /// Sets a scene binding. The name is one of [`pass::scene_bindings::GLOBALS`].
    pub fn set_scene_binding(&mut self, name: &'static str, binding: SceneBinding) {
        self.scene_bindings.insert(name, binding);
        self.forget_binding(name);
    }

    /// Sets what a scene binding of lights is to steps that take but the sources of these names: see
    /// [`pass::LinkedStep::chosen_lights`].
    pub fn set_chosen_lights(&mut self, name: &'static str, sources: Arc<[String]>, buffer: wgpu::Buffer) {
        self.chosen_lights.insert((name, sources), buffer);
        self.forget_binding(name);
    }

    /// Drops the bind groups that hold a scene binding.
    fn forget_binding(&mut self, name: &str) {
        for step in self.loaded.iter_mut().flat_map(|loaded| loaded.steps.iter_mut().flatten()) {
            step.forget_binding(name);
        }
    }

    /// Sets the number of indices of a draw of the scene.
    pub fn set_scene_indices(&mut self, count: u32) {
        self.scene_indices = count;
    }

    /// Sets the run's seed and the number of the sample that the next frame is; if one changes, the passes whose random numbers follow them
    /// run again.
    pub fn set_sample(&mut self, run_seed: u32, number: u32) {
        let sample = Sample { run_seed, number };
        if self.sample != sample {
            self.sample = sample;
            let uniforms = self.loaded.as_ref().and_then(|loaded| loaded.uniforms.as_ref());
            let seeded = uniforms.into_iter().flat_map(Uniforms::seeded_passes);
            self.pending.reseeded.extend(seeded);
        }
    }

    fn check_features(&self, plan: &Plan, steps: &[LinkedSteps]) -> Result<(), ExecutorError> {
        let first = |wants: fn(&LinkedStep) -> bool| {
            let found = plan.passes.iter().zip(steps).find(|(_, steps)| steps.iter().any(|step| wants(step)));
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

    /// Returns the bytes of a resource after the last frame, with rows and layers without padding. Resources
    /// that share their object may have been overwritten; outputs of the pipeline never are.
    ///
    /// # Errors
    /// Fails if there is no such resource, or the device is lost.
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

    /// Writes the bytes of a resource, for a test or an application that provides data to a pass. For a
    /// resource with a history buffer, both copies are written. The resource must not be written by the steps
    /// of a pass.
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

/// Returns the usage of every object, from the steps and clears of the plan.
fn allocation_usages<'s>(plan: &Plan, steps: impl Iterator<Item = &'s LinkedStep>) -> Vec<ObjectUsage> {
    let mut usages = vec![ObjectUsage::default(); plan.allocations.len()];
    let mut add = |id: ResourceId, usage: ObjectUsage| {
        let resource = &plan.resources[id.0 as usize];
        let histories = resource.history.map(|history| plan.histories[history.0 as usize].copies);
        for allocation in histories.iter().flatten().chain([&resource.allocation]) {
            let entry = &mut usages[allocation.0 as usize];
            *entry = entry.or(usage);
        }
    };
    for step in steps {
        usages_of(step, plan, &mut add);
    }
    let attachment = ObjectUsage { attachment: true, ..ObjectUsage::default() };
    for pass in &plan.passes {
        pass.clears.iter().for_each(|(id, _)| add(*id, attachment));
        let copied = pass.continues.iter().filter(|c| !matches!(c.from, Begins::InPlace(_)));
        copied.for_each(|c| add(c.resource, ObjectUsage { filled: true, ..ObjectUsage::default() }));
    }
    for (index, resource) in plan.resources.iter().enumerate() {
        if resource.history.is_some() {
            add(ResourceId(index as u32), attachment);
        }
        // Tests, applications and poisoning write into it; depth formats cannot be copied to.
        if resource.desc.texture().is_some_and(|texture| texture.format != frame_graph::Format::Depth32Float)
        {
            add(ResourceId(index as u32), ObjectUsage { filled: true, ..ObjectUsage::default() });
        }
    }
    usages
}
