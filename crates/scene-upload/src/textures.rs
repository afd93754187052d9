//! The textures of the scene as one array with mip levels: every pass, raster or compute, can read any of
//! them on any adapter, without binding arrays.

use bytemuck::cast_slice;
use executor::wgpu;
use glam::Vec3;
use rayon::prelude::*;
use scene::{Encoding, Environment, Material, Texture};

/// Greatest size of the array with its mip levels, in bytes; the side is halved until it fits.
const BUDGET: u64 = 512 << 20;

/// Returns the side of the array's layers: that of the largest texture, as a power of two, within the
/// adapter's limits and the budget.
pub(crate) fn array_side(textures: &[Texture], limit: u32) -> u32 {
    let largest = textures.iter().map(|texture| texture.width.max(texture.height)).max().unwrap_or(1);
    let mut side = largest.next_power_of_two().min(prev_power_of_two(limit));
    while side > 1 && u64::from(side) * u64::from(side) * 4 * textures.len() as u64 * 4 / 3 > BUDGET {
        side /= 2;
    }
    side
}

fn prev_power_of_two(n: u32) -> u32 {
    1 << n.max(1).ilog2()
}

/// Views of the array: decoded from sRGB, and undecoded.
pub(crate) struct TextureArray {
    pub(crate) color: wgpu::TextureView,
    pub(crate) linear: wgpu::TextureView,
}

/// Uploads the textures of the materials, each stretched to its own layer.
pub(crate) fn upload(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    textures: &[Texture],
    materials: &[Material],
) -> TextureArray {
    let side = array_side(textures, device.limits().max_texture_dimension_2d);
    let levels = side.ilog2() + 1;
    let array = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("scene textures"),
        size: wgpu::Extent3d {
            width: side,
            height: side,
            depth_or_array_layers: textures.len().max(1) as u32,
        },
        mip_level_count: levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[wgpu::TextureFormat::Rgba8UnormSrgb],
    });
    let is_normal_map = |i: usize| materials.iter().any(|material| material.normal_texture == Some(i as u32));
    let chain = |(i, texture)| mip_chain(texture, side, is_normal_map(i));
    let chains: Vec<Vec<Vec<u8>>> = textures.par_iter().enumerate().map(chain).collect();
    for (layer, chain) in chains.iter().enumerate() {
        for (level, pixels) in chain.iter().enumerate() {
            let width = side >> level;
            queue.write_texture(
                wgpu::TexelCopyTextureInfo {
                    texture: &array,
                    mip_level: level as u32,
                    origin: wgpu::Origin3d { x: 0, y: 0, z: layer as u32 },
                    aspect: wgpu::TextureAspect::All,
                },
                pixels,
                wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(width * 4),
                    rows_per_image: None,
                },
                wgpu::Extent3d { width, height: width, depth_or_array_layers: 1 },
            );
        }
    }
    let view = |format| {
        array.create_view(&wgpu::TextureViewDescriptor {
            label: Some("scene textures"),
            format: Some(format),
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        })
    };
    TextureArray {
        color: view(wgpu::TextureFormat::Rgba8UnormSrgb),
        linear: view(wgpu::TextureFormat::Rgba8Unorm),
    }
}

