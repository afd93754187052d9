//! Shapes of pbrt.

use glam::{DMat4, DVec3, Vec2, Vec3};

use super::Scene;
use super::parameters::Parameters;
use crate::codes;
use crate::error::SceneError;
use crate::offline::paint::Paint;
use crate::offline::report::{error, shortened};
use crate::offline::surface::Look;
use crate::offline::triangles::Triangles;
use crate::offline::{ply, shapes};

impl Scene<'_> {
    /// Adds a shape to the world, or to the object that is open.
    pub(super) fn shape(&mut self, kind: &str, parameters: &Parameters) -> Result<(), SceneError> {
        let span = &parameters.span;
        let mut transform = self.state.transform;
        let made = match kind {
            "trianglemesh" => Some(self.triangle_mesh(parameters)?),
            "plymesh" => Some(self.ply_mesh(parameters)?),
            "bilinearmesh" => Some(self.bilinear_mesh(parameters)?),
            "sphere" => {
                let radius = positive("radius", parameters)?;
                self.whole(&["zmin", "zmax", "phimax"], parameters);
                let mut sphere = shapes::sphere(radius as f32);
                // v is from the lower pole to the upper one.
                sphere.uvs.iter_mut().flatten().for_each(|uv| uv.y = 1.0 - uv.y);
                Some(sphere)
            }
            "disk" => {
                let radius = positive("radius", parameters)?;
                let height = parameters.number_or("height", 0.0)?;
                self.whole(&["innerradius", "phimax"], parameters);
                transform *=
                    DMat4::from_translation(DVec3::Z * height) * DMat4::from_scale(DVec3::splat(radius));
                let mut disk = shapes::disk();
                // u is around, and v from the rim to the middle.
                disk.uvs.iter_mut().flatten().for_each(|uv| *uv = Vec2::new(uv.y, 1.0 - uv.x));
                Some(disk)
            }
            "cylinder" => {
                let radius = positive("radius", parameters)? as f32;
                let [low, high] =
                    [("zmin", -1.0), ("zmax", 1.0)].map(|(name, z)| parameters.number_or(name, z));
                self.whole(&["phimax"], parameters);
                Some(shapes::cylinder(Vec3::Z * low? as f32, Vec3::Z * high? as f32, radius))
            }
            _ => {
                let kind = shortened(kind);
                self.collector.report.note(span, format!("the shape of type `{kind}` is left out"));
                None
            }
        };
        let Some(mut triangles) = made else { return Ok(()) };
        if self.state.reversed {
            triangles.flip();
        }
        let mask = parameters.shade("alpha", &self.textures)?;
        let mask = mask.filter(|mask| !matches!(mask, Paint::Plain(share) if share.x == 1.0));
        parameters.note_unused(&mut self.collector.report);
        let light = self.state.area_light.clone().filter(|_| {
            let in_object = self.object.is_some();
            if in_object {
                self.collector
                    .report
                    .note(span, "the area light of a shape of an object is left out, as pbrt does");
            }
            !in_object
        });
        let emission = light.map(|light| match light.depends_on_area() {
            // In pbrt, each triangle is a shape.
            true if !matches!(kind, "trianglemesh" | "plymesh") => {
                light.emission(1, triangles.area(&transform))
            }
            true => light.emission(triangles.indices.len() / 3, triangles.area(&transform)),
            false => light.emission(1, 1.0),
        });
        let look = Look { surface: self.state.surface.clone(), emission, mask };
        let Some(mesh) = self.collector.mesh(kind, triangles, &look, span)? else { return Ok(()) };
        match &mut self.object {
            Some((_, shapes)) => {
                shapes.push((mesh, transform));
                Ok(())
            }
            None => self.collector.place(mesh, &transform, span),
        }
    }

    /// Notes that only a part of a round shape is asked for, which is not cut.
    fn whole(&mut self, names: &[&str], parameters: &Parameters) {
        if let Some(name) = names.iter().find(|name| parameters.has(name)) {
            let note = format!("the shape is not cut by `{name}`: all of it is there");
            self.collector.report.note(parameters.place(name), note);
        }
        parameters.ignore(names);
    }

    fn triangle_mesh(&mut self, parameters: &Parameters) -> Result<Triangles, SceneError> {
        let mut mesh = lists(parameters)?;
        let count = mesh.positions.len();
        mesh.indices = match indices(parameters, count, 3)? {
            Some(indices) => indices,
            None if count == 3 => vec![0, 1, 2],
            None => {
                let message = "a mesh of more than one triangle has `integer indices`";
                return Err(error(&codes::VALUE, &parameters.span, message, "this mesh"));
            }
        };
        mesh.follow_normals();
        Ok(mesh)
    }

    /// Returns bilinear patches as two triangles each: those that are no parallelograms bend along a diagonal.
    fn bilinear_mesh(&mut self, parameters: &Parameters) -> Result<Triangles, SceneError> {
        let mut mesh = lists(parameters)?;
        let count = mesh.positions.len();
        let patches = match indices(parameters, count, 4)? {
            Some(indices) => indices,
            None if count == 4 => vec![0, 1, 2, 3],
            None => {
                let message = "a mesh of more than one patch has `integer indices`";
                return Err(error(&codes::VALUE, &parameters.span, message, "this mesh"));
            }
        };
        // The corners are (0, 0), (1, 0), (0, 1), (1, 1).
        mesh.indices = patches.chunks_exact(4).flat_map(|c| [c[0], c[1], c[3], c[0], c[3], c[2]]).collect();
        mesh.follow_normals();
        Ok(mesh)
    }

    fn ply_mesh(&mut self, parameters: &Parameters) -> Result<Triangles, SceneError> {
        let Some(file) = parameters.text("filename")?.map(str::to_owned) else {
            return Err(error(
                &codes::VALUE,
                &parameters.span,
                "the mesh has no `string filename`",
                "this mesh",
            ));
        };
        parameters.ignore(&["edgelength"]);
        if parameters.has("displacement") {
            self.collector
                .report
                .note(parameters.place("displacement"), "displacement of a mesh is left out");
            parameters.shade("displacement", &self.textures)?;
        }
        let place = parameters.place("filename").clone();
        let (path, bytes) = self.collector.report.bytes(&file, &place)?;
        let budget = self.collector.report.budget;
        let mut mesh = ply::read(&bytes, |count, size| budget.take(count, size)).map_err(|problem| {
            error(&codes::FILE, &place, format!("{}: {problem}", path.display()), "this mesh")
        })?;
        mesh.follow_normals();
        Ok(mesh)
    }
}

