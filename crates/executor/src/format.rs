//! Formats and usages of wgpu for those of the frame graph.

use frame_graph::Format;
use wgpu::{TextureFormat, TextureSampleType};

/// Returns wgpu's name of a format.
pub fn texture_format(format: Format) -> TextureFormat {
    match format {
        Format::R8Unorm => TextureFormat::R8Unorm,
        Format::Rgba8Unorm => TextureFormat::Rgba8Unorm,
        Format::Rgba8UnormSrgb => TextureFormat::Rgba8UnormSrgb,
        Format::R16Float => TextureFormat::R16Float,
        Format::Rg16Float => TextureFormat::Rg16Float,
        Format::Rgba16Float => TextureFormat::Rgba16Float,
        Format::R32Float => TextureFormat::R32Float,
        Format::Rg32Float => TextureFormat::Rg32Float,
        Format::Rgba32Float => TextureFormat::Rgba32Float,
        Format::R32Uint => TextureFormat::R32Uint,
        Format::Rg32Uint => TextureFormat::Rg32Uint,
        Format::Rgba32Uint => TextureFormat::Rgba32Uint,
        Format::Depth32Float => TextureFormat::Depth32Float,
    }
}

/// The storage format of the name that WGSL gives it; `None` for one that the frame graph does not know.
pub(crate) fn storage_format(wgsl: &str) -> Option<TextureFormat> {
    Format::from_name(wgsl).map(texture_format)
}

/// Returns the sample type by which a layout declares a texture.
pub(crate) fn sample_type(kind: frame_graph::resource::SampleKind, filterable: bool) -> TextureSampleType {
    match kind {
        frame_graph::resource::SampleKind::Float => TextureSampleType::Float { filterable },
        frame_graph::resource::SampleKind::Uint => TextureSampleType::Uint,
        frame_graph::resource::SampleKind::Depth => TextureSampleType::Depth,
    }
}
