//! The objects that all views of a scene share on a device.

use crate::acceleration::Acceleration;
use crate::gpu_data::{self, GpuMaterial};
use crate::hierarchy::Hierarchy;
use crate::{buffer, textures};
use bytemuck::cast_slice;
use executor::wgpu::{self, AddressMode, BufferUsages, FilterMode};
use executor::{Executor, ExecutorError, Gpu, SceneBinding};
use scene::{Environment, MovedVertices, Scene, Vertex};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A scene on a device: geometry, materials, textures, and the structures through which rays are traced.
/// Views share it (see [`SceneView`](crate::SceneView)).
///
/// Moving geometry is that of the view whose frame ran last: a view at another time writes it again.
#[derive(Debug)]
pub struct SceneOnGpu {
    vertices: wgpu::Buffer,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    /// The objects by the names of their globals, each with the value of `made` when it was created.
    scene_bindings: Vec<(&'static str, SceneBinding, u64)>,
    /// Increases whenever a scene binding is created.
    made: u64,
    moved: Vec<MovedVertices>,
    /// Increases whenever vertices move.
    moves: u64,
    hierarchy: Hierarchy,
    acceleration: Acceleration,
}

/// The structures through which a pipeline traces rays.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Wanted {
    pub(crate) hierarchy: bool,
    pub(crate) acceleration: bool,
}

impl State {
    fn set(&mut self, scene_bindings: impl IntoIterator<Item = (&'static str, SceneBinding)>) {
        for (name, external) in scene_bindings {
            self.made += 1;
            self.scene_bindings.retain(|(known, ..)| *known != name);
            self.scene_bindings.push((name, external, self.made));
        }
    }
}

impl SceneOnGpu {
    /// Uploads a scene.
    pub fn new(gpu: &Gpu, scene: &Scene) -> SceneOnGpu {
        let device = &gpu.device;
        let storage = BufferUsages::STORAGE;
        let built_from = if gpu.has_ray_queries() { BufferUsages::BLAS_INPUT } else { BufferUsages::empty() };
        let info = gpu_data::SceneInfo::new(scene, scene.textures.len() as u32);
        let materials: Vec<GpuMaterial> = scene.materials.iter().map(GpuMaterial::new).collect();
        let stored = |label, bytes: &[u8], usage| buffer(device, label, bytes, usage);
        let vertices = stored(
            "scene vertices",
            cast_slice(&scene.vertices),
            storage | BufferUsages::VERTEX | built_from,
        );
        let indices =
            stored("scene indices", cast_slice(&scene.indices), storage | BufferUsages::INDEX | built_from);
        let array = textures::upload(device, &gpu.queue, &scene.textures, &scene.materials);
        let info =
            stored("scene info", bytemuck::bytes_of(&info), BufferUsages::UNIFORM | BufferUsages::STORAGE);
        let materials = stored("scene materials", cast_slice(&materials), storage);
        let table = scene.area_table();
        let guide = stored("scene area guide", cast_slice(&Scene::area_guide(&table)), storage);
        let areas = stored("scene area table", cast_slice(&table), storage);
        let emitters = stored("scene emitters", &gpu_data::emitters(&scene.emitters()), storage);
        let black = Environment::uniform([0.0; 3]);
        let environment = scene.environment.as_ref().unwrap_or(&black);
        let environment_table = stored("scene environment table", cast_slice(&environment.table()), storage);
        let environment = textures::upload_environment(device, &gpu.queue, environment);
        let sampler = |label, filter, address| {
            SceneBinding::Sampler(device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some(label),
                address_mode_u: address,
                address_mode_v: address,
                mag_filter: filter,
                min_filter: filter,
                mipmap_filter: if filter == FilterMode::Linear {
                    wgpu::MipmapFilterMode::Linear
                } else {
                    wgpu::MipmapFilterMode::Nearest
                },
                ..Default::default()
            }))
        };
        let mut state = State {
            scene_bindings: Vec::new(),
            made: 0,
            moved: Vec::new(),
            moves: 0,
            hierarchy: Hierarchy::default(),
            acceleration: Acceleration::new(&vertices, &indices),
        };
        state.set([
            ("scene_info", SceneBinding::Buffer(info)),
            ("scene_vertices", SceneBinding::Buffer(vertices.clone())),
            ("scene_indices", SceneBinding::Buffer(indices)),
            ("scene_materials", SceneBinding::Buffer(materials)),
            ("scene_area_table", SceneBinding::Buffer(areas)),
            ("scene_area_guide", SceneBinding::Buffer(guide)),
            ("scene_emitters", SceneBinding::Buffer(emitters)),
            ("scene_environment", SceneBinding::Texture(environment)),
            ("scene_environment_table", SceneBinding::Buffer(environment_table)),
            ("scene_textures", SceneBinding::Texture(array.color)),
            ("scene_textures_linear", SceneBinding::Texture(array.linear)),
            ("scene_sampler", sampler("scene", FilterMode::Linear, AddressMode::Repeat)),
            ("linear_sampler", sampler("linear", FilterMode::Linear, AddressMode::ClampToEdge)),
            ("nearest_sampler", sampler("nearest", FilterMode::Nearest, AddressMode::ClampToEdge)),
        ]);
        SceneOnGpu { vertices, state: Mutex::new(state) }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // If another view panicked, a later frame writes everything again that it left half done.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Binds the objects that were created after `bound`, and updates `bound`.
    pub(crate) fn bind(&self, executor: &mut Executor, bound: &mut u64) {
        let state = self.state();
        for (name, external, made) in &state.scene_bindings {
            if made > bound {
                executor.set_scene_binding(name, external.clone());
            }
        }
        *bound = state.made;
    }

    /// Creates those of the requested `scene_bindings` that do not exist yet. Returns which structures are
    /// requested.
    pub(crate) fn provide(
        &self,
        gpu: &Gpu,
        scene: &Scene,
        scene_bindings: &[&str],
    ) -> Result<Wanted, ExecutorError> {
        let mut state = self.state();
        let wanted = Wanted {
            hierarchy: Hierarchy::is_among(scene_bindings),
            acceleration: Acceleration::is_among(scene_bindings) && gpu.has_ray_queries(),
        };
        if wanted.acceleration {
            let made = state.acceleration.provide(gpu, scene);
            state.set(made);
        }
        if wanted.hierarchy {
            let made = state.hierarchy.provide(gpu, scene)?;
            state.set(made);
        }
        Ok(wanted)
    }

    /// Writes the current positions of moving vertices, and updates the structures through which rays are
    /// traced. Returns a number that increases whenever vertices move.
    pub(crate) fn follow(
        &self,
        gpu: &Gpu,
        scene: &Scene,
        moved: &[MovedVertices],
        wanted: Wanted,
    ) -> Result<u64, ExecutorError> {
        let mut state = self.state();
        if moved != state.moved {
            for moved in moved {
                let offset = u64::from(moved.first_vertex) * size_of::<Vertex>() as u64;
                gpu.queue.write_buffer(&self.vertices, offset, cast_slice(&moved.vertices));
            }
            state.moved = moved.to_vec();
            state.moves += 1;
            state.hierarchy.moved();
            state.acceleration.moved();
        }
        if wanted.hierarchy {
            let made = state.hierarchy.follow(gpu, scene, moved)?;
            state.set(made);
        }
        if wanted.acceleration {
            state.acceleration.follow(gpu);
        }
        Ok(state.moves)
    }
}
