//! A scene that several renderers of one device share.

use crate::RenderError;
use executor::{ExecutorError, Gpu};
use scene::Scene;
use scene_upload::SceneOnGpu;
use std::sync::Arc;

/// A scene with its geometry, materials and textures on a device. Clones share all of it, so that several renderers, by
/// other pipelines, sizes and cameras, need one upload: see [`Renderer::with_scene`](crate::Renderer::with_scene).
#[derive(Clone, Debug)]
pub struct SharedScene {
    pub(crate) gpu: Gpu,
    pub(crate) scene: Arc<Scene>,
    pub(crate) on_gpu: Arc<SceneOnGpu>,
}

impl SharedScene {
    /// Uploads a scene.
    ///
    /// # Errors
    /// The scene is larger than the adapter can bind; or the driver's error for its buffers and textures.
    pub fn new(gpu: &Gpu, scene: Scene) -> Result<SharedScene, RenderError> {
        let bytes = size_of_val(scene.vertices.as_slice()).max(size_of_val(scene.indices.as_slice())) as u64;
        gpu.check_storage(&format!("the geometry of `{}`", scene.name), bytes)?;
        let _phase = tracing::info_span!(target: "phase", "scene on the GPU").entered();
        let on_gpu = Arc::new(SceneOnGpu::new(gpu, &scene));
        match gpu.take_fault() {
            Some(message) => Err(RenderError::Gpu(ExecutorError::Pass {
                pass: format!("upload of `{}`", scene.name),
                message,
            })),
            None => Ok(SharedScene { gpu: gpu.clone(), scene: Arc::new(scene), on_gpu }),
        }
    }

    /// Returns the device that it is on.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Returns the scene.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }
}
