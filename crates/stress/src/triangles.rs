//! Triangles as a glTF file in one piece, for geometry that no built-in shape has.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

/// A texture of one white texel, as PNG.
const WHITE_TEXEL: &str =
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8/5+hHgAHggJ/PchI7wAAAABJRU5ErkJggg==";

/// Component types of glTF.
const FLOAT: u32 = 5126;
const UNSIGNED: u32 = 5125;

/// The material of a surface.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Look {
    /// Share of light that is reflected.
    pub(crate) albedo: f64,
    /// Whether it has a texture of one white texel.
    pub(crate) texel: bool,
}

/// A mesh with its material.
struct Mesh {
    positions: Vec<[f32; 3]>,
    /// Other attributes of the corners: name, type, and numbers.
    attributes: Vec<(&'static str, &'static str, Vec<f32>)>,
    /// Three to a triangle; empty where corners come in order.
    indices: Vec<u32>,
    look: Look,
}

impl Mesh {
    /// Returns a glTF file that has it at these nodes, seen from both sides.
    fn file(&self, nodes: &[Value]) -> String {
        let (mut views, mut accessors, mut bytes) = (Vec::new(), Vec::new(), Vec::new());
        let mut add = |added: Vec<u8>, accessor: Value| {
            views.push(json!({ "buffer": 0, "byteOffset": bytes.len(), "byteLength": added.len() }));
            bytes.extend(added);
            let mut accessor = accessor;
            accessor["bufferView"] = json!(views.len() - 1);
            accessors.push(accessor);
            accessors.len() - 1
        };
        let end = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
            let along = |i: usize| self.positions.iter().map(move |at| at[i]);
            (0..3).map(|i| along(i).reduce(pick).unwrap_or(0.0)).collect()
        };
        let count = self.positions.len();
        let mut primitive = json!({ "material": 0 });
        primitive["attributes"]["POSITION"] = json!(add(
            floats(self.positions.iter().flatten()),
            json!({ "componentType": FLOAT, "count": count, "type": "VEC3", "min": end(f32::min), "max": end(f32::max) }),
        ));
        for (name, ty, numbers) in &self.attributes {
            let accessor = json!({ "componentType": FLOAT, "count": count, "type": ty });
            primitive["attributes"][name] = json!(add(floats(numbers), accessor));
        }
        if !self.indices.is_empty() {
            let indices = self.indices.iter().flat_map(|index| index.to_le_bytes()).collect();
            let accessor =
                json!({ "componentType": UNSIGNED, "count": self.indices.len(), "type": "SCALAR" });
            primitive["indices"] = json!(add(indices, accessor));
        }
        let albedo = self.look.albedo;
        let mut surface = json!({
            "baseColorFactor": [albedo, albedo, albedo, 1.0], "metallicFactor": 0.0, "roughnessFactor": 1.0,
        });
        let mut file = json!({
            "asset": { "version": "2.0" },
            "scene": 0,
            "scenes": [{ "nodes": (0..nodes.len()).collect::<Vec<_>>() }],
            "nodes": nodes,
            "meshes": [{ "primitives": [primitive] }],
            "accessors": accessors,
            "bufferViews": views,
            "buffers": [{
                "byteLength": bytes.len(),
                "uri": format!("data:application/octet-stream;base64,{}", STANDARD.encode(&bytes)),
            }],
        });
        if self.look.texel {
            surface["baseColorTexture"] = json!({ "index": 0 });
            file["textures"] = json!([{ "source": 0 }]);
            file["images"] = json!([{ "uri": format!("data:image/png;base64,{WHITE_TEXEL}") }]);
        }
        file["materials"] = json!([{ "pbrMetallicRoughness": surface, "doubleSided": true }]);
        format!("{file}\n")
    }
}

