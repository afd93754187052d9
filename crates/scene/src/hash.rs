//! A hash of everything in a scene that can change a picture. It is computed from the data itself, and so is
//! the same on every machine. Names are left out, since they do not change pictures.

use bytemuck::{Pod, bytes_of, cast_slice};
use glam::{Affine3A, DVec3, Quat, Vec3};
use xxhash_rust::xxh3::Xxh3;

use crate::animation::{Between, Outside, Track};
use crate::camera::Camera;
use crate::light::{Light, LightKind};
use crate::material::{Encoding, Material, Texture, Wrap};
use crate::model::{Morph, Node, NodeAnimation, Skin, Transform};
use crate::scene::{Driver, Motion, MovingMesh, Scene};

/// Returns the hash of a scene.
pub(crate) fn scene(scene: &Scene) -> u128 {
    let mut hash = Hash(Xxh3::new());
    hash.slice(&scene.vertices);
    hash.slice(&scene.indices);
    hash.list(&scene.materials, Hash::material);
    hash.list(&scene.textures, Hash::texture);
    hash.list(&scene.lights, Hash::light);
    hash.camera(&scene.camera);
    hash.value(scene.frames_per_second);
    let Motion { nodes, far: _, camera, lights, skins, meshes } = &scene.motion;
    hash.list(nodes, Hash::node);
    hash.driver(camera);
    hash.list(lights, Hash::driver);
    hash.list(skins, Hash::skin);
    hash.list(meshes, Hash::mesh);
    // Cameras and lights that others bring are relative to it.
    if scene.origin != DVec3::ZERO {
        hash.value(scene.origin.to_array());
    }
    hash.0.digest128()
}

/// Computes a hash. A list is preceded by its length, and an optional value by a flag.
pub(crate) struct Hash(Xxh3);

impl Hash {
    /// Adds the bytes of a value.
    pub(crate) fn value(&mut self, value: impl Pod) {
        self.0.update(bytes_of(&value));
    }

    /// Adds the bytes of all values of a list.
    pub(crate) fn slice(&mut self, values: &[impl Pod]) {
        self.length(values.len());
        self.0.update(cast_slice(values));
    }

    /// Adds each item of a list.
    pub(crate) fn list<T>(&mut self, items: &[T], add: impl Fn(&mut Hash, &T)) {
        self.length(items.len());
        items.iter().for_each(|item| add(self, item));
    }

    /// Adds the number of items of a list.
    pub(crate) fn length(&mut self, length: usize) {
        self.value(length as u64);
    }

    fn maybe<T>(&mut self, value: Option<T>, add: impl FnOnce(&mut Hash, T)) {
        self.value(u8::from(value.is_some()));
        if let Some(value) = value {
            add(self, value);
        }
    }

    fn index(&mut self, index: Option<usize>) {
        self.maybe(index, Hash::length);
    }

    fn material(&mut self, material: &Material) {
        let Material {
            name: _,
            base_color,
            base_color_texture,
            emission,
            emission_texture,
            specular,
            metallic,
            roughness,
            metallic_roughness_texture,
            normal_texture,
            normal_scale,
            alpha_cutoff,
        } = material;
        self.value(base_color.to_array());
        self.value([emission.to_array(), specular.to_array()]);
        self.value([*metallic, *roughness, *normal_scale]);
        for texture in [base_color_texture, emission_texture, metallic_roughness_texture, normal_texture] {
            self.maybe(*texture, Hash::value);
        }
        self.maybe(*alpha_cutoff, Hash::value);
    }

    fn texture(&mut self, texture: &Texture) {
        let Texture { name: _, width, height, pixels, encoding, wrap } = texture;
        self.value([*width, *height]);
        self.slice(pixels);
        self.value(match encoding {
            Encoding::Srgb => 0u8,
            Encoding::Linear => 1,
        });
        self.value(wrap.map(|wrap| match wrap {
            Wrap::Repeat => 0u8,
            Wrap::Mirror => 1,
            Wrap::Clamp => 2,
        }));
    }

    fn light(&mut self, light: &Light) {
        let Light { name: _, kind, position, direction, intensity } = light;
        match kind {
            LightKind::Spot { inner, outer } => self.value([0.0, *inner, *outer]),
            LightKind::Point => self.value(1.0f32),
            LightKind::Directional => self.value(2.0f32),
        }
        self.value([position, direction, intensity].map(|v| v.to_array()));
    }

    fn camera(&mut self, camera: &Camera) {
        let Camera { position, target, up, vertical_fov, near } = camera;
        self.value([position, target, up].map(|v| v.to_array()));
        self.value([*vertical_fov, *near]);
    }

    fn node(&mut self, node: &Node) {
        // The vertices of the mesh are hashed elsewhere.
        let Node { name: _, parent, rest, animation, mesh: _, skin, morph: Morph { rest: weights, tracks } } =
            node;
        self.index(*parent);
        self.affine(rest);
        self.maybe(animation.as_ref(), Hash::animation);
        self.index(*skin);
        self.slice(weights);
        self.list(tracks, |hash, track| hash.track(track, |weight| weight));
    }

    fn animation(&mut self, animation: &NodeAnimation) {
        let NodeAnimation { base: Transform { translation, rotation, scale }, .. } = animation;
        self.value([translation.to_array(), scale.to_array()]);
        self.value(rotation.to_array());
        self.vectors(&animation.translation);
        self.maybe(animation.rotation.as_ref(), |hash, track| {
            hash.track(track, |turn: Quat| turn.to_array());
        });
        self.vectors(&animation.scale);
    }

    fn driver(&mut self, driver: &Driver) {
        let Driver { node, position, aim, intensity } = driver;
        self.index(*node);
        [position, aim, intensity].into_iter().for_each(|track| self.vectors(track));
    }

    fn vectors(&mut self, track: &Option<Track<Vec3>>) {
        self.maybe(track.as_ref(), |hash, track| hash.track(track, |v| v.to_array()));
    }

    fn track<T: Copy, A: Pod>(&mut self, track: &Track<T>, array: impl Fn(T) -> A) {
        let Track { keys, between, outside } = track;
        self.list(keys, |hash, (time, value)| {
            hash.value(*time);
            hash.value(array(*value));
        });
        match between {
            Between::Step => self.value(0u8),
            Between::Linear => self.value(1u8),
            Between::Cubic(slopes) => {
                self.value(2u8);
                self.list(slopes, |hash, slopes| slopes.iter().for_each(|slope| hash.value(array(*slope))));
            }
        }
        match outside {
            Outside::Hold => self.maybe(None::<f32>, Hash::value),
            Outside::Repeat(period) => self.maybe(Some(*period), Hash::value),
        }
    }

    fn skin(&mut self, skin: &Skin) {
        let Skin { joints, inverse_binds } = skin;
        self.list(joints, |hash, joint| hash.length(*joint));
        self.list(inverse_binds, Hash::affine);
    }

    fn mesh(&mut self, mesh: &MovingMesh) {
        let MovingMesh { instance, node, shape, mirrors } = mesh;
        self.value(*instance);
        self.length(*node);
        self.value(u8::from(*mirrors));
        shape.hash(self);
    }

    fn affine(&mut self, affine: &Affine3A) {
        self.value(affine.to_cols_array());
    }
}
