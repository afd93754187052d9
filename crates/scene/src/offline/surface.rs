//! Turns the surfaces of offline renderers into the materials of a scene.

use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;

use data_file::Span;
use glam::Vec3;

use super::paint::{Paint, Picture, Texels, UvMap, decode};
use super::report::{Report, error};
use crate::codes;
use crate::error::SceneError;
use crate::material::{Encoding, Material, Texture, Wrap};

/// A surface, as far as materials can hold it.
#[derive(Clone)]
pub(super) struct Surface {
    pub(super) name: String,
    /// Albedo of a dielectric, reflectance at normal incidence of a metal.
    pub(super) base: Paint,
    /// Reflectance at normal incidence of the coat of a dielectric.
    pub(super) specular: f32,
    pub(super) is_metal: bool,
    /// Width α of the microfacet distribution.
    pub(super) alpha: Paint,
    /// The share of the surface that is there.
    pub(super) opacity: Option<Paint>,
    pub(super) normal: Option<Picture>,
}

impl Surface {
    /// Returns a Lambertian surface.
    pub(super) fn diffuse(name: &str, albedo: Paint) -> Surface {
        Surface {
            name: name.to_owned(),
            base: albedo,
            specular: 0.0,
            is_metal: false,
            alpha: Paint::number(1.0),
            opacity: None,
            normal: None,
        }
    }
}

/// Light from a surface.
#[derive(Clone)]
pub(super) struct Emission {
    /// Radiance \[W/(m² sr)\].
    pub(super) radiance: Paint,
    pub(super) both_sides: bool,
}

/// A surface and the light from it. Shapes that share both share a material; `None` is a surface that is left out.
#[derive(Clone)]
pub(super) struct Look {
    pub(super) surface: Option<Rc<Surface>>,
    pub(super) emission: Option<Rc<Emission>>,
    /// The share of a shape that is there.
    pub(super) mask: Option<Paint>,
}

/// The materials and textures of a scene.
#[derive(Default)]
pub(super) struct Materials {
    pub(super) materials: Vec<Material>,
    pub(super) textures: Vec<Texture>,
    /// Transform of the texture coordinates of each material.
    pub(super) maps: Vec<UvMap>,
    /// Materials by the addresses of surface and emission, which are kept, so that no other has them.
    made: BTreeMap<(usize, usize), (u32, Look)>,
    /// Textures by the address of their texels and their use.
    used: BTreeMap<(usize, Use), (u32, Rc<Texels>)>,
    /// Pictures by the path of their file, the encoding that was asked for, and what is beyond their edges.
    read: BTreeMap<(String, Option<Encoding>, u8), Option<Rc<Texels>>>,
}

/// A use of texels.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Use {
    Color,
    /// A color whose alpha is a mask.
    Masked,
    Roughness,
    Normal,
}

impl Materials {
    /// Returns the index of the material for a look; `None` if nothing is there.
    pub(super) fn material(
        &mut self,
        look: &Look,
        span: &Span,
        report: &mut Report<'_>,
    ) -> Result<Option<u32>, SceneError> {
        let Some(surface) = &look.surface else { return Ok(None) };
        let mask = look.mask.as_ref().or(surface.opacity.as_ref());
        if let Some(Paint::Plain(share)) = mask
            && share.x < 1.0
        {
            let share = share.x;
            if share < 0.5 {
                report.note(span, format!("a shape with an opacity of {share} is left out"));
                return Ok(None);
            }
            report.note(span, format!("a shape with an opacity of {share} is taken as opaque"));
        }
        let address = look.emission.as_ref().map_or(0, |emission| Rc::as_ptr(emission) as usize);
        let key = (Rc::as_ptr(surface) as usize, address);
        // Masks are few, and each has a material of its own.
        if look.mask.is_none()
            && let Some((index, _)) = self.made.get(&key)
        {
            return Ok(Some(*index));
        }
        let made = self.make(surface, look.emission.as_deref(), mask, span, report)?;
        let index = self.materials.len() as u32;
        let clamped = made.0.clamped();
        if clamped != made.0 {
            report.note(
                span,
                format!("material `{}` has factors out of range: they are clamped", clamped.name),
            );
        }
        self.materials.push(clamped);
        self.maps.push(made.1);
        if look.mask.is_none() {
            self.made.insert(key, (index, look.clone()));
        }
        Ok(Some(index))
    }

    fn make(
        &mut self,
        surface: &Surface,
        emission: Option<&Emission>,
        mask: Option<&Paint>,
        span: &Span,
        report: &mut Report<'_>,
    ) -> Result<(Material, UvMap), SceneError> {
        let mask = match mask {
            Some(Paint::Picture(mask)) => Some(mask),
            _ => None,
        };
        let roughness = surface.alpha.mapped(|alpha| alpha.clamp(0.0, 1.0).sqrt());
        let pictures = [
            picture(&surface.base),
            emission.and_then(|emission| picture(&emission.radiance)),
            picture(&roughness),
            surface.normal.as_ref(),
            mask,
        ];
        let map = pictures.into_iter().flatten().map(|picture| picture.map).next();
        let map = map.unwrap_or(UvMap::IDENTITY);
        if pictures.into_iter().flatten().any(|picture| picture.map != map) {
            let name = &surface.name;
            report.note(
                span,
                format!("material `{name}` has textures with several transforms of coordinates: the first is taken for all"),
            );
        }
        let (base_color, base_color_texture) = match mask {
            None => self.color(&surface.base, span, report)?,
            Some(mask) => {
                let (factor, texels) = masked(&surface.base, mask);
                (factor, Some(self.texture(&Rc::new(texels), Use::Masked, span, report)?))
            }
        };
        let (emitted, emission_texture) = match emission {
            None => (Vec3::ZERO, None),
            Some(emission) => self.color(&emission.radiance, span, report)?,
        };
        let (roughness, metallic_roughness_texture) = match &roughness {
            Paint::Plain(value) => (value.x, None),
            Paint::Picture(picture) => {
                (1.0, Some(self.texture(&picture.texels, Use::Roughness, span, report)?))
            }
        };
        let normal = surface.normal.as_ref();
        let normal_texture =
            normal.map(|picture| self.texture(&picture.texels, Use::Normal, span, report)).transpose()?;
        let material = Material {
            name: surface.name.clone(),
            base_color: base_color.extend(1.0),
            base_color_texture,
            emission: emitted,
            emission_texture,
            specular: Vec3::splat(surface.specular),
            metallic: if surface.is_metal { 1.0 } else { 0.0 },
            roughness,
            metallic_roughness_texture,
            normal_texture,
            alpha_cutoff: mask.map(|_| 0.5),
            ..Material::default()
        };
        Ok((material, map))
    }

