//! What an importer or a generator hands over: geometry in its own space, and the nodes that place it.

use bytemuck::{Pod, Zeroable};
use glam::{Affine3A, Quat, Vec2, Vec3};

use crate::animation::Track;
use crate::hash::Hash;
use crate::light::LightKind;
use crate::material::{Material, Texture};

/// Geometry with materials, in its own space, and a tree of nodes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Model {
    pub(crate) materials: Vec<Material>,
    pub(crate) textures: Vec<Texture>,
    pub(crate) meshes: Vec<Mesh>,
    /// Parents stand before their children.
    pub(crate) nodes: Vec<Node>,
    pub(crate) skins: Vec<Skin>,
    pub(crate) cameras: Vec<NodeCamera>,
    pub(crate) lights: Vec<NodeLight>,
    /// What was repaired or left out.
    pub(crate) repairs: Vec<String>,
    /// Whether no triangles at all is as it should be.
    pub(crate) may_be_empty: bool,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Mesh {
    pub(crate) name: String,
    pub(crate) primitives: Vec<Primitive>,
}

/// Triangles of one material. All arrays of vertices have one length; every index is below it, and the
/// number of indices is a multiple of three. Numbers need not be finite.
#[derive(Clone, Debug, Default)]
pub(crate) struct Primitive {
    pub(crate) positions: Vec<Vec3>,
    /// Unit vectors.
    pub(crate) normals: Vec<Vec3>,
    pub(crate) uvs: Vec<Vec2>,
    pub(crate) indices: Vec<u32>,
    pub(crate) material: u32,
    /// Whether each triangle has three vertices of its own, in their order, and its own normal.
    pub(crate) faceted: bool,
    pub(crate) targets: Vec<MorphTarget>,
    /// Empty, or of every vertex.
    pub(crate) influences: Influences,
}

impl Primitive {
    /// Whether every vertex has joints to follow.
    pub(crate) fn is_bound(&self) -> bool {
        self.influences.len() == self.positions.len()
    }
}

/// What is added to each vertex at weight 1; each list may be empty.
#[derive(Clone, Debug, Default)]
pub(crate) struct MorphTarget {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) normals: Vec<Vec3>,
}

/// What bends a mesh. Joints are nodes; each takes the mesh's space to its own by its inverse bind matrix.
#[derive(Clone, Debug, Default)]
pub(crate) struct Skin {
    pub(crate) joints: Vec<usize>,
    /// As many as joints.
    pub(crate) inverse_binds: Vec<Affine3A>,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Node {
    pub(crate) name: String,
    pub(crate) parent: Option<usize>,
    /// To the parent's space, where nothing moves it.
    pub(crate) rest: Affine3A,
    pub(crate) animation: Option<NodeAnimation>,
    pub(crate) mesh: Option<usize>,
    /// Places the mesh, instead of the node. Only where every vertex of the mesh has influences, of joints
    /// that the skin has.
    pub(crate) skin: Option<usize>,
    pub(crate) morph: Morph,
}

/// The weights of the mesh's morph targets.
#[derive(Clone, Debug, Default)]
pub(crate) struct Morph {
    /// Where no track moves them.
    pub(crate) rest: Vec<f32>,
    /// None, or one a target.
    pub(crate) tracks: Vec<Track<f32>>,
}

/// Movement of a node; what has no track keeps its part of `base`.
#[derive(Clone, Debug, Default)]
pub(crate) struct NodeAnimation {
    pub(crate) base: Transform,
    pub(crate) translation: Option<Track<Vec3>>,
    pub(crate) rotation: Option<Track<Quat>>,
    pub(crate) scale: Option<Track<Vec3>>,
}

/// First scale, then turn, then move.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Transform {
    pub(crate) translation: Vec3,
    pub(crate) rotation: Quat,
    pub(crate) scale: Vec3,
}

impl Default for Transform {
    fn default() -> Self {
        Transform { translation: Vec3::ZERO, rotation: Quat::IDENTITY, scale: Vec3::ONE }
    }
}

impl Transform {
    pub(crate) fn affine(&self) -> Affine3A {
        Affine3A::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }

    pub(crate) fn from_affine(affine: &Affine3A) -> Transform {
        let (scale, rotation, translation) = affine.to_scale_rotation_translation();
        Transform { translation, rotation, scale }
    }
}

impl Node {
    /// To the parent's space at `time` \[s\].
    pub(crate) fn local(&self, time: f32) -> Affine3A {
        let Some(animation) = &self.animation else { return self.rest };
        let base = animation.base;
        Transform {
            translation: animation.translation.as_ref().map_or(base.translation, |t| t.at(time)),
            rotation: animation.rotation.as_ref().map_or(base.rotation, |t| t.at(time)),
            scale: animation.scale.as_ref().map_or(base.scale, |t| t.at(time)),
        }
        .affine()
    }
}

impl Morph {
    /// The weights at `time` \[s\].
    pub(crate) fn at(&self, time: f32) -> Vec<f32> {
        if self.tracks.is_empty() {
            return self.rest.clone();
        }
        self.tracks.iter().map(|track| track.at(time)).collect()
    }
}

/// A camera at a node, looking along its −z, with its +y up.
#[derive(Clone, Debug)]
pub(crate) struct NodeCamera {
    pub(crate) name: String,
    pub(crate) node: usize,
    pub(crate) vertical_fov: f32,
    pub(crate) near: f32,
}

/// A light at a node, shining along its −z.
#[derive(Clone, Debug)]
pub(crate) struct NodeLight {
    pub(crate) name: String,
    pub(crate) node: usize,
    pub(crate) kind: LightKind,
    pub(crate) intensity: Vec3,
}

/// How much a vertex follows a joint.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct Influence {
    /// Index into the joints of the skin.
    pub(crate) joint: u32,
    pub(crate) weight: f32,
}

/// The joints that each vertex follows: at least one each, of weights that sum to 1. Empty for a mesh that
/// no skin can bend.
#[derive(Clone, Debug, Default)]
pub(crate) struct Influences {
    /// Where the influences of each vertex end in `all`.
    ends: Vec<u32>,
    all: Vec<Influence>,
}

impl Influences {
    /// Adds those of the next vertex.
    pub(crate) fn push(&mut self, influences: impl IntoIterator<Item = Influence>) {
        self.all.extend(influences);
        self.ends.push(self.all.len() as u32);
    }

    /// Of how many vertices.
    pub(crate) fn len(&self) -> usize {
        self.ends.len()
    }

    pub(crate) fn of(&self, vertex: usize) -> &[Influence] {
        let start = vertex.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.all[start as usize..self.ends[vertex] as usize]
    }

    /// Adds all of them.
    pub(crate) fn hash(&self, hash: &mut Hash) {
        hash.slice(&self.ends);
        hash.slice(&self.all);
    }

    /// Every influence, with its vertex.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (usize, &Influence)> {
        (0..self.len()).flat_map(|vertex| self.of(vertex).iter().map(move |i| (vertex, i)))
    }
}
