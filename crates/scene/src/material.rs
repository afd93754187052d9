//! Materials and textures, in the metallic-roughness model of glTF 2.0.

use glam::{Vec3, Vec4};
use serde::Serialize;

use crate::light::BRIGHTEST;

/// The material of a surface. Each texture is multiplied by the factor beside it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Material {
    /// The name in its file.
    #[serde(skip)]
    pub name: String,
    /// Albedo of a dielectric, reflectance at normal incidence of a metal; alpha is the last component.
    /// Linear, 0..=1.
    pub base_color: Vec4,
    /// Index into [`Scene::textures`](crate::Scene::textures); sRGB.
    pub base_color_texture: Option<u32>,
    /// Emitted radiance, the same in all directions \[W/(m² sr)\], RGB.
    pub emission: Vec3,
    /// Index of a texture; sRGB.
    pub emission_texture: Option<u32>,
    /// Reflectance at normal incidence of the dielectric part (F₀), RGB: 0.04 unless KHR_materials_specular
    /// gives another value.
    pub specular: Vec3,
    /// The share that is metal, 0..=1: the diffuse albedo is `base_color · (1 − metallic)`, and F₀ of the
    /// metal is `base_color`.
    pub metallic: f32,
    /// Perceptual roughness, 0..=1; α of the microfacet distribution is its square.
    pub roughness: f32,
    /// Index of a texture: roughness in green, metallic in blue; linear.
    pub metallic_roughness_texture: Option<u32>,
    /// Index of a texture of tangent-space normals; linear.
    pub normal_texture: Option<u32>,
    /// Factor of the x and y components of tangent-space normals.
    pub normal_scale: f32,
    /// Alpha below which the surface is cut out; `None` for opaque surfaces.
    pub alpha_cutoff: Option<f32>,
}

impl Default for Material {
    /// Returns a white Lambertian surface.
    fn default() -> Self {
        Material {
            name: String::new(),
            base_color: Vec4::ONE,
            base_color_texture: None,
            emission: Vec3::ZERO,
            emission_texture: None,
            specular: Vec3::splat(0.04),
            metallic: 0.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            alpha_cutoff: None,
        }
    }
}

impl Material {
    /// Returns a Lambertian surface of this albedo.
    pub(crate) fn matte(name: &str, albedo: [f32; 3]) -> Material {
        Material { name: name.into(), base_color: Vec3::from(albedo).extend(1.0), ..Material::default() }
    }

    /// Returns whether the surface has specular reflection. A dielectric of roughness 1 counts as Lambertian,
    /// since its specular reflection is spread over the whole hemisphere.
    pub fn is_glossy(&self) -> bool {
        self.metallic > 0.0 || (self.roughness < 1.0 && self.specular.max_element() > 0.0)
    }

    /// Returns whether the surface emits light.
    pub fn is_emissive(&self) -> bool {
        self.emission.max_element() > 0.0
    }

    /// Returns whether it has any texture.
    pub fn is_textured(&self) -> bool {
        self.textures().into_iter().any(|t| t.is_some())
    }

    fn textures(&self) -> [Option<u32>; 4] {
        [self.base_color_texture, self.emission_texture, self.metallic_roughness_texture, self.normal_texture]
    }

    /// Returns the material with its numbers within their ranges; those that are not finite become the neutral one.
    pub(crate) fn clamped(&self) -> Material {
        let unit = |x: f32| if x.is_finite() { x.clamp(0.0, 1.0) } else { 1.0 };
        let light = |x: f32| if x.is_finite() { x.clamp(0.0, BRIGHTEST) } else { 0.0 };
        Material {
            base_color: Vec4::from_array(self.base_color.to_array().map(unit)),
            emission: self.emission.to_array().map(light).into(),
            specular: self.specular.to_array().map(unit).into(),
            metallic: unit(self.metallic),
            roughness: unit(self.roughness),
            normal_scale: if self.normal_scale.is_finite() { self.normal_scale } else { 1.0 },
            ..self.clone()
        }
    }

    /// Adds `offset` to the texture indices, for a material that is appended after `offset` textures of other
    /// models.
    pub(crate) fn offset_textures(&mut self, offset: u32) {
        for texture in [
            &mut self.base_color_texture,
            &mut self.emission_texture,
            &mut self.metallic_roughness_texture,
            &mut self.normal_texture,
        ]
        .into_iter()
        .flatten()
        {
            *texture += offset;
        }
    }
}

/// The encoding of the values of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub enum Encoding {
    /// Colors in sRGB, with linear alpha.
    Srgb,
    /// Linear values.
    Linear,
}

/// The content of a texture outside 0..1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
pub enum Wrap {
    /// The texture is repeated.
    Repeat,
    /// The texture is repeated, mirrored every second time.
    Mirror,
    /// The value at the edge.
    Clamp,
}

/// A texture image.
#[derive(Clone, PartialEq, Serialize)]
pub struct Texture {
    /// The name in its file.
    #[serde(skip)]
    pub name: String,
    /// Columns, ≥ 1.
    pub width: u32,
    /// Rows, ≥ 1; row 0 is at v = 0.
    pub height: u32,
    /// RGBA, 8 bits each, row by row: 4 · width · height bytes.
    #[serde(skip)]
    pub pixels: Vec<u8>,
    /// The encoding of the pixels.
    pub encoding: Encoding,
    /// The content outside, along u and v.
    pub wrap: [Wrap; 2],
}

impl std::fmt::Debug for Texture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Texture { name, width, height, encoding, wrap, .. } = self;
        write!(f, "Texture({name:?}, {width}×{height}, {encoding:?}, {wrap:?})")
    }
}
