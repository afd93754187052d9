//! Combines models, lights and a camera into a flat [`Scene`] around an origin.

use std::path::PathBuf;
use std::rc::Rc;

use glam::{Affine3A, DVec3, Vec3};
use rayon::prelude::*;

use crate::animation::Track;
use crate::budget::Budget;
use crate::camera::Camera;
use crate::dense::dense_extent;
use crate::error::SceneError;
use crate::hash;
use crate::light::Light;
use crate::material::{Material, Texture};
use crate::model::{Mesh, Model, Morph, Node, NodeAnimation, Skin};
use crate::scene::{
    Driver, Instance, Motion, MovingMesh, Scene, Vertex, camera_at_node, extend_worlds, place_and_direction,
};
use crate::shape::{Shape, usable};

/// Three quarters of what a 4 GiB buffer can hold: 64 Mi vertices of 48 bytes.
const MAX_VERTICES: usize = 1 << 26;
/// 2 GiB of indices.
const MAX_INDICES: usize = 1 << 29;
/// The bounding box of a moving scene is computed at the start and at this many further times.
const TIMES_OF_BOUNDS: u32 = 64;

/// A scene that is being assembled. Its places are relative to its origin.
#[derive(Default)]
pub(crate) struct Assembly {
    pub(crate) name: String,
    /// The name or path by which the scene is loaded.
    pub(crate) spec: String,
    origin: DVec3,
    pub(crate) about: String,
    pub(crate) nodes: Vec<Node>,
    /// The camera of the description; if `near` is 0, a ten-thousandth of the scene's extent is used.
    pub(crate) camera: Option<Camera>,
    pub(crate) camera_tracks: Driver,
    pub(crate) lights: Vec<(Light, Driver)>,
    pub(crate) frames_per_second: Option<f32>,
    pub(crate) duration: f32,
    pub(crate) repairs: Vec<String>,
    pub(crate) files: Vec<PathBuf>,
    /// Whether a scene without triangles is valid.
    pub(crate) may_be_empty: bool,
    pub(crate) budget: Rc<Budget>,
    /// The transforms of the first nodes at the start.
    worlds: Vec<Affine3A>,
    materials: Vec<Material>,
    textures: Vec<Texture>,
    skins: Vec<Skin>,
    cameras: Vec<(String, Camera, usize)>,
    placed: Vec<Placed>,
}

/// A mesh at a node of the assembly.
struct Placed {
    name: String,
    node: usize,
    mesh: Mesh,
    first_material: u32,
}

impl Assembly {
    pub(crate) fn new(name: String, spec: &str, origin: DVec3, budget: &Rc<Budget>) -> Assembly {
        budget.restart();
        Assembly { name, spec: spec.to_owned(), origin, budget: Rc::clone(budget), ..Assembly::default() }
    }

    /// Adds a model below `parent`, or in the world, with its cameras, and with its lights if `with_lights` is set.
    ///
    /// # Errors
    /// A scene that is too large for its files.
    pub(crate) fn place(
        &mut self,
        model: &Model,
        parent: Option<usize>,
        with_lights: bool,
    ) -> Result<(), SceneError> {
        let too_large = |problem| SceneError::TooLarge { file: self.name.clone(), problem };
        self.budget.take(1, model.bytes()).map_err(too_large)?;
        let model = model.clone();
        let (first_node, first_material) = (self.nodes.len(), self.materials.len() as u32);
        let (first_texture, first_skin) = (self.textures.len() as u32, self.skins.len());
        self.textures.extend(model.textures);
        self.materials.extend(model.materials.into_iter().map(|mut material| {
            material.offset_textures(first_texture);
            material
        }));
        for (index, mut node) in model.nodes.into_iter().enumerate() {
            if let Some(mesh) = node.mesh {
                let mesh = model.meshes[mesh].clone();
                let name = if node.name.is_empty() { mesh.name.clone() } else { node.name.clone() };
                self.placed.push(Placed { name, node: first_node + index, mesh, first_material });
            }
            let parent = node.parent.map_or(parent, |p| Some(p + first_node));
            if parent.is_none() {
                node.move_to(self.origin);
            }
            self.duration = self.duration.max(node.animation.as_ref().map_or(0.0, NodeAnimation::end));
            self.duration = self.duration.max(node.morph.end());
            self.nodes.push(Node { parent, skin: node.skin.map(|skin| skin + first_skin), ..node });
        }
        self.skins.extend(model.skins.into_iter().map(|mut skin| {
            skin.joints.iter_mut().for_each(|joint| *joint += first_node);
            skin
        }));
        extend_worlds(&self.nodes, self.origin != DVec3::ZERO, 0.0, &mut self.worlds);
        let worlds = &self.worlds;
        for camera in model.cameras {
            let node = first_node + camera.node;
            let placed = camera_at_node(&worlds[node], camera.vertical_fov, camera.near);
            if placed.position.is_finite() && placed.target.is_finite() {
                self.cameras.push((camera.name, placed, node));
            } else {
                self.repairs.push(format!("camera `{}` is left out: its place is not finite", camera.name));
            }
        }
        for light in model.lights.into_iter().filter(|_| with_lights) {
            let node = first_node + light.node;
            let (position, direction) = place_and_direction(&worlds[node]);
            if !position.is_finite() || !light.intensity.is_finite() {
                self.repairs.push(format!(
                    "light `{}` is left out: its place or intensity is not finite",
                    light.name
                ));
                continue;
            }
            let name =
                if light.name.is_empty() { format!("light {}", self.lights.len()) } else { light.name };
            let light = Light { name, kind: light.kind, position, direction, intensity: light.intensity };
            self.lights.push((light, Driver { node: Some(node), ..Driver::default() }));
        }
        self.repairs.extend(model.repairs);
        self.may_be_empty |= model.may_be_empty;
        Ok(())
    }

