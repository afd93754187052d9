//! The scene in the form in which a renderer uses it, and its changes over time.

use std::collections::BTreeMap;
use std::path::PathBuf;

use data_file::{LightSource, Traits, Value};
use glam::{Affine3A, DVec3, Vec3};
use serde::Serialize;

use crate::animation::Track;
use crate::camera::Camera;
use crate::emitters::cumulative;
use crate::environment::Environment;
use crate::light::{Light, LightKind};
use crate::material::{Material, Texture};
use crate::model::{Node, Skin};
use crate::origin::below;
use crate::shape::{Placement, Shape, usable};

wgsl_structs::wgsl! {
    "../../shaders/scene.wgsl" {
        pub struct Vertex;
        pub struct Emitter;
    }
}

/// One use of a mesh by a node, as ranges of the scene's arrays.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Instance {
    /// The name of the node, or of the mesh.
    pub name: String,
    /// Index of its first vertex.
    pub first_vertex: u32,
    /// Number of its vertices.
    pub vertex_count: u32,
    /// Index of its first index.
    pub first_index: u32,
    /// Number of its indices; three per triangle.
    pub index_count: u32,
    /// Whether its vertices ever move.
    pub moves: bool,
}

/// A scene, flat and in world space. Everything that moves is in its state at 0 s. All places, here and in what is
/// made of a scene, are relative to [`Scene::origin`].
#[derive(Clone, Debug)]
pub struct Scene {
    /// The name of the scene, or of the file without its ending.
    pub name: String,
    /// Its summary, in one line; empty for a plain glTF file.
    pub about: String,
    /// All vertices; those of an instance are contiguous.
    pub vertices: Vec<Vertex>,
    /// Triangles, three indices each into `vertices`, in the order of the instances.
    pub indices: Vec<u32>,
    /// The instances.
    pub instances: Vec<Instance>,
    /// The materials; at least one where there are vertices.
    pub materials: Vec<Material>,
    /// The textures of the materials.
    pub textures: Vec<Texture>,
    /// The lights; without any, the scene is black unless something emits.
    pub lights: Vec<Light>,
    /// The light from infinitely far, if there is any.
    pub environment: Option<Environment>,
    /// The camera of the description, otherwise the first of the geometry file, otherwise one that sees
    /// everything.
    pub camera: Camera,
    /// All cameras of the geometry files, by name.
    pub cameras: Vec<(String, Camera)>,
    /// Frames per second, to convert frame numbers to times; 30 unless the description gives another rate.
    pub frames_per_second: f32,
    /// The time of the last key \[s\]; 0 if nothing moves.
    pub duration: f32,
    /// Repairs, omissions and assumptions of loading, one sentence each, for the user to read.
    pub repairs: Vec<String>,
    /// The name or path that was passed to [`load`](crate::load).
    pub spec: String,
    /// The place in the world of the scene's files that is (0, 0, 0) in the scene \[m\]: near geometry that lies at
    /// 0 s more than 16 of its extents from there, which `f32` would round visibly; else zero. What goes back to a file
    /// is added to it, in `f64`.
    pub origin: DVec3,
    /// The files on disk that were read, to watch for changes.
    pub files: Vec<PathBuf>,
    /// A hash of everything that can change a picture (xxh3), the same on every machine.
    pub hash: u128,
    pub(crate) bounds: (Vec3, Vec3),
    pub(crate) dense_extent: f32,
    pub(crate) motion: Motion,
}

/// The moving parts of a scene.
#[derive(Clone, Debug, Default)]
pub(crate) struct Motion {
    /// The nodes, with parents before children.
    pub(crate) nodes: Vec<Node>,
    /// Whether the scene lies far from the origin of its files.
    pub(crate) far: bool,
    pub(crate) camera: Driver,
    /// One for each light of the files.
    pub(crate) lights: Vec<Driver>,
    pub(crate) skins: Vec<Skin>,
    pub(crate) meshes: Vec<MovingMesh>,
}

/// The animation of a camera or a light: a node, and tracks of its own, which have precedence.
#[derive(Clone, Debug, Default, Serialize)]
pub(crate) struct Driver {
    pub(crate) node: Option<usize>,
    pub(crate) position: Option<Track<Vec3>>,
    /// Track of a camera's target, or of a light's direction.
    pub(crate) aim: Option<Track<Vec3>>,
    pub(crate) intensity: Option<Track<Vec3>>,
}

impl Driver {
    /// That of what does not move.
    const STILL: Driver = Driver { node: None, position: None, aim: None, intensity: None };
}

/// An instance that moves or deforms.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct MovingMesh {
    pub(crate) instance: u32,
    pub(crate) node: usize,
    #[serde(skip)]
    pub(crate) shape: Shape,
    /// Whether the winding of its triangles is opposite to that in its mesh.
    pub(crate) mirrors: bool,
}

/// The state of a scene at one time. (It is the pose of the whole scene, not of a skeleton.)
#[derive(Clone, Debug, PartialEq)]
pub struct Pose {
    /// The time \[s\].
    pub time: f32,
    /// The camera at this time.
    pub camera: Camera,
    /// The lights at this time, in the order of [`Scene::lights`].
    pub lights: Vec<Light>,
    /// The vertices of every instance that ever moves.
    pub moved: Vec<MovedVertices>,
    /// Each node's space to world space.
    worlds: Vec<Affine3A>,
}

