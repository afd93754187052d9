//! Combines models, lights and a camera into a flat [`Scene`]: an [`Assembly`] once, and a [`Stage`] for each origin that
//! is tried.

use std::path::PathBuf;
use std::rc::Rc;

use glam::{Affine3A, DVec3, Vec3};
use rayon::prelude::*;

use crate::animation::Track;
use crate::budget::Budget;
use crate::camera::Camera;
use crate::dense::dense_extent;
use crate::environment::Environment;
use crate::error::SceneError;
use crate::hash;
use crate::light::Light;
use crate::material::{Material, Texture};
use crate::model::{Model, Morph, Node, NodeAnimation, NodeCamera, NodeLight, Skin};
use crate::scene::{
    Driver, Instance, Motion, MovingMesh, Scene, Vertex, camera_at_node, place_and_direction,
};
use crate::shape::{Shape, usable};
use crate::units;

/// Three quarters of what a 4 GiB buffer can hold: 64 Mi vertices of 48 bytes.
const MAX_VERTICES: usize = 1 << 26;
/// 2 GiB of indices.
const MAX_INDICES: usize = 1 << 29;
/// The bounding box of a moving scene is computed at the start and at this many further times.
const TIMES_OF_BOUNDS: u32 = 64;

/// A scene that is being assembled: everything that does not depend on the origin around which it is rendered. Nodes
/// without a parent are in the space of the files' world.
#[derive(Default)]
pub(crate) struct Assembly {
    pub(crate) name: String,
    /// The name or path by which the scene is loaded.
    pub(crate) spec: String,
    pub(crate) about: String,
    pub(crate) nodes: Vec<Node>,
    pub(crate) frames_per_second: Option<f32>,
    pub(crate) duration: f32,
    pub(crate) repairs: Vec<String>,
    pub(crate) files: Vec<PathBuf>,
    pub(crate) environment: Option<Environment>,
    /// Whether a scene without triangles is valid.
    pub(crate) may_be_empty: bool,
    pub(crate) budget: Rc<Budget>,
    materials: Vec<Material>,
    textures: Vec<Texture>,
    skins: Vec<Skin>,
    cameras: Vec<NodeCamera>,
    lights: Vec<NodeLight>,
    placed: Vec<Placed>,
}

/// A mesh at a node of the assembly.
struct Placed {
    name: String,
    node: usize,
    model: Rc<Model>,
    /// Index into the meshes of the model.
    mesh: usize,
    first_material: u32,
}

/// The parts of a scene that have places, around an origin.
#[derive(Default)]
pub(crate) struct Stage {
    origin: DVec3,
    /// Nodes and skins, and the drivers of the camera and the lights.
    pub(crate) motion: Motion,
    /// The camera of the description; if `near` is 0, a ten-thousandth of the scene's extent is used.
    pub(crate) camera: Option<Camera>,
    pub(crate) lights: Vec<Light>,
    cameras: Vec<(String, Camera, usize)>,
    repairs: Vec<String>,
}

impl Assembly {
    pub(crate) fn new(name: String, spec: &str, budget: &Rc<Budget>) -> Assembly {
        Assembly { name, spec: spec.to_owned(), budget: Rc::clone(budget), ..Assembly::default() }
    }

