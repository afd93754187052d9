//! The facade for applications: it takes a scene and a pipeline and renders frames.
//!
//! ```no_run
//! use renderer::{Catalog, Gpu, Renderer};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let catalog = std::sync::Arc::new(Catalog::new(renderer::Assets::new(None)));
//! let scene = renderer::load_scene(&catalog, "cornell-box")?;
//! let mut renderer = Renderer::new(Gpu::open()?, catalog, scene, (512, 512))?;
//! renderer.set_pipeline("ism-invtm", &Default::default())?;
//! renderer.frame()?;
//! let indirect = renderer.output("indirect")?; // linear radiance, W/(m² sr)
//! # Ok(()) }
//! ```
//!
//! An application that has its own wgpu device passes it in with [`Gpu::from_device`], and draws with the texture that
//! [`Renderer::output_texture`] returns.

mod compile;
mod error;
mod figures;
mod picture;
mod provenance;
mod reload;
mod results;
mod settle;
mod shared;
mod warnings;

pub use catalog::{Assets, Catalog, Named};
pub use compile::{Compiled, compile_options};
pub use error::RenderError;
pub use executor::{ExecutorError, FrameOptions, FrameReport, Gpu, LoadReport, Timings, wgpu};
pub use figures::PortFigures;
pub use interfaces::progress::Progress;
pub use provenance::{Provenance, RecordedLight, is_path_from, parse_value};
pub use reload::{Reload, reload_all};
pub use shared::SharedScene;
pub use warnings::without_effect;

use executor::Executor;
use frame_graph::{
    Change, CompileOptions, Diagnostics, LinkContext, Overrides, Plan, ResetCause, Resolved, SceneBindings,
    Value,
};
use glam::Vec2;
use pass::LinkedSteps;
use scene::{Camera, Light, Pose, Scene};
use scene_upload::{Frame, SceneView};
use std::sync::Arc;

/// Loads a scene by the name of a built-in one, or from a `.ron`, `.glb`, `.gltf`, `.pbrt` or `.xml` file.
///
/// # Errors
/// Everything that is wrong with the file, and where; the nearest name where there is none.
pub fn load_scene(catalog: &Catalog, spec: &str) -> Result<Scene, scene::SceneError> {
    let _phase = tracing::info_span!(target: "phase", "scene").entered();
    scene::load(spec, &catalog::SceneAssets(catalog.assets().clone()))
}

/// Renders a scene by a pipeline, frame by frame.
#[derive(Debug)]
pub struct Renderer {
    catalog: Arc<Catalog>,
    executor: Executor,
    scene: SharedScene,
    view: SceneView,
    size: (u32, u32),
    pipeline: Option<Loaded>,
    options: CompileOptions,
    frame_options: FrameOptions,
    /// The camera that replaces the scene's own.
    camera: Option<Camera>,
    /// The lights that replace the scene's own.
    lights: Option<Vec<Light>>,
    /// Whether a file of the scene has changed and could not be loaded yet.
    scene_stale: bool,
    seed: u32,
    index: u32,
    /// The number of the next sample, where each frame is one of a picture.
    sample: u32,
    /// The time of the next frames \[s\] that the application has set; else it follows their numbers.
    time: Option<f32>,
    /// The changes since the last frame.
    change: Change,
    /// The pose of the scene in the last frame: its memory is used again.
    pose: Pose,
}

/// The pipeline that runs.
#[derive(Debug)]
struct Loaded {
    name: String,
    overrides: Overrides,
    /// The variants that run beside each other; empty where it is the pipeline alone.
    variants: Vec<Resolved>,
    compiled: Compiled,
    /// Whether each frame is another sample of the picture.
    sampled: bool,
}

/// A function that gives a plan to an executor: as files describe it, or with values that were set.
type Load = fn(&mut Executor, Arc<Plan>, Vec<LinkedSteps>) -> Result<LoadReport, ExecutorError>;

/// Returns the place of the sample in each pixel, from its centre \[px\]: the first in the centre, then Halton's sequence in bases 2
/// and 3.
fn place_of_sample(sample: u32) -> Vec2 {
    let digits = |base: u32| {
        let (mut rest, mut unit, mut sum) = (sample, 1.0, 0.0);
        while rest > 0 {
            unit /= base as f32;
            sum += (rest % base) as f32 * unit;
            rest /= base;
        }
        sum
    };
    if sample == 0 { Vec2::ZERO } else { Vec2::new(digits(2), digits(3)) - 0.5 }
}

impl Renderer {
    /// Creates a renderer on a device, with a scene and a frame size in pixels. Set a pipeline before running frames.
    ///
    /// # Errors
    /// The driver's error for the scene's buffers and textures.
    pub fn new(
        gpu: Gpu,
        catalog: Arc<Catalog>,
        scene: Scene,
        size: (u32, u32),
    ) -> Result<Renderer, RenderError> {
        Ok(Renderer::with_scene(catalog, &SharedScene::new(&gpu, scene)?, size))
    }

