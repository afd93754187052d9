//! The scene bindings on the GPU: scene, camera, lights, frame; in the layouts of `shaders/`.
//!
//! A [`SceneOnGpu`] holds what all views of a scene share: geometry, materials, textures, and the structures
//! through which rays are traced. A [`SceneView`] is one view of it: its camera, its frame and its lights,
//! bound to one executor. So several executors on one device can render the same scene, with different
//! pipelines, sizes and cameras, after a single upload.

mod acceleration;
mod gpu_data;
mod hierarchy;
mod previous;
mod shared;
mod textures;

pub use gpu_data::{Frame, layouts};
pub use shared::SceneOnGpu;

use bytemuck::cast_slice;
use executor::wgpu::{self, BufferUsages};
use executor::{Executor, ExecutorError, Gpu, SceneBinding};
use frame_graph::SceneBindings;
use frame_graph::frame::Change;
use glam::{Vec2, Vec3};
use previous::PreviousPositions;
use scene::{Pose, Scene};
use shared::Wanted;
use std::sync::Arc;

/// One view of a scene: the buffers that its frames write into, and their current content.
#[derive(Debug)]
pub struct SceneView {
    shared: Arc<SceneOnGpu>,
    camera: wgpu::Buffer,
    frame: wgpu::Buffer,
    lights: wgpu::Buffer,
    layers: wgpu::Buffer,
    chosen: Vec<ChosenLights>,
    /// The camera that was written last, without and with the displacement of the samples, so that an equal one counts as
    /// unchanged.
    written_camera: Option<(gpu_data::Camera, gpu_data::Camera)>,
    /// The bytes that were written last.
    lights_bytes: (Vec<u8>, Vec<u8>),
    /// The lights of the last update: if they are unchanged, so are their bytes.
    seen_lights: Vec<scene::Light>,
    previous_camera: Option<scene::Camera>,
    previous: PreviousPositions,
    /// The place of the samples, from the centres of their pixels \[px\].
    jitter: Vec2,
    /// The structures through which the steps of this view's pipeline trace rays.
    wanted: Wanted,
    /// The counters of new shared objects and of movements when this view last bound the objects and ran a
    /// frame.
    bound: u64,
    seen: u64,
}

/// The label of the buffers of lights of which some are taken alone.
const CHOSEN_LIGHTS: &str = "scene lights, chosen";

/// What steps read that take some sources of light alone.
#[derive(Debug)]
struct ChosenLights {
    /// The names of the sources.
    names: Arc<[String]>,
    /// All lights, with the others dark.
    lights: wgpu::Buffer,
    /// The triangles that emit, without the others.
    emitters: wgpu::Buffer,
}

impl ChosenLights {
    fn bind(&self, executor: &mut Executor) {
        for (global, buffer) in [("scene_lights", &self.lights), ("scene_emitters", &self.emitters)] {
            executor.set_chosen_lights(global, Arc::clone(&self.names), buffer.clone());
        }
    }
}

fn buffer(device: &wgpu::Device, label: &str, bytes: &[u8], usage: BufferUsages) -> wgpu::Buffer {
    // A binding must be at least as large as one element of its array.
    let size = (bytes.len().max(256) as u64).next_multiple_of(16);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: usage | BufferUsages::COPY_DST,
        mapped_at_creation: true,
    });
    if let Ok(mut mapped) = buffer.get_mapped_range_mut(..) {
        mapped.slice(..bytes.len()).copy_from_slice(bytes);
    }
    buffer.unmap();
    buffer
}

impl SceneView {
    /// Uploads a scene for a single view, and binds it.
    pub fn upload(executor: &mut Executor, scene: &Scene) -> SceneView {
        let shared = Arc::new(SceneOnGpu::new(executor.gpu(), scene));
        SceneView::new(executor, shared, scene)
    }

