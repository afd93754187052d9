//! The record of how a picture was rendered: enough to render it again, and to say what differs.

use crate::{RenderError, Renderer};
use frame_graph::{Overrides, Value};
use metrics::decode::MAX_SIDE;
use metrics::{Display, FileFormat};
use scene::{Camera, Light, LightKind};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The record kept with every picture, as JSON.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// Version of Lightloom.
    pub version: String,
    /// The name of the pipeline, as given.
    pub pipeline: String,
    /// Values given for parameters and settings, as on the command line.
    pub set: Vec<(String, String)>,
    /// The flattened pipeline.
    pub resolved: String,
    /// The plan's stable id.
    pub plan: String,
    /// Path and hash of the composed text of every shader.
    pub shaders: BTreeMap<String, String>,
    /// The name of the scene, as given.
    pub scene: String,
    /// Hash of everything in the scene that can change a picture.
    pub scene_hash: String,
    /// Size of the frame in pixels.
    pub size: (u32, u32),
    /// Number of the frame.
    pub frame: u32,
    /// Number of the first frame that ran.
    pub first_frame: u32,
    /// The output or resource that the picture shows.
    pub output: String,
    /// Layer of a resource that is an array.
    pub layer: u32,
    /// The run's seed.
    pub seed: u32,
    /// Adapter and driver.
    pub adapter: String,
    /// The camera, where an application replaced the scene's own. Its places are relative to the
    /// [`Scene::origin`](scene::Scene::origin), which is part of [`Provenance::scene_hash`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<Camera>,
    /// The lights, where an application replaced the scene's own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lights: Option<Vec<RecordedLight>>,
    /// The time \[s\], where an application set it: else it follows the number of the frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<f32>,
    /// The conversion of linear light to display light, in a file that holds display light.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub display: Option<Display>,
    /// The working folder, where the names of the pipeline or the scene are paths from it: from the folder of the picture
    /// if that is below, so that both can be moved, else from the root of the disk.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub folder: Option<String>,
}

/// A [`Light`] in a record: its place is relative to the [`Scene::origin`](scene::Scene::origin) of the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordedLight {
    /// [`Light::name`]
    pub name: String,
    /// Half the angles of the inner and the outer cone \[rad\], for a spot light.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cone: Option<[f32; 2]>,
    /// Whether it is a directional light; else it is a point light where it has no cone.
    #[serde(default)]
    pub directional: bool,
    /// [`Light::position`]
    pub position: [f32; 3],
    /// [`Light::direction`]
    pub direction: [f32; 3],
    /// [`Light::intensity`]
    pub intensity: [f32; 3],
}

impl From<&Light> for RecordedLight {
    fn from(light: &Light) -> RecordedLight {
        let cone = match light.kind {
            LightKind::Spot { inner, outer } => Some([inner, outer]),
            LightKind::Point | LightKind::Directional => None,
        };
        RecordedLight {
            name: light.name.clone(),
            cone,
            directional: light.kind == LightKind::Directional,
            position: light.position.into(),
            direction: light.direction.into(),
            intensity: light.intensity.into(),
        }
    }
}

impl From<&RecordedLight> for Light {
    fn from(light: &RecordedLight) -> Light {
        let kind = match (light.cone, light.directional) {
            (Some([inner, outer]), _) => LightKind::Spot { inner, outer },
            (None, true) => LightKind::Directional,
            (None, false) => LightKind::Point,
        };
        Light {
            name: light.name.clone(),
            kind,
            position: light.position.into(),
            direction: light.direction.into(),
            intensity: light.intensity.into(),
        }
    }
}

impl Provenance {
    /// Creates the record of the newest frame of a renderer. `scene` is the scene as it was named, `shown` the output
    /// or resource and its layer.
    pub fn new(renderer: &Renderer, scene: &str, shown: (&str, u32), first_frame: u32) -> Provenance {
        let loaded = renderer.pipeline.as_ref();
        let compiled = loaded.map(|loaded| &loaded.compiled);
        let set = loaded.map_or_else(Vec::new, |loaded| {
            loaded.overrides.0.iter().map(|(name, value)| (name.clone(), value.to_argument())).collect()
        });
        let shaders = compiled.map_or_else(BTreeMap::new, |compiled| {
            let steps = compiled.steps.iter().flatten();
            let mut hashes: BTreeMap<String, Vec<String>> = BTreeMap::new();
            for step in steps {
                let path = step.shader.files().first().cloned().unwrap_or_default();
                let (hash, variants) =
                    (format!("{:032x}", step.shader.hash), hashes.entry(path).or_default());
                if !variants.contains(&hash) {
                    variants.push(hash);
                }
            }
            hashes.into_iter().map(|(path, variants)| (path, variants.join(" "))).collect()
        });
        Provenance {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            pipeline: renderer.pipeline_name().to_owned(),
            set,
            resolved: compiled
                .map_or_else(String::new, |compiled| compiled.resolved.to_ron(&*renderer.catalog, true)),
            plan: compiled.map_or_else(String::new, |compiled| compiled.plan.id.to_string()),
            shaders,
            scene: scene.to_owned(),
            scene_hash: format!("{:032x}", renderer.scene().hash),
            size: renderer.size,
            frame: renderer.index.saturating_sub(1),
            first_frame,
            output: shown.0.to_owned(),
            layer: shown.1,
            seed: renderer.seed,
            adapter: renderer.gpu().describe(),
            camera: renderer.camera,
            lights: renderer.lights.as_ref().map(|lights| lights.iter().map(RecordedLight::from).collect()),
            time: renderer.time,
            display: None,
            folder: None,
        }
    }

