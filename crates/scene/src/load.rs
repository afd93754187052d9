//! From the name of a scene to a [`Scene`].

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use frame_graph::{Diagnostic, Diagnostics, Label, Source};
use glam::{Quat, Vec3};

use crate::animation::{Animated, Between, Outside, Track};
use crate::assemble::Assembly;
use crate::built_in;
use crate::camera::Camera;
use crate::description::{self, Description, Geometry, Keyframes, nearest, offer, parse, span};
use crate::error::SceneError;
use crate::files::SceneFiles;
use crate::import::import;
use crate::light::{Light, LightKind};
use crate::model::{Model, Node, NodeAnimation, Transform};
use crate::scene::{Driver, Scene};

/// Loads a scene: the name of one of `files` (`cornell-box`), or the path of a `.ron`, `.glb` or `.gltf`
/// file, which may also be one of `files`.
///
/// # Errors
/// See [`SceneError`]. What could be repaired is in [`Scene::repairs`].
pub fn load(spec: &str, files: &dyn SceneFiles) -> Result<Scene, SceneError> {
    let path = Path::new(spec);
    let name = path.file_stem().map_or(spec.into(), |stem| stem.to_string_lossy().into_owned());
    match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("glb" | "gltf") => {
            let mut assembly = Assembly::new(name);
            let model = import(path)?;
            assembly.files.push(path.into());
            assembly.files.extend(model.files);
            assembly.place(model.model, None, true);
            assembly.finish()
        }
        _ => {
            let (source, folder, on_disk) = find(spec, files)?;
            let description = parse(&source)?;
            Loader { source: &source, folder, models: BTreeMap::new() }.assemble(name, description, on_disk)
        }
    }
}

/// The `about` line of a scene file, without loading its geometry: for lists of scenes.
///
/// # Errors
/// As [`load`], of what concerns the description.
pub fn about(spec: &str, files: &dyn SceneFiles) -> Result<String, SceneError> {
    Ok(parse(&find(spec, files)?.0)?.about)
}

/// The description, the folder its files are looked for in, and its path where it is a file on disk.
fn find(spec: &str, files: &dyn SceneFiles) -> Result<(Arc<Source>, PathBuf, Option<PathBuf>), SceneError> {
    let path = Path::new(spec);
    if path.extension().is_some_and(|e| e == "ron") {
        match fs::read_to_string(path) {
            Ok(text) => {
                let folder = path.parent().map(PathBuf::from).unwrap_or_default();
                return Ok((Arc::new(Source { name: spec.into(), text }), folder, Some(path.into())));
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return Err(SceneError::Unreadable { path: path.into(), error }),
        }
    }
    let file = if spec.ends_with(".ron") { spec.to_string() } else { format!("{spec}.ron") };
    if let Some(source) = files.read(&file) {
        let on_disk = Some(files.folder().join(&file)).filter(|path| path.is_file());
        return Ok((source, files.folder(), on_disk));
    }
    let list = files.list();
    let names: Vec<&str> = list.iter().map(|file| file.strip_suffix(".ron").unwrap_or(file)).collect();
    let mut sorted: Vec<String> = nearest(spec, &names).into_iter().map(String::from).collect();
    let rest: Vec<String> = names.iter().map(|n| n.to_string()).filter(|n| !sorted.contains(n)).collect();
    if !sorted.is_empty() {
        sorted.extend(rest);
    }
    Err(SceneError::NotFound { spec: spec.into(), nearest: sorted })
}

/// Named objects: their nodes, and their places where nothing moves them.
type Objects = BTreeMap<String, (usize, Transform)>;

/// Assembles one description.
struct Loader<'a> {
    source: &'a Arc<Source>,
    folder: PathBuf,
    /// Geometry read before, by what names it.
    models: BTreeMap<String, Model>,
}

