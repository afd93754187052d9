//! Collects what a scene of an offline renderer holds, in the world of its file, and turns it into a model.
//!
//! The world of Lightloom is right-handed. Where the camera of a file shows a left-handed one, as those of pbrt do, or a
//! mirrored one, everything is mirrored at z = 0, so that the picture is that of the file.

use std::collections::BTreeMap;

use data_file::Span;
use glam::{Affine3A, DAffine3, DMat4, DVec3, Vec2, Vec3};

use super::report::{Report, error};
use super::sky::Sky;
use super::surface::{Look, Materials};
use super::triangles::Triangles;
use crate::codes;
use crate::error::SceneError;
use crate::import::meshes::{flat, smooth_normals};
use crate::light::{BRIGHTEST, LightKind};
use crate::material::Material;
use crate::model::{Mesh, Model, Node, NodeCamera, NodeLight, Primitive};

/// The distance of the black back of a surface that emits on one side: in extents of the scene, and in extents of the
/// surface. Rays begin up to 2⁻¹² extents of the scene off a surface.
const BACK: [f64; 2] = [5e-4, 1e-3];

/// A scene in the making.
pub(super) struct Collector<'a> {
    pub(super) report: Report<'a>,
    pub(super) materials: Materials,
    meshes: Vec<Mesh>,
    /// The box of each mesh.
    boxes: Vec<Option<(DVec3, DVec3)>>,
    /// Positions and indices of the meshes that emit on one side.
    one_sided: BTreeMap<usize, (Vec<Vec3>, Vec<u32>)>,
    placed: Vec<Placed>,
    cameras: Vec<Camera>,
    lights: Vec<Light>,
    /// The light from infinitely far, and where it is stated.
    sky: Option<(Sky, Span)>,
    /// Whether the world is mirrored.
    mirrored: bool,
}

/// A mesh in the world of the file.
struct Placed {
    name: String,
    mesh: usize,
    transform: DAffine3,
}

/// A camera of a file.
pub(super) struct Camera {
    pub(super) name: String,
    /// To the world of the file: the camera looks along +z, with +y up.
    pub(super) transform: DMat4,
    /// Whether +x is to the right in the picture; otherwise it is to the left.
    pub(super) x_is_right: bool,
    /// The whole vertical field of view \[rad\].
    pub(super) vertical_fov: f64,
    /// Distance of the near plane; 0 leaves it to be derived from the extent.
    pub(super) near: f32,
}

/// A light without extent in the world of the file.
pub(super) struct Light {
    pub(super) name: String,
    pub(super) kind: LightKind,
    pub(super) position: DVec3,
    /// The direction in which the light travels; of any length.
    pub(super) direction: DVec3,
    /// As that of [`Light`](crate::Light).
    pub(super) intensity: Vec3,
}

