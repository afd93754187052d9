//! Materials and textures of Mitsuba.

use std::rc::Rc;

use glam::{DMat4, Vec2, Vec3};

use super::Scene;
use super::tree::Element;
use super::values::Usage;
use crate::codes;
use crate::error::SceneError;
use crate::material::{Encoding, Wrap};
use crate::offline::collector::Collector;
use crate::offline::paint::{Paint, Picture, Texels, UvMap};
use crate::offline::report::{error, shortened, unknown};
use crate::offline::spectrum;
use crate::offline::surface::Surface;

/// The most materials within each other.
const MAX_NESTED: usize = 16;

/// The value of a texture that is not supported.
const GREY: f32 = 0.5;

/// Indices of refraction of the materials that Mitsuba knows by name.
const INDICES: [(&str, f32); 18] = [
    ("vacuum", 1.0),
    ("helium", 1.00004),
    ("hydrogen", 1.00013),
    ("air", 1.00028),
    ("carbon dioxide", 1.00045),
    ("water", 1.333),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.4729),
    ("benzene", 1.501),
    ("silicone oil", 1.520_45),
    ("bromine", 1.661),
    ("fused quartz", 1.458),
    ("pyrex", 1.47),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.5046),
];

impl<'t> Scene<'t, '_> {
    /// Returns the surface of the material of a shape; `None` if the shape is left out.
    pub(super) fn surface_of(&mut self, shape: &'t Element) -> Result<Option<Rc<Surface>>, SceneError> {
        for child in &shape.children {
            let target = self.resolved(child)?;
            if target.tag == "bsdf" {
                child.used.set(true);
                return self.surface(target, 0);
            }
        }
        Ok(Some(Rc::new(Surface::diffuse("default", Paint::number(0.5)))))
    }

    fn surface(&mut self, element: &'t Element, nested: usize) -> Result<Option<Rc<Surface>>, SceneError> {
        if let Some(known) = self.surfaces.get(&std::ptr::from_ref(element)) {
            return Ok(known.clone());
        }
        if nested > MAX_NESTED {
            let message = format!("more than {MAX_NESTED} materials are within each other");
            return Err(error(&codes::FORMAT, &element.span, message, "the innermost one"));
        }
        let surface = self.bsdf(element, nested)?.map(Rc::new);
        element.note_unused(&mut self.collector.report);
        self.surfaces.insert(std::ptr::from_ref(element), surface.clone());
        Ok(surface)
    }

    fn bsdf(&mut self, element: &'t Element, nested: usize) -> Result<Option<Surface>, SceneError> {
        let kind = element.kind()?;
        let name = &element.attribute("id").map_or_else(|| shortened(kind), shortened);
        let span = &element.span;
        Ok(match kind {
            "diffuse" => Some(Surface::diffuse(name, self.paint(element, "reflectance", 0.5)?)),
            "plastic" | "roughplastic" => {
                element.ignore(&["nonlinear", "distribution", "sample_visible"]);
                let base = self.paint(element, "diffuse_reflectance", 0.5)?;
                let [inside, outside] =
                    [("int_ior", 1.49), ("ext_ior", 1.000_28)].map(|(name, n)| index(element, name, n));
                let mut specular = spectrum::dielectric(inside? / outside?);
                if let Some(factor) =
                    element.color("specular_reflectance", Usage::Reflectance, &mut self.collector.report)?
                {
                    specular *= factor.element_sum() / 3.0;
                }
                let alpha = self.alpha(element, kind == "plastic")?;
                Some(Surface { specular, alpha, ..Surface::diffuse(name, base) })
            }
            "conductor" | "roughconductor" => {
                element.ignore(&["distribution", "sample_visible"]);
                let mut base = Paint::Plain(self.metal(element)?);
                if element.value("specular_reflectance", &PAINTS)?.is_some() {
                    let factor = self.paint(element, "specular_reflectance", 1.0)?;
                    base = match (&base, &factor) {
                        (Paint::Plain(metal), _) => factor.times(*metal),
                        (Paint::Picture(_), _) => base,
                    };
                }
                let alpha = self.alpha(element, kind == "conductor")?;
                Some(Surface { is_metal: true, alpha, ..Surface::diffuse(name, base) })
            }
            "dielectric" | "thindielectric" | "roughdielectric" => {
                let note = format!("material `{name}` is of glass (`{kind}`): what has it is left out");
                self.collector.report.note(span, note);
                element.children.iter().for_each(|child| child.used.set(true));
                None
            }
            "null" => None,
            "principled" => {
                let base = self.paint(element, "base_color", 0.5)?;
                let metallic = element.number_or("metallic", 0.0)?;
                let roughness = self.paint(element, "roughness", 0.5)?;
                let specular = element.number_or("specular", 0.5)? as f32;
                if metallic > 0.0 && metallic < 1.0 {
                    let note = format!(
                        "material `{name}` is partly metal: it is taken as the nearer of metal and not"
                    );
                    self.collector.report.note(span, note);
                }
                Some(Surface {
                    // A specular of 0.5 is an index of refraction of 1.5.
                    specular: 0.08 * specular,
                    is_metal: metallic >= 0.5,
                    alpha: roughness.mapped(|roughness| roughness * roughness),
                    ..Surface::diffuse(name, base)
                })
            }
            "twosided" => self.nested(element, nested)?,
            "mask" => {
                let opacity = self.paint(element, "opacity", 0.5)?;
                self.nested(element, nested)?.map(|inner| Surface { opacity: Some(opacity), ..inner })
            }
            "normalmap" => {
                let map = self.paint(element, "normalmap", 0.5)?;
                let normal = match map {
                    Paint::Picture(picture) => Some(picture),
                    Paint::Plain(_) => None,
                };
                self.nested(element, nested)?.map(|inner| Surface { normal, ..inner })
            }
            "bumpmap" => {
                self.collector.report.note(span, format!("material `{name}`: its bumps are left out"));
                element
                    .children
                    .iter()
                    .filter(|child| child.tag == "texture")
                    .for_each(|child| child.used.set(true));
                element.ignore(&["scale"]);
                self.nested(element, nested)?
            }
            "blendbsdf" => {
                self.collector
                    .report
                    .note(span, format!("material `{name}` is a blend: it is taken as its first part"));
                element.children.iter().for_each(|child| child.used.set(true));
                self.nested(element, nested)?
            }
            _ => {
                let kind = shortened(kind);
                let note = format!(
                    "material `{name}` is of the type `{kind}`, which is not supported: it is taken as matte grey"
                );
                self.collector.report.note(span, note);
                element.children.iter().for_each(|child| child.used.set(true));
                Some(Surface::diffuse(name, Paint::number(GREY)))
            }
        })
    }

    /// Returns the first material within another one.
    fn nested(&mut self, element: &'t Element, nested: usize) -> Result<Option<Surface>, SceneError> {
        for child in &element.children {
            let target = self.resolved(child)?;
            if target.tag == "bsdf" {
                child.used.set(true);
                return Ok(self.surface(target, nested + 1)?.map(|surface| Surface::clone(&surface)));
            }
        }
        let message = format!("`<bsdf type=\"{}\">` has no `<bsdf>` in it", shortened(element.kind()?));
        Err(error(&codes::VALUE, &element.span, message, "this material"))
    }

    /// Returns the width of the microfacet distribution; a smooth surface has 0.
    fn alpha(&mut self, element: &'t Element, is_smooth: bool) -> Result<Paint, SceneError> {
        if is_smooth {
            return Ok(Paint::number(0.0));
        }
        let alpha = self.paint(element, "alpha", 0.1)?;
        match [element.number("alpha_u")?, element.number("alpha_v")?] {
            [Some(u), Some(v)] => {
                if u != v {
                    self.collector
                        .report
                        .note(&element.span, "roughness that differs along u and v is taken as its mean");
                }
                Ok(Paint::number(0.5 * (u + v) as f32))
            }
            _ => Ok(alpha),
        }
    }

    fn metal(&mut self, element: &'t Element) -> Result<Vec3, SceneError> {
        if let Some((metal, place)) = element.text("material")? {
            let base = metal.strip_suffix("_palik").unwrap_or(metal);
            let known = spectrum::metal(metal).or_else(|| spectrum::metal(base));
            return match (metal, known) {
                // A perfect mirror.
                ("none", _) => Ok(Vec3::ONE),
                (_, Some(reflectance)) => Ok(reflectance),
                _ => Err(unknown(place, ("metal", "metals"), metal, spectrum::metals().chain(["none"]))),
            };
        }
        let report = &mut self.collector.report;
        let eta = element.color("eta", Usage::Reflectance, report)?;
        let k = element.color("k", Usage::Reflectance, report)?;
        Ok(match (eta, k) {
            (None, None) => spectrum::metal("Cu").unwrap_or(Vec3::ONE),
            (eta, k) => spectrum::conductor(eta.unwrap_or(Vec3::ZERO), k.unwrap_or(Vec3::ONE)),
        })
    }

    /// Returns a color, a number or a texture.
    pub(super) fn paint(
        &mut self,
        element: &'t Element,
        name: &str,
        default: f32,
    ) -> Result<Paint, SceneError> {
        match element.value(name, &PAINTS)? {
            None => Ok(Paint::number(default)),
            Some(value) => {
                let target = self.resolved(value)?;
                self.paint_of(target, Usage::Reflectance)
            }
        }
    }

    /// Returns the paint that an element is.
    pub(super) fn paint_of(&mut self, target: &'t Element, usage: Usage) -> Result<Paint, SceneError> {
        match target.tag.as_str() {
            "texture" => self.texture(target),
            "rgb" | "spectrum" | "float" => {
                target.as_color(usage, &mut self.collector.report).map(Paint::Plain)
            }
            tag => {
                let message = format!("expected a color or a texture, found `<{}>`", shortened(tag));
                Err(error(&codes::VALUE, &target.span, message, "no color"))
            }
        }
    }

    fn texture(&mut self, element: &'t Element) -> Result<Paint, SceneError> {
        let paint = match element.kind()? {
            "bitmap" => {
                element.ignore(&["filter_type", "format", "accel"]);
                let wrap = match element.text("wrap_mode")?.map_or("repeat", |(wrap, _)| wrap) {
                    "clamp" => Wrap::Clamp,
                    "mirror" => Wrap::Mirror,
                    _ => Wrap::Repeat,
                };
                let encoding = element.flag("raw", false)?.then_some(Encoding::Linear);
                let map = self.uv_map(element)?;
                let (file, place) = element.file()?;
                let Collector { materials, report, .. } = &mut self.collector;
                match materials.picture(file, encoding, wrap, place, report)? {
                    Some(texels) => Paint::Picture(Picture { texels, factor: Vec3::ONE, map }),
                    None => Paint::number(GREY),
                }
            }
            "checkerboard" => {
                let report = &mut self.collector.report;
                let [first, second] = [("color0", 0.4), ("color1", 0.2)].map(|(name, default)| {
                    let color = element.color(name, Usage::Reflectance, report)?;
                    Ok::<Vec3, SceneError>(color.unwrap_or(Vec3::splat(default)))
                });
                let texels = Rc::new(Texels::checkerboard([first?, second?]));
                Paint::Picture(Picture { texels, factor: Vec3::ONE, map: self.uv_map(element)? })
            }
            kind => {
                let note = format!("a texture of type `{}` is taken as grey", shortened(kind));
                self.collector.report.note(&element.span, note);
                element.children.iter().for_each(|child| child.used.set(true));
                Paint::number(GREY)
            }
        };
        element.note_unused(&mut self.collector.report);
        Ok(paint)
    }

    /// Returns the transform of texture coordinates: `to_uv`, or `uscale` and the like of older files.
    fn uv_map(&mut self, element: &Element) -> Result<UvMap, SceneError> {
        let given: DMat4 = element.transform("to_uv")?;
        if given.x_axis.y != 0.0 || given.y_axis.x != 0.0 {
            self.collector.report.note(&element.span, "the rotation of a texture is left out");
        }
        let pair = |names: [&str; 2], default: f64| -> Result<Vec2, SceneError> {
            let [u, v] = names.map(|name| element.number_or(name, default));
            Ok(Vec2::new(u? as f32, v? as f32))
        };
        let scale = Vec2::new(given.x_axis.x as f32, given.y_axis.y as f32);
        let offset = Vec2::new(given.w_axis.x as f32, given.w_axis.y as f32);
        Ok(UvMap {
            scale: scale * pair(["uscale", "vscale"], 1.0)?,
            offset: offset + pair(["uoffset", "voffset"], 0.0)?,
        })
    }
}

/// The tags of values that may vary over a surface.
const PAINTS: [&str; 5] = ["rgb", "spectrum", "float", "texture", "ref"];

/// Returns an index of refraction, by its number or by the name of a material.
fn index(element: &Element, name: &str, default: f32) -> Result<f32, SceneError> {
    let Some(found) = element.value(name, &["float", "integer", "string"])? else { return Ok(default) };
    if found.tag != "string" {
        return Ok(element.number_or(name, f64::from(default))? as f32);
    }
    let material = found.required("value")?;
    let known = INDICES.iter().find(|(known, _)| *known == material).map(|(_, index)| *index);
    known.ok_or_else(|| {
        let names = INDICES.iter().map(|(name, _)| *name);
        unknown(found.place("value"), ("index of refraction of", "materials"), material, names)
    })
}
