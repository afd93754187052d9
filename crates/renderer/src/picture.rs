//! Texels as they are read back, and pictures of them.

use crate::error::RenderError;
use frame_graph::plan::PlannedResource;
use frame_graph::{Format, ResourceDesc};
use half::f16;
use metrics::Image;

/// One layer of a texture as a picture. Missing channels are 0, missing alpha 1; a single channel is grey.
pub(crate) fn from_bytes(resource: &PlannedResource, bytes: &[u8], layer: u32) -> Result<Image, RenderError> {
    let refuse = |what: String| RenderError::NoPicture { resource: resource.name.to_string(), what };
    let ResourceDesc::Texture(texture) = &resource.desc else {
        return Err(refuse(format!("a buffer of {} bytes", bytes.len())));
    };
    if layer >= texture.layers {
        return Err(refuse(format!("a texture of {} layers without a layer {layer}", texture.layers)));
    }
    let size = texture.format.bytes() as usize;
    let (width, height) = texture.size;
    let start = layer as usize * width as usize * height as usize * size;
    let texels = bytes[start..].chunks_exact(size).take(width as usize * height as usize);
    let pixels: Vec<[f32; 4]> = texels.map(|texel| decode(texture.format, texel)).collect();
    Image::new(width as usize, height as usize, pixels).map_err(|error| refuse(error.to_string()))
}

fn decode(format: Format, texel: &[u8]) -> [f32; 4] {
    let float =
        |i: usize| f32::from_le_bytes([texel[4 * i], texel[4 * i + 1], texel[4 * i + 2], texel[4 * i + 3]]);
    let half = |i: usize| f16::from_le_bytes([texel[2 * i], texel[2 * i + 1]]).to_f32();
    let word = |i: usize| {
        u32::from_le_bytes([texel[4 * i], texel[4 * i + 1], texel[4 * i + 2], texel[4 * i + 3]]) as f32
    };
    let unorm = |i: usize| f32::from(texel[i]) / 255.0;
    let grey = |v: f32| [v, v, v, 1.0];
    match format {
        Format::R8Unorm => grey(unorm(0)),
        Format::Rgba8Unorm | Format::Rgba8UnormSrgb => [unorm(0), unorm(1), unorm(2), unorm(3)],
        Format::R16Float => grey(half(0)),
        Format::Rg16Float => [half(0), half(1), 0.0, 1.0],
        Format::Rgba16Float => [half(0), half(1), half(2), half(3)],
        Format::R32Float | Format::Depth32Float => grey(float(0)),
        Format::Rg32Float => [float(0), float(1), 0.0, 1.0],
        Format::Rgba32Float => [float(0), float(1), float(2), float(3)],
        Format::R32Uint => grey(word(0)),
        Format::Rg32Uint => [word(0), word(1), 0.0, 1.0],
        Format::Rgba32Uint => [word(0), word(1), word(2), word(3)],
    }
}

/// A picture encoded for a screen as the linear light that it stands for: pictures are linear everywhere.
pub(crate) fn decoded(mut picture: Image) -> Image {
    for pixel in picture.pixels_mut() {
        pixel[..3].iter_mut().for_each(|value| *value = metrics::linear_from_srgb(*value));
    }
    picture
}
