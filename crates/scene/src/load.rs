//! Loads a [`Scene`] by name or path.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::io;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use crate::codes;
use data_file::{Diagnostic, Diagnostics, Place, Source, Span, nearest};
use glam::DVec3;

use crate::animation::{Animated, Between, Outside, Track};
use crate::assemble::{Assembly, Stage};
use crate::budget::Budget;
use crate::built_in;
use crate::description::{
    Description, EnvironmentDescription, EnvironmentMap, Geometry, Keyframes, Keys, parse,
};
use crate::environment::Environment;
use crate::error::SceneError;
use crate::files::SceneFiles;
use crate::import::{Imported, import};
use crate::model::{Node, NodeAnimation, Transform};
use crate::offline::{self, Format};
use crate::origin::settle;
use crate::scene::{Driver, Scene};

/// The endings of files of geometry, with materials, cameras and lights: glTF, pbrt-v4, and Mitsuba 3.
pub const GEOMETRY_ENDINGS: [&str; 4] = [".glb", ".gltf", ".pbrt", ".xml"];

/// Returns whether a file is one of geometry, by its ending.
pub fn is_geometry(file: &str) -> bool {
    let file = file.to_ascii_lowercase();
    GEOMETRY_ENDINGS.iter().any(|ending| file.ends_with(ending))
}

/// Imports a file of geometry.
fn import_any(path: &Path, roots: &[PathBuf], budget: &Budget) -> Result<Imported, SceneError> {
    match path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("pbrt") => offline::import(path, Format::Pbrt, roots, budget),
        Some("xml") => offline::import(path, Format::Mitsuba, roots, budget),
        _ => import(path, roots, budget),
    }
}

/// Loads a scene: by a name among `files` (`cornell-box`), or by the path of a `.ron` file, which may also be among
/// `files`, or of a file of geometry (see [`GEOMETRY_ENDINGS`]).
///
/// # Errors
/// See [`SceneError`]. Errors that could be repaired are listed in [`Scene::repairs`].
pub fn load(spec: &str, files: &dyn SceneFiles) -> Result<Scene, SceneError> {
    load_within(&Rc::default(), spec, files)
}

fn load_within(budget: &Rc<Budget>, spec: &str, files: &dyn SceneFiles) -> Result<Scene, SceneError> {
    let (path, roots) = (Path::new(spec), roots(files));
    let name = path.file_stem().map_or(spec.into(), |stem| stem.to_string_lossy().into_owned());
    let mut assembly = Assembly::new(name, spec, budget);
    let flattened = match is_geometry(spec) {
        true => {
            let Imported { model, files } = import_any(path, &roots, budget)?;
            assembly.files = [vec![path.into()], files].concat();
            assembly.place(&model, None, true)?;
            settle(|origin| {
                let mut stage = assembly.stage(origin);
                stage.add_from_models(&assembly);
                assembly.flatten(stage)
            })
        }
        false => {
            let (source, folder, on_disk) = find(spec, files)?;
            budget.text(source.text.len());
            let description = parse(&source, Some((&folder, &roots)), DVec3::ZERO)?;
            assembly.files.extend(on_disk);
            let mut loader =
                Loader { folder: &folder, roots: &roots, models: BTreeMap::new(), objects: Vec::new() };
            loader.place(&mut assembly, &description.geometry, None, description.lights_from_file)?;
            if let Some(described) = &description.environment {
                assembly.environment = Some(loader.environment(&mut assembly, &source, described)?);
            }
            assembly.about.clone_from(&description.about);
            if let Some(keyframes) = &description.keyframes {
                assembly.frames_per_second = Some(keyframes.frames_per_second);
                assembly.duration = assembly.duration.max(keyframes.end);
            }
            let objects = loader.objects;
            settle(|origin| {
                let description = match origin {
                    DVec3::ZERO => description.clone(),
                    // Its places are rounded once, relative to the origin.
                    _ => parse(&source, None, origin)?,
                };
                assembly.flatten(staged(&assembly, &source, description, &objects, origin)?)
            })
        }
    }?;
    Ok(assembly.finish(flattened))
}

/// Returns the folders in which files may be that scenes and models name.
fn roots(files: &dyn SceneFiles) -> Vec<PathBuf> {
    let mut roots = files.roots();
    roots.push(files.folder());
    roots
}

/// Returns the `about` line of a scene file, without loading its geometry: for lists of scenes.
///
/// # Errors
/// The errors of [`load`] that concern the description.
pub fn about(spec: &str, files: &dyn SceneFiles) -> Result<String, SceneError> {
    Ok(parse(&find(spec, files)?.0, None, DVec3::ZERO)?.about)
}