    /// Creates a renderer of a scene that is on its device already, and that other renderers may render too.
    pub fn with_scene(catalog: Arc<Catalog>, scene: &SharedScene, size: (u32, u32)) -> Renderer {
        let mut executor = Executor::new(scene.gpu.clone());
        let view = SceneView::new(&mut executor, Arc::clone(&scene.on_gpu), &scene.scene);
        Renderer {
            catalog,
            executor,
            scene: scene.clone(),
            view,
            size: (size.0.max(1), size.1.max(1)),
            pipeline: None,
            options: compile_options(),
            frame_options: FrameOptions::default(),
            camera: None,
            lights: None,
            scene_stale: false,
            seed: 0,
            index: 0,
            sample: 0,
            time: None,
            change: Change::default(),
            pose: scene.scene.at(0.0),
        }
    }

    /// Sets the pipeline by name or path, with values for its parameters and settings. If anything is wrong,
    /// the one before stays.
    ///
    /// # Errors
    /// Everything that is wrong with the pipeline and its shaders; limits of the adapter.
    pub fn set_pipeline(&mut self, name: &str, overrides: &Overrides) -> Result<LoadReport, RenderError> {
        let compiled = Compiled::new(&self.catalog, name, overrides, &self.link_context(), &self.options)?;
        self.load((name.to_owned(), overrides.clone(), Vec::new()), compiled, Executor::load)
    }

    /// Sets several variants of a pipeline, the first of which is the pipeline itself, that run side by side: what is equal in
    /// them runs once. `outputs` are the outputs that are wanted, named by [`frame_graph::name_in_united`].
    ///
    /// # Errors
    /// As [`Renderer::set_pipeline`].
    ///
    /// # Panics
    /// If there is no variant.
    pub fn set_variants(
        &mut self,
        name: &str,
        overrides: &Overrides,
        variants: Vec<Resolved>,
        outputs: Vec<String>,
    ) -> Result<LoadReport, RenderError> {
        let options = CompileOptions { outputs, ..self.options.clone() };
        let compiled = Compiled::united(&self.catalog, &variants, &self.link_context(), &options)?;
        self.options = options;
        self.load((name.to_owned(), overrides.clone(), variants), compiled, Executor::load)
    }

    fn load(
        &mut self,
        (name, overrides, variants): (String, Overrides, Vec<Resolved>),
        compiled: Compiled,
        load: Load,
    ) -> Result<LoadReport, RenderError> {
        let scene_bindings = compiled.steps.iter().flatten().flat_map(|step| step.scene_bindings());
        let uploading = tracing::info_span!(target: "phase", "scene on the GPU").entered();
        self.view.provide(&mut self.executor, &self.scene.scene, scene_bindings)?;
        let chosen = compiled.steps.iter().flatten().filter_map(|step| step.chosen_lights());
        self.view.choose_lights(&mut self.executor, &self.scene.scene, chosen);
        drop(uploading);
        let _phase = tracing::info_span!(target: "phase", "plan on the GPU").entered();
        let report = load(&mut self.executor, Arc::clone(&compiled.plan), compiled.steps.clone())?;
        let sampled = compiled.is_sampled();
        if !sampled {
            self.executor.set_sample(self.seed, 0);
            self.view.set_jitter(Vec2::ZERO);
            // Where frames are samples, a sum may go on through the change of a value: no sample comes twice.
            self.sample = 0;
        }
        self.pipeline = Some(Loaded { name, overrides, variants, compiled, sampled });
        Ok(report)
    }

    /// Sets the size of frames in pixels, at least 1×1.
    ///
    /// # Errors
    /// As [`Renderer::set_pipeline`]; the size before stays then.
    pub fn set_size(&mut self, size: (u32, u32)) -> Result<(), RenderError> {
        let before = std::mem::replace(&mut self.size, (size.0.max(1), size.1.max(1)));
        if before == self.size {
            return Ok(());
        }
        self.relink().inspect_err(|_| self.size = before)?;
        self.change.events.push(ResetCause::Resize);
        Ok(())
    }

    /// Sets how plans are compiled: sharing, requested outputs, resources kept for reading back.
    ///
    /// # Errors
    /// As [`Renderer::set_pipeline`]; the options before stay then.
    pub fn set_compile_options(&mut self, options: CompileOptions) -> Result<(), RenderError> {
        let before = std::mem::replace(&mut self.options, options);
        self.relink().inspect_err(|_| self.options = before).map(|_| ())
    }

