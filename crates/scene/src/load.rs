//! Loads a [`Scene`] by name or path.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::io;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

use crate::codes;
use data_file::{Diagnostic, Diagnostics, Place, Source, Span, nearest, read_text};
use glam::DVec3;

use crate::animation::{Animated, Between, Outside, Track};
use crate::assemble::{Assembly, Flattened};
use crate::budget::Budget;
use crate::built_in;
use crate::description::{Description, Geometry, Keyframes, Keys, parse};
use crate::error::SceneError;
use crate::files::SceneFiles;
use crate::import::{Imported, import};
use crate::model::{Node, NodeAnimation, Transform};
use crate::origin::settle;
use crate::scene::{Driver, Scene};

/// Loads a scene: by a name among `files` (`cornell-box`), or by the path of a `.ron`, `.glb` or `.gltf`
/// file, which may also be among `files`.
///
/// # Errors
/// See [`SceneError`]. Errors that could be repaired are listed in [`Scene::repairs`].
pub fn load(spec: &str, files: &dyn SceneFiles) -> Result<Scene, SceneError> {
    let path = Path::new(spec);
    let name = path.file_stem().map_or(spec.into(), |stem| stem.to_string_lossy().into_owned());
    let (roots, budget) = (roots(files), Rc::new(Budget::default()));
    match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
        Some("glb" | "gltf") => {
            let Imported { model, mut files } = import(path, &roots, &budget)?;
            files.insert(0, path.into());
            settle(|origin| {
                let mut assembly = Assembly::new(name.clone(), spec, origin, &budget);
                assembly.files.clone_from(&files);
                assembly.place(&model, None, true)?;
                assembly.flatten()
            })
        }
        _ => {
            let (source, folder, on_disk) = find(spec, files)?;
            budget.text(source.text.len());
            let mut models = BTreeMap::new();
            settle(|origin| {
                let description = parse(&source, Some((&folder, &roots)), origin)?;
                let (source, models) = (&source, &mut models);
                let loader = Loader { source, folder: &folder, roots: &roots, models, errors: Vec::new() };
                let assembly = Assembly::new(name.clone(), spec, origin, &budget);
                loader.assemble(assembly, description, on_disk.clone())
            })
        }
    }
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
/// Those of [`load`] that concern the description.
pub fn about(spec: &str, files: &dyn SceneFiles) -> Result<String, SceneError> {
    Ok(parse(&find(spec, files)?.0, None, DVec3::ZERO)?.about)
}

/// Returns the description, the folder of its geometry files, and its path if it is a file on disk.
fn find(spec: &str, files: &dyn SceneFiles) -> Result<(Arc<Source>, PathBuf, Option<PathBuf>), SceneError> {
    let path = Path::new(spec);
    if path.extension().is_some_and(|e| e == "ron") {
        match read_text(path) {
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
    let near = nearest(spec, names.iter().copied()).map(str::to_owned);
    Err(SceneError::NotFound {
        spec: spec.into(),
        nearest: near,
        known: names.into_iter().map(str::to_owned).collect(),
    })
}

/// The most errors that are reported about a description once its geometry is known.
const MAX_ERRORS: usize = 1000;

/// Named objects: their nodes, and their transforms if nothing moves them.
type Objects = BTreeMap<String, (usize, Transform)>;

/// Assembles one description.
struct Loader<'a> {
    source: &'a Arc<Source>,
    folder: &'a Path,
    /// The folders of geometry files, beside that of the scene.
    roots: &'a [PathBuf],
    /// Geometry that was read or made before, by its path or name.
    models: &'a mut BTreeMap<PathBuf, Imported>,
    /// Errors that can be found only with the geometry.
    errors: Vec<Diagnostic>,
}

impl Loader<'_> {
    fn assemble(
        mut self,
        mut assembly: Assembly,
        description: Description,
        on_disk: Option<PathBuf>,
    ) -> Result<Flattened, SceneError> {
        assembly.about = description.about;
        assembly.files.extend(on_disk);
        assembly.lights = description.lights.into_iter().map(|light| (light, Driver::default())).collect();
        let mut objects = BTreeMap::new();
        self.place(&mut assembly, &description.geometry, None, description.lights_from_file, &mut objects)?;
        assembly.camera = description.camera;
        if let Some(keyframes) = description.keyframes {
            self.animate(&mut assembly, keyframes, &objects);
        }
        if !self.errors.is_empty() {
            return Err(Diagnostics::sorted(self.errors).into());
        }
        assembly.flatten()
    }

    /// Adds geometry below `parent`; `objects` collects the nodes of named objects.
    fn place(
        &mut self,
        assembly: &mut Assembly,
        geometry: &Geometry,
        parent: Option<usize>,
        with_lights: bool,
        objects: &mut Objects,
    ) -> Result<(), SceneError> {
        match geometry {
            // Names that are not built in were reported by the grammar.
            Geometry::BuiltIn(name) => {
                let made =
                    self.models.entry(format!("built in: {}", name.value).into()).or_insert_with(|| {
                        let model = built_in::make(&name.value).unwrap_or_default();
                        assembly.budget.grant(model.bytes() as u64);
                        Imported { model, files: Vec::new() }
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
                        let Imported { model, mut files } = import(&path, &roots, &assembly.budget)?;
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
                    objects.insert(name.clone(), (node, object.transform));
                    let rest = object.transform.affine();
                    assembly.nodes.push(Node { name, parent, rest, ..Node::default() });
                    self.place(assembly, &object.geometry, Some(node), with_lights, objects)?;
                }
            }
        }
        Ok(())
    }

    fn animate(&mut self, assembly: &mut Assembly, keyframes: Keyframes, objects: &Objects) {
        assembly.frames_per_second = Some(keyframes.frames_per_second);
        assembly.duration = assembly.duration.max(keyframes.end);
        let outside = if keyframes.repeat { Outside::Repeat(keyframes.end) } else { Outside::Hold };
        if let Some(keys) = keyframes.camera {
            let mut smooth = |values| self.track(keys.place, values, |values| Track::smooth(values, outside));
            assembly.camera_tracks = Driver {
                position: smooth(keys.value.position),
                aim: smooth(keys.value.target),
                ..Driver::default()
            };
        }
        let names: Vec<String> = assembly.lights.iter().map(|(light, _)| light.name.clone()).collect();
        // A name stands for the first light that has it.
        let numbers: BTreeMap<&str, usize> =
            names.iter().enumerate().rev().map(|(i, name)| (name.as_str(), i)).collect();
        for (name, keys) in keyframes.lights {
            let found = numbers.get(name.value.as_str()).map(|i| &mut assembly.lights[*i]);
            let Some((_, driver)) = found else {
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
            let Some((node, base)) = objects.get(&name.value) else { continue };
            let linear = |keys| Track::new(keys, Between::Linear, outside);
            assembly.nodes[*node].animation = Some(NodeAnimation {
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