/// Returns the description, the folder of its geometry files, and its path if it is a file on disk.
fn find(spec: &str, files: &dyn SceneFiles) -> Result<(Arc<Source>, PathBuf, Option<PathBuf>), SceneError> {
    let path = Path::new(spec);
    if path.extension().is_some_and(|e| e == "ron") {
        match files.on_disk(path) {
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
    if path.is_file() {
        let error =
            io::Error::new(io::ErrorKind::InvalidInput, "a scene is a .ron, .glb, .gltf, .pbrt or .xml file");
        return Err(SceneError::Unreadable { path: path.into(), error });
    }
    let list = files.list();
    let names: Vec<&str> = list.iter().map(|file| file.strip_suffix(".ron").unwrap_or(file)).collect();
    let near = nearest(spec, names.iter().copied()).map(str::to_owned);
    Err(SceneError::NotFound {
        spec: spec.into(),
        nearest: near,
        known: names.into_iter().map(str::to_owned).collect(),
    })
}

/// The most errors that are reported about a description once its geometry is known.
const MAX_ERRORS: usize = 1000;

/// Places the geometry of a description.
struct Loader<'a> {
    folder: &'a Path,
    /// The folders of geometry files, beside that of the scene.
    roots: &'a [PathBuf],
    /// Geometry that was read or made before, by its path or name.
    models: BTreeMap<PathBuf, Imported>,
    /// The nodes of objects, in the order of the description.
    objects: Vec<usize>,
}

impl Loader<'_> {
    /// Adds geometry below `parent`.
    fn place(
        &mut self,
        assembly: &mut Assembly,
        geometry: &Geometry,
        parent: Option<usize>,
        with_lights: bool,
    ) -> Result<(), SceneError> {
        match geometry {
            // Names that are not built in were reported by the grammar.
            Geometry::BuiltIn(name) => {
                let made =
                    self.models.entry(format!("built in: {}", name.value).into()).or_insert_with(|| {
                        let model = built_in::make(&name.value).unwrap_or_default();
                        assembly.budget.grant(model.bytes() as u64);
                        Imported { model: Rc::new(model), files: Vec::new() }
                    });
                assembly.place(&made.model, parent, with_lights)?;
            }
            Geometry::File(file) => {
                let path = self.folder.join(&file.value);
                // However it is written, a file is read once.
                let key = path.canonicalize().unwrap_or_else(|_| path.clone());
                let imported = match self.models.entry(key) {
                    Entry::Occupied(known) => known.into_mut(),
                    Entry::Vacant(new) => {
                        let roots = [self.roots, &[self.folder.to_owned()]].concat();
                        let Imported { model, mut files } = import_any(&path, &roots, &assembly.budget)?;
                        files.insert(0, path);
                        new.insert(Imported { model, files })
                    }
                };
                if !imported.files.first().is_some_and(|file| assembly.files.contains(file)) {
                    assembly.files.extend(imported.files.iter().cloned());
                }
                assembly.place(&imported.model, parent, with_lights)?;
            }
            Geometry::Objects(list) => {
                for object in list {
                    let (node, name) = (assembly.nodes.len(), object.name.value.clone());
                    self.objects.push(node);
                    assembly.nodes.push(Node { name, parent, ..Node::default() });
                    self.place(assembly, &object.geometry, Some(node), with_lights)?;
                }
            }
        }
        Ok(())
    }
}

impl Loader<'_> {
    /// Makes or reads an environment.
    fn environment(
        &self,
        assembly: &mut Assembly,
        source: &Arc<Source>,
        described: &EnvironmentDescription,
    ) -> Result<Environment, SceneError> {
        let factor = described.radiance.to_array();
        let environment = match &described.map {
            None => Environment::uniform(factor),
            Some(EnvironmentMap::Sky) => Environment::sky(factor),
            Some(EnvironmentMap::File(file)) => {
                let path = self.folder.join(&file.value);
                let mut read = Environment::read(&path, factor).map_err(|problem| {
                    let span =
                        Span { source: Arc::clone(source), start: file.place.start, end: file.place.end };
                    let error = Diagnostic::new(&codes::MAP, problem).label(span, "this map");
                    Diagnostics(vec![error])
                })?;
                if let Some((width, height)) = read.shrink() {
                    assembly.repairs.push(format!(
                        "the environment {} is reduced from {width} x {height} to {} x {} pixels",
                        file.value, read.width, read.height
                    ));
                }
                assembly.files.push(path);
                read
            }
        };
        Ok(Environment { rotation: described.rotation, ..environment })
    }
}

/// The nodes of named objects, and their transforms if nothing moves them.
type Objects<'a> = BTreeMap<&'a str, (usize, Transform)>;

/// Returns the stage of a description, whose places are relative to `origin`; `nodes` has those of its objects.
fn staged(
    assembly: &Assembly,
    source: &Arc<Source>,
    description: Description,
    nodes: &[usize],
    origin: DVec3,
) -> Result<Stage, SceneError> {
    let mut stage = assembly.stage(origin);
    let mut objects = BTreeMap::new();
    for (object, node) in description.geometry.objects().into_iter().zip(nodes) {
        stage.motion.nodes[*node].rest = object.transform.affine();
        objects.insert(object.name.as_str(), (*node, object.transform));
    }
    stage.motion.lights = description.lights.iter().map(|_| Driver::default()).collect();
    stage.lights = description.lights;
    stage.add_from_models(assembly);
    stage.camera = description.camera;
    if let Some(keyframes) = description.keyframes {
        let mut animator = Animator { source, errors: Vec::new() };
        animator.animate(&mut stage, keyframes, &objects);
        if !animator.errors.is_empty() {
            return Err(Diagnostics::sorted(animator.errors).into());
        }
    }
    Ok(stage)
}

