//! Objects on the GPU for the allocations of a plan, kept for reuse when a plan is replaced.

use crate::error::ExecutorError;
use crate::format::texture_format;
use crate::gpu::Gpu;
use frame_graph::ResourceDesc;
use std::sync::Arc;
use wgpu::{BufferUsages, TextureUsages};

/// A texture or a buffer.
#[derive(Clone, Debug)]
pub enum Object {
    /// A texture with the view that shaders bind.
    Texture {
        /// The texture.
        texture: wgpu::Texture,
        /// A view of the whole texture, as an array if it is declared so.
        view: wgpu::TextureView,
    },
    /// A buffer.
    Buffer(wgpu::Buffer),
}

/// A scene binding, bound by name.
#[derive(Clone, Debug)]
pub enum SceneBinding {
    /// A uniform or storage buffer.
    Buffer(wgpu::Buffer),
    /// A texture.
    Texture(wgpu::TextureView),
    /// A sampler.
    Sampler(wgpu::Sampler),
    /// The acceleration structure for ray queries.
    AccelerationStructure(wgpu::Tlas),
}

/// A scene binding that holds but the light of some sources: the global, and the names of the sources.
pub(crate) type ChosenLights = (&'static str, Arc<[String]>);

/// The uses of an object, in addition to being bound and read back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ObjectUsage {
    /// It is a target of draws, or cleared.
    pub attachment: bool,
    /// It is bound as a storage texture.
    pub storage: bool,
    /// It is a target of copies.
    pub filled: bool,
    /// It holds the size of an indirect dispatch or draw.
    pub indirect: bool,
}

impl ObjectUsage {
    /// Either.
    pub(crate) fn or(self, other: ObjectUsage) -> ObjectUsage {
        ObjectUsage {
            attachment: self.attachment || other.attachment,
            storage: self.storage || other.storage,
            filled: self.filled || other.filled,
            indirect: self.indirect || other.indirect,
        }
    }

    /// Whether an object for this can be used as the other says.
    pub(crate) fn covers(self, other: ObjectUsage) -> bool {
        self.or(other) == self
    }
}

/// Objects that no plan uses now.
#[derive(Debug, Default)]
pub(crate) struct Pool {
    free: Vec<(ResourceDesc, ObjectUsage, Object)>,
    /// Bytes of all objects made and not dropped.
    pub(crate) held: u64,
    /// The most of it so far.
    pub(crate) most_held: u64,
}

impl Pool {
    /// Takes a free object that fits. Its contents have no meaning.
    pub(crate) fn find(&mut self, desc: &ResourceDesc, usage: ObjectUsage) -> Option<Object> {
        let fits = |(free, free_usage, _): &(ResourceDesc, ObjectUsage, Object)| {
            free == desc && free_usage.covers(usage)
        };
        self.free.iter().position(fits).map(|index| self.free.swap_remove(index).2)
    }

    /// Makes an object, whose limits have been [checked](check_limits).
    pub(crate) fn make(
        &mut self,
        gpu: &Gpu,
        name: &str,
        desc: &ResourceDesc,
        usage: ObjectUsage,
    ) -> Result<Object, ExecutorError> {
        let object = create(gpu, name, desc, usage, self.held)?;
        self.held += desc.bytes();
        self.most_held = self.most_held.max(self.held);
        Ok(object)
    }

    /// Gives an object back.
    pub(crate) fn give(&mut self, desc: ResourceDesc, usage: ObjectUsage, object: Object) {
        self.free.push((desc, usage, object));
    }

    /// Drops what no plan took again; says whether there was anything.
    pub(crate) fn trim(&mut self) -> bool {
        let dropped: u64 = self.free.drain(..).map(|(desc, ..)| desc.bytes()).sum();
        self.held -= dropped;
        dropped > 0
    }
}

fn create(
    gpu: &Gpu,
    name: &str,
    desc: &ResourceDesc,
    usage: ObjectUsage,
    held: u64,
) -> Result<Object, ExecutorError> {
    let memory = gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let validation = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
    let object = match desc {
        ResourceDesc::Texture(texture) => {
            let mut usages = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_SRC;
            usages.set(TextureUsages::RENDER_ATTACHMENT, usage.attachment);
            usages.set(TextureUsages::STORAGE_BINDING, usage.storage);
            usages.set(TextureUsages::COPY_DST, usage.filled);
            let made = gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some(name),
                size: wgpu::Extent3d {
                    width: texture.size.0,
                    height: texture.size.1,
                    depth_or_array_layers: texture.layers,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: texture_format(texture.format),
                usage: usages,
                view_formats: &[],
            });
            let dimension = if texture.array {
                wgpu::TextureViewDimension::D2Array
            } else {
                wgpu::TextureViewDimension::D2
            };
            let view = made.create_view(&wgpu::TextureViewDescriptor {
                label: Some(name),
                dimension: Some(dimension),
                ..Default::default()
            });
            Object::Texture { texture: made, view }
        }
        ResourceDesc::Buffer(buffer) => {
            let mut usages = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
            usages.set(BufferUsages::INDIRECT, usage.indirect);
            Object::Buffer(gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(name),
                size: buffer.bytes,
                usage: usages,
                mapped_at_creation: false,
            }))
        }
    };
    let refused = pollster::block_on(validation.pop());
    if let Some(error) = pollster::block_on(memory.pop()) {
        tracing::debug!(%error, name, "allocation refused");
        return Err(ExecutorError::OutOfMemory { resource: name.to_owned(), bytes: desc.bytes(), held });
    }
    match refused {
        Some(error) => Err(ExecutorError::Pass { pass: name.to_owned(), message: error.to_string() }),
        None => Ok(object),
    }
}

/// Checks an object against the limits of the adapter; steps bind at most this many bytes of a buffer at once.
pub(crate) fn check_limits(
    gpu: &Gpu,
    name: &str,
    (desc, bound): (&ResourceDesc, u64),
    from: impl FnOnce() -> String,
) -> Result<(), ExecutorError> {
    let limits = gpu.limits();
    let error = |wanted: String, allowed: String, limit| {
        Err(ExecutorError::Limit { resource: name.to_owned(), wanted, allowed, limit, from: from() })
    };
    match desc {
        ResourceDesc::Texture(texture) => {
            let side = texture.size.0.max(texture.size.1);
            if side > limits.max_texture_dimension_2d {
                let allowed = format!("{} texels", limits.max_texture_dimension_2d);
                return error(format!("a side of {side} texels"), allowed, "max_texture_dimension_2d");
            }
            if texture.layers > limits.max_texture_array_layers {
                let allowed = limits.max_texture_array_layers.to_string();
                return error(format!("{} layers", texture.layers), allowed, "max_texture_array_layers");
            }
        }
        ResourceDesc::Buffer(buffer) => {
            for (bytes, allowed, limit) in [
                (bound, limits.max_storage_buffer_binding_size, "max_storage_buffer_binding_size"),
                (buffer.bytes, limits.max_buffer_size, "max_buffer_size"),
            ] {
                if bytes > allowed {
                    return error(format!("{bytes} bytes"), format!("{allowed} bytes"), limit);
                }
            }
        }
    }
    Ok(())
}
