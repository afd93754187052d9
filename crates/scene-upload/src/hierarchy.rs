//! The bounding volume hierarchy over the scene's triangles on the GPU, for passes that trace rays.

use crate::buffer;
use executor::wgpu::{self, BufferUsages};
use executor::{ExecutorError, Gpu, SceneBinding};
use ray_tracing::{Bvh, Refit};
use scene::{MovedVertices, Scene};

const NAME: &str = "scene_bvh";

/// Built when it is first requested.
#[derive(Debug, Default)]
pub(crate) struct Hierarchy {
    built: Option<Built>,
    /// Whether vertices have moved since it was last updated.
    stale: bool,
}

/// Names of scene bindings, and the new objects for them.
type NewBindings = Vec<(&'static str, SceneBinding)>;

#[derive(Debug)]
struct Built {
    bvh: Bvh,
    buffer: wgpu::Buffer,
}

impl Hierarchy {
    pub(crate) fn is_among(scene_bindings: &[&str]) -> bool {
        scene_bindings.contains(&NAME)
    }

    /// Builds it if that has not happened yet.
    pub(crate) fn provide(&mut self, gpu: &Gpu, scene: &Scene) -> Result<NewBindings, ExecutorError> {
        if self.built.is_some() {
            return Ok(Vec::new());
        }
        check(gpu, scene, scene.triangles() as u64 * ray_tracing::TRIANGLE_BYTES)?;
        let built = Built::new(gpu, scene, Bvh::build(&positions(scene, &[]), &scene.indices))?;
        Ok(self.built.insert(built).scene_bindings())
    }

    pub(crate) fn moved(&mut self) {
        self.stale = true;
    }

    /// Updates it for vertices that have moved.
    pub(crate) fn follow(
        &mut self,
        gpu: &Gpu,
        scene: &Scene,
        moved: &[MovedVertices],
    ) -> Result<NewBindings, ExecutorError> {
        let Some(built) = self.built.as_mut().filter(|_| self.stale) else { return Ok(Vec::new()) };
        self.stale = false;
        match built.bvh.refit(&positions(scene, moved), &scene.indices) {
            Refit::Refitted => {
                gpu.queue.write_buffer(&built.buffer, 0, built.bvh.bytes());
                Ok(Vec::new())
            }
            Refit::Rebuilt => {
                *built = Built::new(gpu, scene, built.bvh.clone())?;
                Ok(built.scene_bindings())
            }
        }
    }
}

impl Built {
    fn new(gpu: &Gpu, scene: &Scene, bvh: Bvh) -> Result<Built, ExecutorError> {
        check(gpu, scene, bvh.bytes().len() as u64)?;
        let buffer = buffer(&gpu.device, "scene BVH", bvh.bytes(), BufferUsages::STORAGE);
        Ok(Built { bvh, buffer })
    }

    fn scene_bindings(&self) -> NewBindings {
        vec![(NAME, SceneBinding::Buffer(self.buffer.clone()))]
    }
}

fn check(gpu: &Gpu, scene: &Scene, bytes: u64) -> Result<(), ExecutorError> {
    gpu.check_storage(&format!("the hierarchy for rays through `{}`", scene.name), bytes)
}

fn positions(scene: &Scene, moved: &[MovedVertices]) -> Vec<[f32; 3]> {
    let mut positions: Vec<[f32; 3]> = scene.vertices.iter().map(|vertex| vertex.position).collect();
    for moved in moved {
        let places = &mut positions[moved.first_vertex as usize..];
        places.iter_mut().zip(&moved.vertices).for_each(|(place, vertex)| *place = vertex.position);
    }
    positions
}
