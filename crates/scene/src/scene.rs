//! The scene as it is handed to a renderer, and what changes in it with time.

use std::collections::BTreeMap;
use std::path::PathBuf;

use bytemuck::{Pod, Zeroable};
use data_file::{Traits, Value};
use glam::{Affine3A, Vec3};

use crate::animation::Track;
use crate::camera::Camera;
use crate::light::{Light, LightKind};
use crate::material::{Material, Texture};
use crate::model::{Node, Skin};
use crate::shape::{Placement, Shape, usable};

/// A vertex, as it is uploaded: 48 bytes, in world space. It belongs to one instance and one material.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Vertex {
    /// Position \[m\]; finite.
    pub position: [f32; 3],
    /// Index into [`Scene::materials`].
    pub material: u32,
    /// Shading normal, of length 1, on the side from which the triangle winds counter-clockwise.
    pub normal: [f32; 3],
    /// Index into [`Scene::instances`].
    pub instance: u32,
    /// Texture coordinates; v grows downwards, as rows do.
    pub uv: [f32; 2],
    /// Unused; zero.
    pub pad: [f32; 2],
}

/// One use of a mesh by a node: ranges of the scene's arrays.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Instance {
    /// The node's name, or the mesh's.
    pub name: String,
    /// First of its vertices.
    pub first_vertex: u32,
    /// How many.
    pub vertex_count: u32,
    /// First of its indices.
    pub first_index: u32,
    /// How many; three a triangle.
    pub index_count: u32,
    /// Whether its vertices are at other places at some times.
    pub moves: bool,
}

/// A scene, flat and in world space. All that can move is as it is at 0 s.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The name of the scene, or the file's without its ending.
    pub name: String,
    /// What it shows, in a line; empty for a bare glTF file.
    pub about: String,
    /// All vertices; those of an instance are neighbours.
    pub vertices: Vec<Vertex>,
    /// Triangles, three indices each into `vertices`, in the order of the instances.
    pub indices: Vec<u32>,
    /// The instances.
    pub instances: Vec<Instance>,
    /// The materials; at least one where there are vertices.
    pub materials: Vec<Material>,
    /// The textures of the materials.
    pub textures: Vec<Texture>,
    /// The lights; a scene without any is black unless something emits.
    pub lights: Vec<Light>,
    /// The camera of the description, else the file's first, else one that sees everything.
    pub camera: Camera,
    /// All cameras of the geometry files, by name.
    pub cameras: Vec<(String, Camera)>,
    /// Frames per second, for turning the number of a frame into a time; 30 unless the description says.
    pub frames_per_second: f32,
    /// The time of the last key \[s\]; 0 where nothing moves.
    pub duration: f32,
    /// What was repaired, left out or assumed, a sentence each, for the user to read.
    pub repairs: Vec<String>,
    /// What it was loaded by: the name or path that [`load`](crate::load) took.
    pub spec: String,
    /// The files on disk that were read: those to watch.
    pub files: Vec<PathBuf>,
    /// A hash of all that can change a picture (xxh3), the same on every machine.
    pub hash: u128,
    pub(crate) bounds: (Vec3, Vec3),
    pub(crate) motion: Motion,
}

/// What moves, and how.
#[derive(Clone, Debug, Default)]
pub(crate) struct Motion {
    /// Parents before children.
    pub(crate) nodes: Vec<Node>,
    pub(crate) camera: Driver,
    /// As many as lights.
    pub(crate) lights: Vec<Driver>,
    pub(crate) skins: Vec<Skin>,
    pub(crate) meshes: Vec<MovingMesh>,
}

/// What moves a camera or a light: a node, then tracks of its own, which win.
#[derive(Clone, Debug, Default)]
pub(crate) struct Driver {
    pub(crate) node: Option<usize>,
    pub(crate) position: Option<Track<Vec3>>,
    /// A camera's target, a light's direction.
    pub(crate) aim: Option<Track<Vec3>>,
    pub(crate) intensity: Option<Track<Vec3>>,
}

/// An instance that moves or deforms.
#[derive(Clone, Debug)]
pub(crate) struct MovingMesh {
    pub(crate) instance: u32,
    pub(crate) node: usize,
    pub(crate) shape: Shape,
    /// Whether its triangles wind the other way than in its mesh.
    pub(crate) mirrors: bool,
}

/// The scene at one time. (A whole scene's pose, not a skeleton's.)
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// When \[s\].
    pub time: f32,
    /// The camera then.
    pub camera: Camera,
    /// The lights then, in the order of [`Scene::lights`].
    pub lights: Vec<Light>,
    /// The vertices of every instance that moves at some time.
    pub moved: Vec<MovedVertices>,
    /// Each node's space to world space.
    worlds: Vec<Affine3A>,
}

