//! Hashes everything in a scene that can change a picture: from the data itself, so that the hash is the same on every
//! machine. `#[serde(skip)]` leaves out names, which change no picture, and long lists, which are added as bytes.

use bytemuck::{Pod, cast_slice};
use serde::Serialize;
use xxhash_rust::xxh3::Xxh3;

use crate::scene::Scene;

/// Returns the hash of a scene.
pub(crate) fn scene(scene: &Scene) -> u128 {
    let (mut hash, motion) = (Hash(Xxh3::new()), &scene.motion);
    hash.slice(&scene.vertices);
    hash.slice(&scene.indices);
    scene.textures.iter().for_each(|texture| hash.slice(&texture.pixels));
    motion.meshes.iter().for_each(|mesh| mesh.shape.hash(&mut hash));
    hash.value(&(&scene.materials, &scene.textures, &scene.lights, &scene.camera, scene.frames_per_second));
    hash.value(&(&motion.nodes, &motion.camera, &motion.lights, &motion.skins, &motion.meshes));
    if let Some(environment) = &scene.environment {
        hash.slice(environment.texels.as_flattened());
        hash.value(environment);
    }
    // Cameras and lights from elsewhere are relative to it.
    hash.value(&scene.origin);
    hash.0.digest128()
}

/// Computes a hash. Everything added is preceded by its length.
pub(crate) struct Hash(Xxh3);

impl Hash {
    /// Adds a value as JSON, which has the shortest digits that read as the same numbers.
    pub(crate) fn value(&mut self, value: &impl Serialize) {
        let json = serde_json::to_vec(value);
        self.slice(&json.expect("structs and lists of numbers can be written as JSON"));
    }

    /// Adds the bytes of all values of a list.
    pub(crate) fn slice(&mut self, values: &[impl Pod]) {
        self.0.update(&(values.len() as u64).to_le_bytes());
        self.0.update(cast_slice(values));
    }
}
