//! Files that ask for more than they hold: gigabytes from kilobytes, depth without end, paths to elsewhere. Each is
//! refused with what it asks for, before memory is taken.

use crate::common::{
    Glb, Shipped, folder_of, load_bytes, load_path, load_text, load_text_in, scene_in, scene_of, try_load,
};
use data_file::Files;
use proptest::prelude::*;
use scene::{Scene, SceneError};
use serde_json::{Value, json};
use std::fs;
use std::time::Duration;

const LIMIT: Duration = Duration::from_secs(20);

/// Returns the error of a file of less than 400 KB, which must be found in time.
fn refused(bytes: Vec<u8>) -> String {
    assert!(bytes.len() < 400_000, "{} bytes", bytes.len());
    let name = if bytes.starts_with(b"glTF") { "test.glb" } else { "test.gltf" };
    let result = mutation::within(LIMIT, move || load_bytes(name, &bytes).map(|scene| scene.triangles()));
    let error = result.expect_err("it asks for too much").to_string();
    assert!(error.len() < 2000, "{error}");
    error
}

/// Refused for what it asks for, with the bound.
fn too_much(glb: &Glb, place: &str) {
    let error = refused(glb.bytes());
    assert!(
        error.contains(place) && error.contains("it asks for ") && error.contains(" MiB in all"),
        "{error}"
    );
}

/// Adds an accessor of zeros.
fn zeros(glb: &mut Glb, kind: &str, component: u32, count: u64) -> usize {
    glb.accessor(json!({ "componentType": component, "count": count, "type": kind }))
}

#[test]
fn accessors_without_a_buffer_cannot_ask_for_gigabytes() {
    for (kind, component, count) in [
        ("VEC3", 5126, 1 << 24),
        ("MAT4", 5126, 1 << 23),
        ("VEC3", 5121, 1 << 40),
        ("VEC3", 5126, u64::MAX >> 1),
    ] {
        let mut glb = Glb::square();
        let accessor = zeros(&mut glb, kind, component, count);
        glb.attribute("POSITION", accessor);
        too_much(&glb, "0");
    }
    // Little by itself, and asked for again and again.
    let mut glb = Glb::square();
    let indices = zeros(&mut glb, "SCALAR", 5125, 4_000_000);
    let part = json!({ "attributes": { "POSITION": 0 }, "indices": indices });
    glb.json["meshes"][0]["primitives"] = json!(vec![part; 200]);
    too_much(&glb, "mesh 0");
}

#[test]
fn sparse_accessors_cannot_ask_for_gigabytes() {
    let mut glb = Glb::square();
    let accessor = zeros(&mut glb, "VEC3", 5126, 4);
    glb.sparse(accessor, 2, [2.0, 2.0, 0.0], 1 << 60);
    glb.attribute("POSITION", accessor);
    too_much(&glb, &format!("accessor {accessor}"));
}

#[test]
fn lists_that_many_parts_share_are_counted_for_each() {
    let mut glb = Glb::new();
    let positions = glb.floats("VEC3", &[0.5; 3 * 8000]);
    let targets = json!(vec![json!({ "POSITION": positions }); 4000]);
    glb.mesh(json!({ "attributes": { "POSITION": positions }, "targets": targets }));
    glb.push("nodes", json!({ "mesh": 0 }));
    too_much(&glb, "accessor");
}

#[test]
fn corners_without_normals_are_counted_with_their_targets() {
    // A triangle with many targets, repeated by its indices: each corner has all targets.
    let mut glb = Glb::new();
    let positions = glb.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    let indices = glb.indices(&[0, 1, 2].repeat(20_000));
    let targets = json!(vec![json!({ "POSITION": positions }); 2000]);
    glb.mesh(json!({ "attributes": { "POSITION": positions }, "indices": indices, "targets": targets }));
    glb.push("nodes", json!({ "mesh": 0 }));
    too_much(&glb, "primitive 0");
}

#[test]
fn a_mesh_at_nodes_without_number_is_counted_for_each() {
    let mut glb = Glb::new();
    let positions = glb.floats("VEC3", &[0.25; 3 * 6000]);
    glb.mesh(json!({ "attributes": { "POSITION": positions, "NORMAL": positions } }));
    for _ in 0..8000 {
        glb.push("nodes", json!({ "mesh": 0 }));
    }
    too_much(&glb, "test");
    // The weights of morph targets are of nodes.
    let mut glb = Glb::square();
    glb.primitive()["targets"] = json!(vec![json!({}); 40_000]);
    glb.json["nodes"] = json!(vec![json!({ "mesh": 0 }); 10_000]);
    too_much(&glb, "node");
}