/// Vertices that replace a range of [`Scene::vertices`].
#[derive(Clone, Debug, PartialEq)]
pub struct MovedVertices {
    /// The first that is replaced.
    pub first_vertex: u32,
    /// The new ones; only position and normal differ.
    pub vertices: Vec<Vertex>,
}

/// What differs between two times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// The camera.
    pub camera: bool,
    /// Any light.
    pub lights: bool,
    /// Any vertex.
    pub geometry: bool,
}

/// A light at one time, without a copy of its name.
#[derive(Clone, Copy, PartialEq)]
struct PosedLight<'a> {
    /// The light at rest.
    rest: &'a Light,
    position: Vec3,
    direction: Vec3,
    intensity: Vec3,
}

impl PosedLight<'_> {
    fn to_light(self) -> Light {
        let PosedLight { rest, position, direction, intensity } = self;
        Light { name: rest.name.clone(), kind: rest.kind, position, direction, intensity }
    }

    /// Overwrites a light, and allocates nothing where that has the same name.
    fn put_into(self, held: &mut Light) {
        held.name.clone_from(&self.rest.name);
        held.kind = self.rest.kind;
        (held.position, held.direction, held.intensity) = (self.position, self.direction, self.intensity);
    }
}

impl Scene {
    /// Returns the scene at `time` \[s\]. Keys of a scene file hold outside their range unless it says `repeat`; the
    /// animation of a glTF file repeats. Meshes follow their nodes, or are bent by morph targets, then by their skins'
    /// joints. Skips what does not move.
    pub fn at(&self, time: f32) -> Pose {
        let (lights, moved, worlds) = (Vec::new(), Vec::new(), Vec::new());
        let mut pose = Pose { time, camera: self.camera, lights, moved, worlds };
        self.pose(time, &mut pose);
        pose
    }

    /// Puts the scene at `time` \[s\] into a pose, whatever that was of, and uses its memory again: see [`Scene::at`].
    /// Allocates nothing where nothing moves and the pose was of this scene.
    pub fn pose(&self, time: f32, pose: &mut Pose) {
        self.motion.put_worlds(time, &mut pose.worlds);
        let worlds = &pose.worlds;
        pose.time = time;
        pose.camera = self.camera_at(time, worlds);
        pose.lights.truncate(self.lights.len());
        for (i, light) in self.lights_at(time, worlds).enumerate() {
            match pose.lights.get_mut(i) {
                Some(held) => light.put_into(held),
                None => pose.lights.push(light.to_light()),
            }
        }
        pose.moved.clear();
        pose.moved.extend(self.moved_at(time, worlds));
    }

    /// Returns what differs between two times, without making vertices.
    pub fn changes(&self, from: f32, to: f32) -> Changes {
        let (a, b) = (self.motion.worlds(from), self.motion.worlds(to));
        Changes {
            camera: self.camera_at(from, &a) != self.camera_at(to, &b),
            lights: self.lights_at(from, &a).ne(self.lights_at(to, &b)),
            geometry: self.motion.meshes.iter().any(|mesh| {
                self.motion.placement(mesh.node, from, &a) != self.motion.placement(mesh.node, to, &b)
            }),
        }
    }

    /// Returns the time at which frame number `frame` is \[s\].
    pub fn frame_time(&self, frame: u32) -> f32 {
        frame as f32 / self.frames_per_second
    }

    /// Returns how many triangles there are.
    pub fn triangles(&self) -> usize {
        self.indices.len() / 3
    }