/// Uploads the map of an environment.
pub(crate) fn upload_environment(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    environment: &Environment,
) -> wgpu::TextureView {
    let size =
        wgpu::Extent3d { width: environment.width, height: environment.height, depth_or_array_layers: 1 };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("scene environment"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let texels: Vec<[f32; 4]> = environment.texels.iter().map(|[r, g, b]| [*r, *g, *b, 1.0]).collect();
    let rows = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(environment.width * 16),
        rows_per_image: None,
    };
    queue.write_texture(texture.as_image_copy(), cast_slice(&texels), rows, size);
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

/// Returns all mip levels of a texture, RGBA of 8 bits, the finest first. A normal map has unit vectors at the finest level, and their
/// means at the others, which say by their length how much the normals differ.
fn mip_chain(texture: &Texture, side: u32, is_normal_map: bool) -> Vec<Vec<u8>> {
    let mut base = if texture.width == side && texture.height == side {
        texture.pixels.clone()
    } else {
        stretch(texture, side)
    };
    if is_normal_map {
        base.chunks_exact_mut(4).for_each(make_unit);
    }
    let mut chain = vec![base];
    let mut width = side;
    while width > 1 {
        let next = halve(&chain[chain.len() - 1], width, texture.encoding);
        chain.push(next);
        width /= 2;
    }
    chain
}

/// Scales the normal in a texel to unit length; one without a direction stays.
fn make_unit(texel: &mut [u8]) {
    let normal = Vec3::from_array([0, 1, 2].map(|i| f32::from(texel[i]) / 127.5 - 1.0));
    if let Some(unit) = normal.try_normalize() {
        for (byte, x) in texel.iter_mut().zip(unit.to_array()) {
            *byte = ((x + 1.0) * 127.5).round() as u8;
        }
    }
}

/// Stretches a texture to a square. Colors are interpolated in linear light, since they would become darker
/// if interpolated in sRGB.
fn stretch(texture: &Texture, side: u32) -> Vec<u8> {
    let decoded = texture.pixels.iter().enumerate().map(|(i, v)| {
        let value = f32::from(*v) / 255.0;
        if is_color(texture.encoding, i % 4) { metrics::linear_from_srgb(value) } else { value }
    });
    let image = image::Rgba32FImage::from_raw(texture.width, texture.height, decoded.collect())
        .unwrap_or_else(|| image::Rgba32FImage::from_pixel(1, 1, image::Rgba([1.0; 4])));
    let stretched = image::imageops::resize(&image, side, side, image::imageops::FilterType::Triangle);
    let encoded = stretched.into_raw().into_iter().enumerate().map(|(i, value)| {
        let value = if is_color(texture.encoding, i % 4) { metrics::srgb_from_linear(value) } else { value };
        (value * 255.0).round() as u8
    });
    encoded.collect()
}

/// Returns whether a channel is encoded in sRGB: all channels of a color texture except alpha.
fn is_color(encoding: Encoding, channel: usize) -> bool {
    encoding == Encoding::Srgb && channel < 3
}

/// Returns the mean of each 2×2 texels, for colors in linear light.
fn halve(pixels: &[u8], width: u32, encoding: Encoding) -> Vec<u8> {
    let half = (width / 2) as usize;
    let width = width as usize;
    let mut out = Vec::with_capacity(half * half * 4);
    for y in 0..half {
        for x in 0..half {
            for channel in 0..4 {
                let texel = |dx: usize, dy: usize| pixels[((2 * y + dy) * width + 2 * x + dx) * 4 + channel];
                let four = [texel(0, 0), texel(1, 0), texel(0, 1), texel(1, 1)];
                let mean = if is_color(encoding, channel) {
                    let sum: f32 =
                        four.iter().map(|v| metrics::linear_from_srgb(f32::from(*v) / 255.0)).sum();
                    metrics::srgb_from_linear(sum / 4.0) * 255.0
                } else {
                    four.iter().map(|v| f32::from(*v)).sum::<f32>() / 4.0
                };
                out.push(mean.round() as u8);
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texture(width: u32, encoding: Encoding, pixels: Vec<u8>) -> Texture {
        let height = pixels.len() as u32 / 4 / width;
        let wrap = [scene::Wrap::Repeat; 2];
        Texture { name: String::new(), width, height, pixels, encoding, wrap }
    }

    /// The mean of a checkerboard is ½ in linear light, which is 188 in sRGB and not 128.
    #[test]
    fn colors_are_mixed_as_light() {
        let (black, white) = ([0, 0, 0, 255], [255; 4]);
        let row = [black, white, black].concat();
        let stretched = stretch(&texture(3, Encoding::Srgb, row.clone()), 4);
        let light: Vec<f32> =
            stretched.chunks(4).map(|p| metrics::linear_from_srgb(f32::from(p[0]) / 255.0)).collect();
        // Four texels are resampled to three: their centres lie at 1/4 of the distance to the neighbours.
        let expected = [0.0, 0.625, 0.625, 0.0];
        for (found, expected) in light[..4].iter().zip(expected) {
            assert!((found - expected).abs() < 0.01, "{light:?}");
        }
        assert!(stretched.chunks(4).all(|pixel| pixel[3] == 255), "alpha is no light");
        let plain = stretch(&texture(3, Encoding::Linear, row), 4);
        assert!((f32::from(plain[4]) / 255.0 - 0.625).abs() < 0.01, "{plain:?}");
    }

    /// Normals that lean by 60° to either side have half their length in the mean, whatever length the file gives them.
    #[test]
    fn normals_shorten_where_they_differ() {
        let byte = |x: f32| ((x + 1.0) * 127.5).round() as u8;
        let texel = |x: f32, length: f32| [byte(0.866 * x * length), byte(0.0), byte(0.5 * length), 255];
        let pixels = [texel(1.0, 1.0), texel(-1.0, 0.4), texel(-1.0, 1.0), texel(1.0, 0.6)].concat();
        let chain = mip_chain(&texture(2, Encoding::Linear, pixels), 2, true);
        let decoded = |texel: &[u8]| [0, 1, 2].map(|i| f32::from(texel[i]) / 127.5 - 1.0);
        for (texel, side) in chain[0].chunks_exact(4).zip([1.0, -1.0, -1.0, 1.0]) {
            let expected = Vec3::new(0.866 * side, 0.0, 0.5);
            assert!(Vec3::from(decoded(texel)).abs_diff_eq(expected, 0.02), "{texel:?} for {expected}");
        }
        let mean = Vec3::from(decoded(&chain[1]));
        assert!(mean.abs_diff_eq(Vec3::new(0.0, 0.0, 0.5), 0.02), "{mean}");
        // A normal of length 0 has no direction.
        let none = [128, 128, 128, 255];
        assert!(
            mip_chain(&texture(1, Encoding::Linear, none.to_vec()), 1, true)[0].iter().all(|b| *b >= 127)
        );
    }
}
