//! Values that vary over a surface, or do not.

use std::path::Path;
use std::rc::Rc;

use glam::{Vec2, Vec3};
use image::{DynamicImage, RgbaImage};
use metrics::{FileFormat, Image, decode, linear_from_srgb, srgb_from_linear};

use crate::material::{Encoding, Wrap};

/// A color, or a number in its first component: the same everywhere, or from a picture.
#[derive(Clone)]
pub(super) enum Paint {
    Plain(Vec3),
    Picture(Picture),
}

/// A picture on a surface, times a factor.
#[derive(Clone)]
pub(super) struct Picture {
    pub(super) texels: Rc<Texels>,
    pub(super) factor: Vec3,
    pub(super) map: UvMap,
}

/// The texels of a picture.
pub(super) struct Texels {
    pub(super) name: String,
    pub(super) width: u32,
    pub(super) height: u32,
    /// RGBA, row by row from the top.
    pub(super) pixels: Vec<u8>,
    pub(super) encoding: Encoding,
    pub(super) wrap: [Wrap; 2],
}

/// A transform of texture coordinates: scale first, then offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct UvMap {
    pub(super) scale: Vec2,
    pub(super) offset: Vec2,
}

impl UvMap {
    pub(super) const IDENTITY: UvMap = UvMap { scale: Vec2::ONE, offset: Vec2::ZERO };
    /// Of coordinates whose v is upwards: v = 0 is the last row of a picture.
    pub(super) const UPWARDS: UvMap = UvMap { scale: Vec2::new(1.0, -1.0), offset: Vec2::Y };

    pub(super) fn apply(&self, uv: Vec2) -> Vec2 {
        uv * self.scale + self.offset
    }
}

impl Paint {
    pub(super) fn number(value: f32) -> Paint {
        Paint::Plain(Vec3::splat(value))
    }

    /// Returns the paint times a color.
    pub(super) fn times(&self, factor: Vec3) -> Paint {
        match self {
            Paint::Plain(color) => Paint::Plain(*color * factor),
            Paint::Picture(picture) => {
                Paint::Picture(Picture { factor: picture.factor * factor, ..picture.clone() })
            }
        }
    }

    /// Returns the paint with each value changed; those of pictures are kept within 0 and 1.
    pub(super) fn mapped(&self, change: impl Fn(f32) -> f32) -> Paint {
        let picture = match self {
            Paint::Plain(color) => return Paint::Plain(color.map(change)),
            Paint::Picture(picture) => picture,
        };
        let tables = picture.factor.to_array().map(|factor| {
            (0..=u8::MAX)
                .map(|byte| byte_of(change(picture.texels.value(byte) * factor)))
                .collect::<Vec<u8>>()
        });
        let mut pixels = picture.texels.pixels.clone();
        for texel in pixels.chunks_exact_mut(4) {
            (0..3).for_each(|c| texel[c] = tables[c][usize::from(texel[c])]);
        }
        let texels = Texels {
            name: picture.texels.name.clone(),
            pixels,
            encoding: Encoding::Linear,
            ..*picture.texels
        };
        Paint::Picture(Picture { texels: Rc::new(texels), factor: Vec3::ONE, map: picture.map })
    }
}

/// Returns a value from 0 to 1 as a byte.
fn byte_of(value: f32) -> u8 {
    // `as` takes NaN as 0.
    (value.clamp(0.0, 1.0) * 255.0).round() as u8
}

impl Texels {
    /// Returns the value that a byte of a color stands for.
    fn value(&self, byte: u8) -> f32 {
        let value = f32::from(byte) / 255.0;
        match self.encoding {
            Encoding::Srgb => linear_from_srgb(value),
            Encoding::Linear => value,
        }
    }

    /// Returns the pixels in an encoding, with an alpha of 1.
    pub(super) fn opaque(&self, encoding: Encoding) -> Vec<u8> {
        let table: Vec<u8> = (0..=u8::MAX)
            .map(|byte| match (self.encoding, encoding) {
                (Encoding::Linear, Encoding::Srgb) => byte_of(srgb_from_linear(self.value(byte))),
                (Encoding::Srgb, Encoding::Linear) => byte_of(self.value(byte)),
                _ => byte,
            })
            .collect();
        let mut pixels = self.pixels.clone();
        for texel in pixels.chunks_exact_mut(4) {
            (0..3).for_each(|c| texel[c] = table[usize::from(texel[c])]);
            texel[3] = u8::MAX;
        }
        pixels
    }

    /// Returns the red byte of the texel nearest to a place, from 0 to 1 each way.
    pub(super) fn red(&self, [x, y]: [f32; 2]) -> u8 {
        let at = |place: f32, count: u32| ((place * count as f32) as u32).min(count - 1) as usize;
        let texel = at(y, self.height) * self.width as usize + at(x, self.width);
        self.pixels[4 * texel]
    }