fn positive(name: &str, parameters: &Parameters) -> Result<f64, SceneError> {
    let value = parameters.number_or(name, 1.0)?;
    match value > 0.0 {
        true => Ok(value),
        false => Err(error(
            &codes::RANGE,
            parameters.place(name),
            format!("`{name}` must be above 0"),
            "not above 0",
        )),
    }
}

/// Returns the lists of vertices.
fn lists(parameters: &Parameters) -> Result<Triangles, SceneError> {
    let vectors = |list: Vec<[f32; 3]>| list.into_iter().map(Vec3::from).collect::<Vec<Vec3>>();
    let Some(positions) = parameters.vectors::<3>("P", &["point3", "point"])?.map(vectors) else {
        return Err(error(&codes::VALUE, &parameters.span, "the mesh has no `point3 P`", "this mesh"));
    };
    let count = positions.len();
    let as_many = |name: &str, found: usize| match found == count {
        true => Ok(()),
        false => {
            let message = format!("the mesh has {count} positions, and {found} values of `{name}`");
            Err(error(&codes::VALUE, parameters.place(name), message, "another number of values"))
        }
    };
    let normals = parameters.vectors::<3>("N", &["normal3", "normal"])?.map(vectors);
    as_many("N", normals.as_ref().map_or(count, Vec::len))?;
    let uvs = parameters.vectors::<2>("uv", &["point2", "vector2"])?;
    as_many("uv", uvs.as_ref().map_or(count, Vec::len))?;
    let uvs = uvs.map(|uvs| uvs.into_iter().map(Vec2::from).collect());
    // Tangents, and numbers of faces for textures of another format.
    parameters.ignore(&["S", "faceIndices"]);
    Ok(Triangles { positions, normals, uvs, indices: Vec::new() })
}

/// Returns the indices of faces with so many corners, each below the count of vertices.
fn indices(parameters: &Parameters, count: usize, corners: usize) -> Result<Option<Vec<u32>>, SceneError> {
    let Some(numbers) = parameters.numbers("indices", "integer")? else { return Ok(None) };
    let place = parameters.place("indices");
    if !numbers.len().is_multiple_of(corners) {
        let message = format!("each face has {corners} indices; found {} in all", numbers.len());
        return Err(error(&codes::VALUE, place, message, "another number of values"));
    }
    match numbers.iter().find(|number| !(**number >= 0.0 && **number < count as f64 && number.fract() == 0.0))
    {
        Some(number) => {
            let message = format!("expected indices of the {count} vertices, found {number}");
            Err(error(&codes::VALUE, place, message, "an index beyond them"))
        }
        None => Ok(Some(numbers.iter().map(|number| *number as u32).collect())),
    }
}
