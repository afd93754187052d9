//! Lights of pbrt.
//!
//! A light's `rgb` is what a film of pbrt records of it: radiance \[W/(m² sr)\], radiant intensity \[W/sr\] or irradiance
//! \[W/m²\] for each channel here. Other spectra are scaled to a luminance of 1. `scale` multiplies both; `power` and
//! `illuminance` replace the level.

use std::f64::consts::PI;
use std::rc::Rc;

use glam::{DMat3, DVec3, Vec3};

use super::Scene;
use super::parameters::{Parameters, Usage};
use crate::codes;
use crate::error::SceneError;
use crate::light::LightKind;
use crate::material::Wrap;
use crate::offline::collector::{Collector, Light};
use crate::offline::paint::{Paint, Picture, UvMap};
use crate::offline::report::{error, shortened};
use crate::offline::sky::{Form, Sky};
use crate::offline::spot::inner_cone;
use crate::offline::surface::Emission;

/// An area light, before it has a shape.
pub(super) struct AreaLight {
    emission: Rc<Emission>,
    /// The power of each shape \[W\], which replaces the level of the radiance.
    power: Option<f64>,
}

impl AreaLight {
    /// Returns the light of so many shapes with an area \[m²\] together.
    pub(super) fn emission(&self, shapes: usize, area: f64) -> Rc<Emission> {
        let Some(power) = self.power else { return Rc::clone(&self.emission) };
        let sides = if self.emission.both_sides { 2.0 } else { 1.0 };
        let factor = power * shapes as f64 / (PI * sides * area);
        let factor = if factor.is_finite() { factor as f32 } else { 0.0 };
        Rc::new(Emission { radiance: self.emission.radiance.times(Vec3::splat(factor)), ..*self.emission })
    }

    /// Returns whether the light depends on the area of its shape.
    pub(super) fn depends_on_area(&self) -> bool {
        self.power.is_some()
    }
}

