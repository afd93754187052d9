//! What the tests share: the scenes of this project, descriptions in memory, and small glTF files.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use data_file::{Files, Source};
use glam::Vec3;
use scene::{Scene, SceneError, SceneFiles, load};
use serde_json::{Value, json};

/// The scene files of this project.
pub(crate) struct Shipped;

pub(crate) fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The folder of real scenes beside the project, where there is one.
pub(crate) fn shared() -> Option<PathBuf> {
    let folder = root().join("../shared/scenes");
    if folder.is_dir() {
        return Some(folder);
    }
    eprintln!("skipped: there is no folder {}", folder.display());
    None
}

impl Files for Shipped {
    fn read(&self, path: &str) -> Option<Arc<Source>> {
        let text = std::fs::read_to_string(self.folder().join(path)).ok()?;
        Some(Arc::new(Source { name: format!("scenes/{path}"), text }))
    }

    fn list(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.folder()).expect("the folder of scenes");
        let mut names: Vec<String> =
            entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.retain(|name| name.ends_with(".ron"));
        names.sort();
        names
    }
}

impl SceneFiles for Shipped {
    fn folder(&self) -> PathBuf {
        root().join("scenes")
    }
}

/// Descriptions in memory.
pub(crate) struct InMemory(pub(crate) BTreeMap<&'static str, String>);

impl Files for InMemory {
    fn read(&self, path: &str) -> Option<Arc<Source>> {
        self.0.get(path).map(|text| Arc::new(Source { name: path.into(), text: text.clone() }))
    }

    fn list(&self) -> Vec<String> {
        self.0.keys().map(|name| name.to_string()).collect()
    }
}

impl SceneFiles for InMemory {}

pub(crate) fn shipped(name: &str) -> Scene {
    load(name, &Shipped).unwrap_or_else(|error| panic!("{error}"))
}

pub(crate) fn load_text(text: &str) -> Result<Scene, SceneError> {
    load_text_in(Path::new(""), text)
}

/// Loads a scene file of this text, which names geometry files of `folder`.
pub(crate) fn load_text_in(folder: &Path, text: &str) -> Result<Scene, SceneError> {
    load("test", &InFolder(folder, text))
}

struct InFolder<'a>(&'a Path, &'a str);

impl Files for InFolder<'_> {
    fn read(&self, path: &str) -> Option<Arc<Source>> {
        (path == "test.ron").then(|| Source::new(path, self.1))
    }

    fn list(&self) -> Vec<String> {
        vec!["test.ron".to_owned()]
    }
}

impl SceneFiles for InFolder<'_> {
    fn folder(&self) -> PathBuf {
        self.0.to_owned()
    }
}

/// Unsigned integers, with their componentType.
pub(crate) trait Unsigned: bytemuck::Pod {
    const COMPONENT: u32;
}

impl Unsigned for u8 {
    const COMPONENT: u32 = 5121;
}

impl Unsigned for u16 {
    const COMPONENT: u32 = 5123;
}

/// A glTF file in the making: its JSON, and its binary chunk.
pub(crate) struct Glb {
    pub(crate) json: Value,
    pub(crate) bin: Vec<u8>,
}

impl Glb {
    pub(crate) fn new() -> Glb {
        let json = json!({
            "asset": { "version": "2.0" }, "buffers": [{ "byteLength": 0 }], "bufferViews": [], "accessors": [],
            "meshes": [], "nodes": [],
        });
        Glb { json, bin: Vec::new() }
    }

    pub(crate) fn push(&mut self, list: &str, item: Value) -> usize {
        if self.json[list].is_null() {
            self.json[list] = json!([]);
        }
        let list = self.json[list].as_array_mut().expect("a list");
        list.push(item);
        list.len() - 1
    }

    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        let offset = self.bin.len();
        self.bin.extend(bytes);
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        self.push("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }))
    }