fn floats<'a>(numbers: impl IntoIterator<Item = &'a f32>) -> Vec<u8> {
    numbers.into_iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// Returns a glTF file of triangles.
pub(crate) fn gltf(triangles: &[[[f32; 3]; 3]], look: Look) -> String {
    let positions: Vec<[f32; 3]> = triangles.iter().flatten().copied().collect();
    let uvs = positions.iter().flat_map(|[x, y, _]| [*x, *y]).collect();
    let mesh = Mesh { positions, attributes: vec![("TEXCOORD_0", "VEC2", uvs)], indices: Vec::new(), look };
    mesh.file(&[json!({ "mesh": 0 })])
}

/// Returns a glTF file of a sheet of `2 side²` triangles, `count` times on the floor of the Cornell box.
pub(crate) fn sheets(side: u32, count: u32) -> String {
    let across = side + 1;
    let at = |n: u32| n as f32 / side as f32;
    let positions = (0..across * across).map(|i| [at(i % across), 0.0, at(i / across)]).collect();
    let corners = |i: u32| {
        let a = i / side * across + i % side;
        [a, a + 1, a + across, a + 1, a + across + 1, a + across]
    };
    let indices = (0..side * side).flat_map(corners).collect();
    let rows = f64::from(count).sqrt().ceil() as u32;
    let step = 0.5 / f64::from(rows);
    let node = |i: u32| {
        let at = |n: u32| 0.02 + step * f64::from(n);
        // Neighbors lie at other heights, or their edges would meet.
        let height = 1e-3 + 1e-4 * f64::from(i % 7);
        json!({ "mesh": 0, "translation": [at(i % rows), height, at(i / rows)], "scale": [0.8 * step, 1.0, 0.8 * step] })
    };
    let nodes: Vec<Value> = (0..count).map(node).collect();
    Mesh { positions, attributes: Vec::new(), indices, look: Look { albedo: 0.5, texel: false } }.file(&nodes)
}

/// Returns a glTF file of a textured sheet over the floor of the Cornell box, whose normals and texture coordinates are NaN.
pub(crate) fn not_a_number() -> String {
    let mesh = Mesh {
        positions: vec![[0.1, 0.01, 0.05], [0.5, 0.01, 0.05], [0.5, 0.01, 0.3], [0.1, 0.01, 0.3]],
        attributes: vec![("NORMAL", "VEC3", vec![f32::NAN; 12]), ("TEXCOORD_0", "VEC2", vec![f32::NAN; 8])],
        indices: vec![0, 2, 1, 0, 3, 2],
        look: Look { albedo: 0.5, texel: true },
    };
    mesh.file(&[json!({ "mesh": 0 })])
}

/// A box without its front, from the origin to (1, 1, 1), as triangles: open towards −z.
pub(crate) fn open_box() -> Vec<[[f32; 3]; 3]> {
    let quad = |a: [f32; 3], b, c: [f32; 3], d| [[a, b, c], [a, c, d]];
    [
        quad([0., 0., 0.], [1., 0., 0.], [1., 0., 1.], [0., 0., 1.]),
        quad([0., 1., 0.], [1., 1., 0.], [1., 1., 1.], [0., 1., 1.]),
        quad([0., 0., 1.], [1., 0., 1.], [1., 1., 1.], [0., 1., 1.]),
        quad([0., 0., 0.], [0., 0., 1.], [0., 1., 1.], [0., 1., 0.]),
        quad([1., 0., 0.], [1., 0., 1.], [1., 1., 1.], [1., 1., 0.]),
    ]
    .concat()
}

/// Triangles without area and slivers within the Cornell box: points, lines, and needles a ten-millionth as wide as long.
pub(crate) fn degenerate() -> Vec<[[f32; 3]; 3]> {
    let mut all = Vec::new();
    for i in 0..16 {
        let x = 0.05 + 0.028 * i as f32;
        let (low, high) = ([x, 0.2, 0.3], [x, 0.45, 0.3]);
        all.push([low, low, low]);
        all.push([low, high, low]);
        all.push([low, high, [x + 2.5e-8, 0.325, 0.3]]);
    }
    all
}
