//! The data of the host program on the GPU: scene, camera, lights, frame; in the layouts of `shaders/`.

mod acceleration;
mod gpu_data;
mod hierarchy;
mod textures;

pub use gpu_data::{Frame, layouts};

use acceleration::Acceleration;
use bytemuck::cast_slice;
use executor::wgpu::{self, BufferUsages};
use executor::{Executor, ExecutorError, External};
use frame_graph::Externals;
use gpu_data::GpuMaterial;
use hierarchy::Hierarchy;
use scene::{Pose, Scene};

/// Buffers that frames write into, and what they hold.
#[derive(Debug)]
pub struct Host {
    vertices: wgpu::Buffer,
    camera: wgpu::Buffer,
    frame: wgpu::Buffer,
    lights: wgpu::Buffer,
    layers: wgpu::Buffer,
    /// Bytes as last written, so that what is the same counts as unchanged.
    camera_bytes: Vec<u8>,
    lights_bytes: (Vec<u8>, Vec<u8>),
    moved: Vec<scene::MovedVertices>,
    previous_camera: Option<scene::Camera>,
    hierarchy: Hierarchy,
    acceleration: Acceleration,
}

fn buffer(device: &wgpu::Device, label: &str, bytes: &[u8], usage: BufferUsages) -> wgpu::Buffer {
    // A binding has at least the size of one element of its array.
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

impl Host {
    /// Uploads a scene and binds it.
    pub fn upload(executor: &mut Executor, scene: &Scene) -> Host {
        let device = executor.gpu().device.clone();
        let storage = BufferUsages::STORAGE;
        let info = gpu_data::SceneInfo::new(scene, scene.textures.len() as u32);
        let materials: Vec<GpuMaterial> = scene.materials.iter().map(GpuMaterial::new).collect();
        let built_from =
            if executor.gpu().has_ray_queries() { BufferUsages::BLAS_INPUT } else { BufferUsages::empty() };
        let vertices = buffer(
            &device,
            "scene vertices",
            cast_slice(&scene.vertices),
            storage | BufferUsages::VERTEX | built_from,
        );
        let indices = buffer(
            &device,
            "scene indices",
            cast_slice(&scene.indices),
            storage | BufferUsages::INDEX | built_from,
        );
        let (light_bytes, layer_rows) = gpu_data::lights(&scene.lights, scene.bounds());
        let layer_bytes = cast_slice(&layer_rows).to_vec();
        let array = textures::upload(&device, &executor.gpu().queue, &scene.textures);
        let sampler = |label, filter, address| {
            device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some(label),
                address_mode_u: address,
                address_mode_v: address,
                mag_filter: filter,
                min_filter: filter,
                mipmap_filter: if filter == wgpu::FilterMode::Linear {
                    wgpu::MipmapFilterMode::Linear
                } else {
                    wgpu::MipmapFilterMode::Nearest
                },
                ..Default::default()
            })
        };
        let host = Host {
            camera: buffer(&device, "camera", &[], BufferUsages::UNIFORM),
            frame: buffer(&device, "frame", &[], BufferUsages::UNIFORM),
            lights: buffer(&device, "scene lights", &light_bytes, storage),
            layers: buffer(&device, "scene light layers", &layer_bytes, storage),
            vertices: vertices.clone(),
            camera_bytes: Vec::new(),
            lights_bytes: (light_bytes, layer_bytes),
            moved: Vec::new(),
            previous_camera: None,
            hierarchy: Hierarchy::default(),
            acceleration: Acceleration::new(&vertices, &indices),
        };
        use wgpu::{AddressMode, FilterMode};
        let externals = [
            ("camera", External::Buffer(host.camera.clone())),
            ("frame", External::Buffer(host.frame.clone())),
            (
                "scene_info",
                External::Buffer(buffer(
                    &device,
                    "scene info",
                    bytemuck::bytes_of(&info),
                    BufferUsages::UNIFORM,
                )),
            ),
            ("scene_vertices", External::Buffer(vertices)),
            ("scene_indices", External::Buffer(indices)),
            (
                "scene_materials",
                External::Buffer(buffer(&device, "scene materials", cast_slice(&materials), storage)),
            ),
            (
                "scene_area_table",
                External::Buffer(buffer(
                    &device,
                    "scene area table",
                    cast_slice(&scene.area_table()),
                    storage,
                )),
            ),
            ("scene_textures", External::Texture(array.color)),
            ("scene_textures_linear", External::Texture(array.linear)),
            ("scene_sampler", External::Sampler(sampler("scene", FilterMode::Linear, AddressMode::Repeat))),
            (
                "linear_sampler",
                External::Sampler(sampler("linear", FilterMode::Linear, AddressMode::ClampToEdge)),
            ),
            (
                "nearest_sampler",
                External::Sampler(sampler("nearest", FilterMode::Nearest, AddressMode::ClampToEdge)),
            ),
            ("scene_lights", External::Buffer(host.lights.clone())),
            ("scene_light_layers", External::Buffer(host.layers.clone())),
        ];
        for (name, external) in externals {
            executor.set_external(name, external);
        }
        executor.set_scene_indices(scene.indices.len() as u32);
        host
    }

    /// Makes what costs too much to have for every scene and is among `externals`, the names that steps read:
    /// what rays are traced through. It follows what moves as long as it is asked for.
    ///
    /// # Errors
    /// Where it is larger than the adapter can bind.
    pub fn provide(
        &mut self,
        executor: &mut Executor,
        scene: &Scene,
        externals: impl IntoIterator<Item = &'static str>,
    ) -> Result<(), ExecutorError> {
        let externals: Vec<&str> = externals.into_iter().collect();
        self.acceleration.provide(executor, scene, &externals);
        self.hierarchy.provide(executor, scene, &externals)
    }

    /// Writes what a frame needs, and says what of it is new.
    ///
    /// # Errors
    /// As [`Host::provide`], where what moves needs more.
    pub fn update(
        &mut self,
        executor: &mut Executor,
        scene: &Scene,
        pose: &Pose,
        size: (u32, u32),
        frame: gpu_data::Frame,
    ) -> Result<Externals, ExecutorError> {
        let queue = executor.gpu().queue.clone();
        let mut changed = Externals::FRAME;
        queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(&frame));
        let previous = self.previous_camera.replace(pose.camera);
        let camera = gpu_data::Camera::new(&pose.camera, previous.as_ref().unwrap_or(&pose.camera), size);
        let bytes = bytemuck::bytes_of(&camera);
        if bytes != self.camera_bytes {
            queue.write_buffer(&self.camera, 0, bytes);
            self.camera_bytes = bytes.to_vec();
            changed = changed.and(Externals::CAMERA);
        }
        let (lights, layers) = gpu_data::lights(&pose.lights, scene.bounds());
        let written = (lights, cast_slice(&layers).to_vec());
        if written != self.lights_bytes {
            queue.write_buffer(&self.lights, 0, &written.0);
            queue.write_buffer(&self.layers, 0, &written.1);
            self.lights_bytes = written;
            changed = changed.and(Externals::LIGHTS);
        }
        if pose.moved != self.moved {
            for moved in &pose.moved {
                let offset = u64::from(moved.first_vertex) * size_of::<scene::Vertex>() as u64;
                queue.write_buffer(&self.vertices, offset, cast_slice(&moved.vertices));
            }
            self.moved.clone_from(&pose.moved);
            self.hierarchy.moved();
            self.acceleration.moved();
            changed = changed.and(Externals::SCENE);
        }
        self.hierarchy.follow(executor, scene, &self.moved)?;
        self.acceleration.follow(executor);
        Ok(changed)
    }
}
