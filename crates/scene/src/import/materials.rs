//! Reads materials, textures and images.

use std::collections::{BTreeMap, BTreeSet};

use glam::{Vec3, Vec4};
use gltf::json::material::AlphaMode;
use gltf::json::texture::{Sampler, WrappingMode};
use gltf::json::validation::Checked;
use image::DynamicImage;
use metrics::decode;
use rayon::prelude::*;

use super::{Importer, named};
use crate::error::SceneError;
use crate::material::{Encoding, Material, Texture, Wrap};

/// A texture of the document, with the encoding in which a material uses it.
type Key = (usize, Encoding);

/// The index by which the crate `gltf` says that a texture names no image.
const NO_IMAGE: usize = u32::MAX as usize;

/// Access to the field of a material that holds the index of one of its textures.
type Slot = fn(&mut Material) -> &mut Option<u32>;

/// The materials, their textures, and for each material the set of texture coordinates that it uses.
pub(super) struct Materials {
    pub(super) materials: Vec<Material>,
    pub(super) textures: Vec<Texture>,
    pub(super) uv_sets: Vec<u32>,
}

/// A use of a texture: the field for its index, which is not yet known.
struct Use {
    material: usize,
    key: Key,
    slot: Slot,
}

impl Importer<'_> {
    /// Returns all materials, and the textures that they use.
    pub(super) fn materials(&mut self) -> Result<Materials, SceneError> {
        let (mut materials, mut uses, mut uv_sets) = (Vec::new(), Vec::new(), Vec::new());
        for (index, material) in self.root.materials.iter().enumerate() {
            let name = named(&material.name).unwrap_or_else(|| format!("material {index}"));
            let pbr = &material.pbr_metallic_roughness;
            let extensions = material.extensions.as_ref();
            let strength =
                extensions.and_then(|e| e.emissive_strength.as_ref()).map_or(1.0, |s| s.emissive_strength.0);
            let specular = extensions.and_then(|e| e.specular.as_ref());
            let specular =
                specular.map_or(Vec3::ONE, |s| Vec3::from(s.specular_color_factor.0) * s.specular_factor.0);
            let alpha_cutoff = match material.alpha_mode {
                Checked::Valid(AlphaMode::Mask) => Some(material.alpha_cutoff.map_or(0.5, |c| c.0)),
                Checked::Valid(AlphaMode::Blend) => {
                    self.repairs.push(format!("material `{name}` blends by alpha: it is taken as opaque"));
                    None
                }
                _ => None,
            };
            let read = Material {
                base_color: Vec4::from(pbr.base_color_factor.0),
                emission: Vec3::from(material.emissive_factor.0) * strength,
                specular: (0.04 * specular).min(Vec3::ONE),
                metallic: pbr.metallic_factor.0,
                roughness: pbr.roughness_factor.0,
                normal_scale: material.normal_texture.as_ref().map_or(1.0, |t| t.scale),
                alpha_cutoff,
                name,
                ..Material::default()
            };
            let slots: [(_, _, Slot); 4] = [
                (pbr.base_color_texture.as_ref().map(|t| (t.index, t.tex_coord)), Encoding::Srgb, |m| {
                    &mut m.base_color_texture
                }),
                (material.emissive_texture.as_ref().map(|t| (t.index, t.tex_coord)), Encoding::Srgb, |m| {
                    &mut m.emission_texture
                }),
                (
                    pbr.metallic_roughness_texture.as_ref().map(|t| (t.index, t.tex_coord)),
                    Encoding::Linear,
                    |m| &mut m.metallic_roughness_texture,
                ),
                (material.normal_texture.as_ref().map(|t| (t.index, t.tex_coord)), Encoding::Linear, |m| {
                    &mut m.normal_texture
                }),
            ];
            let mut sets = Vec::new();
            for (texture, encoding, slot) in slots {
                if let Some((texture, set)) = texture {
                    sets.push(set);
                    uses.push(Use { material: index, key: (texture.value(), encoding), slot });
                }
            }
            if sets.windows(2).any(|pair| pair[0] != pair[1]) {
                let name = &read.name;
                let set = sets[0];
                self.repairs.push(format!(
                    "material `{name}` has textures in several sets of coordinates: set {set} is taken for all"
                ));
            }
            uv_sets.push(sets.first().copied().unwrap_or(0));
            materials.push(self.clamped(read));
        }
        let (textures, indices) = self.textures(&uses, &materials)?;
        for usage in uses {
            *(usage.slot)(&mut materials[usage.material]) = indices.get(&usage.key).copied();
        }
        Ok(Materials { materials, textures, uv_sets })
    }

    /// Clamps numbers to the ranges of glTF, and reports that as a repair.
    fn clamped(&mut self, material: Material) -> Material {
        let clamped = material.clamped();
        if clamped != material {
            self.repairs
                .push(format!("material `{}` has factors out of range: they are clamped", material.name));
        }
        clamped
    }

    /// Returns the textures in use, and the index of each. Textures that cannot be read are left out and
    /// reported.
    fn textures(
        &mut self,
        uses: &[Use],
        materials: &[Material],
    ) -> Result<(Vec<Texture>, BTreeMap<Key, u32>), SceneError> {
        let mut sources: BTreeMap<Key, (usize, [Wrap; 2])> = BTreeMap::new();
        let (mut seen, mut encoded) = (BTreeSet::new(), Vec::new());
        for usage in uses {
            let name = &materials[usage.material].name;
            let texture =
                self.get(&self.root.textures, usage.key.0, "texture", &format!("material `{name}`"))?;
            let place = format!("texture {}", usage.key.0);
            let wrap = match texture.sampler {
                Some(sampler) => {
                    let Sampler { wrap_s, wrap_t, .. } =
                        self.get(&self.root.samplers, sampler.value(), "sampler", &place)?;
                    [wrap_s, wrap_t].map(|wrap| match wrap {
                        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
                        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
                        _ => Wrap::Repeat,
                    })
                }
                None => [Wrap::Repeat; 2],
            };
            let image = texture.source.value();
            if image == NO_IMAGE {
                let repair = format!("{place} is taken as white: it names an image by an extension alone");
                if !self.repairs.contains(&repair) {
                    self.repairs.push(repair);
                }
                continue;
            }
            sources.insert(usage.key, (image, wrap));
            if seen.insert(image) {
                match self.encoded_image(image, &place)? {
                    Ok(bytes) => encoded.push((image, bytes)),
                    Err(problem) => self.without(image, &problem),
                }
            }
        }
        let mut checked = Vec::new();
        for (image, bytes) in encoded {
            match decode::size(&bytes, None).and_then(|size| within(size).map(|()| size)) {
                Ok((width, height)) => {
                    self.take(u64::from(width) * u64::from(height), 4, &format!("image {image}"))?;
                    checked.push((image, bytes));
                }
                Err(problem) => self.without(image, &problem),
            }
        }
        let decoded: Vec<_> = checked
            .into_par_iter()
            .map(|(image, bytes)| (image, decode::picture(&bytes, None).map(DynamicImage::into_rgba8)))
            .collect();
        let mut pixels = BTreeMap::new();
        for (image, result) in decoded {
            match result {
                Ok(decoded) => {
                    pixels.insert(image, decoded);
                }
                Err(problem) => self.without(image, &problem),
            }
        }
        let (mut textures, mut indices) = (Vec::new(), BTreeMap::new());
        for (key, (image, wrap)) in sources {
            let Some(decoded) = pixels.get(&image) else { continue };
            indices.insert(key, textures.len() as u32);
            self.take(decoded.as_raw().len() as u64, 1, &format!("texture {}", key.0))?;
            textures.push(Texture {
                name: self.image_name(image),
                width: decoded.width(),
                height: decoded.height(),
                pixels: decoded.as_raw().clone(),
                encoding: key.1,
                wrap,
            });
        }
        Ok((textures, indices))
    }

    fn image_name(&self, image: usize) -> String {
        let json = self.root.images.get(image);
        let file = |uri: &String| !uri.starts_with("data:");
        let name = json.and_then(|i| named(&i.name).or_else(|| named(&i.uri).filter(file)));
        name.unwrap_or_else(|| format!("image {image}"))
    }

    fn without(&mut self, image: usize, problem: &str) {
        let name = self.image_name(image);
        self.repairs.push(format!("texture image `{name}` is taken as white: {problem}"));
    }

    /// Returns the bytes of an image as stored in the file; the inner error is one that can be repaired.
    fn encoded_image(&mut self, index: usize, place: &str) -> Result<Result<Vec<u8>, String>, SceneError> {
        let image = self.get(&self.root.images, index, "image", place)?;
        if let Some(view) = image.buffer_view {
            let place = format!("image {index}");
            let bytes = self.view(view.value(), &place)?;
            self.take(bytes.len() as u64, 1, &place)?;
            return Ok(Ok(bytes.to_vec()));
        }
        Ok(match &image.uri {
            Some(uri) => self.fetch(uri),
            None => Err("it names neither a file nor a buffer view".into()),
        })
    }
}

/// Checks the size of an image against what GPUs guarantee.
fn within((width, height): (u32, u32)) -> Result<(), String> {
    if width.max(height) <= decode::MAX_SIDE {
        return Ok(());
    }
    Err(format!("it has {width} x {height} pixels; at most {} each way are allowed", decode::MAX_SIDE))
}