    /// Adds a material without textures.
    pub(super) fn plain(&mut self, material: Material) -> u32 {
        self.materials.push(material);
        self.maps.push(UvMap::IDENTITY);
        self.materials.len() as u32 - 1
    }

    fn color(
        &mut self,
        paint: &Paint,
        span: &Span,
        report: &mut Report<'_>,
    ) -> Result<(Vec3, Option<u32>), SceneError> {
        match paint {
            Paint::Plain(color) => Ok((*color, None)),
            Paint::Picture(Picture { texels, factor, .. }) => {
                Ok((*factor, Some(self.texture(texels, Use::Color, span, report)?)))
            }
        }
    }

    fn texture(
        &mut self,
        texels: &Rc<Texels>,
        usage: Use,
        span: &Span,
        report: &mut Report<'_>,
    ) -> Result<u32, SceneError> {
        let key = (Rc::as_ptr(texels) as usize, usage);
        if let Some((index, _)) = self.used.get(&key) {
            return Ok(*index);
        }
        report.take(texels.pixels.len(), 1, span)?;
        let (pixels, encoding) = match usage {
            Use::Masked => (texels.pixels.clone(), Encoding::Srgb),
            Use::Color => (texels.opaque(Encoding::Srgb), Encoding::Srgb),
            Use::Normal => (texels.pixels.clone(), Encoding::Linear),
            Use::Roughness => {
                let texels = texels.pixels.chunks_exact(4);
                (texels.flat_map(|texel| [u8::MAX, texel[0], u8::MAX, u8::MAX]).collect(), Encoding::Linear)
            }
        };
        let index = self.textures.len() as u32;
        self.textures.push(Texture {
            name: texels.name.clone(),
            width: texels.width,
            height: texels.height,
            pixels,
            encoding,
            wrap: texels.wrap,
        });
        self.used.insert(key, (index, Rc::clone(texels)));
        Ok(index)
    }

    /// Returns the texels of a picture file; `None` if its format is not read, which is noted. With an `encoding`, its bytes
    /// are taken to have that, whatever their format.
    pub(super) fn picture(
        &mut self,
        name: &str,
        encoding: Option<Encoding>,
        wrap: Wrap,
        span: &Span,
        report: &mut Report<'_>,
    ) -> Result<Option<Rc<Texels>>, SceneError> {
        let path = report.path(name, span)?;
        let key = (path.display().to_string(), encoding, wrap as u8);
        if let Some(known) = self.read.get(&key) {
            return Ok(known.clone());
        }
        let (path, bytes) = report.bytes(name, span)?;
        let take = |bytes: usize| report.budget.take(bytes, 1);
        let texels = match decode(&path, &bytes, take) {
            Err(problem) => {
                report.note(span, format!("the picture {name} is taken as grey: {problem}"));
                None
            }
            Ok(Err(problem)) => {
                let message = format!("{}: cannot be read: {problem}", path.display());
                return Err(error(&codes::FILE, span, message, "this picture"));
            }
            Ok(Ok((image, of_format))) => Some(Rc::new(Texels {
                name: Path::new(name)
                    .file_name()
                    .map_or(name.into(), |name| name.to_string_lossy())
                    .into_owned(),
                width: image.width(),
                height: image.height(),
                pixels: image.into_raw(),
                encoding: encoding.unwrap_or(of_format),
                wrap: [wrap; 2],
            })),
        };
        self.read.insert(key, texels.clone());
        Ok(texels)
    }
}

fn picture(paint: &Paint) -> Option<&Picture> {
    match paint {
        Paint::Plain(_) => None,
        Paint::Picture(picture) => Some(picture),
    }
}

/// Returns the factor and the texels of a color whose alpha is the red of a mask.
fn masked(base: &Paint, mask: &Picture) -> (Vec3, Texels) {
    let (factor, of_base) = match base {
        Paint::Plain(color) => (*color, None),
        Paint::Picture(picture) => (picture.factor, Some(&picture.texels)),
    };
    let size = of_base.unwrap_or(&mask.texels);
    let (width, height) = (size.width, size.height);
    let mut pixels = match of_base {
        Some(texels) => texels.opaque(Encoding::Srgb),
        None => vec![u8::MAX; 4 * width as usize * height as usize],
    };
    for (i, texel) in (0..).zip(pixels.chunks_exact_mut(4)) {
        let place =
            [(i % width, width), (i / width, height)].map(|(at, count)| (at as f32 + 0.5) / count as f32);
        texel[3] = mask.texels.red(place);
    }
    let name = mask.texels.name.clone();
    (factor, Texels { name, width, height, pixels, encoding: Encoding::Srgb, wrap: size.wrap })
}
