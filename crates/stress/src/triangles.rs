//! Triangles as a glTF file in one piece, for geometry that no built-in shape has.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::Deserialize;
use serde_json::{Value, json};

/// A texture of one white texel, as PNG.
const WHITE_TEXEL: &str =
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8/5+hHgAHggJ/PchI7wAAAABJRU5ErkJggg==";

/// Component types of glTF.
const FLOAT: u32 = 5126;
const UNSIGNED: u32 = 5125;

/// The mesh of a file of the table, seen from both sides.
#[derive(Clone, Copy, Debug, Deserialize)]
pub(crate) enum Mesh {
    /// One triangle.
    OneTriangle,
    /// A box without its front, from the origin to (1, 1, 1): open towards −z.
    OpenBox {
        /// Share of light that is reflected.
        albedo: f64,
        /// Whether it has a texture of one white texel.
        #[serde(default)]
        texel: bool,
    },
    /// Triangles without area and slivers within the Cornell box: points, lines, and needles a ten-millionth as wide as long.
    Degenerate,
    /// A sheet of `2 side²` triangles, `count` times on the floor of the Cornell box.
    Sheets {
        /// Squares along a side of the sheet.
        side: u32,
        /// Number of sheets.
        count: u32,
    },
    /// A textured sheet over the floor of the Cornell box, whose normals and texture coordinates are NaN.
    NotANumber,
}

/// What a glTF file holds of a mesh.
struct Data {
    positions: Vec<[f32; 3]>,
    /// Other attributes of the corners: name, type, and numbers.
    attributes: Vec<(&'static str, &'static str, Vec<f32>)>,
    /// Three to a triangle; empty where corners come in order.
    indices: Vec<u32>,
    albedo: f64,
    /// Whether it has a texture of one white texel.
    texel: bool,
}

type Triangle = [[f32; 3]; 3];

impl Mesh {
    /// Returns whether it stands in the place of the Cornell box.
    pub(crate) fn replaces_box(self) -> bool {
        matches!(self, Mesh::OneTriangle | Mesh::OpenBox { .. })
    }

    /// Returns the text of the file.
    pub(crate) fn gltf(self) -> String {
        let one = [json!({ "mesh": 0 })];
        match self {
            Mesh::OneTriangle => {
                Data::of(&[[[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.5, 1.0, 1.0]]], 0.5, false).file(&one)
            }
            Mesh::OpenBox { albedo, texel } => Data::of(&open_box(), albedo, texel).file(&one),
            Mesh::Degenerate => Data::of(&degenerate(), 0.5, false).file(&one),
            Mesh::Sheets { side, count } => sheets(side, count),
            Mesh::NotANumber => not_a_number().file(&one),
        }
    }
}

impl Data {
    fn of(triangles: &[Triangle], albedo: f64, texel: bool) -> Data {
        let positions: Vec<[f32; 3]> = triangles.iter().flatten().copied().collect();
        let uvs = positions.iter().flat_map(|[x, y, _]| [*x, *y]).collect();
        let attributes = vec![("TEXCOORD_0", "VEC2", uvs)];
        Data { positions, attributes, indices: Vec::new(), albedo, texel }
    }

    /// Returns the text of a file that has it at these nodes, seen from both sides.
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
        let albedo = self.albedo;
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
        if self.texel {
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

fn sheets(side: u32, count: u32) -> String {
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
    Data { positions, attributes: Vec::new(), indices, albedo: 0.5, texel: false }.file(&nodes)
}

fn not_a_number() -> Data {
    Data {
        positions: vec![[0.1, 0.01, 0.05], [0.5, 0.01, 0.05], [0.5, 0.01, 0.3], [0.1, 0.01, 0.3]],
        attributes: vec![("NORMAL", "VEC3", vec![f32::NAN; 12]), ("TEXCOORD_0", "VEC2", vec![f32::NAN; 8])],
        indices: vec![0, 2, 1, 0, 3, 2],
        albedo: 0.5,
        texel: true,
    }
}

fn open_box() -> Vec<Triangle> {
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

fn degenerate() -> Vec<Triangle> {
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
