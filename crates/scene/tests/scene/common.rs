//! Shared by the tests: the scenes of this project, descriptions in memory, and small glTF files.

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

/// Descriptions in memory, by their file names, with geometry files in a folder.
#[derive(Default)]
pub(crate) struct InMemory {
    pub(crate) texts: BTreeMap<&'static str, String>,
    pub(crate) folder: PathBuf,
}

impl Files for InMemory {
    fn read(&self, path: &str) -> Option<Arc<Source>> {
        self.texts.get(path).map(|text| Source::new(path, text.as_str()))
    }

    fn list(&self) -> Vec<String> {
        self.texts.keys().map(|name| name.to_string()).collect()
    }
}

impl SceneFiles for InMemory {
    fn folder(&self) -> PathBuf {
        self.folder.clone()
    }
}

pub(crate) fn shipped(name: &str) -> Scene {
    load(name, &Shipped).unwrap_or_else(|error| panic!("{error}"))
}

/// Loads a file on disk.
pub(crate) fn try_load(path: &Path) -> Result<Scene, SceneError> {
    load(path.to_str().unwrap(), &InMemory::default())
}

/// Loads a good file on disk.
pub(crate) fn load_path(path: &Path) -> Scene {
    try_load(path).unwrap_or_else(|error| panic!("{error}"))
}

/// Loads a scene file of this text, which names geometry files of `folder`.
pub(crate) fn load_text_in(folder: &Path, text: &str) -> Result<Scene, SceneError> {
    load("test", &InMemory { texts: [("test.ron", text.to_owned())].into(), folder: folder.into() })
}

pub(crate) fn load_text(text: &str) -> Result<Scene, SceneError> {
    load_text_in(Path::new(""), text)
}

/// Loads a good scene file of this text, which names geometry files of `folder`.
#[track_caller]
pub(crate) fn scene_in(folder: &Path, text: &str) -> Scene {
    load_text_in(folder, text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Loads a good scene file of this text.
#[track_caller]
pub(crate) fn scene_of(text: &str) -> Scene {
    scene_in(Path::new(""), text)
}

/// Loads a built-in geometry alone.
pub(crate) fn built_in(name: &str) -> Scene {
    scene_of(&format!("Scene(geometry: BuiltIn({name:?}))"))
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

    pub(crate) fn accessor(&mut self, accessor: Value) -> usize {
        self.push("accessors", accessor)
    }

    pub(crate) fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let sizes = [("SCALAR", 1), ("VEC2", 2), ("VEC3", 3), ("VEC4", 4), ("MAT4", 16)];
        let components = sizes.iter().find(|(k, _)| *k == kind).expect("a kind").1;
        let (view, count) = (self.view(bytemuck::cast_slice(values)), values.len() / components);
        self.accessor(json!({ "bufferView": view, "componentType": 5126, "count": count, "type": kind }))
    }

    /// Adds elements of four unsigned integers each.
    pub(crate) fn fours<T: Unsigned>(&mut self, values: &[T], normalized: bool) -> usize {
        let (view, count) = (self.view(bytemuck::cast_slice(values)), values.len() / 4);
        self.accessor(json!({ "bufferView": view, "componentType": T::COMPONENT, "normalized": normalized,
            "count": count, "type": "VEC4" }))
    }

    /// Returns the first primitive.
    pub(crate) fn primitive(&mut self) -> &mut Value {
        &mut self.json["meshes"][0]["primitives"][0]
    }

    /// Replaces one element of an accessor by a sparse value.
    pub(crate) fn sparse(&mut self, accessor: usize, element: u8, value: [f32; 3], count: u64) {
        let (at, value) = (self.view(&[element]), self.view(bytemuck::cast_slice(&value)));
        self.json["accessors"][accessor]["sparse"] = json!({ "count": count,
            "indices": { "bufferView": at, "componentType": 5121 }, "values": { "bufferView": value } });
    }

    /// Removes the normals of the first primitive.
    pub(crate) fn without_normals(&mut self) {
        self.primitive()["attributes"].as_object_mut().expect("an object").remove("NORMAL");
    }

    /// Sets an attribute of the first primitive.
    pub(crate) fn attribute(&mut self, name: &str, accessor: usize) {
        self.primitive()["attributes"][name] = json!(accessor);
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
        let (view, count) = (self.view(bytemuck::cast_slice(values)), values.len());
        self.accessor(json!({ "bufferView": view, "componentType": 5123, "count": count, "type": "SCALAR" }))
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

    /// Loads a good file.
    #[track_caller]
    pub(crate) fn scene(&self) -> Scene {
        self.load().unwrap_or_else(|error| panic!("{error}"))
    }
}

/// Loads a file of these bytes from a folder of its own.
pub(crate) fn load_bytes(name: &str, bytes: &[u8]) -> Result<Scene, SceneError> {
    let folder = folder_of(&[(name, bytes)]);
    try_load(&folder.path().join(name))
}

/// Returns a folder with these files.
pub(crate) fn folder_of(files: &[(&str, &[u8])]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }
    folder
}

/// A way to spoil a file: what is spoilt, words of the error, and the change.
pub(crate) type Spoilt = (&'static str, &'static [&'static str], fn(&mut Glb));

/// Checks that each case refuses the file, with its name and these words.
pub(crate) fn assert_refused(good: impl Fn() -> Glb, cases: &[Spoilt]) {
    for (what, words, change) in cases {
        let mut glb = good();
        change(&mut glb);
        let error = glb.load().expect_err(what).to_string();
        for word in ["test.glb"].iter().chain(*words) {
            assert!(error.contains(word), "{what}: `{word}` in: {error}");
        }
    }
}

/// Returns the position of a vertex in the world of the scene's file.
pub(crate) fn position(scene: &Scene, vertex: usize) -> Vec3 {
    (scene.origin + Vec3::from(scene.vertices[vertex].position).as_dvec3()).as_vec3()
}

pub(crate) fn normal(scene: &Scene, vertex: usize) -> Vec3 {
    scene.vertices[vertex].normal.into()
}

#[track_caller]
pub(crate) fn assert_near(found: Vec3, expected: Vec3) {
    assert!(found.abs_diff_eq(expected, 1e-6), "{found}, not {expected}");
}

/// Checks that triangles wind as their vertices are shaded; returns their unit normals.
#[track_caller]
pub(crate) fn assert_windings(scene: &Scene, tolerance: f32) -> Vec<Vec3> {
    let triangles = scene.indices.chunks_exact(3).map(|triangle| {
        let [a, b, c] = [0, 1, 2].map(|i| position(scene, triangle[i] as usize));
        let (face, shading) = ((b - a).cross(c - a).normalize(), normal(scene, triangle[0] as usize));
        assert!(face.abs_diff_eq(shading, tolerance), "winds as {face}, shaded as {shading}");
        face
    });
    triangles.collect()
}

pub(crate) fn states(scene: &Scene, words: &str) -> bool {
    scene.repairs.iter().any(|repair| repair.contains(words))
}

/// Checks that a repair that the scene states holds these words.
#[track_caller]
pub(crate) fn assert_states(scene: &Scene, words: &str) {
    assert!(states(scene, words), "expected `{words}` in {:?}", scene.repairs);
}

/// Checks a trait of the scene.
#[track_caller]
pub(crate) fn assert_trait(scene: &Scene, name: &str, expected: bool) {
    assert_eq!(scene.traits().values[name].as_bool(), Some(expected), "{name}");
}
