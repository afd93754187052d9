//! Emitters of Mitsuba. In its variants of three channels, radiance \[W/(m² sr)\], radiant intensity \[W/sr\] and irradiance
//! \[W/m²\] are those of Lightloom.

use std::rc::Rc;

use glam::{DMat3, DVec3, Vec3};

use super::Scene;
use super::tree::Element;
use super::values::Usage;
use crate::codes;
use crate::error::SceneError;
use crate::light::LightKind;
use crate::offline::collector::Light;
use crate::offline::report::{error, shortened};
use crate::offline::sky::{Form, Sky};
use crate::offline::spot::inner_cone;
use crate::offline::surface::Emission;

/// The tags of radiance.
const COLORS: [&str; 4] = ["rgb", "spectrum", "texture", "ref"];

impl<'t> Scene<'t, '_> {
    /// Returns the light of a shape; `None` if it has none.
    pub(super) fn emission_of(&mut self, shape: &'t Element) -> Result<Option<Rc<Emission>>, SceneError> {
        for child in &shape.children {
            let target = self.resolved(child)?;
            if target.tag != "emitter" {
                continue;
            }
            child.used.set(true);
            let kind = target.kind()?;
            if kind != "area" {
                let note = format!("the emitter of type `{}` of a shape is left out", shortened(kind));
                self.collector.report.note(&target.span, note);
                return Ok(None);
            }
            target.ignore(&["sampling_weight"]);
            let Some(radiance) = target.value("radiance", &COLORS)? else {
                return Err(error(
                    &codes::VALUE,
                    &target.span,
                    "the emitter has no `radiance`",
                    "this emitter",
                ));
            };
            let value = self.resolved(radiance)?;
            let radiance = self.paint_of(value, Usage::Light)?;
            target.note_unused(&mut self.collector.report);
            return Ok(Some(Rc::new(Emission { radiance, both_sides: false })));
        }
        Ok(None)
    }

    /// Adds an emitter without a shape.
    pub(super) fn emitter(&mut self, element: &'t Element) -> Result<(), SceneError> {
        let span = &element.span;
        element.ignore(&["sampling_weight"]);
        let transform = element.transform("to_world")?;
        let report = &mut self.collector.report;
        let mut color = |name: &str| -> Result<Vec3, SceneError> {
            Ok(element.color(name, Usage::Light, report)?.unwrap_or(Vec3::ONE))
        };
        let forward = transform.transform_vector3(DVec3::Z);
        let origin = transform.transform_point3(DVec3::ZERO);
        match element.kind()? {
            "constant" => {
                let radiance = color("radiance")?;
                self.collector.sky(Sky::Uniform(radiance), span);
            }
            "envmap" => {
                let (file, place) = element.file()?;
                let factor = Vec3::splat(element.number_or("scale", 1.0)? as f32);
                let (path, _) = self.collector.report.bytes(file, place)?;
                let transform = DMat3::from_mat4(transform);
                self.collector
                    .sky(Sky::Map { file: path, factor, form: Form::LongitudeLatitude, transform }, span);
            }
            "point" => {
                let intensity = color("intensity")?;
                let position = element.vector("position")?.unwrap_or(origin);
                self.add(element, LightKind::Point, [position, DVec3::Z], intensity)?;
            }
            "directional" => {
                let intensity = color("irradiance")?;
                let direction = element.vector("direction")?.unwrap_or(forward);
                self.add(element, LightKind::Directional, [origin, direction], intensity)?;
            }
            "spot" => {
                let intensity = color("intensity")?;
                let outer = element.number_or("cutoff_angle", 20.0)?;
                let inner = element.number_or("beam_width", 0.75 * outer)?;
                if !(outer > 0.0 && outer <= 90.0 && (0.0..=outer).contains(&inner)) {
                    let message = format!(
                        "`cutoff_angle` must be above 0° and at most 90°, and `beam_width` within it; found {outer} and {inner}"
                    );
                    return Err(error(&codes::RANGE, span, message, "this light"));
                }
                let (inner, outer) = (inner.to_radians(), outer.to_radians());
                let inner = inner_cone(share(inner, outer), outer.cos()).min(outer);
                let kind = LightKind::Spot { inner: inner as f32, outer: outer as f32 };
                self.add(element, kind, [origin, forward], intensity)?;
            }
            kind => {
                let note = format!("the emitter of type `{}` is left out", shortened(kind));
                self.collector.report.note(span, note);
                return Ok(());
            }
        }
        element.note_unused(&mut self.collector.report);
        Ok(())
    }

    fn add(
        &mut self,
        element: &Element,
        kind: LightKind,
        [position, direction]: [DVec3; 2],
        intensity: Vec3,
    ) -> Result<(), SceneError> {
        if !position.is_finite() || direction.try_normalize().is_none() {
            let message = "the light has no direction, or lies nowhere";
            return Err(error(&codes::RANGE, &element.span, message, "this light"));
        }
        let name = element.attribute("id").map_or(String::new(), shortened);
        self.collector.light(Light { name, kind, position, direction, intensity }, &element.span);
        Ok(())
    }
}

/// Returns the flux of a spot over 2π times its intensity: that falls linearly with the angle, from the one to the other
/// \[rad\].
fn share(inner: f64, outer: f64) -> f64 {
    // ∫ (outer − θ)/(outer − inner) sin θ dθ, from the inner angle to the outer one, is cos inner less this.
    let mean = if outer > inner { (outer.sin() - inner.sin()) / (outer - inner) } else { outer.cos() };
    1.0 - mean
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_flux_of_a_spot_is_that_of_its_falloff() {
        for (inner, outer) in [(15.0_f64, 20.0_f64), (0.0, 90.0), (29.999, 30.0), (30.0, 30.0)] {
            let (inner, outer) = (inner.to_radians(), outer.to_radians());
            let steps = 100_000;
            let sum: f64 = (0..steps)
                .map(|i| {
                    let angle = outer * (f64::from(i) + 0.5) / f64::from(steps);
                    let falloff = if angle <= inner { 1.0 } else { (outer - angle) / (outer - inner) };
                    falloff * angle.sin() * outer / f64::from(steps)
                })
                .sum();
            assert!((share(inner, outer) / sum - 1.0).abs() < 1e-4, "{inner} to {outer}: {sum}");
        }
    }
}