/// Vertices that replace a range of [`Scene::vertices`].
#[derive(Clone, Debug, PartialEq)]
pub struct MovedVertices {
    /// Index of the first vertex that is replaced.
    pub first_vertex: u32,
    /// The new vertices; only position and normal differ.
    pub vertices: Vec<Vertex>,
}

/// The differences between two times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// Whether the camera differs.
    pub camera: bool,
    /// Whether any light differs.
    pub lights: bool,
    /// Whether any vertex differs.
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

    /// Overwrites a light; allocates nothing if that has the same name.
    fn put_into(self, held: &mut Light) {
        held.name.clone_from(&self.rest.name);
        held.kind = self.rest.kind;
        (held.position, held.direction, held.intensity) = (self.position, self.direction, self.intensity);
    }
}

impl Scene {
    /// Returns the state of the scene at `time` \[s\]. The first and last keys of a scene file hold outside
    /// their range unless it sets `repeat`; the animation of a glTF file repeats. Meshes follow their nodes,
    /// or are deformed by morph targets, then by the joints of their skins. What does not move is skipped.
    pub fn at(&self, time: f32) -> Pose {
        let (lights, moved, worlds) = (Vec::new(), Vec::new(), Vec::new());
        let mut pose = Pose { time, camera: self.camera, lights, moved, worlds };
        self.pose(time, &mut pose);
        pose
    }

    /// Writes the state of the scene at `time` \[s\] into an existing pose, and reuses its memory: see
    /// [`Scene::at`]. Allocates nothing if nothing moves and the pose was one of this scene.
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

    /// Returns the differences between two times, without computing vertices.
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

    /// Returns the time of frame number `frame` \[s\].
    pub fn frame_time(&self, frame: u32) -> f32 {
        frame as f32 / self.frames_per_second
    }

    /// Returns the number of triangles.
    pub fn triangles(&self) -> usize {
        self.indices.len() / 3
    }

