//! Reads what deforms a mesh: morph targets and skins.

use glam::{Affine3A, Mat4, Vec3};
use gltf::json::mesh::Primitive as JsonPrimitive;
use gltf::json::scene;
use gltf::json::validation::Checked;
use gltf::mesh::Semantic;

use super::{Importer, named};
use crate::error::SceneError;
use crate::model::{Influence, Influences, Mesh, Model, Morph, MorphTarget, Skin};

/// Greatest deviation of the sum of a vertex's weights from 1 that is not reported; rounding four weights to
/// 8 bits stays below it.
const TOLERANCE: f32 = 0.01;

impl Importer<'_> {
    /// Reads the morph targets of a primitive of `count` vertices.
    pub(super) fn targets(
        &self,
        json: &JsonPrimitive,
        count: usize,
        place: &str,
    ) -> Result<Vec<MorphTarget>, SceneError> {
        let mut targets = Vec::new();
        for (number, target) in json.targets.iter().flatten().enumerate() {
            let place = format!("{place}, target {number}");
            let read = |index: Option<usize>, what: &str| -> Result<Vec<Vec3>, SceneError> {
                let Some(index) = index else { return Ok(Vec::new()) };
                let values = self.floats::<3>(index, &place)?;
                self.same_count(count, values.len(), what, &place)?;
                Ok(values.into_iter().map(Vec3::from).collect())
            };
            targets.push(MorphTarget {
                positions: read(target.positions.as_ref().map(|i| i.value()), "displacements")?,
                normals: read(target.normals.as_ref().map(|i| i.value()), "displacements of normals")?,
            });
        }
        Ok(targets)
    }

    /// Reads the joints and weights of a primitive of `count` vertices, of all its sets; weights of 0 are
    /// left out.
    pub(super) fn influences(
        &mut self,
        json: &JsonPrimitive,
        count: usize,
        place: &str,
    ) -> Result<Influences, SceneError> {
        let attribute = |semantic| json.attributes.get(&Checked::Valid(semantic)).map(|index| index.value());
        let mut sets = Vec::new();
        for set in 0.. {
            let (joints, weights) =
                match (attribute(Semantic::Joints(set)), attribute(Semantic::Weights(set))) {
                    (Some(joints), Some(weights)) => (joints, weights),
                    (None, None) => break,
                    (joints, _) => {
                        let [there, missing] =
                            if joints.is_some() { ["JOINTS", "WEIGHTS"] } else { ["WEIGHTS", "JOINTS"] };
                        return Err(
                            self.wrong(place, format!("it has {there}_{set}, but no {missing}_{set}"))
                        );
                    }
                };
            let (joints, weights) = (self.joints(joints, place)?, self.floats::<4>(weights, place)?);
            self.same_count(count, joints.len(), &format!("elements of JOINTS_{set}"), place)?;
            self.same_count(count, weights.len(), &format!("elements of WEIGHTS_{set}"), place)?;
            sets.push((joints, weights));
        }
        let mut influences = Influences::default();
        let (mut scaled, mut unbound) = (0, 0);
        for vertex in (0..count).filter(|_| !sets.is_empty()) {
            let pairs = || {
                let of = |(joints, weights): &(Vec<[u32; 4]>, Vec<[f32; 4]>)| {
                    std::array::from_fn::<_, 4, _>(|i| (joints[vertex][i], weights[vertex][i]))
                };
                let influences = sets.iter().flat_map(of);
                influences.filter(|(_, weight)| *weight > 0.0 && weight.is_finite())
            };
            let sum: f32 = pairs().map(|(_, weight)| weight).sum();
            if sum > 0.0 && sum.is_finite() {
                scaled += usize::from((sum - 1.0).abs() > TOLERANCE);
                influences.push(pairs().map(|(joint, weight)| Influence { joint, weight: weight / sum }));
            } else {
                unbound += 1;
                influences.push([Influence { joint: sets[0].0[vertex][0], weight: 1.0 }]);
            }
        }
        if scaled > 0 {
            self.repairs.push(format!("{place}: the weights of {scaled} vertices are scaled to a sum of 1"));
        }
        if unbound > 0 {
            self.repairs.push(format!(
                "{place}: {unbound} vertices have no usable weights: each follows its first joint alone"
            ));
        }
        Ok(influences)
    }

    /// Returns the initial weights of the morph targets of a node's mesh: those of the node, otherwise of the
    /// mesh, otherwise 0.
    pub(super) fn morph(
        &mut self,
        json: &scene::Node,
        place: &str,
        model: &Model,
    ) -> Result<Morph, SceneError> {
        let Some(mesh) = json.mesh.map(|mesh| mesh.value()) else { return Ok(Morph::default()) };
        let own = &self.get(&self.root.meshes, mesh, "mesh", place)?.weights;
        let count = targets_of(&model.meshes[mesh]);
        self.take(count as u64, 4, place)?;
        let Some(weights) = json.weights.as_ref().or(own.as_ref()) else {
            return Ok(Morph { rest: vec![0.0; count], tracks: Vec::new() });
        };
        if weights.len() != count {
            let found = weights.len();
            self.repairs.push(format!(
                "{place}: {found} weights for {count} morph targets: those that are missing are 0"
            ));
        }
        if weights.iter().any(|weight| !weight.is_finite()) {
            self.repairs.push(format!("{place}: its morph weights that are not finite are taken as 0"));
        }
        let weight = |i: usize| weights.get(i).copied().filter(|weight| weight.is_finite()).unwrap_or(0.0);
        Ok(Morph { rest: (0..count).map(weight).collect(), tracks: Vec::new() })
    }

    /// Assigns skins to nodes; `skinned` are the nodes of the model that name one, with its index.
    pub(super) fn skins(
        &mut self,
        skinned: &[(usize, usize)],
        placed: &[Option<usize>],
        model: &mut Model,
    ) -> Result<(), SceneError> {
        // For each skin of the document, its index in the model once it is used.
        let mut made: Vec<Option<usize>> = vec![None; self.root.skins.len()];
        for &(node, index) in skinned {
            let Some(mesh) = model.nodes[node].mesh else { continue };
            let place = format!("node `{}`", model.nodes[node].name);
            let json = self.get(&self.root.skins, index, "skin", &place)?;
            let whole = format!("its skin {index} is left out, and its mesh keeps its bind pose");
            let mesh = &model.meshes[mesh];
            if let Some(bare) = mesh.primitives.iter().position(|p| !p.is_bound()) {
                let name = &mesh.name;
                self.repairs.push(format!("{place}: {whole}: part {bare} of mesh `{name}` has no joints"));
                continue;
            }
            for (number, primitive) in mesh.primitives.iter().enumerate() {
                let count = json.joints.len();
                let wrong = primitive.influences.iter().find(|(_, i)| i.joint as usize >= count);
                if let Some((vertex, Influence { joint, .. })) = wrong {
                    let problem = format!(
                        "skin {index} has {count} joints, but vertex {vertex} of part {number} of mesh `{}` follows joint {joint}",
                        mesh.name
                    );
                    return Err(self.wrong(place, problem));
                }
            }
            if made[index].is_none() {
                let Some(skin) = self.skin(index, placed)? else {
                    self.repairs.push(format!("{place}: {whole}: its joints are not all in the scene"));
                    continue;
                };
                made[index] = Some(model.skins.len());
                model.skins.push(skin);
            }
            model.nodes[node].skin = made[index];
        }
        Ok(())
    }

    /// Returns a skin of the document, or `None` if some of its joints are not in the scene.
    fn skin(&self, index: usize, placed: &[Option<usize>]) -> Result<Option<Skin>, SceneError> {
        let json = self.get(&self.root.skins, index, "skin", "skins")?;
        let place = match &named(&json.name) {
            Some(name) => format!("skin {index} `{name}`"),
            None => format!("skin {index}"),
        };
        let mut joints = Vec::new();
        for joint in &json.joints {
            self.get(&self.root.nodes, joint.value(), "node", &place)?;
            joints.extend(placed[joint.value()]);
        }
        let inverse_binds = match &json.inverse_bind_matrices {
            Some(index) => self.inverse_binds(index.value(), json.joints.len(), &place)?,
            None => vec![Affine3A::IDENTITY; json.joints.len()],
        };
        Ok((joints.len() == json.joints.len()).then_some(Skin { joints, inverse_binds }))
    }

    fn inverse_binds(&self, index: usize, joints: usize, place: &str) -> Result<Vec<Affine3A>, SceneError> {
        let matrices = self.floats::<16>(index, place)?;
        if matrices.len() < joints {
            let problem = format!("{joints} joints, but {} inverse bind matrices", matrices.len());
            return Err(self.wrong(place, problem));
        }
        if let Some(i) = matrices.iter().take(joints).position(|m| m.iter().any(|x| !x.is_finite())) {
            return Err(self.wrong(place, format!("inverse bind matrix {i} is not finite")));
        }
        let affine = |matrix: &[f32; 16]| Affine3A::from_mat4(Mat4::from_cols_array(matrix));
        Ok(matrices.iter().take(joints).map(affine).collect())
    }
}

/// Returns the number of morph targets of a mesh.
pub(super) fn targets_of(mesh: &Mesh) -> usize {
    mesh.primitives.iter().map(|primitive| primitive.targets.len()).max().unwrap_or(0)
}