#[test]
fn nodes_must_be_a_tree_of_any_depth() {
    let mut glb = Glb::square();
    glb.json["nodes"] = (0..20_000).map(|i| json!({ "children": [i + 1] })).collect();
    glb.push("nodes", json!({ "mesh": 0 }));
    glb.json["scenes"] = json!([{ "nodes": [0] }]);
    let bytes = glb.bytes();
    let scene = mutation::within(LIMIT, move || load_bytes("test.glb", &bytes)).expect("a deep tree");
    assert_eq!(scene.triangles(), 2);
    // A cycle; and a graph in which the number of ways doubles with each node.
    for children in [|i: usize| vec![(i + 1) % 40], |i: usize| vec![i + 1, i + 1]] {
        let mut glb = Glb::square();
        glb.json["nodes"] = (0..40).map(|i| json!({ "children": children(i), "mesh": 0 })).collect();
        glb.push("nodes", json!({ "mesh": 0 }));
        glb.json["scenes"] = json!([{ "nodes": [0] }]);
        let error = refused(glb.bytes());
        assert!(error.contains("reached twice"), "{error}");
    }
}

#[test]
fn long_names_are_not_repeated_by_what_is_stated() {
    let mut glb = Glb::new();
    let positions = glb.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    let part = |mode: u32| json!({ "attributes": { "POSITION": positions }, "mode": mode });
    let (triangle, lines) = (part(4), part(1));
    let parts: Vec<_> = std::iter::once(triangle).chain(vec![lines; 2000]).collect();
    glb.json["meshes"] = json!([{ "name": "x".repeat(100_000), "primitives": parts }]);
    glb.push("nodes", json!({ "mesh": 0, "name": "y".repeat(100_000) }));
    let bytes = glb.bytes();
    let scene = mutation::within(LIMIT, move || load_bytes("test.glb", &bytes)).expect("a scene");
    let stated: usize = scene.repairs.iter().map(String::len).sum();
    assert!(scene.repairs.len() >= 2000 && stated < 1_000_000, "{stated} bytes");
}

/// A square with a texture of these bytes.
fn textured(image: &[u8]) -> Glb {
    let mut glb = Glb::square();
    let view = glb.view(image);
    glb.push("images", json!({ "bufferView": view, "mimeType": "image/png", "name": "odd" }));
    glb.push("textures", json!({ "source": 0 }));
    let texture = json!({ "index": 0 });
    glb.push("materials", json!({ "pbrMetallicRoughness": { "baseColorTexture": texture } }));
    glb.primitive()["material"] = json!(0);
    glb
}

/// Checks that one repair holds both.
fn assert_states_both(scene: &Scene, a: &str, b: &str) {
    let both = scene.repairs.iter().any(|repair| repair.contains(a) && repair.contains(b));
    assert!(both, "{:?}", scene.repairs);
}

/// A PNG file of one bit a pixel, all black.
fn black(width: u32, height: u32) -> Vec<u8> {
    let mut image = std::io::Cursor::new(Vec::new());
    image::GrayImage::new(width, height).write_to(&mut image, image::ImageFormat::Png).expect("encoded");
    image.into_inner()
}

#[test]
fn images_cannot_ask_for_gigabytes() {
    // A header alone: 16384 × 16384 fit a GPU, and no file of this size.
    let mut png = black(8, 8);
    png[16..24].copy_from_slice(&[16_384_u32.to_be_bytes(); 2].concat());
    too_much(&textured(&png), "image 0");
    png[16..24].copy_from_slice(&[0x7f; 8]);
    let scene = textured(&png).scene();
    assert_states_both(&scene, "odd", "16384");
    // One image of 4 MiB, as the source of many textures.
    let mut glb = textured(&black(1024, 1024));
    for _ in 0..1000 {
        let texture = glb.push("textures", json!({ "source": 0 }));
        glb.push(
            "materials",
            json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": texture } } }),
        );
    }
    too_much(&glb, "texture");
}

#[test]
fn an_image_for_which_the_decoder_panics_is_left_out_and_named() {
    let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
    let chunks: [(&[u8], [u8; 4]); 5] = [
        (b"IHDR\0\0\0\x17\0\0\0\x11\x08\x03\0\0\0", [0x01, 0xad, 0xc7, 0x8f]),
        (b"PLTE\xcf\xfc\xdf\x89", [0xb4, 0x97, 0x38, 0xca]),
        (b"tRNS\x53\x3e\x84\x2b", [0xaa, 0x05, 0x28, 0xed]),
        (b"IDATx\x9cc``db\xc6\x81\x19F\xc5\x07T\x1c\0\xbf\xe7\x02\x32", [0x45, 0x05, 0xeb, 0]),
        (b"IEND", [0xae, 0x42, 0x60, 0x82]),
    ];
    for (content, sum) in chunks {
        png.extend((content.len() as u32 - 4).to_be_bytes());
        png.extend(content);
        png.extend(sum);
    }
    let scene = textured(&png).scene();
    assert_states_both(&scene, "`odd`", "palette");
}