    /// Returns the minimum and the maximum corner of the box around all triangles \[m\]; both are zero if
    /// there are none. For moving triangles, it contains their positions at 65 times from 0 s to the end of
    /// the animation.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        self.bounds
    }

    /// Returns the diagonal of [`Scene::bounds`] \[m\], to which tolerances are proportional.
    pub fn extent(&self) -> f32 {
        let (min, max) = self.bounds();
        (max - min).length()
    }

    /// Returns the area of all triangles at 0 s, each counted once \[m²\].
    pub fn area(&self) -> f64 {
        self.areas().sum()
    }

    /// Returns the area of each triangle at 0 s \[m²\].
    pub(crate) fn areas(&self) -> impl Iterator<Item = f64> {
        self.indices.chunks_exact(3).map(|triangle| {
            let [a, b, c] =
                [0, 1, 2].map(|i| Vec3::from(self.vertices[triangle[i] as usize].position).as_dvec3());
            0.5 * (b - a).cross(c - a).length()
        })
    }

    /// Returns the cumulative areas of the triangles at 0 s in fixed point, for sampling triangles in
    /// proportion to their area: `triangles + 1` entries, of which the first is 0, and entry i is the area of
    /// the first i triangles divided by the whole area, times 2³², rounded, and at most `u32::MAX`.
    ///
    /// For a random number u in 0..2³², triangle i is sampled if `table[i] <= u < table[i + 1]`; triangles
    /// without area are never sampled. If the whole area is 0, all triangles are equally likely.
    pub fn area_table(&self) -> Vec<u32> {
        let areas: Vec<f64> = self.areas().collect();
        if areas.iter().any(|area| *area > 0.0) {
            cumulative(&areas)
        } else {
            cumulative(&vec![1.0; areas.len()])
        }
    }

    /// Returns where searches in an [area table](Scene::area_table) begin and end: a guide table (Chen & Asau 1974) of
    /// 2^b + 1 entries, where b is the binary logarithm of the number of triangles, from 1 to 20. Entry i is the triangle
    /// that the number i · 2^(32 - b) samples, and the last is the last triangle; without triangles, all are 0.
    pub fn area_guide(table: &[u32]) -> Vec<u32> {
        let last = table.len().saturating_sub(2);
        let bits = (last + 1).max(2).ilog2().min(20);
        let mut triangle = 0;
        let of_number = |number: u32| {
            while triangle < last && table[triangle + 1] <= number {
                triangle += 1;
            }
            triangle as u32
        };
        let entries: Vec<u32> = (0..1 << bits).map(|i: u32| i << (32 - bits)).map(of_number).collect();
        [entries, vec![last as u32]].concat()
    }

    /// Returns the traits of the scene, for the switches of a pipeline. Booleans are `textured`, `glossy`,
    /// `emissive`,
    /// `masked`, `normal_mapped` (of the materials that triangles have), `environment`, `moving_camera`, `moving_lights`,
    /// `moving_geometry`; integers `lights`, `spot_lights`, `point_lights`, `directional_lights`, `light_layers`
    /// (the sum of [`Light::layers`]), `triangles`.
    pub fn traits(&self) -> Traits {
        self.traits_with(&self.lights)
    }

    /// Returns whether any triangle moves.
    pub fn has_moving_geometry(&self) -> bool {
        !self.motion.meshes.is_empty()
    }

    /// Returns the traits of the scene with `lights` in place of its own.
    pub fn traits_with(&self, lights: &[Light]) -> Traits {
        let mut used = vec![false; self.materials.len()];
        self.indices.iter().for_each(|i| used[self.vertices[*i as usize].material as usize] = true);
        let any = |is: fn(&Material) -> bool| {
            Value::Bool(self.materials.iter().zip(&used).any(|(material, used)| *used && is(material)))
        };
        let count = |is: fn(&LightKind) -> bool| {
            Value::U32(lights.iter().filter(|light| is(&light.kind)).count() as u32)
        };
        let values = BTreeMap::from(
            [
                ("textured", any(Material::is_textured)),
                ("glossy", any(Material::is_glossy)),
                ("emissive", any(Material::is_emissive)),
                ("masked", any(|m| m.alpha_cutoff.is_some())),
                ("normal_mapped", any(|m| m.normal_texture.is_some())),
                ("environment", Value::Bool(self.environment.as_ref().is_some_and(|e| !e.is_black()))),
                ("moving_camera", Value::Bool(self.motion.moves(&self.motion.camera))),
                ("moving_lights", Value::Bool(self.motion.lights.iter().any(|l| self.motion.moves(l)))),
                ("moving_geometry", Value::Bool(self.has_moving_geometry())),
                ("lights", count(|_| true)),
                ("spot_lights", count(|kind| matches!(kind, LightKind::Spot { .. }))),
                ("point_lights", count(|kind| matches!(kind, LightKind::Point))),
                ("directional_lights", count(|kind| matches!(kind, LightKind::Directional))),
                ("light_layers", Value::U32(lights.iter().map(Light::layers).sum())),
                ("triangles", Value::U32(self.triangles() as u32)),
                // Until an adapter is known.
                ("ray_queries", Value::Bool(false)),
            ]
            .map(|(name, value)| (name.to_string(), value)),
        );
        let emitting = self.materials.iter().zip(&used);
        let emitting = emitting.filter(|(material, used)| **used && material.is_emissive());
        let emitting = emitting.map(|(material, _)| (&material.name, 0));
        let sources = lights.iter().map(|light| (&light.name, light.layers())).chain(emitting);
        let sources = sources.map(|(name, layers)| LightSource { name: name.clone(), layers }).collect();
        Traits { values, sources }
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
        // Lights that were put into the scene after it was loaded have no driver.
        let drivers = self.motion.lights.iter().chain(std::iter::repeat(&Driver::STILL));
        self.lights.iter().zip(drivers).map(move |(rest, driver)| {
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
            // A cubic track can fall below zero between its keys.
            let intensity = driver.intensity.as_ref().map_or(light.intensity, |track| track.at(time));
            light.intensity = intensity.max(Vec3::ZERO);
            let finite = light.position.is_finite() && light.direction.is_finite();
            if finite { light } else { still }
        })
    }

    /// Returns the vertices of every instance that moves.
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
    /// Returns the transform from each node's space to world space at `time` \[s\].
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
            worlds.push(match node.parent {
                Some(parent) if self.far => below(&worlds[parent], &local),
                Some(parent) => worlds[parent] * local,
                None => local,
            });
        }
    }

    /// Returns the placement of a node's mesh at `time` \[s\], given the transforms of all nodes at that
    /// time.
    pub(crate) fn placement(&self, node: usize, time: f32, worlds: &[Affine3A]) -> Placement {
        let weights = self.nodes[node].morph.at(time);
        match self.nodes[node].skin.map(|skin| &self.skins[skin]) {
            // glTF 2.0, §3.7.3.3: the transform of the node of a skinned mesh is ignored.
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

    /// Returns whether the mesh of a node is ever placed or deformed otherwise than at 0 s.
    pub(crate) fn mesh_moves(&self, node: usize) -> bool {
        let Node { skin, morph, .. } = &self.nodes[node];
        morph.tracks.iter().any(Track::moves)
            || match skin {
                Some(skin) => self.skins[*skin].joints.iter().any(|joint| self.node_moves(*joint)),
                None => self.node_moves(node),
            }
    }

    /// Returns whether a node ever has another transform than at 0 s.
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

/// Returns the position of a node, and its −z axis.
pub(crate) fn place_and_direction(world: &Affine3A) -> (Vec3, Vec3) {
    (world.translation.into(), Vec3::from(-world.matrix3.z_axis).normalize_or(Vec3::NEG_Z))
}

pub(crate) fn camera_at_node(world: &Affine3A, vertical_fov: f32, near: f32) -> Camera {
    let (position, direction) = place_and_direction(world);
    let up = Vec3::from(world.matrix3.y_axis).normalize_or(Vec3::Y);
    Camera { position, target: position + direction, up, vertical_fov, near }
}
