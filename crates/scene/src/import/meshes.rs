//! Reads meshes: attributes and indices, with substitutes for missing ones.

use glam::{Vec2, Vec3};
use gltf::json::mesh;
use gltf::json::validation::Checked;
use gltf::mesh::{Mode, Semantic};

use super::{Importer, named};
use crate::error::SceneError;
use crate::material::Material;
use crate::model::{Influences, Mesh, MorphTarget, Primitive};

impl Importer<'_> {
    /// Returns all meshes. `uv_sets` has the set of texture coordinates of each material; a default material
    /// is added if a primitive names none.
    pub(super) fn meshes(
        &mut self,
        uv_sets: &[u32],
        materials: &mut Vec<Material>,
    ) -> Result<Vec<Mesh>, SceneError> {
        let mut default_material = None;
        let mut meshes = Vec::new();
        for (index, json) in self.root.meshes.iter().enumerate() {
            let name = named(&json.name).unwrap_or_else(|| format!("mesh {index}"));
            let mut primitives = Vec::new();
            for (number, primitive) in json.primitives.iter().enumerate() {
                let place = format!("mesh {index} `{name}`, primitive {number}");
                let material = match primitive.material {
                    Some(material) => {
                        self.get(uv_sets, material.value(), "material", &place)?;
                        material.value()
                    }
                    None => *default_material.get_or_insert_with(|| {
                        // The default of glTF is a rough metal, which is black in diffuse light and hardly
                        // intended.
                        self.repairs
                            .push(format!("{place} names no material: it is taken as white and matte"));
                        materials.push(Material { name: "default".into(), ..Material::default() });
                        materials.len() - 1
                    }),
                };
                let uv_set = uv_sets.get(material).copied().unwrap_or(0);
                let read = self.primitive(primitive, &place, uv_set)?;
                primitives.extend(read.map(|p| Primitive { material: material as u32, ..p }));
            }
            meshes.push(Mesh { name, primitives });
        }
        Ok(meshes)
    }

    /// Returns one primitive as triangles, or `None` if it is left out.
    fn primitive(
        &mut self,
        json: &mesh::Primitive,
        place: &str,
        uv_set: u32,
    ) -> Result<Option<Primitive>, SceneError> {
        let Checked::Valid(mode) = json.mode else {
            return Err(self.wrong(place, "its mode is none of 0 to 6"));
        };
        if matches!(mode, Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
            self.repairs.push(format!("{place} is left out: it holds points or lines"));
            return Ok(None);
        }
        let attribute = |semantic| json.attributes.get(&Checked::Valid(semantic)).map(|index| index.value());
        let Some(positions) = attribute(Semantic::Positions) else {
            self.repairs.push(format!("{place} is left out: it has no positions"));
            return Ok(None);
        };
        let positions: Vec<Vec3> =
            self.floats(positions, place)?.into_iter().map(|p: [f32; 3]| Vec3::from(p)).collect();
        let count = positions.len();
        let uvs = match attribute(Semantic::TexCoords(uv_set)) {
            Some(index) => {
                self.floats(index, place)?.into_iter().map(|uv: [f32; 2]| Vec2::from(uv)).collect()
            }
            None => vec![Vec2::ZERO; count],
        };
        self.same_count(count, uvs.len(), "texture coordinates", place)?;
        let normals: Option<Vec<Vec3>> = match attribute(Semantic::Normals) {
            Some(index) => {
                Some(self.floats(index, place)?.into_iter().map(|n: [f32; 3]| Vec3::from(n)).collect())
            }
            None => None,
        };
        self.same_count(count, normals.as_ref().map_or(count, Vec::len), "normals", place)?;

        let corners: Vec<u32> = match json.indices {
            Some(index) => self.indices(index.value(), place)?,
            None => {
                self.take(count as u64, 16, place)?;
                (0..count as u32).collect()
            }
        };
        if let Some((i, index)) = corners.iter().enumerate().find(|(_, index)| **index as usize >= count) {
            let problem = format!("index number {i} is {index}, but there are only {count} vertices");
            return Err(self.wrong(place, problem));
        }
        let indices = match mode {
            Mode::TriangleStrip => triangles_of_strip(&corners),
            Mode::TriangleFan => triangles_of_fan(&corners),
            _ => corners[..corners.len() / 3 * 3].to_vec(),
        };
        if mode == Mode::Triangles && indices.len() < corners.len() {
            self.repairs.push(format!("{place}: the last {} indices make no triangle", corners.len() % 3));
        }
        if attribute(Semantic::Colors(0)).is_some() {
            self.repair_primitive("colors of vertices are left out", place);
        }
        let targets = self.targets(json, count, place)?;
        let influences = self.influences(json, count, place)?;
        let primitive = Primitive { positions, uvs, indices, targets, influences, ..Primitive::default() };
        Ok(Some(match normals {
            Some(normals) => self.with_normals(primitive, normals, place),
            None => {
                self.take(primitive.indices.len() as u64, primitive.corner_bytes(), place)?;
                self.repair_primitive("triangles without normals are shaded flat", place);
                flat(&primitive)
            }
        }))
    }

    /// Adds normals, scaled to length 1; normals of length zero are replaced by those of adjacent triangles.
    fn with_normals(&mut self, primitive: Primitive, normals: Vec<Vec3>, place: &str) -> Primitive {
        let mut bad = 0;
        let mut smooth = None;
        let fixed = normals.into_iter().enumerate().map(|(i, normal)| {
            normal.try_normalize().unwrap_or_else(|| {
                bad += 1;
                smooth.get_or_insert_with(|| smooth_normals(&primitive.positions, &primitive.indices))[i]
            })
        });
        let normals = fixed.collect();
        if bad > 0 {
            self.repairs
                .push(format!("{place}: {bad} normals are no directions: they come from the triangles"));
        }
        Primitive { normals, ..primitive }
    }
}

