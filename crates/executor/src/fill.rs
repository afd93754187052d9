//! Objects filled with one value: cleared, or poisoned.

use crate::current::LayerViews;
use crate::gpu::Gpu;
use crate::object::{Object, ObjectUsage};
use frame_graph::plan::AllocationId;
use frame_graph::{Clear, Plan, ResourceDesc};

/// Encodes the filling of a whole object with one value.
pub(crate) fn fill(
    encoder: &mut wgpu::CommandEncoder,
    views: &mut LayerViews,
    (id, object): (AllocationId, &Object),
    desc: &ResourceDesc,
    clear: Clear,
) {
    match (object, desc) {
        (Object::Buffer(buffer), _) => encoder.clear_buffer(buffer, 0, None),
        (Object::Texture { texture, .. }, ResourceDesc::Texture(described)) => {
            let color = match clear {
                Clear::Zero => wgpu::Color::TRANSPARENT,
                Clear::Color([r, g, b, a]) => {
                    wgpu::Color { r: r.into(), g: g.into(), b: b.into(), a: a.into() }
                }
            };
            for layer in 0..described.layers {
                let view = views.get(id, layer, texture);
                let is_depth = described.format == frame_graph::Format::Depth32Float;
                let color_attachment = [Some(wgpu::RenderPassColorAttachment {
                    view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations { load: wgpu::LoadOp::Clear(color), store: wgpu::StoreOp::Store },
                })];
                encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                    label: Some("clear"),
                    color_attachments: if is_depth { &[] } else { &color_attachment },
                    depth_stencil_attachment: is_depth.then_some(wgpu::RenderPassDepthStencilAttachment {
                        view,
                        depth_ops: Some(wgpu::Operations {
                            load: wgpu::LoadOp::Clear(color.r as f32),
                            store: wgpu::StoreOp::Store,
                        }),
                        stencil_ops: None,
                    }),
                    ..Default::default()
                });
            }
        }
        (Object::Texture { .. }, ResourceDesc::Buffer(_)) => {}
    }
}

/// Encodes the copying of a resource into an object of the same format and size.
pub(crate) fn copy(encoder: &mut wgpu::CommandEncoder, from: &Object, to: &Object, desc: &ResourceDesc) {
    match (from, to) {
        (Object::Buffer(from), Object::Buffer(to)) => {
            encoder.copy_buffer_to_buffer(from, 0, to, 0, desc.bytes());
        }
        (Object::Texture { texture: from, .. }, Object::Texture { texture: to, .. }) => {
            encoder.copy_texture_to_texture(from.as_image_copy(), to.as_image_copy(), to.size());
        }
        _ => {}
    }
}

/// A buffer of equal bytes, as large as the largest resource with its rows padded.
pub(crate) fn poison_buffer(gpu: &Gpu, plan: &Plan, byte: u8) -> wgpu::Buffer {
    let largest = plan.resources.iter().map(|resource| match &resource.desc {
        ResourceDesc::Buffer(buffer) => buffer.bytes,
        ResourceDesc::Texture(texture) => {
            padded_row(texture) * u64::from(texture.size.1) * u64::from(texture.layers)
        }
    });
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("poison"),
        size: largest.max().unwrap_or(4).next_multiple_of(4),
        usage: wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: true,
    });
    if let Ok(mut bytes) = buffer.get_mapped_range_mut(..) {
        bytes.slice(..).fill(byte);
    }
    buffer.unmap();
    buffer
}

fn padded_row(texture: &frame_graph::TextureDesc<(u32, u32)>) -> u64 {
    (u64::from(texture.size.0) * texture.format.bytes())
        .next_multiple_of(u64::from(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT))
}

pub(crate) fn poison_object(
    encoder: &mut wgpu::CommandEncoder,
    poison: &wgpu::Buffer,
    desc: &ResourceDesc,
    object: &(ObjectUsage, Object),
) {
    match (&object.1, desc) {
        (Object::Buffer(buffer), ResourceDesc::Buffer(desc)) => {
            encoder.copy_buffer_to_buffer(poison, 0, buffer, 0, desc.bytes);
        }
        // Depth is not copied from buffers.
        (Object::Texture { texture, .. }, ResourceDesc::Texture(desc))
            if object.0.filled && desc.format != frame_graph::Format::Depth32Float =>
        {
            encoder.copy_buffer_to_texture(
                wgpu::TexelCopyBufferInfo {
                    buffer: poison,
                    layout: wgpu::TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: u32::try_from(padded_row(desc)).ok(),
                        rows_per_image: Some(desc.size.1),
                    },
                },
                texture.as_image_copy(),
                texture.size(),
            );
        }
        _ => {}
    }
}
