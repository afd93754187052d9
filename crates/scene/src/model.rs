//! The output of an importer or a generator: geometry in its own space, and the nodes that place it.

use bytemuck::{Pod, Zeroable};
use glam::{Affine3A, Quat, Vec2, Vec3};
use serde::Serialize;

use crate::animation::Track;
use crate::environment::Environment;
use crate::hash::Hash;
use crate::light::LightKind;
use crate::material::{Material, Texture};
use crate::scene::Vertex;

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
    pub(crate) environment: Option<Environment>,
    /// Repairs and omissions.
    pub(crate) repairs: Vec<String>,
    /// Whether a model without triangles is valid.
    pub(crate) may_be_empty: bool,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Mesh {
    pub(crate) name: String,
    pub(crate) primitives: Vec<Primitive>,
}

/// Triangles of one material. All arrays of vertices have the same length, every index is below it, and the
/// number of indices is a multiple of three. Numbers need not be finite.
#[derive(Clone, Debug, Default)]
pub(crate) struct Primitive {
    pub(crate) positions: Vec<Vec3>,
    /// Unit vectors.
    pub(crate) normals: Vec<Vec3>,
    pub(crate) uvs: Vec<Vec2>,
    pub(crate) indices: Vec<u32>,
    pub(crate) material: u32,
    /// Whether each triangle has its own three vertices, in order, and its own normal.
    pub(crate) faceted: bool,
    pub(crate) targets: Vec<MorphTarget>,
    /// Empty, or for every vertex.
    pub(crate) influences: Influences,
}

impl Model {
    /// Returns the bytes that it takes when it is placed.
    pub(crate) fn bytes(&self) -> usize {
        let textures: usize = self.textures.iter().map(|texture| texture.pixels.len()).sum();
        let nodes = self.nodes.len() * size_of::<Node>() + self.materials.len() * size_of::<Material>();
        let meshes = self.nodes.iter().filter_map(|node| Some(self.meshes[node.mesh?].bytes()));
        textures.saturating_add(nodes).saturating_add(meshes.fold(0, usize::saturating_add))
    }
}

impl Mesh {
    /// Returns the bytes that it takes at each node.
    fn bytes(&self) -> usize {
        let parts = self.primitives.iter();
        let parts = parts.map(|part| part.positions.len() * part.corner_bytes() + part.indices.len() * 8);
        parts.fold(0, usize::saturating_add)
    }
}

impl Primitive {
    /// Returns the bytes that a vertex takes: here, and in the scene.
    pub(crate) fn corner_bytes(&self) -> usize {
        let influences = if self.is_bound() { 4 * size_of::<Influence>() } else { 0 };
        let targets = self.targets.len() * 2 * size_of::<Vec3>();
        2 * size_of::<Vec3>() + size_of::<Vec2>() + size_of::<Vertex>() + influences + targets
    }

    /// Returns whether every vertex has joints to follow.
    pub(crate) fn is_bound(&self) -> bool {
        self.influences.len() == self.positions.len()
    }
}

/// The displacement of each vertex at weight 1; each list may be empty.
#[derive(Clone, Debug, Default)]
pub(crate) struct MorphTarget {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) normals: Vec<Vec3>,
}

/// A skin, which bends a mesh. Joints are nodes; each inverse bind matrix transforms from the mesh's space to
/// that of the joint.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Skin {
    pub(crate) joints: Vec<usize>,
    /// One per joint.
    pub(crate) inverse_binds: Vec<Affine3A>,
}

#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Node {
    #[serde(skip)]
    pub(crate) name: String,
    pub(crate) parent: Option<usize>,
    /// Transform to the parent's space if nothing moves it.
    pub(crate) rest: Affine3A,
    pub(crate) animation: Option<NodeAnimation>,
    #[serde(skip)]
    pub(crate) mesh: Option<usize>,
    /// The skin that places the mesh instead of the node. It is set only if every vertex of the mesh has
    /// influences, of joints that the skin has.
    pub(crate) skin: Option<usize>,
    pub(crate) morph: Morph,
}

/// The weights of the mesh's morph targets.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Morph {
    /// The weights if no track changes them.
    pub(crate) rest: Vec<f32>,
    /// Empty, or one track per target.
    pub(crate) tracks: Vec<Track<f32>>,
}

/// Animation of a node; components without a track keep their value of `base`.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct NodeAnimation {
    pub(crate) base: Transform,
    pub(crate) translation: Option<Track<Vec3>>,
    pub(crate) rotation: Option<Track<Quat>>,
    pub(crate) scale: Option<Track<Vec3>>,
}

/// A transform: scale first, then rotation, then translation.
#[derive(Clone, Copy, Debug, Serialize)]
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
    /// Returns the transform to the parent's space at `time` \[s\].
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
    /// Returns the weights at `time` \[s\].
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

/// The influence of a joint on a vertex.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct Influence {
    /// Index into the joints of the skin.
    pub(crate) joint: u32,
    pub(crate) weight: f32,
}

/// The joints that each vertex follows: at least one each, with weights that sum to 1. Empty for a mesh that
/// no skin can bend.
#[derive(Clone, Debug, Default)]
pub(crate) struct Influences {
    /// The end index in `all` of the influences of each vertex.
    ends: Vec<u32>,
    all: Vec<Influence>,
}

impl Influences {
    /// Adds the influences of the next vertex.
    pub(crate) fn push(&mut self, influences: impl IntoIterator<Item = Influence>) {
        self.all.extend(influences);
        self.ends.push(self.all.len() as u32);
    }

    /// Returns the number of vertices.
    pub(crate) fn len(&self) -> usize {
        self.ends.len()
    }

    pub(crate) fn of(&self, vertex: usize) -> &[Influence] {
        let start = vertex.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.all[start as usize..self.ends[vertex] as usize]
    }

    /// Adds all influences to a hash.
    pub(crate) fn hash(&self, hash: &mut Hash) {
        hash.slice(&self.ends);
        hash.slice(&self.all);
    }

    /// Returns every influence, with the index of its vertex.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (usize, &Influence)> {
        (0..self.len()).flat_map(|vertex| self.of(vertex).iter().map(move |i| (vertex, i)))
    }
}
