//! Files that are spoilt at random: an error or a scene, never a panic.

use std::path::Path;

use proptest::prelude::*;
use proptest::test_runner::TestCaseError;
use scene::{Scene, SceneError};
use serde_json::{Value, json};

use crate::common::{Glb, InMemory, load_bytes, load_text};

/// A small file that has one of everything.
pub(crate) fn sample() -> Glb {
    let mut glb = Glb::square();
    let uvs = glb.floats("VEC2", &[0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    glb.attribute("TEXCOORD_0", uvs);
    glb.primitive()["material"] = json!(0);
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbaImage::new(2, 2).write_to(&mut png, image::ImageFormat::Png).expect("encoded");
    let view = glb.view(png.get_ref());
    glb.push("images", json!({ "bufferView": view, "mimeType": "image/png" }));
    glb.push("samplers", json!({}));
    glb.push("textures", json!({ "source": 0, "sampler": 0 }));
    let texture = json!({ "index": 0 });
    glb.push(
        "materials",
        json!({
            "pbrMetallicRoughness": { "baseColorTexture": texture, "metallicRoughnessTexture": texture },
            "normalTexture": texture, "emissiveTexture": texture, "emissiveFactor": [1.0, 1.0, 1.0],
            "extensions": { "KHR_materials_specular": { "specularFactor": 0.5 } },
        }),
    );
    glb.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "spot", "intensity": 3.0, "spot": { "outerConeAngle": 0.5 } },
    ] } });
    glb.push("cameras", json!({ "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.1 } }));
    glb.push("nodes", json!({ "extensions": { "KHR_lights_punctual": { "light": 0 } }, "children": [2] }));
    glb.push("nodes", json!({ "camera": 0, "rotation": [0.0, 0.0, 0.0, 1.0] }));
    let input = glb.floats("SCALAR", &[0.0, 1.0]);
    let output = glb.floats("VEC4", &[0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0]);
    glb.push(
        "animations",
        json!({
            "samplers": [{ "input": input, "output": output }],
            "channels": [{ "sampler": 0, "target": { "node": 1, "path": "rotation" } }],
        }),
    );
    let moved = glb.floats("VEC3", &[0.0, 0.0, 1.0].repeat(4));
    let turned = glb.floats("VEC3", &[1.0, 0.0, 0.0].repeat(4));
    glb.primitive()["targets"] = json!([{ "POSITION": moved, "NORMAL": turned }, { "POSITION": moved }]);
    glb.json["meshes"][0]["weights"] = json!([0.25, 0.5]);
    let joints = glb.fours(&[0u8, 1, 0, 0].repeat(4), false);
    glb.attribute("JOINTS_0", joints);
    let weights = glb.floats("VEC4", &[0.5, 0.5, 0.0, 0.0].repeat(4));
    glb.attribute("WEIGHTS_0", weights);
    let binds = glb.floats("MAT4", &glam::Mat4::IDENTITY.to_cols_array().repeat(2));
    glb.push("skins", json!({ "joints": [1, 2], "inverseBindMatrices": binds }));
    glb.json["nodes"][0]["skin"] = json!(0);
    let weights = glb.floats("SCALAR", &[0.0, 0.0, 1.0, 1.0]);
    glb.animate(0, "weights", "LINEAR", input, weights);
    glb.sparse(0, 2, [2.0, 2.0, 0.0], 1);
    glb.json["scenes"] = json!([{ "nodes": [0, 1] }]);
    glb
}

/// Checks that the result is an error, or a scene that holds together.
pub(crate) fn assert_sound(result: Result<Scene, SceneError>) -> Result<(), TestCaseError> {
    let scene = match result {
        Ok(scene) => scene,
        Err(error) => {
            prop_assert!(!error.to_string().is_empty());
            return Ok(());
        }
    };
    prop_assert!(scene.indices.iter().all(|i| (*i as usize) < scene.vertices.len()));
    prop_assert!(scene.vertices.iter().all(|v| (v.material as usize) < scene.materials.len()));
    prop_assert!(scene.vertices.iter().all(|v| (v.instance as usize) < scene.instances.len()));
    for time in [0.0, 0.4, 1e30, f32::NAN] {
        let pose = scene.at(time);
        let moved = pose.moved.iter().flat_map(|m| &m.vertices);
        for vertex in scene.vertices.iter().chain(moved) {
            let numbers = vertex.position.iter().chain(&vertex.normal).chain(&vertex.uv);
            prop_assert!(numbers.into_iter().all(|x| x.is_finite()), "{vertex:?}");
        }
        prop_assert!(pose.camera.view().is_finite(), "{:?}", pose.camera);
        for light in &pose.lights {
            prop_assert!(light.position.is_finite() && light.intensity.is_finite(), "{light:?}");
            prop_assert!((light.direction.length() - 1.0).abs() < 1e-4, "{light:?}");
        }
    }
    let count = scene.textures.len() as u32;
    for material in &scene.materials {
        let textures = [material.base_color_texture, material.normal_texture, material.emission_texture];
        prop_assert!(textures.into_iter().flatten().all(|t| t < count));
    }
    prop_assert_eq!(scene.area_table().len(), scene.triangles() + 1);
    prop_assert!(scene.area().is_finite() && scene.extent().is_finite());
    prop_assert!(!scene.traits().values.is_empty());
    Ok(())
}

/// Every place of a JSON document.
fn places(value: &Value, path: String, out: &mut Vec<String>) {
    out.push(path.clone());
    match value {
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(i, v)| places(v, format!("{path}/{i}"), out));
        }
        Value::Object(map) => map.iter().for_each(|(k, v)| places(v, format!("{path}/{k}"), out)),
        _ => {}
    }
}