/// Makes movement of keyframes.
struct Animator<'a> {
    source: &'a Arc<Source>,
    /// Errors that can be found only with the geometry.
    errors: Vec<Diagnostic>,
}

impl Animator<'_> {
    fn animate(&mut self, stage: &mut Stage, keyframes: Keyframes, objects: &Objects<'_>) {
        let outside = if keyframes.repeat { Outside::Repeat(keyframes.end) } else { Outside::Hold };
        if let Some(keys) = keyframes.camera {
            let mut smooth = |values| self.track(keys.place, values, |values| Track::smooth(values, outside));
            stage.motion.camera = Driver {
                position: smooth(keys.value.position),
                aim: smooth(keys.value.target),
                ..Driver::default()
            };
        }
        let names: Vec<String> = stage.lights.iter().map(|light| light.name.clone()).collect();
        // A name stands for the first light that has it.
        let numbers: BTreeMap<&str, usize> =
            names.iter().enumerate().rev().map(|(i, name)| (name.as_str(), i)).collect();
        for (name, keys) in keyframes.lights {
            let found = numbers.get(name.value.as_str()).map(|i| &mut stage.motion.lights[*i]);
            let Some(driver) = found else {
                if self.errors.len() >= MAX_ERRORS {
                    continue;
                }
                let message = format!("keyframes for `{}`, but no light has this name", name.value);
                let error = Diagnostic::new(&codes::NAME, message)
                    .label(self.span(name.place), "no such light")
                    .suggest("lights", &name.value, names.iter().map(String::as_str));
                self.errors.push(error);
                continue;
            };
            let mut smooth = |values| self.track(name.place, values, |values| Track::smooth(values, outside));
            driver.position = smooth(keys.position);
            driver.aim = smooth(keys.direction);
            driver.intensity = smooth(keys.intensity);
        }
        for (name, keys) in keyframes.objects {
            // Names that no object has were reported by the grammar.
            let Some((node, base)) = objects.get(name.as_str()) else { continue };
            let linear = |keys| Track::new(keys, Between::Linear, outside);
            stage.motion.nodes[*node].animation = Some(NodeAnimation {
                base: *base,
                translation: self.track(name.place, keys.translate, |keys| Track::smooth(keys, outside)),
                rotation: self
                    .track(name.place, keys.rotate, |keys| Track::new(keys, Between::Linear, outside)),
                scale: self.track(name.place, keys.scale, linear),
            });
        }
    }

    /// Returns a track, if there are keys.
    fn track<T: Animated>(
        &mut self,
        place: Place,
        keys: Keys<T>,
        make: impl Fn(Keys<T>) -> Result<Track<T>, String>,
    ) -> Option<Track<T>> {
        if keys.is_empty() {
            return None;
        }
        let message = |why| format!("these keys make no movement: {why}");
        let track = make(keys).map_err(|why| {
            let error = Diagnostic::new(&codes::CONFLICT, message(why)).label(self.span(place), "its keys");
            self.errors.push(error);
        });
        track.ok()
    }

    fn span(&self, place: Place) -> Span {
        Span { source: Arc::clone(self.source), start: place.start, end: place.end }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct NoFiles;

    impl data_file::Files for NoFiles {
        fn read(&self, _: &str) -> Option<Arc<Source>> {
            None
        }

        fn list(&self) -> Vec<String> {
            Vec::new()
        }
    }

    impl SceneFiles for NoFiles {}

    /// Each placed model takes bytes of the budget, so a scene that is assembled again takes more.
    #[test]
    fn a_scene_is_assembled_once_wherever_it_lies() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("test.ron");
        let taken = |x: &str| {
            let text = format!(
                "Scene(geometry: Objects([Object(name: \"box\", geometry: BuiltIn(\"cornell-box\"),
                    transform: Transform(translate: ({x}, 0, 0)))]))"
            );
            std::fs::write(&path, text).unwrap();
            let budget = Rc::default();
            let scene = load_within(&budget, path.to_str().unwrap(), &NoFiles).unwrap();
            (scene.origin.x, budget.taken())
        };
        let (near, once) = taken("0");
        assert!(near == 0.0 && once > 0);
        // The first is found by one replacement of the origin, the second by two.
        for x in ["1e6", "1e12"] {
            let (far, taken) = taken(x);
            assert!(far > 9e5, "{far}");
            assert_eq!(taken, once, "at {x} m");
        }
    }
}