    pub(crate) fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let sizes = [("SCALAR", 1), ("VEC2", 2), ("VEC3", 3), ("VEC4", 4), ("MAT4", 16)];
        let components = sizes.iter().find(|(k, _)| *k == kind).expect("a kind").1;
        let view = self.view(bytemuck::cast_slice(values));
        let count = values.len() / components;
        self.push(
            "accessors",
            json!({ "bufferView": view, "componentType": 5126, "count": count, "type": kind }),
        )
    }

    /// Elements of four unsigned integers each.
    pub(crate) fn fours<T: Unsigned>(&mut self, values: &[T], normalized: bool) -> usize {
        let view = self.view(bytemuck::cast_slice(values));
        self.push(
            "accessors",
            json!({ "bufferView": view, "componentType": T::COMPONENT, "normalized": normalized,
                "count": values.len() / 4, "type": "VEC4" }),
        )
    }

    /// Sets an attribute of the first primitive.
    pub(crate) fn attribute(&mut self, name: &str, accessor: usize) {
        self.json["meshes"][0]["primitives"][0]["attributes"][name] = json!(accessor);
    }

    /// Adds a channel, as an animation of its own sampler, to the first animation.
    pub(crate) fn animate(
        &mut self,
        node: usize,
        path: &str,
        interpolation: &str,
        input: usize,
        output: usize,
    ) {
        if self.json["animations"].is_null() {
            self.push("animations", json!({ "samplers": [], "channels": [] }));
        }
        let animation = &mut self.json["animations"][0];
        let samplers = animation["samplers"].as_array_mut().expect("a list");
        samplers.push(json!({ "input": input, "output": output, "interpolation": interpolation }));
        let sampler = samplers.len() - 1;
        let channel = json!({ "sampler": sampler, "target": { "node": node, "path": path } });
        animation["channels"].as_array_mut().expect("a list").push(channel);
    }

    pub(crate) fn indices(&mut self, values: &[u16]) -> usize {
        let view = self.view(bytemuck::cast_slice(values));
        self.push(
            "accessors",
            json!({ "bufferView": view, "componentType": 5123, "count": values.len(), "type": "SCALAR" }),
        )
    }

    /// A mesh of one primitive.
    pub(crate) fn mesh(&mut self, primitive: Value) -> usize {
        self.push("meshes", json!({ "name": "mesh", "primitives": [primitive] }))
    }

    /// A unit square at z = 0 facing +z, with normals and indices, at a node.
    pub(crate) fn square() -> Glb {
        let mut glb = Glb::new();
        let positions = glb.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
        let normals = glb.floats("VEC3", &[0.0, 0.0, 1.0].repeat(4));
        let indices = glb.indices(&[0, 1, 2, 0, 2, 3]);
        glb.mesh(json!({ "attributes": { "POSITION": positions, "NORMAL": normals }, "indices": indices }));
        glb.push("nodes", json!({ "name": "square", "mesh": 0 }));
        glb
    }

    pub(crate) fn bytes(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        json["buffers"][0]["byteLength"] = json!(self.bin.len());
        let mut json = serde_json::to_vec(&json).expect("JSON");
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut out = b"glTF".to_vec();
        let total = 12 + 8 + json.len() + 8 + self.bin.len();
        for n in [2, total as u32, json.len() as u32] {
            out.extend(n.to_le_bytes());
        }
        out.extend(b"JSON");
        out.extend(json);
        out.extend((self.bin.len() as u32).to_le_bytes());
        out.extend(b"BIN\0");
        out.extend(&self.bin);
        out
    }

    pub(crate) fn load(&self) -> Result<Scene, SceneError> {
        load_bytes("test.glb", &self.bytes())
    }
}

/// Loads a file of these bytes from a folder of its own.
pub(crate) fn load_bytes(name: &str, bytes: &[u8]) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).expect("a file");
    load(path.to_str().expect("UTF-8"), &InMemory(BTreeMap::new()))
}

/// The place of a vertex in the world of the scene's file.
pub(crate) fn position(scene: &Scene, vertex: usize) -> Vec3 {
    (scene.origin + Vec3::from(scene.vertices[vertex].position).as_dvec3()).as_vec3()
}

pub(crate) fn normal(scene: &Scene, vertex: usize) -> Vec3 {
    scene.vertices[vertex].normal.into()
}

/// Whether any of the stated repairs holds these words.
pub(crate) fn states(scene: &Scene, words: &str) -> bool {
    scene.repairs.iter().any(|repair| repair.contains(words))
}
