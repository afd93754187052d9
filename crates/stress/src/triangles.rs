//! Triangles as a glTF file in one piece, for geometry that no built-in shape has.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::json;

/// A texture of one white texel, as PNG.
const WHITE_TEXEL: &str =
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8/5+hHgAHggJ/PchI7wAAAABJRU5ErkJggg==";

/// How a surface looks.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Look {
    /// Share of light that is reflected.
    pub(crate) albedo: f64,
    /// Whether a texture of one white texel is over it.
    pub(crate) texel: bool,
}

/// Returns a glTF file of triangles, seen from both sides.
pub(crate) fn gltf(triangles: &[[[f32; 3]; 3]], look: Look) -> String {
    let corners: Vec<[f32; 3]> = triangles.iter().flatten().copied().collect();
    let bytes: Vec<u8> = corners.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let uvs: Vec<u8> = corners.iter().flat_map(|[x, y, _]| [*x, *y]).flat_map(f32::to_le_bytes).collect();
    let end = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
        (0..3).map(|i| corners.iter().map(|corner| corner[i]).reduce(pick).unwrap_or(0.0)).collect()
    };
    let (first, second) = (bytes.len(), uvs.len());
    let whole = [bytes, uvs].concat();
    let mut surface = json!({
        "baseColorFactor": [look.albedo, look.albedo, look.albedo, 1.0],
        "metallicFactor": 0.0,
        "roughnessFactor": 1.0,
    });
    let mut file = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "material": 0 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": corners.len(), "type": "VEC3", "min": end(f32::min), "max": end(f32::max) },
            { "bufferView": 1, "componentType": 5126, "count": corners.len(), "type": "VEC2" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": first },
            { "buffer": 0, "byteOffset": first, "byteLength": second },
        ],
        "buffers": [{
            "byteLength": whole.len(),
            "uri": format!("data:application/octet-stream;base64,{}", STANDARD.encode(&whole)),
        }],
    });
    if look.texel {
        surface["baseColorTexture"] = json!({ "index": 0 });
        file["textures"] = json!([{ "source": 0 }]);
        file["images"] = json!([{ "uri": format!("data:image/png;base64,{WHITE_TEXEL}") }]);
    }
    file["materials"] = json!([{ "pbrMetallicRoughness": surface, "doubleSided": true }]);
    format!("{file:#}\n")
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