    /// Returns a pattern of two colors over four squares, the first in the upper left.
    pub(super) fn checkerboard(colors: [Vec3; 2]) -> Texels {
        // So fine that the filter between texels does not blur the edges of squares much.
        const SIDE: u32 = 128;
        let bytes = colors.map(|color| color.to_array().map(|x| byte_of(srgb_from_linear(x))));
        let pixels = (0..SIDE * SIDE).flat_map(|i| {
            let [x, y] = [i % SIDE, i / SIDE].map(|place| place / (SIDE / 2));
            let [r, g, b] = bytes[(x ^ y) as usize];
            [r, g, b, u8::MAX]
        });
        Texels {
            name: "checkerboard".to_owned(),
            width: SIDE,
            height: SIDE,
            pixels: pixels.collect(),
            encoding: Encoding::Srgb,
            wrap: [Wrap::Repeat; 2],
        }
    }
}

/// Decodes a picture. `take` counts bytes before they are allocated.
///
/// # Errors
/// The error of the file; the outer one is of a format that is not read.
pub(super) fn decode(
    path: &Path,
    bytes: &[u8],
    take: impl Fn(usize) -> Result<(), String>,
) -> Result<Result<(RgbaImage, Encoding), String>, String> {
    let is_jpeg = path
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("jpg") || ending.eq_ignore_ascii_case("jpeg"));
    match FileFormat::of(path) {
        None if !is_jpeg => Err("its format is none of PNG, JPEG, HDR, EXR and PFM".to_owned()),
        None | Some(FileFormat::Png) => Ok(decode::size(bytes, None).and_then(|(width, height)| {
            take(width as usize * height as usize * 8)?;
            let picture = decode::picture(bytes, None).map(DynamicImage::into_rgba8)?;
            Ok((picture, Encoding::Srgb))
        })),
        Some(_) => Ok(radiance(path).and_then(|image| {
            take(image.pixels().len() * 4)?;
            let bytes = image.pixels().iter().flat_map(|pixel| {
                let [r, g, b] = [0, 1, 2].map(|c| byte_of(srgb_from_linear(pixel[c])));
                [r, g, b, byte_of(pixel[3])]
            });
            let side = |side: usize| u32::try_from(side).ok().filter(|side| *side <= decode::MAX_SIDE);
            let (width, height) = (side(image.width()), side(image.height()));
            let size = width
                .zip(height)
                .ok_or_else(|| format!("a side is longer than {} pixels", decode::MAX_SIDE))?;
            let picture = RgbaImage::from_raw(size.0, size.1, bytes.collect());
            Ok((picture.ok_or("it has no pixels")?, Encoding::Srgb))
        })),
    }
}

fn radiance(path: &Path) -> Result<Image, String> {
    Image::read(path).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changed_values_are_those_of_the_light_not_of_the_bytes() {
        let texels = Texels { pixels: vec![0, 128, 255, 255], ..Texels::checkerboard([Vec3::ZERO; 2]) };
        let picture =
            Picture { texels: Rc::new(texels), factor: Vec3::new(1.0, 1.0, 0.25), map: UvMap::IDENTITY };
        let Paint::Picture(root) = Paint::Picture(picture).mapped(f32::sqrt) else { panic!("a picture") };
        // √0.2159 = 0.4646, and √0.25 = 0.5.
        assert_eq!(root.texels.pixels, [0, 118, 128, 255]);
        assert_eq!(root.texels.encoding, Encoding::Linear);
        assert!(matches!(Paint::number(0.25).mapped(f32::sqrt), Paint::Plain(Vec3 { x: 0.5, .. })));
    }

    #[test]
    fn pixels_are_encoded_as_they_are_used() {
        let mut texels = Texels { pixels: vec![0, 128, 255, 7], ..Texels::checkerboard([Vec3::ZERO; 2]) };
        assert_eq!(texels.opaque(Encoding::Srgb), [0, 128, 255, 255]);
        assert_eq!(texels.opaque(Encoding::Linear), [0, 55, 255, 255]);
        texels.encoding = Encoding::Linear;
        assert_eq!(texels.opaque(Encoding::Srgb), [0, 188, 255, 255]);
    }

    #[test]
    fn a_checkerboard_begins_with_its_first_color() {
        let board = Texels::checkerboard([Vec3::ONE, Vec3::ZERO]);
        assert_eq!(
            [[0.1, 0.1], [0.6, 0.1], [0.1, 0.6], [0.9, 0.9]].map(|at| board.red(at)),
            [255, 0, 0, 255]
        );
    }
}
