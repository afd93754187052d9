//! Materials of pbrt.

use std::rc::Rc;

use glam::Vec3;

use super::Scene;
use super::parameters::{Parameters, Usage};
use crate::error::SceneError;
use crate::material::{Encoding, Wrap};
use crate::offline::collector::Collector;
use crate::offline::paint::{Paint, Picture, UvMap};
use crate::offline::report::{shortened, unknown};
use crate::offline::spectrum;
use crate::offline::surface::Surface;

impl Scene<'_> {
    /// Returns the surface of a material; `None` if what has it is left out.
    pub(super) fn material(
        &mut self,
        kind: &str,
        name: &str,
        parameters: &Parameters,
    ) -> Result<Option<Rc<Surface>>, SceneError> {
        let name = &shortened(name);
        parameters.ignore(&["type"]);
        let surface = match kind {
            "diffuse" => Some(Surface::diffuse(name, self.reflectance("reflectance", parameters)?)),
            "coateddiffuse" => {
                parameters.ignore(&["thickness", "albedo", "g", "maxdepth", "nsamples"]);
                let base = self.reflectance("reflectance", parameters)?;
                Some(Surface {
                    specular: self.interface("eta", parameters)?,
                    alpha: self.alpha("", parameters, 0.0)?,
                    ..Surface::diffuse(name, base)
                })
            }
            "conductor" => Some(self.conductor(name, "", parameters)?),
            "coatedconductor" => {
                let coat = [
                    "thickness",
                    "interface.eta",
                    "albedo",
                    "g",
                    "maxdepth",
                    "nsamples",
                    "interface.roughness",
                ];
                parameters.ignore(&coat);
                parameters.ignore(&["interface.uroughness", "interface.vroughness"]);
                self.collector.report.note(&parameters.span, "the coat of a conductor is left out");
                Some(self.conductor(name, "conductor.", parameters)?)
            }
            "dielectric" | "thindielectric" | "interface" | "" => {
                parameters.ignore(&["eta", "roughness", "uroughness", "vroughness", "remaproughness"]);
                if kind.ends_with("dielectric") {
                    let note = format!("material `{name}` is of glass (`{kind}`): what has it is left out");
                    self.collector.report.note(&parameters.span, note);
                }
                None
            }
            "diffusetransmission" => {
                let note = format!("material `{name}` transmits light: it is taken as opaque");
                self.collector.report.note(&parameters.span, note);
                parameters.ignore(&["transmittance", "scale"]);
                Some(Surface::diffuse(name, self.reflectance("reflectance", parameters)?))
            }
            _ => {
                let kind = shortened(kind);
                let note = format!(
                    "material `{name}` is of the type `{kind}`, which is not supported: it is taken as matte grey"
                );
                self.collector.report.note(&parameters.span, note);
                return Ok(Some(Rc::new(Surface::diffuse(name, Paint::number(0.5)))));
            }
        };
        let surface = match surface {
            None => None,
            Some(surface) => Some(Rc::new(Surface { normal: self.normal_map(parameters)?, ..surface })),
        };
        parameters.note_unused(&mut self.collector.report);
        Ok(surface)
    }

    fn reflectance(&mut self, name: &str, parameters: &Parameters) -> Result<Paint, SceneError> {
        let found = parameters.paint(name, Usage::Reflectance, &self.textures, &mut self.collector.report)?;
        Ok(found.unwrap_or(Paint::number(0.5)))
    }

    /// Returns the reflectance at normal incidence of a coat with an index of refraction; 1.5 is the default.
    fn interface(&mut self, name: &str, parameters: &Parameters) -> Result<f32, SceneError> {
        let eta = parameters.color(name, Usage::Index, &mut self.collector.report)?;
        // The mean over the visible: indices of refraction hardly vary.
        Ok(spectrum::dielectric(eta.map_or(1.5, |eta| eta.element_sum() / 3.0)))
    }

    fn conductor(
        &mut self,
        name: &str,
        prefix: &str,
        parameters: &Parameters,
    ) -> Result<Surface, SceneError> {
        let [eta, k, reflectance] = ["eta", "k", "reflectance"].map(|name| format!("{prefix}{name}"));
        let base = if parameters.has(&reflectance) {
            self.reflectance(&reflectance, parameters)?
        } else if let Some(metal) = parameters.metal(&eta) {
            parameters.ignore(&[&k]);
            match spectrum::metal(metal) {
                Some(reflectance) => Paint::Plain(reflectance),
                // Brass has no measured spectrum here.
                None if metal == "CuZn" => {
                    self.collector
                        .report
                        .note(parameters.place(&eta), "the metal `CuZn` is taken as copper, `Cu`");
                    Paint::Plain(copper())
                }
                None => {
                    return Err(unknown(
                        parameters.place(&eta),
                        ("metal", "metals"),
                        metal,
                        spectrum::metals(),
                    ));
                }
            }
        } else if parameters.has(&eta) || parameters.has(&k) {
            let eta = parameters.color(&eta, Usage::Index, &mut self.collector.report)?;
            let k = parameters.color(&k, Usage::Index, &mut self.collector.report)?;
            Paint::Plain(spectrum::conductor(eta.unwrap_or(Vec3::ONE), k.unwrap_or(Vec3::ZERO)))
        } else {
            Paint::Plain(copper())
        };
        let alpha = self.alpha(prefix, parameters, 0.0)?;
        Ok(Surface { is_metal: true, alpha, ..Surface::diffuse(name, base) })
    }

    /// Returns the width of the microfacet distribution: pbrt takes the square root of the roughness, unless the material says
    /// that it is the width itself.
    fn alpha(&mut self, prefix: &str, parameters: &Parameters, default: f32) -> Result<Paint, SceneError> {
        let remapped = !parameters.has("remaproughness") || parameters.flag("remaproughness")?;
        let names = ["roughness", "uroughness", "vroughness"].map(|name| format!("{prefix}{name}"));
        let mut values = Vec::new();
        for name in &names {
            values.push(parameters.shade(name, &self.textures)?);
        }
        let [both, u, v] = [0, 1, 2].map(|i| values[i].clone());
        let value = match (u, v) {
            (Some(Paint::Plain(u)), Some(Paint::Plain(v))) => {
                if u != v {
                    let note = "roughness that differs along u and v is taken as its mean";
                    self.collector.report.note(parameters.place(&names[1]), note);
                }
                Some(Paint::Plain((u + v) * 0.5))
            }
            (Some(either), _) | (None, Some(either)) => Some(either),
            (None, None) => both,
        };
        let value = value.unwrap_or(Paint::number(default));
        Ok(if remapped { value.mapped(|roughness| roughness.max(0.0).sqrt()) } else { value })
    }

    fn normal_map(&mut self, parameters: &Parameters) -> Result<Option<Picture>, SceneError> {
        let Some(file) = parameters.text("normalmap")?.map(str::to_owned) else { return Ok(None) };
        let place = parameters.place("normalmap").clone();
        let Collector { materials, report, .. } = &mut self.collector;
        let texels = materials.picture(&file, Some(Encoding::Linear), Wrap::Repeat, &place, report)?;
        let map = UvMap::UPWARDS;
        Ok(texels.map(|texels| Picture { texels, factor: Vec3::ONE, map }))
    }
}

/// The metal of conductors that name none.
fn copper() -> Vec3 {
    spectrum::metal("Cu").unwrap_or(Vec3::ONE)
}
