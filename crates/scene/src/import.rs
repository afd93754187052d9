//! Imports glTF 2.0, `.glb` and `.gltf`, as a [`Model`].
//!
//! The `gltf` crate reads the JSON; its own validation and accessor readers are not used, since they panic on
//! wrong indices and ranges. Here every index is looked up and every range checked, and errors are reported
//! with their place. What is read: nodes, meshes, materials (metallic-roughness, KHR_materials_specular,
//! KHR_materials_emissive_strength), textures, morph targets, skins, perspective cameras,
//! KHR_lights_punctual, and the first of the animations (its translations, rotations, scales and morph
//! weights), since a file does not state which one to play. All surfaces are treated as two-sided.

mod accessor;
mod deform;
mod materials;
pub(crate) mod meshes;
mod nodes;

use std::borrow::Cow;
use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use data_file::paths::{OUTSIDE, may_name};
use gltf::buffer;
use gltf::json::{self, Root};
use metrics::decode::read_file;

use self::materials::Materials;
use crate::budget::Budget;
use crate::error::SceneError;
use crate::model::Model;

/// Extensions that are supported.
const READ: [&str; 4] = [
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_specular",
    // Integer positions and similar data: accessors are read this way in any case.
    "KHR_mesh_quantization",
];

/// A model, and the other files that were read for it.
pub(crate) struct Imported {
    pub(crate) model: Rc<Model>,
    pub(crate) files: Vec<PathBuf>,
}

/// Reads a `.glb` or `.gltf` file, with the buffers and images that it names.
///
/// Its bytes in memory are counted in `budget`; its files are in its own folder or in `roots`.
pub(crate) fn import(path: &Path, roots: &[PathBuf], budget: &Budget) -> Result<Imported, SceneError> {
    let bytes = read_file(path).map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => {
            SceneError::NotFound { spec: path.display().to_string(), nearest: None, known: Vec::new() }
        }
        _ => SceneError::Unreadable { path: path.into(), error },
    })?;
    budget.file(path, bytes.len());
    let (json, blob) = split(path, &bytes)?;
    let root =
        document(&json).map_err(|e| wrong(path, "JSON", format!("{e}; expected a glTF 2.0 document")))?;
    let mut importer = Importer {
        path,
        roots,
        root: &root,
        budget,
        buffers: Vec::new(),
        files: Vec::new(),
        repairs: Vec::new(),
        of_primitives: Vec::new(),
    };
    importer.check_version()?;
    importer.check_extensions()?;
    importer.read_buffers(blob)?;
    let Materials { materials, textures, uv_sets } = importer.materials()?;
    let mut model = Model { materials, textures, ..Model::default() };
    model.meshes = importer.meshes(&uv_sets, &mut model.materials)?;
    importer.tell_of_primitives();
    importer.nodes(&mut model)?;
    model.repairs = importer.repairs;
    Ok(Imported { model: Rc::new(model), files: importer.files })
}

/// Reads the JSON of a glTF file.
///
/// Numbers beyond those of an `f32`, which serde_json refuses, become infinite: some programs write the largest `f64`
/// for what has no bound. The second reading has no places for its errors, and takes memory for the whole file: what is cut off or is no
/// glTF is not read again.
fn document(json: &[u8]) -> Result<Root, serde_json::Error> {
    json::deserialize::from_slice(json).or_else(|error: serde_json::Error| {
        let again = error.is_syntax().then(|| serde_json::from_slice(json).and_then(serde_json::from_value));
        again.and_then(Result::ok).ok_or(error)
    })
}

/// The JSON, and the binary chunk of a `.glb`.
type Chunks<'a> = (Cow<'a, [u8]>, Option<Cow<'a, [u8]>>);

fn split<'a>(path: &Path, bytes: &'a [u8]) -> Result<Chunks<'a>, SceneError> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes.into(), None));
    }
    let length = bytes.get(8..12).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    match length {
        Some(length @ 12..) if length as usize <= bytes.len() => {}
        _ => {
            let length = length.map_or("none".into(), |n| format!("{n}"));
            let problem =
                format!("the file has {} bytes, its header says {length}: it is cut off", bytes.len());
            return Err(wrong(path, "GLB header", problem));
        }
    }
    let glb = gltf::Glb::from_slice(bytes).map_err(|e| wrong(path, "GLB chunks", e))?;
    Ok((glb.json, glb.bin))
}

