//! Shapes of Mitsuba.

use glam::{DMat4, DVec3, Vec3};

use super::Scene;
use super::tree::Element;
use crate::codes;
use crate::error::SceneError;
use crate::offline::report::{error, shortened};
use crate::offline::surface::Look;
use crate::offline::triangles::Triangles;
use crate::offline::{obj, ply, shapes};

impl<'t> Scene<'t, '_> {
    /// Adds a shape to the world.
    pub(super) fn shape(&mut self, element: &'t Element) -> Result<(), SceneError> {
        match element.kind()? {
            // A group is seen where it has instances.
            "shapegroup" => Ok(()),
            "instance" => self.instance(element),
            "merge" => {
                for child in element.children.iter().filter(|child| child.tag == "shape") {
                    child.used.set(true);
                    self.shape(child)?;
                }
                element.note_unused(&mut self.collector.report);
                Ok(())
            }
            _ => match self.mesh(element)? {
                Some((mesh, transform)) => self.collector.place(mesh, &transform, &element.span),
                None => Ok(()),
            },
        }
    }

    fn instance(&mut self, element: &'t Element) -> Result<(), SceneError> {
        let transform = element.transform("to_world")?;
        let mut group = None;
        for child in &element.children {
            let target = self.resolved(child)?;
            if target.tag == "shape" {
                child.used.set(true);
                group = Some(target);
            }
        }
        let Some(group) = group else {
            return Err(error(
                &codes::VALUE,
                &element.span,
                "the instance has no group of shapes",
                "this instance",
            ));
        };
        let address = std::ptr::from_ref(group);
        if !self.groups.contains_key(&address) {
            let mut meshes = Vec::new();
            let children = group.children.iter().filter(|child| child.tag == "shape");
            for child in children {
                child.used.set(true);
                if matches!(child.kind()?, "instance" | "shapegroup" | "merge") {
                    let note = format!("a shape of type `{}` within a group is left out", child.kind()?);
                    self.collector.report.note(&child.span, note);
                    continue;
                }
                meshes.extend(self.mesh(child)?);
            }
            group.note_unused(&mut self.collector.report);
            self.groups.insert(address, meshes);
        }
        element.note_unused(&mut self.collector.report);
        for (mesh, inner) in self.groups.get(&address).into_iter().flatten() {
            self.collector.place(*mesh, &(transform * *inner), &element.span)?;
        }
        Ok(())
    }

    /// Returns a mesh and its transform; `None` if it is left out.
    fn mesh(&mut self, element: &'t Element) -> Result<Option<(usize, DMat4)>, SceneError> {
        let kind = element.kind()?;
        let mut transform = element.transform("to_world")?;
        let mut triangles = match kind {
            "rectangle" => shapes::rectangle(),
            "cube" => shapes::cube(),
            "disk" => shapes::disk(),
            "sphere" => {
                let centre = element.vector("center")?.unwrap_or(DVec3::ZERO);
                transform *= DMat4::from_translation(centre);
                shapes::sphere(positive(element, "radius")? as f32)
            }
            "cylinder" => {
                let [from, to] = [("p0", DVec3::ZERO), ("p1", DVec3::Z)]
                    .map(|(name, default)| Ok(element.vector(name)?.unwrap_or(default).as_vec3()));
                let (from, to): (Vec3, Vec3) = (from?, to.map_err(|error: SceneError| error)?);
                shapes::cylinder(from, to, positive(element, "radius")? as f32)
            }
            "obj" | "ply" => self.file(element, kind)?,
            _ => {
                let note = format!("the shape of type `{}` is left out", shortened(kind));
                self.collector.report.note(&element.span, note);
                return Ok(None);
            }
        };
        if element.flag("flip_normals", false)? {
            triangles.flip();
        }
        let emission = self.emission_of(element)?;
        let look = Look { surface: self.surface_of(element)?, emission, mask: None };
        element.note_unused(&mut self.collector.report);
        let name = element.attribute("id").map_or_else(|| kind.to_owned(), shortened);
        let mesh = self.collector.mesh(&name, triangles, &look, &element.span)?;
        Ok(mesh.map(|mesh| (mesh, transform)))
    }

    /// Reads the mesh of a file.
    fn file(&mut self, element: &'t Element, kind: &str) -> Result<Triangles, SceneError> {
        let (name, place) = element.file()?;
        let (path, bytes) = self.collector.report.bytes(name, place)?;
        let budget = self.collector.report.budget;
        let take = |count, size| budget.take(count, size);
        let read = match kind {
            "obj" => match std::str::from_utf8(&bytes) {
                Ok(text) => obj::read(text, take),
                Err(_) => Err("the text is not UTF-8".to_owned()),
            },
            _ => ply::read(&bytes, take),
        };
        let mut mesh = read.map_err(|problem| {
            error(&codes::FILE, place, format!("{}: {problem}", path.display()), "this mesh")
        })?;
        // In OBJ files v is upwards, and in those of PLY as it is in the picture, if nothing else is said.
        if element.flag("flip_tex_coords", kind == "obj")? {
            mesh.uvs.iter_mut().flatten().for_each(|uv| uv.y = 1.0 - uv.y);
        }
        if element.flag("face_normals", false)? {
            mesh.normals = None;
        } else {
            mesh.smooth();
        }
        Ok(mesh)
    }
}

fn positive(element: &Element, name: &str) -> Result<f64, SceneError> {
    let value = element.number_or(name, 1.0)?;
    match value > 0.0 {
        true => Ok(value),
        false => Err(error(&codes::RANGE, &element.span, format!("`{name}` must be above 0"), "this shape")),
    }
}