/// Returns the triangles of a strip: triangle i has the vertices i, i + 1, i + 2, the last two swapped if i
/// is odd.
fn triangles_of_strip(corners: &[u32]) -> Vec<u32> {
    let triangle = |(i, c): (usize, &[u32])| if i % 2 == 0 { [c[0], c[1], c[2]] } else { [c[0], c[2], c[1]] };
    corners.windows(3).enumerate().flat_map(triangle).collect()
}

/// Returns the triangles of a fan: triangle i has the vertices i + 1, i + 2, 0.
fn triangles_of_fan(corners: &[u32]) -> Vec<u32> {
    corners.get(1..).unwrap_or_default().windows(2).flat_map(|c| [c[0], c[1], corners[0]]).collect()
}

/// Returns the normal of a triangle by its winding, with twice its area as length.
fn face_normal(positions: &[Vec3], triangle: &[u32]) -> Vec3 {
    let [a, b, c] = [triangle[0], triangle[1], triangle[2]].map(|i| positions[i as usize]);
    (b - a).cross(c - a)
}

/// Returns a primitive in which each triangle has its own vertices and its own normal.
pub(crate) fn flat(primitive: &Primitive) -> Primitive {
    let normals = primitive.indices.chunks_exact(3).flat_map(|triangle| {
        [face_normal(&primitive.positions, triangle).try_normalize().unwrap_or(Vec3::Y); 3]
    });
    let corners = || primitive.indices.iter().map(|i| *i as usize);
    // The list may be empty.
    let of_corners = |list: &[Vec3]| corners().filter_map(|i| list.get(i).copied()).collect::<Vec<Vec3>>();
    let target = |target: &MorphTarget| MorphTarget {
        positions: of_corners(&target.positions),
        normals: of_corners(&target.normals),
    };
    let mut influences = Influences::default();
    for corner in corners().filter(|_| primitive.is_bound()) {
        influences.push(primitive.influences.of(corner).iter().copied());
    }
    Primitive {
        positions: of_corners(&primitive.positions),
        normals: normals.collect(),
        uvs: corners().map(|i| primitive.uvs[i]).collect(),
        indices: (0..primitive.indices.len() as u32).collect(),
        material: primitive.material,
        faceted: true,
        targets: primitive.targets.iter().map(target).collect(),
        influences,
    }
}

/// Returns the mean normal, weighted by area, of the triangles at each vertex; +y if they have none.
pub(crate) fn smooth_normals(positions: &[Vec3], indices: &[u32]) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; positions.len()];
    for triangle in indices.chunks_exact(3) {
        let normal = face_normal(positions, triangle);
        if normal.is_finite() {
            triangle.iter().for_each(|i| sums[*i as usize] += normal);
        }
    }
    sums.into_iter().map(|sum| sum.try_normalize().unwrap_or(Vec3::Y)).collect()
}
