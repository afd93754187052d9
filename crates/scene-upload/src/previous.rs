//! Where moving geometry was in the frame before.

use crate::buffer;
use bytemuck::cast_slice;
use executor::wgpu::{self, BufferUsages};
use scene::{MovedVertices, Scene, Vertex};

/// The positions of all vertices in the last frame of a view. Each view has its own, as it has its own time.
#[derive(Debug)]
pub(crate) struct PreviousPositions {
    pub(crate) buffer: wgpu::Buffer,
    /// Whether any step reads them: else they are not written.
    pub(crate) wanted: bool,
    /// The geometry of the last frame; `None` before the first.
    last: Option<Vec<MovedVertices>>,
    /// The geometry that the buffer holds; `None` for that of the scene at rest.
    written: Option<Vec<MovedVertices>>,
}

impl PreviousPositions {
    pub(crate) fn new(device: &wgpu::Device, scene: &Scene) -> PreviousPositions {
        let positions = if scene.has_moving_geometry() { positions(&scene.vertices) } else { Vec::new() };
        PreviousPositions {
            buffer: buffer(device, "scene previous positions", cast_slice(&positions), BufferUsages::STORAGE),
            wanted: false,
            last: None,
            written: None,
        }
    }

    /// Takes over the geometry of a frame that begins. Returns whether the positions of the frame before are others than
    /// those of the one before that. Before the first frame all was where it is.
    pub(crate) fn follow(&mut self, queue: &wgpu::Queue, moved: &[MovedVertices]) -> bool {
        let rests = self.last.as_deref() == Some(moved);
        let before = if rests { None } else { self.last.replace(moved.to_vec()) };
        let previous = before.as_deref().unwrap_or(moved);
        if !self.wanted || self.written.as_deref() == Some(previous) {
            return false;
        }
        for moved in previous {
            let offset = u64::from(moved.first_vertex) * size_of::<[f32; 3]>() as u64;
            queue.write_buffer(&self.buffer, offset, cast_slice(&positions(&moved.vertices)));
        }
        self.written = Some(previous.to_vec());
        true
    }
}

fn positions(vertices: &[Vertex]) -> Vec<[f32; 3]> {
    vertices.iter().map(|vertex| vertex.position).collect()
}