    /// Sets the value of a parameter (`lights`) or of a pass's setting (`composite.exposure`), in addition to those
    /// that were given with the pipeline. Where it changes no size, switch or output, nothing is linked but the steps of
    /// the passes that read it. History buffers go on, but for those whose links name `Setting`.
    ///
    /// # Errors
    /// As [`Renderer::set_pipeline`]; the value before stays then.
    pub fn set_value(&mut self, path: &str, value: Value) -> Result<LoadReport, RenderError> {
        let mut overrides = self.overrides().cloned().ok_or(RenderError::NoPipeline)?;
        overrides.0.retain(|(known, _)| known != path);
        overrides.0.push((path.to_owned(), value));
        self.set_values(overrides)
    }

    /// Sets the values of parameters and settings, in place of all that were given before: as [`Renderer::set_value`] does
    /// for one.
    ///
    /// # Errors
    /// As [`Renderer::set_pipeline`]; the values before stay then.
    pub fn set_values(&mut self, overrides: Overrides) -> Result<LoadReport, RenderError> {
        let loaded = self.pipeline.as_ref().ok_or(RenderError::NoPipeline)?;
        let (name, context) = (loaded.name.clone(), self.link_context());
        let compiled =
            loaded.compiled.with_overrides(&self.catalog, &name, &overrides, &context, &self.options)?;
        self.load((name, overrides, Vec::new()), compiled, Executor::load_values)
    }

    /// Replaces the scene's own lights; `None` restores them. Nothing is linked again if the number of lights of each
    /// type stays the same.
    ///
    /// # Errors
    /// As [`Renderer::set_pipeline`], where their numbers differ; the lights before stay then.
    pub fn set_lights(&mut self, lights: Option<Vec<Light>>) -> Result<(), RenderError> {
        let traits = self.link_context().traits;
        let before = std::mem::replace(&mut self.lights, lights);
        if self.link_context().traits == traits {
            return Ok(());
        }
        self.relink().inspect_err(|_| self.lights = before).map(|_| ())
    }

    /// Replaces the scene. The pipeline is linked again, and all its passes run in the next frame. The report is that
    /// of loading the pipeline; it is empty where none is set.
    ///
    /// # Errors
    /// As [`Renderer::set_pipeline`]: a pipeline may require something that this scene lacks. The scene before stays
    /// then.
    pub fn set_scene(&mut self, scene: Scene) -> Result<LoadReport, RenderError> {
        let scene = SharedScene::new(self.gpu(), scene)?;
        self.set_shared_scene(&scene)
    }

    /// Replaces the scene by one that is on this renderer's device already, as [`Renderer::set_scene`] does.
    ///
    /// # Errors
    /// As [`Renderer::set_scene`].
    pub fn set_shared_scene(&mut self, scene: &SharedScene) -> Result<LoadReport, RenderError> {
        let view = SceneView::new(&mut self.executor, Arc::clone(&scene.on_gpu), &scene.scene);
        let before = std::mem::replace(&mut self.scene, scene.clone());
        let mut view_before = std::mem::replace(&mut self.view, view);
        let report = match self.relink() {
            Ok(report) => report,
            Err(error) => {
                view_before.take_over(&mut self.executor, &before.scene);
                (self.scene, self.view) = (before, view_before);
                return Err(error);
            }
        };
        self.change.events.push(ResetCause::Scene);
        self.change.all = true;
        Ok(report)
    }

    /// Returns the scene as it is on the device, for another renderer.
    pub fn shared_scene(&self) -> &SharedScene {
        &self.scene
    }

    /// Sets how frames run.
    pub fn set_frame_options(&mut self, options: FrameOptions) {
        self.frame_options = options;
    }

    /// Replaces the scene's own camera; `None` restores it. `cut` says that the camera jumps, which resets the history
    /// buffers whose links name `Cut`.
    pub fn set_camera(&mut self, camera: Option<Camera>, cut: bool) {
        self.camera = camera;
        if cut {
            self.change.events.push(ResetCause::Cut);
        }
    }

    /// Sets the seed of all random numbers; 0 gives plain sequences, as the papers use them.
    pub fn set_seed(&mut self, seed: u32) {
        self.seed = seed;
        self.sample = 0;
        self.executor.set_sample(seed, 0);
    }

    /// Sets the number of the next frame, and with it the time of animations.
    pub fn set_frame_index(&mut self, index: u32) {
        self.index = index;
    }

    /// Sets the time of the next frames \[s\], whatever their numbers: an application that has a clock of its own sets it
    /// before each frame. `None` lets the time follow the numbers again.
    pub fn set_time(&mut self, time: Option<f32>) {
        self.time = time;
    }

    /// Makes every pass run in the next frame, even if nothing has changed: for measurements.
    pub fn run_everything(&mut self) {
        self.change.all = true;
    }