    /// Creates a view of a scene that is already on the executor's device, and binds it.
    pub fn new(executor: &mut Executor, shared: Arc<SceneOnGpu>, scene: &Scene) -> SceneView {
        let device = executor.gpu().device.clone();
        let (light_bytes, layer_rows) = gpu_data::lights(&scene.lights, scene.bounds());
        let layer_bytes = cast_slice(&layer_rows).to_vec();
        let storage = BufferUsages::STORAGE;
        let mut view = SceneView {
            shared,
            camera: buffer(&device, "camera", &[], BufferUsages::UNIFORM | BufferUsages::STORAGE),
            frame: buffer(&device, "frame", &[], BufferUsages::UNIFORM | BufferUsages::STORAGE),
            lights: buffer(&device, "scene lights", &light_bytes, storage),
            layers: buffer(&device, "scene light layers", &layer_bytes, storage),
            chosen: Vec::new(),
            written_camera: None,
            lights_bytes: (light_bytes, layer_bytes),
            seen_lights: scene.lights.clone(),
            previous_camera: None,
            previous: PreviousPositions::new(&device, scene),
            jitter: Vec2::ZERO,
            wanted: Wanted::default(),
            bound: 0,
            seen: 0,
        };
        view.take_over(executor, scene);
        view
    }

    /// Binds all objects of this view, in place of those of another view that the executor had.
    pub fn take_over(&mut self, executor: &mut Executor, scene: &Scene) {
        self.bound = 0;
        self.bind(executor);
        executor.set_scene_indices(scene.indices.len() as u32);
        let own = [
            ("camera", &self.camera),
            ("frame", &self.frame),
            ("scene_lights", &self.lights),
            ("scene_light_layers", &self.layers),
            ("scene_previous_positions", &self.previous.buffer),
        ];
        for (name, buffer) in own {
            executor.set_scene_binding(name, SceneBinding::Buffer(buffer.clone()));
        }
        self.chosen.iter().for_each(|chosen| chosen.bind(executor));
    }

    /// Binds shared objects that were created since this view last did so.
    fn bind(&mut self, executor: &mut Executor) {
        self.shared.bind(executor, &mut self.bound);
    }

    /// Creates the scene bindings among `names` that are too expensive to create for every scene: the
    /// structures through which rays are traced. `names` are the scene bindings that steps read. The
    /// structures follow moving geometry as long as they are requested.
    ///
    /// # Errors
    /// Fails if one is larger than the adapter can bind.
    pub fn provide(
        &mut self,
        executor: &mut Executor,
        scene: &Scene,
        scene_bindings: impl IntoIterator<Item = &'static str>,
    ) -> Result<(), ExecutorError> {
        let scene_bindings: Vec<&str> = scene_bindings.into_iter().collect();
        self.previous.wanted = scene_bindings.contains(&"scene_previous_positions");
        self.wanted = self.shared.provide(executor.gpu(), scene, &scene_bindings)?;
        self.bind(executor);
        Ok(())
    }