    /// Returns the vertices of the scene as they are at 0 s, and what is needed to finish it.
    pub(crate) fn flatten(mut self) -> Result<Flattened, SceneError> {
        let nodes = std::mem::take(&mut self.nodes);
        let (far, skins) = (self.origin != DVec3::ZERO, std::mem::take(&mut self.skins));
        let mut motion = Motion { nodes, far, skins, ..Motion::default() };
        let worlds = motion.worlds(0.0);
        let mut flat = Flat::default();
        for placed in std::mem::take(&mut self.placed) {
            let moving = flat.add(&placed, &motion, &worlds, &mut self.repairs);
            motion.meshes.extend(moving);
            if flat.vertices.len() > MAX_VERTICES || flat.indices.len() > MAX_INDICES {
                let problem = format!(
                    "at `{}` there are {} vertices and {} indices; a GPU buffer holds {MAX_VERTICES} and {MAX_INDICES}",
                    placed.name,
                    flat.vertices.len(),
                    flat.indices.len()
                );
                return Err(SceneError::TooLarge { file: self.name, problem });
            }
        }
        if flat.indices.is_empty() && !self.may_be_empty {
            return Err(SceneError::Empty { file: self.name, repairs: self.repairs });
        }
        Ok(Flattened { assembly: self, motion, flat })
    }
}

/// A scene whose vertices are known at 0 s.
pub(crate) struct Flattened {
    assembly: Assembly,
    motion: Motion,
    flat: Flat,
}

impl Flattened {
    /// Returns the box around all triangles at 0 s, relative to the origin; zero if there are none.
    pub(crate) fn still_bounds(&self) -> (Vec3, Vec3) {
        let Flat { vertices, indices, .. } = &self.flat;
        box_around(vertices, &used(vertices, indices)).unwrap_or_default()
    }

    /// Returns the flat scene.
    pub(crate) fn finish(self) -> Scene {
        let Flattened { mut assembly, mut motion, flat } = self;
        let (lights, drivers): (Vec<_>, Vec<_>) = assembly.lights.into_iter().unzip();
        if lights.is_empty() {
            assembly.repairs.push("there are no lights: only what emits is not black".into());
        }
        if assembly.origin != DVec3::ZERO {
            let (DVec3 { x, y, z }, far) = (assembly.origin, assembly.origin.length());
            assembly.repairs.push(format!(
                "the scene lies {far:.0} m from the origin of its file: it is rendered around ({x}, {y}, {z})"
            ));
        }
        motion.lights = drivers;
        motion.camera = assembly.camera_tracks;
        let mut scene = Scene {
            bounds: (Vec3::ZERO, Vec3::ZERO),
            dense_extent: 0.0,
            origin: assembly.origin,
            name: assembly.name,
            about: assembly.about,
            vertices: flat.vertices,
            indices: flat.indices,
            instances: flat.instances,
            materials: assembly.materials,
            textures: assembly.textures,
            lights,
            camera: Camera::framing(Vec3::ZERO, Vec3::ZERO),
            cameras: assembly.cameras.iter().map(|(name, camera, _)| (name.clone(), *camera)).collect(),
            frames_per_second: assembly.frames_per_second.unwrap_or(30.0),
            duration: assembly.duration,
            repairs: assembly.repairs,
            spec: assembly.spec,
            files: assembly.files,
            hash: 0,
            motion,
        };
        scene.bounds = bounds(&scene);
        scene.dense_extent = dense_extent(&scene.vertices, &scene.indices, &scene.instances, scene.extent());
        scene.camera = match (assembly.camera, assembly.cameras.first()) {
            (Some(camera), _) => camera,
            (None, Some((_, camera, node))) => {
                scene.motion.camera.node = Some(*node);
                *camera
            }
            (None, None) => {
                let (min, max) = scene.bounds();
                scene.repairs.push("there is no camera: one is placed that sees the whole scene".into());
                Camera::framing(min, max)
            }
        };
        if scene.camera.near <= 0.0 {
            let extent = scene.extent();
            scene.camera.near = if extent > 0.0 { extent * 1e-4 } else { 1e-3 };
        }
        // Animated values at 0 s come from their tracks.
        let start = scene.at(0.0);
        (scene.camera, scene.lights) = (start.camera, start.lights);
        if scene.camera.position == scene.camera.target {
            let message = "the camera's position and target are too near each other: it looks along −z";
            scene.repairs.push(message.into());
        }
        scene.hash = hash::scene(&scene);
        scene
    }
}

