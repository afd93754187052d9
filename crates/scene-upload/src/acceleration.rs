//! The acceleration structure of the adapter for ray queries, over the scene's triangles.

use executor::wgpu;
use executor::{Gpu, SceneBinding};
use scene::{Scene, Vertex};

const NAME: &str = "scene_acceleration";

/// Built when it is first requested, on adapters that support ray queries.
#[derive(Debug)]
pub(crate) struct Acceleration {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    built: Option<Built>,
    /// Whether vertices have moved since it was built.
    stale: bool,
}

#[derive(Debug)]
struct Built {
    size: wgpu::BlasTriangleGeometrySizeDescriptor,
    /// `None` for a scene without triangles.
    triangles: Option<wgpu::Blas>,
    scene: wgpu::Tlas,
}

impl Acceleration {
    pub(crate) fn new(vertices: &wgpu::Buffer, indices: &wgpu::Buffer) -> Acceleration {
        let (vertices, indices) = (vertices.clone(), indices.clone());
        Acceleration { vertices, indices, built: None, stale: false }
    }

    pub(crate) fn is_among(scene_bindings: &[&str]) -> bool {
        scene_bindings.contains(&NAME)
    }

    /// Builds it if that has not happened yet, over the current vertices. If the adapter has no ray queries,
    /// the executor reports the pass that requests them.
    pub(crate) fn provide(&mut self, gpu: &Gpu, scene: &Scene) -> Option<(&'static str, SceneBinding)> {
        if self.built.is_some() {
            return None;
        }
        let built = Built::new(&gpu.device, scene);
        let external = SceneBinding::AccelerationStructure(built.scene.clone());
        self.built = Some(built);
        self.stale = true;
        self.follow(gpu);
        Some((NAME, external))
    }

    pub(crate) fn moved(&mut self) {
        self.stale = true;
    }

    /// Rebuilds it over the current vertices.
    pub(crate) fn follow(&mut self, gpu: &Gpu) {
        let Some(built) = self.built.as_ref().filter(|_| self.stale) else { return };
        self.stale = false;
        let geometry = wgpu::BlasTriangleGeometry {
            size: &built.size,
            vertex_buffer: &self.vertices,
            first_vertex: 0,
            vertex_stride: size_of::<Vertex>() as u64,
            index_buffer: Some(&self.indices),
            first_index: Some(0),
            transform_buffer: None,
            transform_buffer_offset: None,
        };
        let entry = built.triangles.as_ref().map(|blas| wgpu::BlasBuildEntry {
            blas,
            geometry: wgpu::BlasGeometries::TriangleGeometries(vec![geometry]),
        });
        let label = Some("scene acceleration");
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
        encoder.build_acceleration_structures(&entry, [&built.scene]);
        gpu.queue.submit([encoder.finish()]);
    }
}

impl Built {
    fn new(device: &wgpu::Device, scene: &Scene) -> Built {
        let size = wgpu::BlasTriangleGeometrySizeDescriptor {
            vertex_format: wgpu::VertexFormat::Float32x3,
            vertex_count: scene.vertices.len() as u32,
            index_format: Some(wgpu::IndexFormat::Uint32),
            index_count: Some(scene.indices.len() as u32),
            // Shaders decide which hits count.
            flags: wgpu::AccelerationStructureGeometryFlags::empty(),
        };
        let (flags, update_mode) = (
            wgpu::AccelerationStructureFlags::PREFER_FAST_TRACE,
            wgpu::AccelerationStructureUpdateMode::Build,
        );
        let triangles = (scene.triangles() > 0).then(|| {
            device.create_blas(
                &wgpu::CreateBlasDescriptor { label: Some("scene triangles"), flags, update_mode },
                wgpu::BlasGeometrySizeDescriptors::Triangles { descriptors: vec![size.clone()] },
            )
        });
        let mut whole = device.create_tlas(&wgpu::CreateTlasDescriptor {
            label: Some("scene"),
            max_instances: 1,
            flags,
            update_mode,
        });
        whole[0] = triangles.as_ref().map(|blas| {
            let identity = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
            wgpu::TlasInstance::new(blas, identity, 0, 0xff)
        });
        Built { size, triangles, scene: whole }
    }
}