    /// Adds a model below `parent`, or in the world, with its cameras, and with its lights if `with_lights` is set.
    ///
    /// # Errors
    /// A scene that is too large for its files.
    pub(crate) fn place(
        &mut self,
        model: &Rc<Model>,
        parent: Option<usize>,
        with_lights: bool,
    ) -> Result<(), SceneError> {
        let too_large = |problem| SceneError::TooLarge { file: self.name.clone(), problem };
        self.budget.take(1, model.bytes()).map_err(too_large)?;
        let (first_node, first_material) = (self.nodes.len(), self.materials.len() as u32);
        let (first_texture, first_skin) = (self.textures.len() as u32, self.skins.len());
        self.textures.extend(model.textures.iter().cloned());
        self.materials.extend(model.materials.iter().cloned().map(|mut material| {
            material.offset_textures(first_texture);
            material
        }));
        for (index, node) in model.nodes.iter().enumerate() {
            if let Some(mesh) = node.mesh {
                let name = if node.name.is_empty() { &model.meshes[mesh].name } else { &node.name }.clone();
                let (node, model) = (first_node + index, Rc::clone(model));
                self.placed.push(Placed { name, node, model, mesh, first_material });
            }
            self.duration = self.duration.max(node.animation.as_ref().map_or(0.0, NodeAnimation::end));
            self.duration = self.duration.max(node.morph.end());
            let parent = node.parent.map_or(parent, |p| Some(p + first_node));
            self.nodes.push(Node { parent, skin: node.skin.map(|skin| skin + first_skin), ..node.clone() });
        }
        self.skins.extend(model.skins.iter().cloned().map(|mut skin| {
            skin.joints.iter_mut().for_each(|joint| *joint += first_node);
            skin
        }));
        let cameras = model.cameras.iter().cloned();
        self.cameras.extend(cameras.map(|camera| NodeCamera { node: first_node + camera.node, ..camera }));
        let lights = model.lights.iter().filter(|_| with_lights).cloned();
        self.lights.extend(lights.map(|light| NodeLight { node: first_node + light.node, ..light }));
        if with_lights && self.environment.is_none() {
            self.environment.clone_from(&model.environment);
        }
        self.repairs.extend(model.repairs.iter().cloned());
        self.may_be_empty |= model.may_be_empty;
        Ok(())
    }

    /// Returns the nodes around an origin, without cameras and lights.
    pub(crate) fn stage(&self, origin: DVec3) -> Stage {
        let (mut nodes, skins) = (self.nodes.clone(), self.skins.clone());
        nodes.iter_mut().filter(|node| node.parent.is_none()).for_each(|node| node.move_to(origin));
        let motion = Motion { nodes, far: origin != DVec3::ZERO, skins, ..Motion::default() };
        Stage { origin, motion, ..Stage::default() }
    }

    /// Returns the vertices of a stage as they are at 0 s.
    ///
    /// # Errors
    /// Too many vertices or indices, and none at all.
    pub(crate) fn flatten(&self, mut stage: Stage) -> Result<Flattened, SceneError> {
        let worlds = stage.motion.worlds(0.0);
        let mut flat = Flat::default();
        for placed in &self.placed {
            let moving = flat.add(placed, &stage.motion, &worlds, &mut stage.repairs);
            stage.motion.meshes.extend(moving);
            if flat.vertices.len() > MAX_VERTICES || flat.indices.len() > MAX_INDICES {
                let problem = format!(
                    "at `{}` there are {} vertices and {} indices; a GPU buffer holds {MAX_VERTICES} and {MAX_INDICES}",
                    placed.name,
                    flat.vertices.len(),
                    flat.indices.len()
                );
                return Err(SceneError::TooLarge { file: self.name.clone(), problem });
            }
        }
        if flat.indices.is_empty() && !self.may_be_empty {
            let repairs = [&self.repairs[..], &stage.repairs].concat();
            return Err(SceneError::Empty { file: self.name.clone(), repairs });
        }
        Ok(Flattened { stage, flat })
    }