impl<'a> Collector<'a> {
    /// Creates a collector. Without a camera, its world is mirrored if `left_handed` is set.
    pub(super) fn new(report: Report<'a>, left_handed: bool) -> Collector<'a> {
        Collector {
            report,
            materials: Materials::default(),
            meshes: Vec::new(),
            boxes: Vec::new(),
            one_sided: BTreeMap::new(),
            placed: Vec::new(),
            cameras: Vec::new(),
            lights: Vec::new(),
            sky: None,
            mirrored: left_handed,
        }
    }

    /// Adds a mesh; `None` if nothing of it is there.
    pub(super) fn mesh(
        &mut self,
        name: &str,
        triangles: Triangles,
        look: &Look,
        span: &Span,
    ) -> Result<Option<usize>, SceneError> {
        let Some(material) = self.materials.material(look, span, &mut self.report)? else { return Ok(None) };
        let corners = triangles.positions.len().max(triangles.indices.len());
        self.report.take(corners, 2 * size_of::<crate::Vertex>(), span)?;
        let map = self.materials.maps[material as usize];
        let count = triangles.positions.len();
        self.boxes.push(triangles.bounds());
        if look.emission.as_ref().is_some_and(|emission| !emission.both_sides) && !triangles.is_closed() {
            self.one_sided
                .insert(self.meshes.len(), (triangles.positions.clone(), triangles.indices.clone()));
        }
        let uvs = triangles.uvs.unwrap_or_else(|| vec![Vec2::ZERO; count]);
        let primitive = Primitive {
            positions: triangles.positions,
            uvs: uvs.into_iter().map(|uv| map.apply(uv)).collect(),
            indices: triangles.indices,
            material,
            ..Primitive::default()
        };
        let primitive = match triangles.normals {
            None => flat(&primitive),
            Some(mut normals) => {
                let mut smooth = None;
                for (i, normal) in normals.iter_mut().enumerate() {
                    *normal = normal.try_normalize().unwrap_or_else(|| {
                        smooth.get_or_insert_with(|| smooth_normals(&primitive.positions, &primitive.indices))
                            [i]
                    });
                }
                Primitive { normals, ..primitive }
            }
        };
        self.meshes.push(Mesh { name: name.to_owned(), primitives: vec![primitive] });
        Ok(Some(self.meshes.len() - 1))
    }

    /// Places a mesh in the world of the file.
    pub(super) fn place(&mut self, mesh: usize, transform: &DMat4, span: &Span) -> Result<(), SceneError> {
        let transform = affine(transform, span)?;
        self.report.take(1, size_of::<Node>(), span)?;
        let name = self.meshes[mesh].name.clone();
        self.placed.push(Placed { name, mesh, transform });
        Ok(())
    }

    /// Adds a camera. The first is that of the scene, and decides whether the world is mirrored.
    pub(super) fn camera(&mut self, camera: Camera, span: &Span) -> Result<(), SceneError> {
        let transform = affine(&camera.transform, span)?;
        let mirrored = camera.x_is_right == (transform.matrix3.determinant() > 0.0);
        if self.cameras.is_empty() {
            self.mirrored = mirrored;
        } else if self.mirrored != mirrored {
            let note = "the camera is left out: its picture is mirrored, and that of the first camera is not";
            self.report.note(span, note);
            return Ok(());
        }
        self.cameras.push(camera);
        Ok(())
    }

    /// Adds a light; its intensity is clamped to what lights may send.
    pub(super) fn light(&mut self, light: Light, span: &Span) {
        let intensity = light.intensity.clamp(Vec3::ZERO, Vec3::splat(BRIGHTEST));
        if intensity != light.intensity {
            self.report.note(span, "the intensity is not within 0 to 10³⁰ and is taken as the nearer");
        }
        self.lights.push(Light { intensity, ..light });
    }

    /// Sets the light from infinitely far; a second one is left out.
    pub(super) fn sky(&mut self, sky: Sky, span: &Span) {
        match &self.sky {
            Some(_) => self.report.note(span, "it is left out: there is an environment already"),
            None => self.sky = Some((sky, span.clone())),
        }
    }

    /// Returns the box around all placed meshes.
    fn bounds(&self) -> (DVec3, DVec3) {
        let boxes = self.placed.iter().filter_map(|placed| {
            let (min, max) = self.boxes[placed.mesh]?;
            Some(transformed((min, max), &placed.transform))
        });
        boxes.reduce(|(min, max), (a, b)| (min.min(a), max.max(b))).unwrap_or_default()
    }

    /// Adds the black backs of surfaces that emit on one side: the surfaces of a scene emit on both.
    fn backs(&mut self, span: &Span) -> Result<(), SceneError> {
        if self.one_sided.is_empty() {
            return Ok(());
        }
        let (min, max) = self.bounds();
        let extent = (max - min).length();
        let mut material = None;
        let mut backs = Vec::new();
        for placed in &self.placed {
            let Some((positions, indices)) = self.one_sided.get(&placed.mesh) else { continue };
            let (low, high) = transformed(self.boxes[placed.mesh].unwrap_or_default(), &placed.transform);
            let distance = (BACK[0] * extent).max(BACK[1] * (high - low).length());
            let normal_matrix = placed.transform.matrix3.inverse().transpose();
            // A flat transform has no inverse, and its surface no front.
            if !normal_matrix.is_finite() {
                continue;
            }
            self.report.take(positions.len(), 2 * size_of::<crate::Vertex>(), span)?;
            let normals = smooth_normals(positions, indices);
            let at = |(position, normal): (&Vec3, &Vec3)| {
                let outwards = (normal_matrix * normal.as_dvec3()).normalize_or_zero();
                (placed.transform.transform_point3(position.as_dvec3()) - outwards * distance).as_vec3()
            };
            let material = *material.get_or_insert_with(|| {
                self.materials
                    .plain(Material { specular: Vec3::ZERO, ..Material::matte("back of a light", [0.0; 3]) })
            });
            let primitive = Primitive {
                positions: positions.iter().zip(&normals).map(at).collect(),
                uvs: vec![Vec2::ZERO; positions.len()],
                indices: indices.clone(),
                material,
                ..Primitive::default()
            };
            backs.push((format!("back of {}", placed.name), flat(&primitive)));
        }
        for (name, primitive) in backs {
            self.placed.push(Placed {
                name: name.clone(),
                mesh: self.meshes.len(),
                transform: DAffine3::IDENTITY,
            });
            self.boxes.push(None);
            self.meshes.push(Mesh { name, primitives: vec![primitive] });
        }
        Ok(())
    }

    /// Returns the model, without its files. `span` is that of the whole scene.
    pub(super) fn finish(mut self, span: &Span) -> Result<(Model, Report<'a>), SceneError> {
        self.backs(span)?;
        let mirror = DVec3::new(1.0, 1.0, if self.mirrored { -1.0 } else { 1.0 });
        let to_scene = DAffine3::from_scale(mirror);
        let node = |name: String, mesh, transform: &DAffine3| {
            let DAffine3 { matrix3, translation } = to_scene * *transform;
            let rest = Affine3A::from_mat3_translation(matrix3.as_mat3(), translation.as_vec3());
            Node { name, rest, mesh, ..Node::default() }
        };
        let mut nodes: Vec<Node> = self
            .placed
            .into_iter()
            .map(|placed| node(placed.name, Some(placed.mesh), &placed.transform))
            .collect();
        let (mut cameras, mut lights) = (Vec::new(), Vec::new());
        for camera in self.cameras {
            let transform = DAffine3::from_mat4(camera.transform);
            let [forward, up] = [transform.matrix3.z_axis, transform.matrix3.y_axis];
            let looking = looking(transform.translation, forward, up);
            cameras.push(NodeCamera {
                name: camera.name.clone(),
                node: nodes.len(),
                vertical_fov: camera.vertical_fov as f32,
                near: camera.near,
            });
            nodes.push(node(camera.name, None, &looking));
        }
        for Light { name, kind, position, direction, intensity } in self.lights {
            lights.push(NodeLight { name: name.clone(), node: nodes.len(), kind, intensity });
            nodes.push(node(name, None, &looking(position, direction, direction.any_orthogonal_vector())));
        }
        if let Some(problem) = nodes.iter().find(|node| !node.rest.is_finite()) {
            let message = format!("the transform of `{}` is not finite in 32 bits", problem.name);
            return Err(error(&codes::RANGE, span, message, "this scene"));
        }
        let environment = match &self.sky {
            None => None,
            Some((sky, span)) => Some(sky.environment(mirror, span, &mut self.report)?),
        };
        let model = Model {
            materials: self.materials.materials,
            textures: self.materials.textures,
            meshes: self.meshes,
            nodes,
            cameras,
            lights,
            environment,
            repairs: self.report.notes(),
            ..Model::default()
        };
        Ok((model, self.report))
    }
}

/// Returns an affine transform.
///
/// # Errors
/// One that is projective, or not finite.
fn affine(transform: &DMat4, span: &Span) -> Result<DAffine3, SceneError> {
    let row = transform.row(3);
    if !transform.is_finite() {
        return Err(error(&codes::RANGE, span, "the transform is not finite", "placed by it"));
    }
    if row.truncate() != DVec3::ZERO || row.w != 1.0 {
        let message = format!("the last row of the transform must be 0 0 0 1; found {row}");
        return Err(error(&codes::RANGE, span, message, "placed by it"));
    }
    Ok(DAffine3::from_mat4(*transform))
}

/// Returns the transform of a node that looks along its −z.
fn looking(position: DVec3, forward: DVec3, up: DVec3) -> DAffine3 {
    let back = -forward.normalize_or(DVec3::Z);
    let right = up.cross(back).try_normalize().unwrap_or_else(|| back.any_orthonormal_vector());
    DAffine3::from_cols(right, back.cross(right), back, position)
}

fn transformed((min, max): (DVec3, DVec3), transform: &DAffine3) -> (DVec3, DVec3) {
    let corners = (0..8).map(|i| {
        let choose = |axis: usize| if i >> axis & 1 == 0 { min[axis] } else { max[axis] };
        transform.transform_point3(DVec3::new(choose(0), choose(1), choose(2)))
    });
    let corners: Vec<DVec3> = corners.collect();
    let first = corners[0];
    corners.into_iter().fold((first, first), |(min, max), at| (min.min(at), max.max(at)))
}