impl NodeAnimation {
    /// Returns the time of the last key \[s\].
    fn end(&self) -> f32 {
        let ends = [
            self.translation.as_ref().map(|t| t.end()),
            self.rotation.as_ref().map(|t| t.end()),
            self.scale.as_ref().map(|t| t.end()),
        ];
        ends.into_iter().flatten().fold(0.0, f32::max)
    }
}

impl Morph {
    /// Returns the time of the last key \[s\].
    fn end(&self) -> f32 {
        self.tracks.iter().map(Track::end).fold(0.0, f32::max)
    }
}

#[derive(Default)]
struct Flat {
    vertices: Vec<Vertex>,
    indices: Vec<u32>,
    instances: Vec<Instance>,
}

impl Flat {
    /// Adds a mesh in world space; returns its moving form if it moves.
    fn add(
        &mut self,
        placed: &Placed,
        motion: &Motion,
        worlds: &[Affine3A],
        repairs: &mut Vec<String>,
    ) -> Option<MovingMesh> {
        let (first_vertex, first_index) = (self.vertices.len(), self.indices.len());
        let instance = self.instances.len() as u32;
        let shape = Shape::new(&placed.mesh);
        let placement = motion.placement(placed.node, 0.0, worlds);
        let mirrors = shape.mirrors(&placement);
        let mut posed = shape.posed(&placement, mirrors).into_iter();
        let mut dropped = 0;
        for primitive in &placed.mesh.primitives {
            let base = self.vertices.len() as u32;
            let material = placed.first_material + primitive.material;
            let mut bad = vec![false; primitive.positions.len()];
            for (i, (mut position, normal)) in posed.by_ref().take(bad.len()).enumerate() {
                if !usable(position) {
                    (bad[i], position) = (true, Vec3::ZERO);
                }
                let uv = primitive.uvs[i];
                self.vertices.push(Vertex {
                    position: position.into(),
                    material,
                    normal: normal.into(),
                    instance,
                    uv: if uv.is_finite() { uv.into() } else { [0.0; 2] },
                    pad: [0.0; 2],
                });
            }
            for triangle in primitive.indices.chunks_exact(3) {
                if triangle.iter().any(|i| bad[*i as usize]) {
                    dropped += 1;
                    continue;
                }
                let [a, b, c] = [triangle[0], triangle[1], triangle[2]].map(|i| base + i);
                self.indices.extend(if mirrors { [a, c, b] } else { [a, b, c] });
            }
        }
        if dropped > 0 {
            repairs.push(format!(
                "`{}`: {dropped} triangles are left out: their vertices are not finite, or beyond 10¹⁸ m",
                placed.name
            ));
        }
        let moves = motion.mesh_moves(placed.node);
        self.instances.push(Instance {
            name: placed.name.clone(),
            first_vertex: first_vertex as u32,
            vertex_count: (self.vertices.len() - first_vertex) as u32,
            first_index: first_index as u32,
            index_count: (self.indices.len() - first_index) as u32,
            moves,
        });
        moves.then_some(MovingMesh { instance, node: placed.node, shape, mirrors })
    }
}

/// Returns the box around all triangles, at all times.
fn bounds(scene: &Scene) -> (Vec3, Vec3) {
    let used = used(&scene.vertices, &scene.indices);
    let around = |first: usize, vertices: &[Vertex]| box_around(vertices, &used[first..]);
    let moved = |step: u32| {
        let time = scene.duration * (step as f32 / TIMES_OF_BOUNDS as f32);
        let worlds = scene.motion.worlds(time);
        let moved = scene.moved_at(time, &worlds);
        moved.filter_map(|moved| around(moved.first_vertex as usize, &moved.vertices)).reduce(join)
    };
    let steps = if scene.motion.meshes.is_empty() { 0 } else { TIMES_OF_BOUNDS };
    let moved = (1..=steps).into_par_iter().filter_map(moved).reduce_with(join);
    around(0, &scene.vertices).into_iter().chain(moved).reduce(join).unwrap_or_default()
}

/// Returns which vertices triangles use.
fn used(vertices: &[Vertex], indices: &[u32]) -> Vec<bool> {
    let mut used = vec![false; vertices.len()];
    indices.iter().for_each(|i| used[*i as usize] = true);
    used
}

/// Returns the box around those vertices that are used.
fn box_around(vertices: &[Vertex], used: &[bool]) -> Option<(Vec3, Vec3)> {
    let corners = vertices.iter().zip(used).filter(|(_, used)| **used);
    corners.map(|(v, _)| (v.position.into(), v.position.into())).reduce(join)
}

/// Returns the box around two boxes.
fn join(a: (Vec3, Vec3), b: (Vec3, Vec3)) -> (Vec3, Vec3) {
    (a.0.min(b.0), a.1.max(b.1))
}