    /// Returns the flat scene.
    pub(crate) fn finish(self, flattened: Flattened) -> Scene {
        let Flattened { stage: Stage { origin, motion, camera, lights, cameras, repairs }, flat } = flattened;
        let mut repairs = [self.repairs, repairs].concat();
        let shines = self.environment.as_ref().is_some_and(|environment| !environment.is_black());
        if lights.is_empty() && !shines && !self.materials.iter().any(Material::is_emissive) {
            repairs.push("there are no lights, and nothing emits: all is black".into());
        }
        if origin != DVec3::ZERO {
            let (DVec3 { x, y, z }, far) = (origin, origin.length());
            repairs.push(format!(
                "the scene lies {far:.0} m from the origin of its file: it is rendered around ({x}, {y}, {z})"
            ));
        }
        let mut scene = Scene {
            bounds: (Vec3::ZERO, Vec3::ZERO),
            dense_extent: 0.0,
            origin,
            name: self.name,
            about: self.about,
            vertices: flat.vertices,
            indices: flat.indices,
            instances: flat.instances,
            materials: self.materials,
            textures: self.textures,
            lights,
            environment: self.environment,
            camera: Camera::framing(Vec3::ZERO, Vec3::ZERO),
            cameras: cameras.iter().map(|(name, camera, _)| (name.clone(), *camera)).collect(),
            frames_per_second: self.frames_per_second.unwrap_or(30.0),
            duration: self.duration,
            repairs,
            spec: self.spec,
            files: self.files,
            hash: 0,
            motion,
        };
        scene.bounds = bounds(&scene);
        scene.dense_extent = dense_extent(&scene.vertices, &scene.indices, &scene.instances, scene.extent());
        scene.camera = match (camera, cameras.first()) {
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
        let extent = scene.extent();
        let near = if extent > 0.0 { extent * 1e-4 } else { 1e-3 };
        let cameras = scene.cameras.iter_mut().map(|(_, camera)| camera).chain([&mut scene.camera]);
        cameras.filter(|camera| camera.near <= 0.0).for_each(|camera| camera.near = near);
        // Animated values at 0 s come from their tracks.
        let start = scene.at(0.0);
        (scene.camera, scene.lights) = (start.camera, start.lights);
        if scene.camera.position == scene.camera.target {
            let message = "the camera's position and target are too near each other: it looks along −z";
            scene.repairs.push(message.into());
        }
        scene.repairs.extend(units::suspects(&scene));
        scene.hash = hash::scene(&scene);
        scene
    }
}

impl Stage {
    /// Adds the cameras and the lights of models, at their nodes.
    pub(crate) fn add_from_models(&mut self, assembly: &Assembly) {
        let worlds = self.motion.worlds(0.0);
        for NodeCamera { name, node, vertical_fov, near } in &assembly.cameras {
            let camera = camera_at_node(&worlds[*node], *vertical_fov, *near);
            if camera.position.is_finite() && camera.target.is_finite() {
                self.cameras.push((name.clone(), camera, *node));
            } else {
                self.repairs.push(format!("camera `{name}` is left out: its place is not finite"));
            }
        }
        for NodeLight { name, node, kind, intensity } in &assembly.lights {
            let (position, direction) = place_and_direction(&worlds[*node]);
            if !position.is_finite() || !intensity.is_finite() {
                self.repairs
                    .push(format!("light `{name}` is left out: its place or intensity is not finite"));
                continue;
            }
            let name = if name.is_empty() { format!("light {}", self.lights.len()) } else { name.clone() };
            self.lights.push(Light { name, kind: *kind, position, direction, intensity: *intensity });
            self.motion.lights.push(Driver { node: Some(*node), ..Driver::default() });
        }
    }
}

/// A stage whose vertices are known at 0 s.
pub(crate) struct Flattened {
    stage: Stage,
    flat: Flat,
}

impl Flattened {
    /// Returns the origin, and the box around all triangles at 0 s, relative to it; zero if there are none.
    pub(crate) fn still_bounds(&self) -> (DVec3, (Vec3, Vec3)) {
        let Flat { vertices, indices, .. } = &self.flat;
        (self.stage.origin, box_around(vertices, &used(vertices, indices)).unwrap_or_default())
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
        let mesh = &placed.model.meshes[placed.mesh];
        let shape = Shape::new(mesh);
        let placement = motion.placement(placed.node, 0.0, worlds);
        let mirrors = shape.mirrors(&placement);
        let mut posed = shape.posed(&placement, mirrors).into_iter();
        let mut dropped = 0;
        for primitive in &mesh.primitives {
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