#[test]
fn json_nested_too_deep_is_refused() {
    for piece in ["[", "{\"a\":"] {
        for start in
            ["", "{\"asset\":{\"version\":\"2.0\",\"extras\":", "{\"asset\":{\"version\":\"2.0\"},\"nodes\":"]
        {
            let error = refused(format!("{start}{}", piece.repeat(50_000)).into_bytes());
            assert!(error.contains("recursion limit") || error.contains("JSON"), "{error}");
        }
    }
}

#[test]
fn a_scene_file_cannot_ask_for_gigabytes() {
    let objects = |count: usize, geometry: &str| {
        let object = |i| format!("Object(name: \"o{i}\", geometry: {geometry}),");
        format!("Scene(geometry: Objects([{}]))", (0..count).map(object).collect::<String>())
    };
    let text = objects(5000, "BuiltIn(\"hall-16k\")");
    let error =
        mutation::within(LIMIT, move || load_text(&text).map(|_| ())).expect_err("too much").to_string();
    assert!(error.contains("it asks for ") && error.contains("KiB of files"), "{error}");
    // A few are what a scene may hold, however many bytes it has; and what is small, many times.
    assert_eq!(scene_of(&objects(3, "BuiltIn(\"hall-16k\")")).instances.len() % 3, 0);
    let text = objects(20_000, "BuiltIn(\"cube\")");
    let scene = mutation::within(LIMIT, move || load_text(&text)).expect("a scene");
    assert_eq!(scene.triangles(), 240_000);
}

#[test]
fn a_file_that_is_named_in_many_ways_is_read_once() {
    let folder = folder_of(&[("a.glb", &Glb::square().bytes())]);
    let object = |i: usize| format!("Object(name: \"o{i}\", geometry: File(\"{}a.glb\")),", "./".repeat(i));
    let text = format!("Scene(geometry: Objects([{}]))", (0..20).map(object).collect::<String>());
    let scene = scene_in(folder.path(), &text);
    assert_eq!((scene.triangles(), scene.files.len()), (40, 1));
}

#[test]
fn descriptions_of_one_piece_and_of_many_names_are_stated_fast() {
    for (piece, text) in mutation::large(1 << 20) {
        let error = mutation::within(LIMIT, move || load_text(&text).map(|_| ())).expect_err("no scene");
        assert!(error.to_string().len() < 200_000, "{piece:?}");
    }
    let objects: String =
        (0..20_000).map(|i| format!("Object(name: \"o{i}\", geometry: BuiltIn(\"cube\")),")).collect();
    let lights: String = (0..20_000)
        .map(|i| format!("Point(name: \"l{i}\", position: (0,0,0), intensity: (1,1,1)),"))
        .collect();
    let keys = |name: &str| -> String {
        (0..20_000).map(|i| format!("\"{name}{i}\": [Key(time: 0.0), Key(time: 1.0)],")).collect()
    };
    for wrong in ["o", "x"] {
        let text = format!(
            "Scene(geometry: Objects([{objects}]), lights: [{lights}], keyframes: Keyframes(lights: {{{}}}, objects: {{{}}}))",
            keys("l"),
            keys(wrong)
        );
        let result = mutation::within(LIMIT, move || load_text(&text).map(|scene| scene.lights.len()));
        match result {
            Ok(lights) => assert_eq!((wrong, lights), ("o", 20_000)),
            Err(error) => assert!(wrong == "x" && error.to_string().len() < 200_000),
        }
    }
}

#[test]
fn files_name_no_files_outside_of_their_folders() {
    let square = Glb::square().bytes();
    let names = ["models/a.glb", "scenes/a.glb", "scenes/inner/a.glb"];
    let folder = folder_of(&names.map(|name| (name, &square[..])));
    let at = |name: &str| folder.path().join(name);
    let scenes = at("scenes");
    let load_file = |file: &str| load_text_in(&scenes, &format!("Scene(geometry: File({file:?}))"));
    let absolute = at("scenes/a.glb");
    for good in
        ["a.glb", "inner/a.glb", "./inner/../a.glb", "../scenes/a.glb", absolute.to_str().expect("UTF-8")]
    {
        load_file(good).unwrap_or_else(|error| panic!("{error}"));
    }
    let outside = at("models/a.glb");
    for bad in
        ["../models/a.glb", "inner/../../models/a.glb", "/etc/passwd", outside.to_str().expect("UTF-8")]
    {
        let error = load_file(bad).expect_err("it is outside").to_string();
        assert!(
            error.contains("error[C") && error.contains(":1:22") && error.contains("`--root`"),
            "{error}"
        );
    }
    // On the command line the user says so.
    let given = load_path(&outside);
    assert_eq!(given.triangles(), 2);
}