    /// Returns the least and the greatest corner of the box around all triangles \[m\]; both zero where there are none.
    /// What moves counts wherever it is at 65 times from 0 s to the end of the movement.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        self.bounds
    }

    /// Returns the diagonal of [`Scene::bounds`] \[m\]: the scale that tolerances go by.
    pub fn extent(&self) -> f32 {
        let (min, max) = self.bounds();
        (max - min).length()
    }

    /// Returns the area of all triangles at 0 s, each counted once \[m²\].
    pub fn area(&self) -> f64 {
        self.areas().sum()
    }

    /// The area of each triangle at 0 s \[m²\].
    fn areas(&self) -> impl Iterator<Item = f64> {
        self.indices.chunks_exact(3).map(|triangle| {
            let [a, b, c] =
                [0, 1, 2].map(|i| Vec3::from(self.vertices[triangle[i] as usize].position).as_dvec3());
            0.5 * (b - a).cross(c - a).length()
        })
    }

    /// Returns the running sum of the triangles' areas at 0 s in fixed point, for drawing triangles in proportion to
    /// their area: `triangles + 1` entries, the first 0, entry i the area of the first i triangles over the whole area,
    /// times 2³², rounded, and at most `u32::MAX`.
    ///
    /// For a random number u in 0..2³², triangle i is drawn where `table[i] <= u < table[i + 1]`; triangles
    /// without area are never drawn. Where the whole area is 0, every triangle counts alike.
    pub fn area_table(&self) -> Vec<u32> {
        let total = self.area();
        let count = self.triangles() as f64;
        let mut sum = 0.0;
        std::iter::once(0)
            .chain(self.areas().map(|area| {
                sum += if total > 0.0 { area / total } else { 1.0 / count };
                // `as` saturates at u32::MAX, which the last entry is to be.
                (sum * 4_294_967_296.0).round() as u32
            }))
            .collect()
    }

    /// Returns what the scene holds, for the switches of a pipeline. Booleans `textured`, `glossy`, `emissive`,
    /// `masked` (of the materials that triangles have), `environment`, `moving_camera`, `moving_lights`,
    /// `moving_geometry`; integers `lights`, `spot_lights`, `point_lights`, `directional_lights`, `light_layers`
    /// (the sum of [`Light::layers`]), `triangles`.
    pub fn traits(&self) -> Traits {
        self.traits_with(&self.lights)
    }

    /// Returns the traits that the scene has with `lights` in place of its own.
    pub fn traits_with(&self, lights: &[Light]) -> Traits {
        let mut used = vec![false; self.materials.len()];
        self.indices.iter().for_each(|i| used[self.vertices[*i as usize].material as usize] = true);
        let any = |is: fn(&Material) -> bool| {
            Value::Bool(self.materials.iter().zip(&used).any(|(material, used)| *used && is(material)))
        };
        let count = |is: fn(&LightKind) -> bool| {
            Value::U32(lights.iter().filter(|light| is(&light.kind)).count() as u32)
        };
        Traits(BTreeMap::from(
            [
                ("textured", any(Material::is_textured)),
                ("glossy", any(Material::is_glossy)),
                ("emissive", any(Material::is_emissive)),
                ("masked", any(|m| m.alpha_cutoff.is_some())),
                ("environment", Value::Bool(false)),
                ("moving_camera", Value::Bool(self.motion.moves(&self.motion.camera))),
                ("moving_lights", Value::Bool(self.motion.lights.iter().any(|l| self.motion.moves(l)))),
                ("moving_geometry", Value::Bool(!self.motion.meshes.is_empty())),
                ("lights", count(|_| true)),
                ("spot_lights", count(|kind| matches!(kind, LightKind::Spot { .. }))),
                ("point_lights", count(|kind| matches!(kind, LightKind::Point))),
                ("directional_lights", count(|kind| matches!(kind, LightKind::Directional))),
                ("light_layers", Value::U32(lights.iter().map(Light::layers).sum())),
                ("triangles", Value::U32(self.triangles() as u32)),
            ]
            .map(|(name, value)| (name.to_string(), value)),
        ))
    }

    fn camera_at(&self, time: f32, worlds: &[Affine3A]) -> Camera {
        let driver = &self.motion.camera;
        let mut camera = self.camera;
        if let Some(world) = driver.node.and_then(|node| worlds.get(node)) {
            camera = camera_at_node(world, camera.vertical_fov, camera.near);
        }
        camera.position = driver.position.as_ref().map_or(camera.position, |track| track.at(time));
        camera.target = driver.aim.as_ref().map_or(camera.target, |track| track.at(time));
        let finite = camera.position.is_finite() && camera.target.is_finite() && camera.up.is_finite();
        if finite { camera } else { self.camera }
    }

    fn lights_at<'a>(
        &'a self,
        time: f32,
        worlds: &'a [Affine3A],
    ) -> impl Iterator<Item = PosedLight<'a>> + 'a {
        let pairs = self.lights.iter().zip(&self.motion.lights);
        pairs.map(move |(rest, driver)| {
            let still = PosedLight {
                rest,
                position: rest.position,
                direction: rest.direction,
                intensity: rest.intensity,
            };
            let mut light = still;
            if let Some(world) = driver.node.and_then(|node| worlds.get(node)) {
                (light.position, light.direction) = place_and_direction(world);
            }
            light.position = driver.position.as_ref().map_or(light.position, |track| track.at(time));
            if let Some(track) = &driver.aim {
                light.direction = track.at(time).normalize_or(light.direction);
            }
            // A cubic track can dip below zero between its keys.
            let intensity = driver.intensity.as_ref().map_or(light.intensity, |track| track.at(time));
            light.intensity = intensity.max(Vec3::ZERO);
            let finite = light.position.is_finite() && light.direction.is_finite();
            if finite { light } else { still }
        })
    }

    /// The vertices of every instance that moves.
    pub(crate) fn moved_at(&self, time: f32, worlds: &[Affine3A]) -> impl Iterator<Item = MovedVertices> {
        self.motion.meshes.iter().map(move |mesh| {
            let first_vertex = self.instances[mesh.instance as usize].first_vertex;
            let rest = &self.vertices[first_vertex as usize..][..mesh.shape.len()];
            let posed = mesh.shape.posed(&self.motion.placement(mesh.node, time, worlds), mesh.mirrors);
            let vertices = rest.iter().zip(posed).map(|(rest, (position, normal))| {
                if !usable(position) {
                    return *rest;
                }
                Vertex { position: position.into(), normal: normal.into(), ..*rest }
            });
            MovedVertices { first_vertex, vertices: vertices.collect() }
        })
    }
}