    /// Creates what steps read that take the sources of light of these names alone. What was created before stays, as the
    /// plan before does if the next is refused.
    pub fn choose_lights<'a>(
        &mut self,
        executor: &mut Executor,
        scene: &Scene,
        chosen: impl IntoIterator<Item = &'a Arc<[String]>>,
    ) {
        let device = executor.gpu().device.clone();
        for names in chosen {
            if self.chosen.iter().any(|known| known.names == *names) {
                continue;
            }
            let (lights, _) = gpu_data::lights(&alone(&self.seen_lights, names), scene.bounds());
            let emitters = scene.emitters_of(|name| names.iter().any(|known| known == name));
            let stored = |label, bytes: &[u8]| buffer(&device, label, bytes, BufferUsages::STORAGE);
            let made = ChosenLights {
                names: Arc::clone(names),
                lights: stored(CHOSEN_LIGHTS, &lights),
                emitters: stored("scene emitters, chosen", &gpu_data::emitters(&emitters)),
            };
            made.bind(executor);
            self.chosen.push(made);
        }
    }

    /// Sets where the samples of the next frames lie, from the centres of their pixels \[px, y down\].
    pub fn set_jitter(&mut self, jitter: Vec2) {
        self.jitter = jitter;
    }

    /// Writes the data that a frame needs, and adds to `change` what has changed in it.
    ///
    /// # Errors
    /// The errors of [`SceneView::provide`], if a structure grows as geometry moves.
    pub fn update(
        &mut self,
        executor: &mut Executor,
        scene: &Scene,
        pose: &Pose,
        size: (u32, u32),
        frame: gpu_data::Frame,
        change: &mut Change,
    ) -> Result<(), ExecutorError> {
        let queue = &executor.gpu().queue;
        let mut changed = SceneBindings::FRAME;
        queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(&frame));
        let previous = self.previous_camera.replace(pose.camera);
        let camera = |jitter| {
            gpu_data::Camera::new(&pose.camera, previous.as_ref().unwrap_or(&pose.camera), size, jitter)
        };
        let still = camera(Vec2::ZERO);
        let sampled = if self.jitter == Vec2::ZERO { still } else { camera(self.jitter) };
        let written = Some((still, sampled));
        if written != self.written_camera {
            queue.write_buffer(&self.camera, 0, bytemuck::bytes_of(&sampled));
            match self.written_camera {
                Some((before, _)) if before == still => {
                    change.resampled = change.resampled.and(SceneBindings::CAMERA);
                }
                _ => changed = changed.and(SceneBindings::CAMERA),
            }
            self.written_camera = written;
        }
        if pose.lights != self.seen_lights {
            self.seen_lights.clone_from(&pose.lights);
            let (lights, layers) = gpu_data::lights(&pose.lights, scene.bounds());
            let written = (lights, cast_slice(&layers).to_vec());
            // A light that has another name alone is another light to those who choose it.
            if written != self.lights_bytes || !self.chosen.is_empty() {
                self.write_lights(executor, &written, scene);
                self.lights_bytes = written;
                changed = changed.and(SceneBindings::LIGHTS);
            }
        }
        if self.previous.follow(&executor.gpu().queue, &pose.moved) {
            changed = changed.and(SceneBindings::PREVIOUS);
        }
        let moves = self.shared.follow(executor.gpu(), scene, &pose.moved, self.wanted)?;
        self.bind(executor);
        if moves != self.seen {
            self.seen = moves;
            changed = changed.and(SceneBindings::SCENE);
        }
        change.scene_bindings = change.scene_bindings.and(changed);
        Ok(())
    }

    /// Writes lights and their layers, into larger buffers if there are more of them than before.
    fn write_lights(
        &mut self,
        executor: &mut Executor,
        (lights, layers): &(Vec<u8>, Vec<u8>),
        scene: &Scene,
    ) {
        let gpu = executor.gpu().clone();
        for chosen in &mut self.chosen {
            let (bytes, _) = gpu_data::lights(&alone(&self.seen_lights, &chosen.names), scene.bounds());
            if rewrite(&gpu, CHOSEN_LIGHTS, &mut chosen.lights, &bytes) {
                chosen.bind(executor);
            }
        }
        let mut write = |name: &'static str, label, held: &mut wgpu::Buffer, bytes: &[u8]| {
            if rewrite(&gpu, label, held, bytes) {
                executor.set_scene_binding(name, SceneBinding::Buffer(held.clone()));
            }
        };
        write("scene_lights", "scene lights", &mut self.lights, lights);
        write("scene_light_layers", "scene light layers", &mut self.layers, layers);
    }
}

/// Writes a buffer of lights anew. Returns whether it had to be replaced by a larger one.
fn rewrite(gpu: &Gpu, label: &str, held: &mut wgpu::Buffer, bytes: &[u8]) -> bool {
    let grows = bytes.len() as u64 > held.size();
    if grows {
        *held = buffer(&gpu.device, label, bytes, BufferUsages::STORAGE);
    } else {
        gpu.queue.write_buffer(held, 0, bytes);
    }
    grows
}

/// Returns all lights, of which those without one of these names are dark: numbers of lights and layers stay.
fn alone(lights: &[scene::Light], names: &[String]) -> Vec<scene::Light> {
    let mut lights = lights.to_vec();
    for light in lights.iter_mut().filter(|light| !names.contains(&light.name)) {
        light.intensity = Vec3::ZERO;
    }
    lights
}