#[test]
fn models_name_no_files_outside_of_their_folders() {
    let png = black(2, 2);
    let folder =
        folder_of(&["a.png", "models/a.png", "models/textures/a b.png"].map(|name| (name, &png[..])));
    let at = |name: &str| folder.path().join(name);
    let outside = at("a.png");
    let outside = outside.to_str().expect("UTF-8");
    let load_with = |uri: &str| -> Result<Scene, SceneError> {
        let mut glb = textured(&[]);
        glb.json["images"] = json!([{ "uri": uri, "name": "odd" }]);
        fs::write(at("models/m.glb"), glb.bytes()).unwrap();
        try_load(&at("models/m.glb"))
    };
    let inside = at("models/a.png");
    let inside = format!("file://{}", inside.to_str().expect("UTF-8"));
    for good in ["a.png", "textures/a%20b.png", "textures/../a.png", &inside] {
        let scene = load_with(good).expect("a scene");
        assert_eq!(scene.textures.len(), 1, "{good}: {:?}", scene.repairs);
    }
    let file = format!("file://{outside}");
    for bad in [
        "../a.png",
        "textures/../../a.png",
        "%2e%2e/a.png",
        outside,
        &file,
        "/etc/passwd",
        "../../../../etc/passwd",
    ] {
        let scene = load_with(bad).expect("the texture is left out");
        assert_states_both(&scene, "`odd`", "`--root`");
        assert!(scene.textures.is_empty(), "{bad}: {:?}", scene.repairs);
    }
    let mut glb = Glb::square();
    glb.json["buffers"] = json!([{ "uri": "../a.png", "byteLength": 4 }]);
    let error = glb.load().expect_err("its buffer is outside").to_string();
    assert!(error.contains("buffer 0") && error.contains("`--root`"), "{error}");
}

/// Good glTF files as text, with their content in them.
fn models() -> Vec<Vec<u8>> {
    let glbs = [Glb::square(), crate::broken::sample(), textured(&black(4, 4))];
    let text = |glb: &Glb| {
        let mut json: Value = glb.json.clone();
        let data: String = glb.bin.chunks(3).map(base64).collect();
        let uri = format!("data:application/octet-stream;base64,{data}");
        json["buffers"][0] = json!({ "byteLength": glb.bin.len(), "uri": uri });
        serde_json::to_vec(&json).expect("JSON")
    };
    glbs.iter().map(text).chain(glbs.iter().map(Glb::bytes)).collect()
}

/// The models that are text.
fn documents() -> impl Iterator<Item = Value> {
    models().into_iter().filter_map(|bytes| serde_json::from_slice(&bytes).ok())
}

#[test]
fn edits_of_what_a_model_says_get_past_the_parser() {
    let parses = |json: Value| {
        gltf::Gltf::from_slice_without_validation(&serde_json::to_vec(&json).expect("JSON")).is_ok()
    };
    let taken = mutation::taken(&mutation::json(documents()), 400, parses);
    assert!(3 * taken >= 400, "{taken} of 400");
}

fn base64(three: &[u8]) -> String {
    const LETTERS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let bits = three.iter().fold(0_u32, |bits, byte| bits << 8 | u32::from(*byte)) << (8 * (3 - three.len()));
    (0..4)
        .map(|i| if i <= three.len() { LETTERS[(bits >> (18 - 6 * i) & 63) as usize] as char } else { '=' })
        .collect()
}

fn descriptions() -> impl Iterator<Item = String> {
    Shipped.list().into_iter().map(|name| Shipped.read(&name).expect("a file").text.clone())
}

proptest! {
    #![proptest_config(mutation::config(400))]

    #[test]
    fn models_with_edits(bytes in mutation::bytes(models())) {
        let name = if bytes.starts_with(b"glTF") { "test.glb" } else { "test.gltf" };
        crate::broken::assert_sound(mutation::within(LIMIT, move || load_bytes(name, &bytes)))?;
    }

    #[test]
    fn models_that_say_something_else(json in mutation::json(documents())) {
        let bytes = serde_json::to_vec(&json).expect("JSON");
        crate::broken::assert_sound(mutation::within(LIMIT, move || load_bytes("test.gltf", &bytes)))?;
    }

    #[test]
    fn descriptions_with_edits(text in mutation::texts(descriptions())) {
        crate::broken::assert_sound(mutation::within(LIMIT, move || load_text(&text)))?;
    }
}