impl Motion {
    /// Each node's space to world space at `time` \[s\].
    pub(crate) fn worlds(&self, time: f32) -> Vec<Affine3A> {
        let mut worlds = Vec::with_capacity(self.nodes.len());
        self.put_worlds(time, &mut worlds);
        worlds
    }

    /// Puts what [`Motion::worlds`] returns in place of what `worlds` holds.
    fn put_worlds(&self, time: f32, worlds: &mut Vec<Affine3A>) {
        worlds.clear();
        for node in &self.nodes {
            let local = node.local(time);
            worlds.push(node.parent.map_or(local, |parent| worlds[parent] * local));
        }
    }

    /// Where the mesh of a node is at `time` \[s\], given all nodes' places then.
    pub(crate) fn placement(&self, node: usize, time: f32, worlds: &[Affine3A]) -> Placement {
        let weights = self.nodes[node].morph.at(time);
        match self.nodes[node].skin.map(|skin| &self.skins[skin]) {
            // glTF 2.0, §3.7.3.3: the transform of a skinned mesh's own node counts for nothing.
            Some(skin) => Placement {
                world: Affine3A::IDENTITY,
                joints: skin
                    .joints
                    .iter()
                    .zip(&skin.inverse_binds)
                    .map(|(j, bind)| worlds[*j] * *bind)
                    .collect(),
                weights,
            },
            None => Placement { world: worlds[node], joints: Vec::new(), weights },
        }
    }

    /// Whether the mesh of a node is ever elsewhere, or bent otherwise, than at 0 s.
    pub(crate) fn mesh_moves(&self, node: usize) -> bool {
        let Node { skin, morph, .. } = &self.nodes[node];
        morph.tracks.iter().any(Track::moves)
            || match skin {
                Some(skin) => self.skins[*skin].joints.iter().any(|joint| self.node_moves(*joint)),
                None => self.node_moves(node),
            }
    }

    /// Whether a node is ever elsewhere than at 0 s.
    pub(crate) fn node_moves(&self, mut node: usize) -> bool {
        loop {
            if let Some(animation) = &self.nodes[node].animation {
                let turns = animation.rotation.as_ref().is_some_and(Track::moves);
                if turns || [&animation.translation, &animation.scale].into_iter().flatten().any(Track::moves)
                {
                    return true;
                }
            }
            match self.nodes[node].parent {
                Some(parent) => node = parent,
                None => return false,
            }
        }
    }

    pub(crate) fn moves(&self, driver: &Driver) -> bool {
        driver.node.is_some_and(|node| self.node_moves(node))
            || [&driver.position, &driver.aim, &driver.intensity].into_iter().flatten().any(Track::moves)
    }
}

/// Where a node is, and its −z axis.
pub(crate) fn place_and_direction(world: &Affine3A) -> (Vec3, Vec3) {
    (world.translation.into(), Vec3::from(-world.matrix3.z_axis).normalize_or(Vec3::NEG_Z))
}

pub(crate) fn camera_at_node(world: &Affine3A, vertical_fov: f32, near: f32) -> Camera {
    let (position, direction) = place_and_direction(world);
    let up = Vec3::from(world.matrix3.y_axis).normalize_or(Vec3::Y);
    Camera { position, target: position + direction, up, vertical_fov, near }
}