impl Loader<'_> {
    fn assemble(
        mut self,
        name: String,
        description: Description,
        on_disk: Option<PathBuf>,
    ) -> Result<Scene, SceneError> {
        let mut assembly = Assembly::new(name);
        assembly.about.clone_from(&description.about);
        assembly.files.extend(on_disk);
        let mut lights = Vec::new();
        for light in &description.lights {
            lights.push((self.light(light, lights.len())?, Driver::default()));
        }
        assembly.lights = lights;
        let mut objects = BTreeMap::new();
        let geometry = &description.geometry;
        self.place(&mut assembly, geometry, None, description.lights_from_file, &mut objects)?;
        if let Some(camera) = description.camera {
            assembly.camera = Some(self.camera(&camera)?);
        }
        if let Some(keyframes) = &description.keyframes {
            self.animate(&mut assembly, keyframes, &objects)?;
        }
        assembly.finish()
    }

    /// Places geometry below `parent`; `objects` collects the nodes of named objects.
    fn place(
        &mut self,
        assembly: &mut Assembly,
        geometry: &Geometry,
        parent: Option<usize>,
        with_lights: bool,
        objects: &mut Objects,
    ) -> Result<(), SceneError> {
        match geometry {
            Geometry::BuiltIn(name) => {
                let model = built_in::make(name).ok_or_else(|| {
                    self.wrong(
                        "C004",
                        format!("there is no built-in geometry `{name}`"),
                        name,
                        "not built in",
                    )
                    .with_notes(offer(name, &built_in::names()))
                    .error()
                })?;
                assembly.place(model, parent, with_lights);
            }
            Geometry::File(file) => {
                if !self.models.contains_key(file) {
                    let path = self.folder.join(file);
                    if !path.exists() {
                        let message = format!("there is no file {}", path.display());
                        let note = "file names start from the folder of the scene file".to_string();
                        return Err(self
                            .wrong("C004", message, file, "not found")
                            .with_notes(vec![note])
                            .error());
                    }
                    let imported = import(&path)?;
                    assembly.files.push(path);
                    assembly.files.extend(imported.files);
                    self.models.insert(file.clone(), imported.model);
                }
                assembly.place(self.models[file].clone(), parent, with_lights);
            }
            Geometry::Objects(list) => {
                for object in list {
                    let node = assembly.nodes.len();
                    let transform = object.transform.model();
                    if objects.insert(object.name.clone(), (node, transform)).is_some() {
                        let message = format!("two objects are named `{}`", object.name);
                        return Err(self.wrong("C005", message, &object.name, "the first of them").error());
                    }
                    let rest = transform.affine();
                    assembly.nodes.push(Node { name: object.name.clone(), parent, rest, ..Node::default() });
                    self.place(assembly, &object.geometry, Some(node), with_lights, objects)?;
                }
            }
        }
        Ok(())
    }

    fn camera(&self, camera: &description::Camera) -> Result<Camera, SceneError> {
        if camera.position == camera.target {
            let message = "the camera's position and target are the same point".to_string();
            return Err(self.wrong_at("C005", message, "camera", "it looks nowhere").error());
        }
        Ok(Camera {
            position: camera.position,
            target: camera.target,
            up: camera.up,
            vertical_fov: camera.vertical_fov_deg.to_radians(),
            // 0 stands for a part of the extent, which is not known yet.
            near: camera.near.unwrap_or(0.0),
        })
    }

    fn light(&self, light: &description::Light, index: usize) -> Result<Light, SceneError> {
        let named = |name: &str| if name.is_empty() { format!("light {index}") } else { name.to_string() };
        Ok(match light {
            description::Light::Spot { name, position, direction, intensity, outer_deg, inner_deg } => {
                let inner_deg = inner_deg.unwrap_or(*outer_deg);
                if inner_deg > *outer_deg {
                    let message =
                        format!("the inner cone, {inner_deg}°, is wider than the outer, {outer_deg}°");
                    return Err(self.wrong_at("C005", message, "inner_deg", "at most `outer_deg`").error());
                }
                let kind = LightKind::Spot { inner: inner_deg.to_radians(), outer: outer_deg.to_radians() };
                let direction = direction.normalize();
                Light { name: named(name), kind, position: *position, direction, intensity: *intensity }
            }
            description::Light::Point { name, position, intensity } => Light {
                name: named(name),
                kind: LightKind::Point,
                position: *position,
                direction: Vec3::NEG_Y,
                intensity: *intensity,
            },
            description::Light::Directional { name, direction, irradiance } => Light {
                name: named(name),
                kind: LightKind::Directional,
                position: Vec3::ZERO,
                direction: direction.normalize(),
                intensity: *irradiance,
            },
        })
    }

    fn animate(
        &self,
        assembly: &mut Assembly,
        keyframes: &Keyframes,
        objects: &Objects,
    ) -> Result<(), SceneError> {
        assembly.frames_per_second = Some(keyframes.frames_per_second);
        let times = keyframes.camera.iter().map(|key| key.time);
        let times = times.chain(keyframes.lights.values().flatten().map(|key| key.time));
        let end = times.chain(keyframes.objects.values().flatten().map(|key| key.time)).fold(0.0, f32::max);
        assembly.duration = assembly.duration.max(end);
        let outside = if keyframes.repeat { Outside::Repeat(end) } else { Outside::Hold };

        let smooth =
            |what: &str, keys: Vec<(f32, Vec3)>| self.track(what, keys, |k| Track::smooth(k, outside));
        let camera = &keyframes.camera;
        assembly.camera_tracks = Driver {
            position: smooth("camera", pick(camera, |k| (k.time, k.position)))?,
            aim: smooth("camera", pick(camera, |k| (k.time, k.target)))?,
            ..Driver::default()
        };
        for (name, keys) in &keyframes.lights {
            let names: Vec<String> = assembly.lights.iter().map(|(light, _)| light.name.clone()).collect();
            let Some((_, driver)) = assembly.lights.iter_mut().find(|(light, _)| light.name == *name) else {
                let message = format!("keyframes for `{name}`, but no light has this name");
                let notes = offer(name, &names);
                return Err(self
                    .wrong_last("C004", message, name, "no such light")
                    .with_notes(notes)
                    .error());
            };
            driver.position = smooth(name, pick(keys, |k| (k.time, k.position)))?;
            driver.aim = smooth(name, pick(keys, |k| (k.time, k.direction)))?;
            driver.intensity = smooth(name, pick(keys, |k| (k.time, k.intensity)))?;
        }
        for (name, keys) in &keyframes.objects {
            let Some((node, base)) = objects.get(name) else {
                let names: Vec<&String> = objects.keys().collect();
                let message = format!("keyframes for `{name}`, but no object has this name");
                let notes = offer(name, &names);
                return Err(self
                    .wrong_last("C004", message, name, "no such object")
                    .with_notes(notes)
                    .error());
            };
            let turns: Vec<(f32, Quat)> = pick(keys, |k| (k.time, k.rotate_deg.map(description::rotation)));
            let linear = |keys| Track::new(keys, Between::Linear, outside);
            assembly.nodes[*node].animation = Some(NodeAnimation {
                base: *base,
                translation: smooth(name, pick(keys, |k| (k.time, k.translate)))?,
                rotation: self.track(name, turns, |keys| Track::new(keys, Between::Linear, outside))?,
                scale: self.track(name, pick(keys, |k| (k.time, k.scale)), linear)?,
            });
        }
        Ok(())
    }

    /// A track, where there are keys.
    fn track<T: Animated>(
        &self,
        what: &str,
        keys: Vec<(f32, T)>,
        make: impl Fn(Vec<(f32, T)>) -> Result<Track<T>, String>,
    ) -> Result<Option<Track<T>>, SceneError> {
        if keys.is_empty() {
            return Ok(None);
        }
        make(keys).map(Some).map_err(|why| {
            let message = format!("the keys of `{what}` make no movement: {why}");
            self.wrong_last("C005", message, what, "its keys").error()
        })
    }

    /// An error at the first place where `text` stands in quotes.
    fn wrong(&self, code: &'static str, message: String, text: &str, here: &str) -> Wrong {
        let quoted = format!("{text:?}");
        self.at(code, message, self.source.text.find(&quoted), quoted.len(), here)
    }

    /// An error at the last place where `text` stands, in quotes or as a field.
    fn wrong_last(&self, code: &'static str, message: String, text: &str, here: &str) -> Wrong {
        let quoted = format!("{text:?}");
        match self.source.text.rfind(&quoted) {
            Some(start) => self.at(code, message, Some(start), quoted.len(), here),
            None => self.at(code, message, self.source.text.rfind(text), text.len(), here),
        }
    }

    /// An error at the first place where the field `text` stands.
    fn wrong_at(&self, code: &'static str, message: String, text: &str, here: &str) -> Wrong {
        self.at(code, message, self.source.text.find(&format!("{text}:")), text.len(), here)
    }

    fn at(&self, code: &'static str, message: String, start: Option<usize>, len: usize, here: &str) -> Wrong {
        // Text that is written otherwise than it reads (escapes) is not found: then the whole file is meant.
        let (start, end) = start.map_or((0, 0), |start| (start, start + len));
        let label = Label { span: span(self.source, start, end), message: here.into() };
        Wrong(Diagnostic { code, message, labels: vec![label], notes: Vec::new() })
    }
}

/// An error in the making.
struct Wrong(Diagnostic);

impl Wrong {
    fn with_notes(mut self, notes: Vec<String>) -> Wrong {
        self.0.notes = notes;
        self
    }

    fn error(self) -> SceneError {
        SceneError::Description(Diagnostics(vec![self.0]))
    }
}

/// The keys that set a value, with their times.
fn pick<K, T>(keys: &[K], read: impl Fn(&K) -> (f32, Option<T>)) -> Vec<(f32, T)> {
    keys.iter().map(read).filter_map(|(time, value)| Some((time, value?))).collect()
}
