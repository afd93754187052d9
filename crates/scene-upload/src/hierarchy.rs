//! The hierarchy over the scene's triangles on the GPU, for passes that trace rays.

use crate::buffer;
use executor::wgpu::{self, BufferUsages};
use executor::{Executor, ExecutorError, External};
use ray_tracing::{Bvh, Refit};
use scene::{MovedVertices, Scene};

const NODES: &str = "scene_bvh";
const TRIANGLES: &str = "scene_bvh_triangles";

/// Made when it is first asked for.
#[derive(Debug, Default)]
pub(crate) struct Hierarchy {
    made: Option<Made>,
    /// Whether the steps that run ask for it.
    wanted: bool,
    /// Whether vertices have moved since it was fitted.
    stale: bool,
}

#[derive(Debug)]
struct Made {
    bvh: Bvh,
    nodes: wgpu::Buffer,
    triangles: wgpu::Buffer,
}

impl Hierarchy {
    pub(crate) fn provide(
        &mut self,
        executor: &mut Executor,
        scene: &Scene,
        externals: &[&str],
    ) -> Result<(), ExecutorError> {
        self.wanted = externals.contains(&NODES) || externals.contains(&TRIANGLES);
        if self.wanted && self.made.is_none() {
            let bytes = scene.triangles() as u64 * ray_tracing::TRIANGLE_BYTES;
            check(executor, scene, bytes)?;
            let bvh = Bvh::build(&positions(scene, &[]), &scene.indices);
            self.made = Some(Made::new(executor, scene, bvh)?);
        }
        Ok(())
    }

    pub(crate) fn moved(&mut self) {
        self.stale = true;
    }

    /// Fits it to the vertices that have moved.
    pub(crate) fn follow(
        &mut self,
        executor: &mut Executor,
        scene: &Scene,
        moved: &[MovedVertices],
    ) -> Result<(), ExecutorError> {
        let Some(made) = self.made.as_mut().filter(|_| self.wanted && self.stale) else { return Ok(()) };
        self.stale = false;
        match made.bvh.refit(&positions(scene, moved), &scene.indices) {
            Refit::Refitted => {
                let queue = &executor.gpu().queue;
                queue.write_buffer(&made.nodes, 0, made.bvh.nodes_bytes());
                queue.write_buffer(&made.triangles, 0, made.bvh.triangles_bytes());
            }
            Refit::Rebuilt => *made = Made::new(executor, scene, made.bvh.clone())?,
        }
        Ok(())
    }
}

impl Made {
    fn new(executor: &mut Executor, scene: &Scene, bvh: Bvh) -> Result<Made, ExecutorError> {
        check(executor, scene, bvh.nodes_bytes().len().max(bvh.triangles_bytes().len()) as u64)?;
        let device = executor.gpu().device.clone();
        let nodes = buffer(&device, "scene BVH", bvh.nodes_bytes(), BufferUsages::STORAGE);
        let triangles = buffer(&device, "scene BVH triangles", bvh.triangles_bytes(), BufferUsages::STORAGE);
        executor.set_external(NODES, External::Buffer(nodes.clone()));
        executor.set_external(TRIANGLES, External::Buffer(triangles.clone()));
        Ok(Made { bvh, nodes, triangles })
    }
}

fn check(executor: &Executor, scene: &Scene, bytes: u64) -> Result<(), ExecutorError> {
    let allowed = executor.gpu().limits().max_storage_buffer_binding_size;
    if bytes <= allowed {
        return Ok(());
    }
    Err(ExecutorError::Limit {
        resource: format!("the hierarchy for rays through `{}`", scene.name),
        wanted: format!("{bytes} bytes"),
        allowed: format!("{allowed} bytes"),
        limit: "max_storage_buffer_binding_size",
    })
}

fn positions(scene: &Scene, moved: &[MovedVertices]) -> Vec<[f32; 3]> {
    let mut positions: Vec<[f32; 3]> = scene.vertices.iter().map(|vertex| vertex.position).collect();
    for moved in moved {
        let places = &mut positions[moved.first_vertex as usize..];
        places.iter_mut().zip(&moved.vertices).for_each(|(place, vertex)| *place = vertex.position);
    }
    positions
}
