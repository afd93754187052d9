//! Reads the keys of a scene file.

use super::{CameraKey, LightKey};
use crate::description::{Keys, parse};
use crate::error::SceneError;
use data_file::Source;
use glam::{DVec3, Vec3};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// The keys of a scene file, by rising times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneKeys {
    /// The keys of the camera.
    pub camera: Vec<CameraKey>,
    /// The keys of lights, by name.
    pub lights: BTreeMap<String, Vec<LightKey>>,
}

/// Returns the keys of the scene file at `path`, with places relative to the [`Scene::origin`](crate::Scene::origin) of
/// the scene that it makes; a key has what the file sets at its time.
///
/// # Errors
/// A file that cannot be read, and all its errors.
pub fn keys_of(path: &Path, origin: DVec3) -> Result<SceneKeys, SceneError> {
    let text =
        fs::read_to_string(path).map_err(|error| SceneError::Unreadable { path: path.into(), error })?;
    let keyframes = parse(&Source::new(path.display().to_string(), text), None, origin)?.keyframes;
    let Some(keyframes) = keyframes else { return Ok(SceneKeys::default()) };
    let camera = keyframes.camera.map(|camera| camera.value);
    let camera = camera.map_or_else(Vec::new, |keys| {
        let times = times(&[&keys.position, &keys.target]);
        let key = |time: &f32| CameraKey {
            time: *time,
            position: at(&keys.position, *time),
            target: at(&keys.target, *time),
        };
        times.iter().map(key).collect()
    });
    let lights = keyframes.lights.into_iter().map(|(name, keys)| {
        let times = times(&[&keys.position, &keys.direction, &keys.intensity]);
        let key = |time: &f32| LightKey {
            time: *time,
            position: at(&keys.position, *time),
            direction: at(&keys.direction, *time),
            intensity: at(&keys.intensity, *time),
        };
        (name.value, times.iter().map(key).collect())
    });
    Ok(SceneKeys { camera, lights: lights.collect() })
}

/// Returns the times of some channels, each once, in rising order.
fn times(channels: &[&Keys<Vec3>]) -> Vec<f32> {
    let mut times: Vec<f32> =
        channels.iter().flat_map(|channel| channel.iter().map(|(time, _)| *time)).collect();
    times.sort_by(f32::total_cmp);
    times.dedup();
    times
}

fn at(channel: &Keys<Vec3>, time: f32) -> Option<Vec3> {
    channel.iter().find(|(known, _)| *known == time).map(|(_, value)| *value)
}