    /// Records how the picture goes into a file, by `display` where the file holds display light, else as it is; and where
    /// the pipeline and the scene are from there, where they are files.
    #[must_use]
    pub fn written_to(mut self, path: &Path, display: Display) -> Provenance {
        self.display = FileFormat::of(path).filter(|format| format.is_display_referred()).map(|_| display);
        let here = std::env::current_dir().ok();
        let is_path = |name: &String| is_path_from(Path::new("."), name);
        self.folder = here
            .filter(|_| is_path(&self.pipeline) || is_path(&self.scene))
            .map(|here| way_back(&here, path).to_string_lossy().into_owned());
        self
    }

    /// Returns the folders from which the names of the record may be paths, the likeliest first: the working folder, that
    /// of the record, and that of the picture, which is at `picture`.
    pub fn folders(&self, picture: &Path) -> Vec<PathBuf> {
        let own = picture.parent().filter(|own| !own.as_os_str().is_empty()).unwrap_or(Path::new("."));
        // The root of the disk holds all files, which the files of a picture from elsewhere could then name.
        let recorded = self.folder.as_ref().and_then(|folder| own.join(folder).canonicalize().ok());
        let recorded = recorded.filter(|folder| folder.parent().is_some());
        let mut folders: Vec<PathBuf> = Vec::new();
        for folder in
            [Path::new(".").canonicalize().ok(), recorded, own.canonicalize().ok()].into_iter().flatten()
        {
            if !folders.contains(&folder) {
                folders.push(folder);
            }
        }
        folders
    }

    /// Gives a renderer the camera, the lights and the time of the record, where it has them.
    ///
    /// # Errors
    /// As [`Renderer::set_lights`].
    pub fn apply_view(&self, renderer: &mut Renderer) -> Result<(), RenderError> {
        if self.camera.is_some() {
            renderer.set_camera(self.camera, false);
        }
        if let Some(lights) = &self.lights {
            renderer.set_lights(Some(lights.iter().map(Light::from).collect()))?;
        }
        if self.time.is_some() {
            renderer.set_time(self.time);
        }
        Ok(())
    }

    /// Writes it as JSON.
    pub fn to_json(&self) -> String {
        // A struct of texts and numbers always has a form in JSON.
        serde_json::to_string_pretty(self).unwrap_or_default()
    }

    /// Reads it from JSON.
    ///
    /// # Errors
    /// The text has another form, or a size that no picture has.
    pub fn from_json(text: &str) -> Result<Provenance, serde_json::Error> {
        let record: Provenance = serde_json::from_str(text)?;
        let (width, height) = record.size;
        if [width, height].iter().any(|side| !(1..=MAX_SIDE).contains(side)) {
            let problem = format!("the size is {width}×{height}; a side is from 1 to {MAX_SIDE} px");
            return Err(serde::de::Error::custom(problem));
        }
        Ok(record)
    }

    /// Returns the values that were given, for [`Renderer::set_pipeline`].
    pub fn overrides(&self) -> Overrides {
        Overrides(self.set.iter().map(|(name, value)| (name.clone(), parse_value(value))).collect())
    }

    /// Returns what differs from another record, one line each; the record of the same picture, rendered again, gives
    /// none.
    pub fn differences(&self, other: &Provenance) -> Vec<String> {
        let mut lines = Vec::new();
        let mut compare = |what: &str, a: &str, b: &str| {
            if a != b {
                lines.push(format!("{what}: was {a}, is {b}"));
            }
        };
        compare("version", &self.version, &other.version);
        compare("plan", &self.plan, &other.plan);
        compare("scene", &self.scene_hash, &other.scene_hash);
        compare("adapter", &self.adapter, &other.adapter);
        for path in
            self.shaders.keys().chain(other.shaders.keys().filter(|path| !self.shaders.contains_key(*path)))
        {
            let hash = |of: &Provenance| of.shaders.get(path).cloned().unwrap_or_else(|| "absent".to_owned());
            compare(path, &hash(self), &hash(other));
        }
        lines
    }
}

/// Returns whether a name of a record is the path of a file from a folder, also where its ending `.ron` is left out.
pub fn is_path_from(folder: &Path, name: &str) -> bool {
    let path = folder.join(name);
    Path::new(name).is_relative() && (path.is_file() || folder.join(format!("{name}.ron")).is_file())
}

/// The way from the folder of a file to a folder `here`: of `..` where that is around the file, else `here` itself.
fn way_back(here: &Path, file: &Path) -> PathBuf {
    let folder = file.parent().map(|folder| here.join(folder));
    let folder = folder.and_then(|folder| folder.canonicalize().ok());
    let inside = folder.zip(here.canonicalize().ok());
    let inside = inside.and_then(|(folder, here)| Some(folder.strip_prefix(here).ok()?.components().count()));
    inside.map_or_else(|| here.to_owned(), |depth| std::iter::repeat_n("..", depth).collect())
}

/// Parses a value from the text of a command line: a boolean, an integer, a real number, a vector as `(x, y, z)`,
/// else text.
pub fn parse_value(text: &str) -> Value {
    let text = text.trim();
    if let Ok(truth) = text.parse::<bool>() {
        return Value::Bool(truth);
    }
    if let Ok(number) = text.parse::<u32>() {
        return Value::U32(number);
    }
    if let Ok(number) = text.parse::<i32>() {
        return Value::I32(number);
    }
    if let Ok(number) = text.parse::<f32>() {
        return Value::F32(number);
    }
    let vector = text.strip_prefix('(').and_then(|rest| rest.strip_suffix(')'));
    match vector
        .map(|inner| inner.split(',').map(|part| part.trim().parse::<f32>()).collect::<Result<Vec<f32>, _>>())
    {
        Some(Ok(components)) if (2..=4).contains(&components.len()) => Value::Vector(components),
        _ => Value::Text(text.to_owned()),
    }
}