fn wrong(path: &Path, place: impl Into<String>, problem: impl Display) -> SceneError {
    SceneError::Gltf { file: path.into(), place: place.into(), problem: problem.to_string() }
}

/// A file that is being read.
pub(super) struct Importer<'a> {
    path: &'a Path,
    roots: &'a [PathBuf],
    root: &'a Root,
    budget: &'a Budget,
    buffers: Vec<Vec<u8>>,
    files: Vec<PathBuf>,
    repairs: Vec<String>,
    /// What many primitives may share: the repair, the first that has it, and the number of them.
    of_primitives: Vec<(&'static str, String, usize)>,
}

impl<'a> Importer<'a> {
    fn wrong(&self, place: impl Into<String>, problem: impl Display) -> SceneError {
        wrong(self.path, place, problem)
    }

    /// Returns the item at `index` of a list in the document.
    fn get<T>(&self, list: &'a [T], index: usize, what: &str, place: &str) -> Result<&'a T, SceneError> {
        list.get(index)
            .ok_or_else(|| self.wrong(place, format!("there is no {what} {index}: there are {}", list.len())))
    }

    /// Checks that the file is of a version that is read. A file of a later one says in `minVersion` whether it can be.
    fn check_version(&self) -> Result<(), SceneError> {
        let asset = &self.root.asset;
        let parts = |version: &str| {
            let (major, minor) = version.split_once('.')?;
            Some((major.parse::<u32>().ok()?, minor.parse::<u32>().ok()?))
        };
        let (place, least) = match &asset.min_version {
            Some(version) => ("asset.minVersion", version),
            None => ("asset.version", &asset.version),
        };
        let is_read = match parts(least) {
            Some((2, minor)) => minor == 0 || asset.min_version.is_none(),
            _ => false,
        };
        let least: String = least.chars().take(20).collect();
        if is_read {
            Ok(())
        } else {
            Err(self.wrong(place, format!("the file is of glTF {least}; 2.0 is read")))
        }
    }

    /// Notes a repair of a primitive, once for all that need it.
    fn repair_primitive(&mut self, what: &'static str, place: &str) {
        match self.of_primitives.iter_mut().find(|(other, ..)| *other == what) {
            Some((.., count)) => *count += 1,
            None => self.of_primitives.push((what, place.to_owned(), 1)),
        }
    }

    /// Tells the repairs of primitives.
    fn tell_of_primitives(&mut self) {
        for (what, first, count) in self.of_primitives.drain(..) {
            let more = match count - 1 {
                0 => String::new(),
                1 => " and one more".to_owned(),
                more => format!(" and {more} more"),
            };
            self.repairs.push(format!("{first}{more}: {what}"));
        }
    }

    fn check_extensions(&mut self) -> Result<(), SceneError> {
        let unknown = |name: &&String| !READ.contains(&name.as_str());
        if let Some(name) = self.root.extensions_required.iter().find(unknown) {
            let problem =
                format!("the file requires {name}, which is not supported (supported: {})", READ.join(", "));
            return Err(self.wrong("extensionsRequired", problem));
        }
        for name in self.root.extensions_used.iter().filter(unknown) {
            self.repairs.push(format!("the extension {name} is not supported: what it adds is left out"));
        }
        Ok(())
    }

    fn read_buffers(&mut self, mut blob: Option<Cow<'a, [u8]>>) -> Result<(), SceneError> {
        for (index, buffer) in self.root.buffers.iter().enumerate() {
            let place = format!("buffer {index}");
            let bytes = match &buffer.uri {
                Some(uri) => self.fetch(uri).map_err(|problem| self.wrong(&place, problem))?,
                None => match blob.take() {
                    Some(bytes) => bytes.into_owned(),
                    None => {
                        return Err(
                            self.wrong(place, "it names no file, and there is no binary chunk for it")
                        );
                    }
                },
            };
            let expected = buffer.byte_length.0;
            if (bytes.len() as u64) < expected {
                return Err(self.wrong(place, format!("expected {expected} bytes, found {}", bytes.len())));
            }
            self.buffers.push(bytes);
        }
        Ok(())
    }

    /// Counts what is about to be made.
    fn take(&self, count: u64, size: usize, place: &str) -> Result<(), SceneError> {
        let count = usize::try_from(count).unwrap_or(usize::MAX);
        self.budget.take(count, size).map_err(|problem| self.wrong(place, problem))
    }

    /// Returns the content behind a URI of the file: embedded data, or another file.
    fn fetch(&mut self, uri: &str) -> Result<Vec<u8>, String> {
        let shown: String = uri.chars().take(80).collect();
        if uri.starts_with("data:") {
            let data = buffer::Data::from_source(buffer::Source::Uri(uri), None);
            return data.map(|data| data.0).map_err(|error| format!("`{shown}` cannot be read: {error}"));
        }
        let file = unescaped(uri).ok_or_else(|| format!("its URI `{shown}` is not UTF-8"))?;
        let file = match file.split_once(':') {
            None => file.as_str(),
            Some(("file", path)) => path.strip_prefix("//").unwrap_or(path),
            Some(_) => return Err(format!("`{shown}` cannot be read: expected a path, `file:` or `data:`")),
        };
        let path = self.path.parent().unwrap_or(Path::new("")).join(file);
        if !may_name(self.path, &path, self.roots) {
            return Err(format!("`{shown}` {OUTSIDE}"));
        }
        let cannot = |error: io::Error| format!("`{shown}` cannot be read: {error}");
        let bytes = read_file(&path).map_err(cannot)?;
        self.budget.file(&path, bytes.len());
        self.budget.take(bytes.len(), 1)?;
        self.files.push(path);
        Ok(bytes)
    }

    /// Returns the bytes of a buffer view.
    fn view(&self, index: usize, place: &str) -> Result<&[u8], SceneError> {
        let view = self.get(&self.root.buffer_views, index, "buffer view", place)?;
        let buffer = self.buffers.get(view.buffer.value()).ok_or_else(|| {
            let problem =
                format!("there is no buffer {}: there are {}", view.buffer.value(), self.buffers.len());
            self.wrong(format!("buffer view {index}"), problem)
        })?;
        let start = view.byte_offset.unwrap_or_default().0;
        let end = start.checked_add(view.byte_length.0).filter(|end| *end <= buffer.len() as u64);
        match end {
            Some(end) => Ok(&buffer[start as usize..end as usize]),
            None => Err(self.wrong(
                format!("buffer view {index}"),
                format!(
                    "bytes {start} to {start} + {} reach beyond buffer {} of {} bytes",
                    view.byte_length.0,
                    view.buffer.value(),
                    buffer.len()
                ),
            )),
        }
    }
}

/// The longest name that is kept, in characters: each message about a mesh or a material repeats it.
const MAX_NAME: usize = 200;

/// Returns the name that the document gives, without what is beyond the length of names.
fn named(name: &Option<String>) -> Option<String> {
    name.as_ref().map(|name| name.chars().take(MAX_NAME).collect())
}

/// Returns a URI with its `%xx` escapes replaced, if the result is UTF-8.
fn unescaped(uri: &str) -> Option<String> {
    let (mut out, mut rest) = (Vec::with_capacity(uri.len()), uri.as_bytes());
    while let [byte, tail @ ..] = rest {
        let escaped = (*byte == b'%')
            .then(|| tail.get(..2).and_then(|hex| std::str::from_utf8(hex).ok()))
            .flatten()
            .and_then(|hex| u8::from_str_radix(hex, 16).ok());
        out.push(escaped.unwrap_or(*byte));
        rest = if escaped.is_some() { &tail[2..] } else { tail };
    }
    String::from_utf8(out).ok()
}