    /// Runs one frame.
    ///
    /// # Errors
    /// [`RenderError::NoPipeline`], or the error of the GPU.
    pub fn frame(&mut self) -> Result<&FrameReport, RenderError> {
        if self.pipeline.is_none() {
            return Err(RenderError::NoPipeline);
        }
        let _frame = tracing::trace_span!(target: "frame", "frame", index = self.index).entered();
        let posing = tracing::trace_span!(target: "frame", "pose and upload").entered();
        let scene = &self.scene.scene;
        let (time, step) = match self.time {
            Some(time) => (time, (time - self.pose.time).max(0.0)),
            None => (scene.frame_time(self.index), scene.frame_time(1)),
        };
        scene.pose(time, &mut self.pose);
        if let Some(camera) = self.camera {
            self.pose.camera = camera;
        }
        if let Some(lights) = &self.lights {
            self.pose.lights.clone_from(lights);
        }
        if self.pipeline.as_ref().is_some_and(|loaded| loaded.sampled) {
            self.executor.set_sample(self.seed, self.sample);
            self.view.set_jitter(place_of_sample(self.sample));
            self.change.resampled = SceneBindings::SAMPLE;
            self.sample += 1;
        }
        let frame = Frame { index: self.index, time, step, pad: 0.0 };
        self.view.update(&mut self.executor, scene, &self.pose, self.size, frame, &mut self.change)?;
        drop(posing);
        let result = self.executor.frame(&self.change, self.frame_options);
        self.change.clear();
        let report = result?;
        self.index = self.index.wrapping_add(1);
        Ok(report)
    }

    /// Returns the GPU times of the newest frame that was [timed](FrameOptions::timed), or was
    /// [monitored](FrameOptions::monitored) and has finished. Never waits. `None` before there is one, and where the
    /// adapter has no timestamps.
    pub fn timings(&mut self) -> Option<&Timings> {
        self.executor.timings()
    }

    /// Returns the report of the last frame; empty before the first.
    pub fn report(&self) -> &FrameReport {
        self.executor.report()
    }

    /// Returns the plan that runs.
    pub fn plan(&self) -> Option<&Arc<Plan>> {
        self.executor.plan()
    }

    /// Returns the pipeline as compiled.
    pub fn compiled(&self) -> Option<&Compiled> {
        self.pipeline.as_ref().map(|pipeline| &pipeline.compiled)
    }

    /// Returns the warnings about the pipeline in this scene: see [`Compiled::warnings`].
    pub fn warnings(&self) -> Diagnostics {
        let Some(Loaded { name, overrides, compiled, .. }) = &self.pipeline else {
            return Diagnostics::default();
        };
        compiled.warnings(&self.catalog, name, overrides, &self.link_context(), &self.options)
    }

    /// Returns the name by which the pipeline was set; empty before.
    pub fn pipeline_name(&self) -> &str {
        self.pipeline.as_ref().map_or("", |pipeline| &pipeline.name)
    }

    /// Returns the values that were given for parameters and settings, in the order in which they were.
    pub fn overrides(&self) -> Option<&Overrides> {
        self.pipeline.as_ref().map(|pipeline| &pipeline.overrides)
    }

    /// Returns the state of the scene in the last frame, with the camera and the lights that replace its own; before
    /// the first frame, that at 0 s.
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// Returns the scene.
    pub fn scene(&self) -> &Scene {
        &self.scene.scene
    }

    /// Returns the device.
    pub fn gpu(&self) -> &Gpu {
        self.executor.gpu()
    }

    /// Returns the size of frames in pixels.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Returns the bytes of all objects of the plan, without those of the scene.
    pub fn held_bytes(&self) -> u64 {
        self.executor.held_bytes()
    }

    fn link_context(&self) -> LinkContext {
        let scene = self.scene();
        let lights = self.lights.as_deref().unwrap_or(&scene.lights);
        let mut traits = scene.traits_with(lights);
        let queries = self.gpu().can_query_rays(scene.triangles() as u32);
        traits.values.insert("ray_queries".to_owned(), Value::Bool(queries));
        LinkContext { frame: self.size, traits }
    }

    /// Loads the pipeline again, for another scene or size; nothing where none is set.
    fn relink(&mut self) -> Result<LoadReport, RenderError> {
        match &self.pipeline {
            Some(Loaded { name, overrides, variants, .. }) => {
                let (name, overrides, variants) = (name.clone(), overrides.clone(), variants.clone());
                if variants.is_empty() {
                    return self.set_pipeline(&name, &overrides);
                }
                self.set_variants(&name, &overrides, variants, self.options.outputs.clone())
            }
            None => Ok(LoadReport::default()),
        }
    }
}
