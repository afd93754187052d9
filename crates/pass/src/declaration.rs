//! The lines of WGSL that declare the resources of ports.

use frame_graph::resource::SampleKind;
use frame_graph::{Content, Format, ResourceDesc};
use shader_library::{Access, Dimension, Sample};

/// Returns the name of the global that is bound to a member of a port.
pub fn global(port: &str, member: &str) -> String {
    if member.is_empty() { port.to_owned() } else { format!("{port}_{member}") }
}

/// Returns the format of a member in words: `rgba16float, layers`.
pub fn format_of(content: Content) -> String {
    match content {
        Content::Texture(format) => format.name().to_owned(),
        Content::TextureArray(format) => format!("{}, layers", format.name()),
        Content::Struct(of) => format!("`{}`", of.name),
        Content::Array(element) => format!("{element}, array"),
        Content::Buffer => "as its module reads it".to_owned(),
    }
}

/// Returns the line by which a shader reads a member of an interface: `var view_depth: texture_2d<f32>;`. `None` for a buffer
/// that a module alone reads.
pub fn of_member(global: &str, content: Content) -> Option<String> {
    let buffer = |ty: &str| Some(format!("var<storage, read> {global}: {ty};"));
    match content {
        Content::Texture(format) => Some(read(global, Dimension::D2, format)),
        Content::TextureArray(format) => Some(read(global, Dimension::D2Array, format)),
        Content::Struct(of) => buffer(of.name),
        Content::Array(element) => buffer(&format!("array<{element}>")),
        Content::Buffer => None,
    }
}

/// Returns the line by which a shader reads a resource, or writes one of its own pass; of a buffer, the type follows from what
/// the member of its interface holds.
pub(crate) fn of_resource(
    global: &str,
    desc: &ResourceDesc,
    content: Option<Content>,
    writable: bool,
) -> String {
    match desc {
        ResourceDesc::Texture(texture) => {
            let dimension = if texture.array { Dimension::D2Array } else { Dimension::D2 };
            if writable {
                let ty = storage_texture_type(dimension, texture.format.name(), Access::Write);
                return format!("var {global}: {ty};");
            }
            read(global, dimension, texture.format)
        }
        ResourceDesc::Buffer(_) => {
            let line = content.and_then(|content| of_member(global, content));
            let line = line.unwrap_or_else(|| format!("var<storage, read> {global}: array<u32>;"));
            if writable { line.replace("storage, read>", "storage, read_write>") } else { line }
        }
    }
}

fn read(global: &str, dimension: Dimension, format: Format) -> String {
    let sample = match format.sample_kind() {
        SampleKind::Float => Sample::Float { sampled: false },
        SampleKind::Uint => Sample::Uint,
        SampleKind::Depth => Sample::Depth,
    };
    format!("var {global}: {};", texture_type(dimension, sample))
}

fn suffix(dimension: Dimension) -> &'static str {
    match dimension {
        Dimension::D1 => "1d",
        Dimension::D2 => "2d",
        Dimension::D2Array => "2d_array",
        Dimension::D3 => "3d",
        Dimension::Cube => "cube",
        Dimension::CubeArray => "cube_array",
    }
}

/// Returns a type of textures as WGSL writes it.
pub(crate) fn texture_type(dimension: Dimension, sample: Sample) -> String {
    let dimension = suffix(dimension);
    match sample {
        Sample::Float { .. } => format!("texture_{dimension}<f32>"),
        Sample::Uint => format!("texture_{dimension}<u32>"),
        Sample::Sint => format!("texture_{dimension}<i32>"),
        Sample::Depth => format!("texture_depth_{dimension}"),
    }
}

/// Returns a type of storage textures as WGSL writes it.
pub(crate) fn storage_texture_type(dimension: Dimension, format: &str, access: Access) -> String {
    let access = match access {
        Access::Read => "read",
        Access::Write => "write",
        Access::ReadWrite => "read_write",
        Access::Atomic => "atomic",
    };
    format!("texture_storage_{}<{format}, {access}>", suffix(dimension))
}