fn odd_value() -> impl Strategy<Value = Value> {
    prop_oneof![
        Just(Value::Null),
        (-3i64..12).prop_map(|n| json!(n)),
        Just(json!(u64::MAX)),
        Just(json!(1u64 << 40)),
        Just(json!(u32::MAX)),
        Just(json!(-1e300)),
        Just(json!(1e38)),
        any::<f32>().prop_map(|x| json!(x)),
        Just(json!("")),
        Just(json!("SCALAR")),
        Just(json!("%ff")),
        Just(json!("data:,")),
        Just(json!("CUBICSPLINE")),
        Just(json!("weights")),
        Just(json!([])),
        Just(json!({})),
        Just(json!([0, 0, 0])),
        Just(json!([1, 2])),
    ]
}

#[test]
fn the_sample_itself_is_good() {
    let scene = sample().scene();
    let sizes = (scene.triangles(), scene.lights.len(), scene.cameras.len(), scene.textures.len());
    assert_eq!(sizes, (2, 1, 1, 2), "{:?}", scene.repairs);
    let changes = scene.changes(0.0, 0.5);
    assert!(changes.lights && changes.geometry, "it moves");
    let positions: Vec<_> = scene.at(0.5).moved[0].vertices.iter().map(|v| v.position).collect();
    assert!(positions[1][2].abs() > 0.1, "it is bent: {positions:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn odd_values_in_the_json(edits in prop::collection::vec((any::<prop::sample::Index>(), odd_value()), 1..4)) {
        let mut glb = sample();
        for (place, value) in edits {
            let mut all = Vec::new();
            places(&glb.json, String::new(), &mut all);
            if let Some(slot) = glb.json.pointer_mut(place.get::<String>(&all[1..])) {
                *slot = value;
            }
        }
        // The writer of the test needs a buffer to put the length in.
        if glb.json["buffers"][0].is_object() {
            assert_sound(glb.load())?;
        }
    }

    #[test]
    fn odd_bytes_anywhere(edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6), cut in 0usize..200) {
        let mut bytes = sample().bytes();
        for (place, byte) in edits {
            let place = place.index(bytes.len());
            bytes[place] = byte;
        }
        bytes.truncate(bytes.len() - cut.saturating_sub(150));
        assert_sound(load_bytes("test.glb", &bytes))?;
    }

    #[test]
    fn odd_text_in_a_description(start in any::<prop::sample::Index>(), length in 0usize..12, insert in "[-(){}\\[\\]:,.\"a-zA-Z0-9 \n€]{0,6}") {
        let mut text: Vec<char> = include_str!("../../../../scenes/cornell-box-moving.ron").chars().collect();
        let start = start.index(text.len());
        let end = (start + length).min(text.len());
        text.splice(start..end, insert.chars());
        assert_sound(load_text(&text.into_iter().collect::<String>()))?;
    }

    #[test]
    fn any_text_as_the_name_of_a_scene(spec in "\\PC{0,20}") {
        prop_assume!(!Path::new(&spec).exists());
        let files = InMemory { texts: [("cornell-box.ron", String::new())].into(), ..InMemory::default() };
        prop_assert!(scene::load(&spec, &files).is_err());
    }
}
