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
    let chain = |(i, texture)| mip_chain(texture, side, Holds::of(i as u32, materials));
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

/// What the texels of a texture say, on which it depends what their mean is.
#[derive(Clone, Copy, PartialEq)]
enum Holds {
    /// Each channel by itself.
    Channels,
    /// Colors of surfaces that are cut out where alpha is low: what is not there has no color.
    CutOuts,
    /// Unit vectors. Their mean says by its length how much they differ.
    Normals,
}

impl Holds {
    fn of(texture: u32, materials: &[Material]) -> Self {
        let texture = Some(texture);
        if materials.iter().any(|material| material.normal_texture == texture) {
            return Self::Normals;
        }
        let mut colored =
            materials.iter().filter(|material| material.base_color_texture == texture).peekable();
        let is_cut_out = colored.peek().is_some() && colored.all(|material| material.alpha_cutoff.is_some());
        if is_cut_out { Self::CutOuts } else { Self::Channels }
    }
}

/// Returns all mip levels of a texture, RGBA of 8 bits, the finest first.
fn mip_chain(texture: &Texture, side: u32, holds: Holds) -> Vec<Vec<u8>> {
    let mut base = if texture.width == side && texture.height == side {
        texture.pixels.clone()
    } else {
        stretch(texture, side)
    };
    if holds == Holds::Normals {
        base.chunks_exact_mut(4).for_each(make_unit);
    }
    let mut chain = vec![base];
    let mut width = side;
    while width > 1 {
        let next = halve(&chain[chain.len() - 1], width, texture.encoding, holds);
        chain.push(next);
        width /= 2;
    }
    if holds == Holds::CutOuts {
        for level in (2..chain.len()).rev() {
            let (finer, coarser) = chain.split_at_mut(level);
            color_what_is_cut_out(&mut finer[level - 1], &coarser[0], side as usize >> (level - 1));
        }
    }
    chain
}

/// Gives texels of which nothing is there the color of the level above, so that filters mix no black into what is beside them.
fn color_what_is_cut_out(pixels: &mut [u8], above: &[u8], width: usize) {
    for (i, texel) in pixels.chunks_exact_mut(4).enumerate() {
        if texel[3] == 0 {
            let first = (i / width / 2 * (width / 2) + i % width / 2) * 4;
            texel[..3].copy_from_slice(&above[first..first + 3]);
        }
    }
}

/// Scales the normal in a texel to unit length. No byte stands for 0, so every normal has a direction.
fn make_unit(texel: &mut [u8]) {
    let normal = Vec3::from_array([0, 1, 2].map(|i| f32::from(texel[i]) / 127.5 - 1.0));
    for (byte, x) in texel.iter_mut().zip(normal.normalize().to_array()) {
        *byte = ((x + 1.0) * 127.5).round() as u8;
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
fn halve(pixels: &[u8], width: u32, encoding: Encoding, holds: Holds) -> Vec<u8> {
    let half = (width / 2) as usize;
    let width = width as usize;
    let mut out = Vec::with_capacity(half * half * 4);
    for y in 0..half {
        for x in 0..half {
            let corners = [(0, 0), (1, 0), (0, 1), (1, 1)];
            let four = corners.map(|(dx, dy)| {
                let first = ((2 * y + dy) * width + 2 * x + dx) * 4;
                [0, 1, 2, 3].map(|channel| pixels[first + channel])
            });
            let alphas = four.map(|texel| f32::from(texel[3]));
            let is_weighted = holds == Holds::CutOuts && alphas.iter().any(|alpha| *alpha > 0.0);
            for channel in 0..4 {
                let values = four.map(|texel| texel[channel]);
                let weights = if is_weighted && channel < 3 { alphas } else { [1.0; 4] };
                out.push(mean(values, weights, is_color(encoding, channel)));
            }
        }
    }
    out
}

/// Returns the weighted mean of bytes, of colors that of the light that they encode.
fn mean(values: [u8; 4], weights: [f32; 4], is_color: bool) -> u8 {
    let decoded = |byte: u8| {
        if is_color { metrics::linear_from_srgb(f32::from(byte) / 255.0) } else { f32::from(byte) }
    };
    let sum: f32 = values.into_iter().zip(weights).map(|(byte, weight)| weight * decoded(byte)).sum();
    let mean = sum / weights.iter().sum::<f32>();
    (if is_color { metrics::srgb_from_linear(mean) * 255.0 } else { mean }).round() as u8
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
        let chain = mip_chain(&texture(2, Encoding::Linear, pixels), 2, Holds::Normals);
        let decoded = |texel: &[u8]| [0, 1, 2].map(|i| f32::from(texel[i]) / 127.5 - 1.0);
        for (texel, side) in chain[0].chunks_exact(4).zip([1.0, -1.0, -1.0, 1.0]) {
            let expected = Vec3::new(0.866 * side, 0.0, 0.5);
            assert!(Vec3::from(decoded(texel)).abs_diff_eq(expected, 0.02), "{texel:?} for {expected}");
        }
        let mean = Vec3::from(decoded(&chain[1]));
        assert!(mean.abs_diff_eq(Vec3::new(0.0, 0.0, 0.5), 0.02), "{mean}");
    }

    /// The mean of a white leaf and what is around it is white.
    #[test]
    fn what_is_cut_out_has_no_color() {
        let (leaf, around) = ([255, 255, 255, 255], [0, 0, 0, 0]);
        let pixels = [leaf, around, around, around].concat();
        for (holds, color) in [(Holds::CutOuts, 255), (Holds::Channels, 137)] {
            let chain = mip_chain(&texture(2, Encoding::Srgb, pixels.clone()), 2, holds);
            assert_eq!(chain[1], [color, color, color, 64]);
        }
        // So is the mean of what has no leaf beside it.
        let rows = [[leaf, around, around, around], [around; 4], [around; 4], [around; 4]].concat().concat();
        let chain = mip_chain(&texture(4, Encoding::Srgb, rows), 4, Holds::CutOuts);
        assert_eq!(
            chain[1],
            [[255, 255, 255, 64], [255, 255, 255, 0], [255, 255, 255, 0], [255, 255, 255, 0]].concat()
        );
        let nothing = mip_chain(&texture(2, Encoding::Srgb, around.repeat(4)), 2, Holds::CutOuts);
        assert_eq!(nothing[1], around);
        let cut_out =
            Material { base_color_texture: Some(0), alpha_cutoff: Some(0.5), ..Material::default() };
        let whole = Material { alpha_cutoff: None, ..cut_out.clone() };
        assert!(Holds::of(0, std::slice::from_ref(&cut_out)) == Holds::CutOuts);
        assert!(Holds::of(0, &[cut_out, whole]) == Holds::Channels);
    }
}
