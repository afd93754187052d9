//! Whether a global of a shader can be bound to a resource.

use crate::declaration;
use frame_graph::ResourceDesc;
use frame_graph::resource::SampleKind;
use shader_library::{Access, Dimension, GlobalKind, Sample};

/// Why a global cannot be bound to a resource; `None` where it can.
pub(super) fn mismatch(global: &GlobalKind, desc: &ResourceDesc, writable: bool) -> Option<&'static str> {
    match (global, desc) {
        (GlobalKind::Storage { writable: write, .. }, ResourceDesc::Buffer(_)) => {
            (*write && !writable).then_some("an input is read-only: declare it `var<storage, read>`")
        }
        (GlobalKind::Uniform { .. }, ResourceDesc::Buffer(_)) => {
            Some("buffers of the graph are bound as `var<storage, read>`")
        }
        (GlobalKind::Texture { dimension, sample, .. }, ResourceDesc::Texture(texture)) => {
            let dimension_fits = match dimension {
                Dimension::D2 => !texture.array,
                Dimension::D2Array => texture.array,
                _ => false,
            };
            let kind_fits = matches!(
                (sample, texture.format.sample_kind()),
                (Sample::Float { .. }, SampleKind::Float)
                    | (Sample::Uint, SampleKind::Uint)
                    | (Sample::Depth, SampleKind::Depth)
            );
            (!dimension_fits || !kind_fits).then_some("the dimension and the component type must be the same")
        }
        (GlobalKind::StorageTexture { format, access, dimension }, ResourceDesc::Texture(texture)) => {
            if *access != Access::Read && !writable {
                Some("an input is read-only")
            } else if (*dimension == Dimension::D2Array) != texture.array || *format != texture.format.name()
            {
                Some("the format and the dimension must be the same")
            } else {
                None
            }
        }
        (GlobalKind::AccelerationStructure, _) => Some("only the application has one"),
        _ => Some("one is a texture, the other a buffer"),
    }
}

/// A resource in words.
pub(super) fn describe(desc: &ResourceDesc) -> String {
    match desc {
        ResourceDesc::Buffer(buffer) => format!("a buffer of {} bytes", buffer.bytes),
        ResourceDesc::Texture(texture) => {
            let array = if texture.array { format!(" of {} layers", texture.layers) } else { String::new() };
            format!("a texture of {}{array}", texture.format.name())
        }
    }
}

/// A global of a shader in words.
pub(super) fn describe_global(kind: &GlobalKind) -> String {
    match kind {
        GlobalKind::Uniform { layout } => format!("var<uniform> {}", layout.ty),
        GlobalKind::Storage { writable, .. } => {
            format!("var<storage, {}>", if *writable { "read_write" } else { "read" })
        }
        GlobalKind::Texture { dimension, sample, .. } => declaration::texture_type(*dimension, *sample),
        GlobalKind::StorageTexture { format, access, dimension } => {
            declaration::storage_texture_type(*dimension, format, *access)
        }
        GlobalKind::Sampler { .. } => "a sampler".to_owned(),
        GlobalKind::AccelerationStructure => "an acceleration structure".to_owned(),
    }
}
