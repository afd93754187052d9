//! Reads scenes of Mitsuba 3 in XML, and those of 0.x as far as their names alone differ.
//!
//! What concerns how Mitsuba renders (integrators, samplers, the film but for its shape, reconstruction filters) is skipped.

mod emitters;
mod shapes;
mod surfaces;
mod tree;
mod values;

use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

use data_file::Source;
use glam::DMat4;

use super::collector::{Camera, Collector};
use super::report::{error, shortened, unknown};
use super::surface::Surface;
use crate::codes;
use crate::error::SceneError;
use tree::Element;

/// Half the diagonal of a frame of 35 mm film \[mm\], by which `focal_length` is stated.
const HALF_DIAGONAL: f64 = 21.633_307_652_8;

/// A scene that is being read. Elements are known by their addresses.
struct Scene<'t, 'a> {
    collector: Collector<'a>,
    ids: BTreeMap<&'t str, &'t Element>,
    surfaces: BTreeMap<*const Element, Option<Rc<Surface>>>,
    /// The meshes of shape groups, and their transforms.
    groups: BTreeMap<*const Element, Vec<(usize, DMat4)>>,
}

/// Reads a scene into a collector.
pub(super) fn read<'a>(
    source: Arc<Source>,
    mut collector: Collector<'a>,
) -> Result<Collector<'a>, SceneError> {
    let root = tree::read(source, &mut collector.report)?;
    let mut scene =
        Scene { collector, ids: BTreeMap::new(), surfaces: BTreeMap::new(), groups: BTreeMap::new() };
    scene.learn(&root)?;
    for element in &root.children {
        scene.element(element)?;
    }
    Ok(scene.collector)
}

impl<'t> Scene<'t, '_> {
    /// Learns the ids of all elements.
    fn learn(&mut self, element: &'t Element) -> Result<(), SceneError> {
        for child in &element.children {
            if child.tag == "alias" {
                let (id, name) = (child.required("id")?, child.required("as")?);
                let known = self.ids.get(id).copied();
                let target = known.ok_or_else(|| self.not_known(child, id))?;
                self.ids.insert(name, target);
            } else if child.tag != "ref"
                && let Some(id) = child.attribute("id")
            {
                self.ids.insert(id, child);
            }
            self.learn(child)?;
        }
        Ok(())
    }

    fn not_known(&self, element: &Element, id: &str) -> SceneError {
        unknown(element.place("id"), ("element with the id", "ids"), id, self.ids.keys().copied())
    }

    /// Returns an element, or that which it refers to.
    fn resolved(&self, element: &'t Element) -> Result<&'t Element, SceneError> {
        if element.tag != "ref" {
            return Ok(element);
        }
        let id = element.required("id")?;
        self.ids.get(id).copied().ok_or_else(|| self.not_known(element, id))
    }

    /// Reads an element of the scene.
    fn element(&mut self, element: &'t Element) -> Result<(), SceneError> {
        match element.tag.as_str() {
            // Materials and textures are read where they are used.
            "integrator" | "bsdf" | "texture" | "alias" | "sampler" | "rfilter" => Ok(()),
            "sensor" => self.sensor(element),
            "emitter" => self.emitter(element),
            "shape" => self.shape(element),
            tag => {
                let note = format!("the element `<{}>` is not supported: it is left out", shortened(tag));
                self.collector.report.note(&element.span, note);
                Ok(())
            }
        }
    }

    fn sensor(&mut self, element: &'t Element) -> Result<(), SceneError> {
        let span = &element.span;
        match element.kind()? {
            "perspective" => {}
            "thinlens" => {
                element.ignore(&["aperture_radius", "focus_distance"]);
                self.collector.report.note(span, "the lens is left out: all is in focus");
            }
            kind => {
                let note =
                    format!("the sensor of type `{}` is left out: it is no pinhole camera", shortened(kind));
                self.collector.report.note(span, note);
                return Ok(());
            }
        }
        let transform = element.transform("to_world")?;
        let mut size = [768.0, 576.0];
        for film in element.children.iter().filter(|child| child.tag == "film") {
            size = [film.number_or("width", size[0])?, film.number_or("height", size[1])?];
        }
        let is_apart = |child: &&Element| matches!(child.tag.as_str(), "film" | "sampler");
        element.children.iter().filter(is_apart).for_each(|child| child.used.set(true));
        if size.iter().any(|side| *side < 1.0) {
            return Err(error(&codes::VALUE, span, "a film has a pixel at least each way", "this sensor"));
        }
        let half_tangent = match element.number("fov")? {
            Some(fov) => {
                let axis = element.text("fov_axis")?.map_or("x", |(axis, _)| axis);
                let Some(side) = side_of(axis, size) else {
                    let known = ["x", "y", "diagonal", "smaller", "larger"];
                    return Err(unknown(span, ("axis", "axes"), axis, known));
                };
                (0.5 * fov.to_radians()).tan() * size[1] / side
            }
            None => {
                let length = element.text("focal_length")?.map_or("50mm", |(length, _)| length);
                let millimetres: Option<f64> = length.trim().trim_end_matches("mm").trim().parse().ok();
                let millimetres = millimetres.filter(|length| length.is_finite() && *length > 0.0);
                let millimetres = millimetres.ok_or_else(|| {
                    error(&codes::VALUE, span, "expected a focal length such as `50mm`", "this sensor")
                })?;
                HALF_DIAGONAL / millimetres * size[1] / size[0].hypot(size[1])
            }
        };
        let vertical_fov = 2.0 * half_tangent.atan();
        if !(vertical_fov > 0.0 && half_tangent.is_finite()) {
            return Err(error(&codes::RANGE, span, "`fov` must be between 0° and 180°", "this sensor"));
        }
        let near = element.number_or("near_clip", 0.01)? as f32;
        element.ignore(&["far_clip", "shutter_open", "shutter_close", "srf"]);
        element.note_unused(&mut self.collector.report);
        let name = element.attribute("id").map_or("camera".to_owned(), shortened);
        let near = if near > 0.0 && near.is_finite() { near } else { 0.0 };
        let camera = Camera { name, transform, x_is_right: false, vertical_fov, near };
        self.collector.camera(camera, span)
    }
}

/// Returns the length of the axis of a film along which the field of view is stated, in pixels.
fn side_of(axis: &str, [width, height]: [f64; 2]) -> Option<f64> {
    match axis {
        "x" => Some(width),
        "y" => Some(height),
        "diagonal" => Some(width.hypot(height)),
        "smaller" => Some(width.min(height)),
        "larger" => Some(width.max(height)),
        _ => None,
    }
}