impl Scene<'_> {
    /// Returns the light of an `AreaLightSource`.
    pub(super) fn area_light(
        &mut self,
        kind: &str,
        parameters: &Parameters,
    ) -> Result<Option<Rc<AreaLight>>, SceneError> {
        if kind != "diffuse" {
            let note = format!("the area light of type `{}` is left out", shortened(kind));
            self.collector.report.note(&parameters.span, note);
            return Ok(None);
        }
        let scale = self.level(parameters)?;
        let radiance = match parameters.text("filename")?.map(str::to_owned) {
            None => Paint::Plain(self.light_color("L", parameters)? * scale),
            Some(file) => {
                let place = parameters.place("filename").clone();
                let Collector { materials, report, .. } = &mut self.collector;
                let texels = materials.picture(&file, None, Wrap::Clamp, &place, report)?;
                let factor = Vec3::splat(scale);
                match texels {
                    None => Paint::Plain(factor),
                    Some(texels) => Paint::Picture(Picture { texels, factor, map: UvMap::UPWARDS }),
                }
            }
        };
        let both_sides = parameters.flag("twosided")?;
        let power = parameters.number("power")?.filter(|power| *power > 0.0);
        parameters.note_unused(&mut self.collector.report);
        Ok(Some(Rc::new(AreaLight { emission: Rc::new(Emission { radiance, both_sides }), power })))
    }

    /// Adds the light of a `LightSource`.
    pub(super) fn light_source(&mut self, kind: &str, parameters: &Parameters) -> Result<(), SceneError> {
        match kind {
            "distant" => {
                let [from, to] = self.ends(parameters)?;
                let level = parameters.number("illuminance")?.filter(|level| *level > 0.0).unwrap_or(1.0);
                let intensity = self.light_color("L", parameters)? * self.level(parameters)? * level as f32;
                self.add(LightKind::Directional, [from, to], intensity, parameters)?;
            }
            "point" => {
                let [from, _] = self.ends(parameters)?;
                let level = self.power(parameters, 4.0 * PI)?;
                let intensity = self.light_color("I", parameters)? * self.level(parameters)? * level;
                self.add(LightKind::Point, [from, from + DVec3::Z], intensity, parameters)?;
            }
            "spot" => {
                let ends = self.ends(parameters)?;
                let angle = parameters.number_or("coneangle", 30.0)?;
                let delta = parameters.number_or("conedeltaangle", 5.0)?;
                let [start, end] = [angle - delta, angle].map(|degrees| degrees.to_radians().cos());
                if !(angle > 0.0 && angle <= 90.0 && (0.0..=angle).contains(&delta)) {
                    let message = format!(
                        "`coneangle` must be above 0° and at most 90°, and `conedeltaangle` within it; found {angle} and {delta}"
                    );
                    return Err(error(&codes::RANGE, parameters.place("coneangle"), message, "this cone"));
                }
                // Between the cones the intensity is a smooth step, whose mean over the cosine is a half.
                let share = (1.0 - start) + 0.5 * (start - end);
                let level = self.power(parameters, 2.0 * PI * share)?;
                let intensity = self.light_color("I", parameters)? * self.level(parameters)? * level;
                let inner = inner_cone(share, end) as f32;
                let outer = angle.to_radians() as f32;
                self.add(LightKind::Spot { inner: inner.min(outer), outer }, ends, intensity, parameters)?;
            }
            "infinite" => self.infinite(parameters)?,
            _ => {
                let note = format!("the light of type `{}` is left out", shortened(kind));
                self.collector.report.note(&parameters.span, note);
                return Ok(());
            }
        }
        parameters.note_unused(&mut self.collector.report);
        Ok(())
    }

    /// Returns the color of a light; white if it has none.
    fn light_color(&mut self, name: &str, parameters: &Parameters) -> Result<Vec3, SceneError> {
        Ok(parameters.color(name, Usage::Light, &mut self.collector.report)?.unwrap_or(Vec3::ONE))
    }

    fn level(&self, parameters: &Parameters) -> Result<f32, SceneError> {
        Ok(parameters.number_or("scale", 1.0)? as f32)
    }

    /// Returns the factor that gives a light of intensity 1 its power \[W\]; 1 if none is given.
    fn power(&self, parameters: &Parameters, solid_angle: f64) -> Result<f32, SceneError> {
        let power = parameters.number("power")?.filter(|power| *power > 0.0);
        Ok(power.map_or(1.0, |power| power / solid_angle) as f32)
    }

    fn ends(&self, parameters: &Parameters) -> Result<[DVec3; 2], SceneError> {
        let types = ["point3", "point"];
        let from = parameters.vector("from", &types)?.unwrap_or(DVec3::ZERO);
        let to = parameters.vector("to", &types)?.unwrap_or(DVec3::Z);
        Ok([from, to])
    }

    fn add(
        &mut self,
        kind: LightKind,
        ends: [DVec3; 2],
        intensity: Vec3,
        parameters: &Parameters,
    ) -> Result<(), SceneError> {
        let [position, to] = ends.map(|end| self.state.transform.transform_point3(end));
        let direction = to - position;
        if !position.is_finite() || direction.try_normalize().is_none() {
            let message = "the light has no direction, or lies nowhere: `from` and `to` must be two points";
            return Err(error(&codes::RANGE, &parameters.span, message, "this light"));
        }
        let light = Light { name: String::new(), kind, position, direction, intensity };
        self.collector.light(light, &parameters.span);
        Ok(())
    }

    fn infinite(&mut self, parameters: &Parameters) -> Result<(), SceneError> {
        let span = &parameters.span;
        let scale = self.level(parameters)?;
        let sky = match parameters.text("filename")? {
            None => {
                let level = parameters.number("illuminance")?.filter(|level| *level > 0.0);
                let level = level.map_or(1.0, |level| level / PI) as f32;
                Sky::Uniform(self.light_color("L", parameters)? * scale * level)
            }
            Some(file) => {
                let place = parameters.place("filename");
                let (path, _) = self.collector.report.bytes(file, place)?;
                let transform = DMat3::from_mat4(self.state.transform);
                Sky::Map { file: path, factor: Vec3::splat(scale), form: Form::EqualArea, transform }
            }
        };
        self.collector.sky(sky, span);
        Ok(())
    }
}
