//! glTF: transforms, lights, materials, repairs.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

use glam::{Affine3A, Mat4, Quat, Vec3, Vec4};
use scene::{Encoding, LightKind, Wrap};
use serde_json::{Value, json};

use crate::common::{
    Glb, Spoilt, assert_near, assert_refused, assert_states, assert_trait, assert_windings, folder_of,
    load_bytes, load_path, normal, position, states, try_load,
};

#[test]
fn a_mesh_used_twice_gives_two_instances_with_the_transforms_of_their_parents() {
    let mut glb = Glb::square();
    glb.json["nodes"] = json!([
        { "name": "group", "children": [1, 2], "translation": [0.0, 0.0, -3.0] },
        { "name": "left", "mesh": 0, "translation": [-2.0, 0.0, 0.0] },
        { "name": "right", "mesh": 0, "rotation": [0.0, 1.0, 0.0, 0.0], "scale": [2.0, 1.0, 1.0] },
    ]);
    glb.json["scenes"] = json!([{ "nodes": [0] }]);
    let scene = glb.scene();
    let names: Vec<_> = scene.instances.iter().map(|i| i.name.as_str()).collect();
    assert_eq!(names, ["left", "right"]);
    assert_eq!(position(&scene, 1), Vec3::new(-1.0, 0.0, -3.0), "moved by parent and node");
    // Half a turn about y takes (1, 0, 0), made twice as long, to (−2, 0, 0), and turns the normal.
    assert_near(position(&scene, 5), Vec3::new(-2.0, 0.0, -3.0));
    assert_near(normal(&scene, 5), Vec3::NEG_Z);
    assert_eq!(scene.vertices[5].instance, 1);
    assert_eq!(scene.instances[1].first_index, 6);
    assert!((scene.area() - 3.0).abs() < 1e-6, "1 m² and 2 m²");
}

#[test]
fn only_nodes_of_the_default_scene_are_taken() {
    let mut glb = Glb::square();
    glb.push("nodes", json!({ "mesh": 0, "translation": [5.0, 0.0, 0.0] }));
    glb.json["scenes"] = json!([{ "nodes": [0] }, { "nodes": [1] }]);
    glb.json["scene"] = json!(1);
    let scene = glb.scene();
    assert_eq!((scene.triangles(), position(&scene, 0).x), (2, 5.0), "the second scene");
}

#[test]
fn mirrors_and_unequal_scales_keep_normals_and_windings_together() {
    // A slanted square, so that an unequal scale turns its normal.
    let transforms = [
        Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0)),
        Mat4::from_scale(Vec3::new(-1.0, -2.0, -3.0)),
        Mat4::from_scale(Vec3::new(1.0, 5.0, 0.2)),
        Mat4::from_quat(Quat::from_rotation_x(1.0)) * Mat4::from_scale(Vec3::new(3.0, -1.0, 0.5)),
        // A shear, which no scale and turn can make.
        Mat4::from_cols(Vec4::X, Vec4::new(0.7, 1.0, 0.3, 0.0), Vec4::Z, Vec4::W),
    ];
    for transform in transforms {
        let mut glb = Glb::new();
        let positions = glb.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 1.0, 1.0]);
        let slanted = Vec3::new(0.0, -1.0, 1.0).normalize().to_array();
        let normals = glb.floats("VEC3", &slanted.repeat(4));
        let indices = glb.indices(&[0, 1, 2, 0, 2, 3]);
        glb.mesh(json!({ "attributes": { "POSITION": positions, "NORMAL": normals }, "indices": indices }));
        glb.push("nodes", json!({ "mesh": 0, "matrix": transform.to_cols_array() }));
        let scene = glb.scene();
        assert_windings(&scene, 1e-5);
        // The side the normal shows stays the same side of the surface.
        let above = transform.transform_point3(Vec3::from(slanted));
        let side = (above - position(&scene, 0)).dot(normal(&scene, 0));
        assert!(side > 0.0, "{transform}: the normal changes sides");
    }
}

#[test]
fn lights_shine_along_minus_z_of_their_nodes() {
    let mut glb = Glb::square();
    glb.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "spot", "name": "key", "color": [1.0, 0.5, 0.25], "intensity": 8.0,
          "spot": { "innerConeAngle": 0.2, "outerConeAngle": 0.4 } },
        { "type": "directional", "intensity": 3.0 },
        { "type": "point", "intensity": 2.0, "range": 10.0 },
        { "type": "spot", "spot": {} },
    ] } });
    let light = |i| json!({ "KHR_lights_punctual": { "light": i } });
    let quarter = Quat::from_rotation_y(FRAC_PI_2).to_array();
    glb.push("nodes", json!({ "translation": [1.0, 2.0, 3.0], "rotation": quarter, "scale": [5.0, 5.0, 5.0], "extensions": light(0) }));
    glb.push("nodes", json!({ "name": "sun", "rotation": Quat::from_rotation_x(-FRAC_PI_2).to_array(), "extensions": light(1) }));
    glb.push("nodes", json!({ "extensions": light(2) }));
    glb.push("nodes", json!({ "extensions": light(3) }));
    let scene = glb.scene();
    let [key, sun, bulb, plain] = &scene.lights[..] else { panic!("four lights: {:?}", scene.lights) };
    assert_eq!((key.name.as_str(), key.position), ("key", Vec3::new(1.0, 2.0, 3.0)));
    assert!(key.direction.abs_diff_eq(Vec3::NEG_X, 1e-6), "−z turned by 90° about y: {}", key.direction);
    assert_eq!(key.intensity, Vec3::new(8.0, 4.0, 2.0), "color times candela, as W/sr; no scale");
    assert_eq!(key.kind, LightKind::Spot { inner: 0.2, outer: 0.4 });
    assert!(sun.direction.abs_diff_eq(Vec3::NEG_Y, 1e-6), "−z turned down: {}", sun.direction);
    assert_eq!((sun.name.as_str(), sun.intensity), ("sun", Vec3::splat(3.0)), "lux as W/m²");
    assert_eq!(bulb.kind, LightKind::Point);
    assert_states(&scene, "range");
    assert_eq!(plain.kind, LightKind::Spot { inner: 0.0, outer: FRAC_PI_4 }, "glTF's defaults");
}

#[test]
fn materials_are_read_with_their_extensions() {
    let mut glb = Glb::square();
    glb.json["materials"] = json!([{
        "name": "lamp",
        "pbrMetallicRoughness": { "baseColorFactor": [0.1, 0.2, 0.3, 1.0], "metallicFactor": 0.25, "roughnessFactor": 0.5 },
        "emissiveFactor": [1.0, 0.5, 0.0],
        "alphaMode": "MASK", "alphaCutoff": 0.3,
        "extensions": {
            "KHR_materials_emissive_strength": { "emissiveStrength": 20.0 },
            "KHR_materials_specular": { "specularFactor": 0.5, "specularColorFactor": [1.0, 0.5, 0.0] },
        },
    }]);
    glb.primitive()["material"] = json!(0);
    let scene = glb.scene();
    let material = &scene.materials[0];
    assert_eq!(material.base_color, Vec4::new(0.1, 0.2, 0.3, 1.0));
    assert_eq!(material.emission, Vec3::new(20.0, 10.0, 0.0), "factor times strength");
    assert!(material.specular.abs_diff_eq(Vec3::new(0.02, 0.01, 0.0), 1e-7), "{}", material.specular);
    assert_eq!((material.metallic, material.roughness, material.alpha_cutoff), (0.25, 0.5, Some(0.3)));
    for (name, value) in [("glossy", true), ("emissive", true), ("masked", true), ("textured", false)] {
        assert_trait(&scene, name, value);
    }
    let plain = Glb::square().scene();
    assert_trait(&plain, "glossy", false);
    assert_states(&plain, "names no material");
}

/// A PNG of 2 × 1 pixels: red and half-transparent green.
pub(crate) fn png() -> Vec<u8> {
    let image = image::RgbaImage::from_raw(2, 1, vec![255, 0, 0, 255, 0, 255, 0, 128]).expect("2 × 1 pixels");
    let mut out = std::io::Cursor::new(Vec::new());
    image.write_to(&mut out, image::ImageFormat::Png).expect("encoded");
    out.into_inner()
}

/// A textured square; `image` says where its image is.
pub(crate) fn textured(image: Value, bytes: &[u8]) -> Glb {
    let mut glb = Glb::square();
    let uvs = glb.floats("VEC2", &[0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    glb.attribute("TEXCOORD_0", uvs);
    let view = glb.view(bytes);
    let image = if image.is_null() { json!({ "bufferView": view, "mimeType": "image/png" }) } else { image };
    glb.push("images", image);
    glb.push("samplers", json!({ "wrapS": 33071, "wrapT": 33648 }));
    glb.push("textures", json!({ "source": 0, "sampler": 0 }));
    glb.json["materials"] = json!([{
        "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 }, "metallicRoughnessTexture": { "index": 0 } },
    }]);
    glb.primitive()["material"] = json!(0);
    glb
}

#[test]
fn a_texture_is_read_once_for_each_way_it_is_meant() {
    let scene = textured(Value::Null, &png()).scene();
    let [color, data] = &scene.textures[..] else { panic!("two textures: {:?}", scene.textures) };
    assert_eq!((color.width, color.height, color.encoding), (2, 1, Encoding::Srgb));
    assert_eq!(color.pixels, [255, 0, 0, 255, 0, 255, 0, 128]);
    assert_eq!((color.wrap, data.encoding), ([Wrap::Clamp, Wrap::Mirror], Encoding::Linear));
    let material = &scene.materials[0];
    assert_eq!((material.base_color_texture, material.metallic_roughness_texture), (Some(0), Some(1)));
    assert_eq!(scene.vertices[1].uv, [1.0, 1.0]);
    assert_trait(&scene, "textured", true);
}

#[test]
fn an_image_can_be_embedded_as_text() {
    // A PNG of one white pixel, in base64.
    let uri = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8/5+hHgAHggJ/PchI7wAAAABJRU5ErkJggg==";
    let scene = textured(json!({ "uri": uri }), &[]).scene();
    assert_eq!((scene.textures.len(), scene.textures[0].width), (2, 1), "{:?}", scene.repairs);
}

#[test]
fn a_texture_that_cannot_be_read_is_white_and_stated() {
    for (image, bytes, words) in [
        (json!({ "uri": "missing.png" }), &b""[..], "missing.png"),
        (Value::Null, &b"not a picture"[..], "taken as white"),
        (Value::Null, &png()[..20], "taken as white"),
        (json!({}), &b""[..], "neither a file nor a buffer view"),
        (json!({ "uri": "bad%ff.png" }), &b""[..], "not UTF-8"),
    ] {
        let scene = textured(image, bytes).scene();
        assert_states(&scene, words);
        assert_eq!(scene.materials[0].base_color_texture, None, "white");
    }
}

#[test]
fn a_texture_without_an_image_of_its_own_is_white_and_stated() {
    let mut glb = textured(json!({ "uri": "missing.png" }), &[]);
    for texture in glb.json["textures"].as_array_mut().expect("textures") {
        *texture = json!({ "extensions": { "KHR_texture_basisu": { "source": 0 } } });
    }
    let scene = glb.scene();
    assert_states(&scene, "texture 0 is taken as white: it names an image by an extension alone");
    assert_eq!(scene.materials[0].base_color_texture, None, "white");
}

#[test]
fn buffers_and_images_are_read_from_files_beside() {
    let glb = textured(json!({ "uri": "a%20picture.png" }), &[]);
    let mut json = glb.json.clone();
    json["buffers"] = json!([{ "uri": "data.bin", "byteLength": glb.bin.len() }]);
    let json = serde_json::to_vec(&json).expect("JSON");
    let folder = folder_of(&[("scene.gltf", &json), ("data.bin", &glb.bin), ("a picture.png", &png())]);
    let path = folder.path().join("scene.gltf");
    let scene = load_path(&path);
    assert_eq!((scene.triangles(), scene.textures.len()), (2, 2), "{:?}", scene.repairs);
    assert_eq!(scene.files.len(), 3, "the file, its buffer, its image: {:?}", scene.files);
    assert!(scene.files.iter().all(|f| f.is_file()), "all can be watched: {:?}", scene.files);
    std::fs::remove_file(folder.path().join("data.bin")).expect("removed");
    let error = try_load(&path).expect_err("no buffer");
    assert!(error.to_string().contains("buffer 0") && error.to_string().contains("data.bin"), "{error}");
}

#[test]
fn a_mesh_without_normals_is_flat_and_stated() {
    let mut glb = Glb::square();
    glb.without_normals();
    let scene = glb.scene();
    assert_states(&scene, "mesh 0 `mesh`, primitive 0: triangles without normals are shaded flat");
    assert_eq!(scene.vertices.len(), 6, "each corner is a vertex of its own");
    assert!(scene.vertices.iter().all(|v| v.normal == [0.0, 0.0, 1.0]), "by the winding");
}

#[test]
fn what_many_primitives_lack_is_stated_once() {
    let mut glb = Glb::square();
    glb.without_normals();
    let primitive = glb.json["meshes"][0]["primitives"][0].clone();
    glb.json["meshes"][0]["primitives"] = json!([primitive, primitive, primitive]);
    let scene = glb.scene();
    let about: Vec<&String> = scene.repairs.iter().filter(|repair| repair.contains("normals")).collect();
    assert_eq!(about, ["mesh 0 `mesh`, primitive 0 and 2 more: triangles without normals are shaded flat"]);
}

#[test]
fn a_file_of_another_version_is_refused() {
    let load = |asset: serde_json::Value| {
        let mut glb = Glb::square();
        glb.json["asset"] = asset;
        glb.load()
    };
    for asset in [
        json!({ "version": "2.0" }),
        json!({ "version": "2.1" }),
        json!({ "version": "2.1", "minVersion": "2.0" }),
    ] {
        load(asset.clone()).unwrap_or_else(|error| panic!("{asset}: {error}"));
    }
    for (asset, words) in [
        (json!({ "version": "1.0" }), "asset.version: the file is of glTF 1.0; 2.0 is read"),
        (json!({ "version": "3.0" }), "asset.version: the file is of glTF 3.0"),
        (json!({ "version": "two" }), "asset.version: the file is of glTF two"),
        (json!({ "version": "2.1", "minVersion": "2.1" }), "asset.minVersion: the file is of glTF 2.1"),
    ] {
        let error = load(asset.clone()).expect_err("another version").to_string();
        assert!(error.contains(words), "{asset}: {error}");
    }
}

#[test]
fn normals_without_direction_come_from_the_triangles() {
    let mut glb = Glb::square();
    let normals = glb.floats("VEC3", &[0.0, 0.0, 0.0, f32::NAN, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 1.0]);
    glb.attribute("NORMAL", normals);
    let scene = glb.scene();
    assert_states(&scene, "2 normals");
    assert!(scene.vertices.iter().all(|v| v.normal == [0.0, 0.0, 1.0]), "{:?}", scene.vertices);
}

#[test]
fn triangles_with_vertices_that_are_no_numbers_are_dropped_and_counted() {
    for bad in [f32::NAN, f32::INFINITY, 1e30] {
        let mut glb = Glb::square();
        let positions = glb.floats("VEC3", &[0.0, 0.0, 0.0, bad, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
        glb.attribute("POSITION", positions);
        let scene = glb.scene();
        assert!(states(&scene, "1 triangles are left out"), "{bad}: {:?}", scene.repairs);
        assert_eq!(scene.triangles(), 1, "{bad}: the other stays");
        assert!((scene.area() - 0.5).abs() < 1e-9 && scene.extent().is_finite(), "{bad}");
        assert!(
            scene.vertices.iter().flat_map(|v| v.position).all(f32::is_finite),
            "{bad}: nothing bad is left"
        );
    }
}

#[test]
fn strips_and_fans_become_triangles() {
    for (mode, order, expected) in
        [(5, &[0u16, 1, 3, 2][..], [0, 1, 3, 1, 2, 3]), (6, &[0, 1, 2, 3][..], [1, 2, 0, 2, 3, 0])]
    {
        let mut glb = Glb::square();
        let indices = glb.indices(order);
        glb.primitive()["indices"] = json!(indices);
        glb.primitive()["mode"] = json!(mode);
        let scene = glb.scene();
        assert_eq!(scene.indices, expected, "mode {mode}");
        assert!((scene.area() - 1.0).abs() < 1e-6, "mode {mode}: the same square");
    }
}

#[test]
fn points_and_lines_are_left_out_and_what_is_left_is_empty() {
    for mode in 0..=3 {
        let mut glb = Glb::square();
        glb.primitive()["mode"] = json!(mode);
        let error = glb.load().expect_err("nothing is left").to_string();
        assert!(error.contains("no triangles") && error.contains("points or lines"), "mode {mode}: {error}");
    }
}

#[test]
fn indices_of_every_size_and_sparse_and_normalised_accessors_are_read() {
    let mut glb = Glb::square();
    let view = glb.view(&[0u8, 1, 2, 0, 2, 3]);
    let bytes =
        glb.accessor(json!({ "bufferView": view, "componentType": 5121, "count": 6, "type": "SCALAR" }));
    glb.primitive()["indices"] = json!(bytes);
    // Texture coordinates as normalised u16, four bytes apart from each other by a stride of eight.
    let view =
        glb.view(bytemuck::cast_slice(&[0u16, 65535, 7, 7, 65535, 0, 7, 7, 0, 0, 7, 7, 32768, 1, 7, 7]));
    glb.json["bufferViews"][view]["byteStride"] = json!(8);
    let uvs = glb.accessor(
        json!({ "bufferView": view, "componentType": 5123, "normalized": true, "count": 4, "type": "VEC2" }),
    );
    glb.attribute("TEXCOORD_0", uvs);
    glb.sparse(0, 2, [2.0, 2.0, 0.0], 1);
    let scene = glb.scene();
    assert_eq!(scene.indices, [0, 1, 2, 0, 2, 3]);
    assert_eq!(scene.vertices[0].uv, [0.0, 1.0]);
    assert_eq!(scene.vertices[3].uv[0], 32768.0 / 65535.0);
    assert_eq!(position(&scene, 2), Vec3::new(2.0, 2.0, 0.0), "the sparse value");
}

#[test]
fn a_camera_of_the_file_is_the_scenes() {
    let mut glb = Glb::square();
    let world =
        Affine3A::from_rotation_translation(Quat::from_rotation_y(FRAC_PI_2), Vec3::new(4.0, 0.0, 0.0));
    glb.push("cameras", json!({ "type": "orthographic", "orthographic": { "xmag": 1.0, "ymag": 1.0, "zfar": 9.0, "znear": 0.0 } }));
    glb.push("cameras", json!({ "type": "perspective", "perspective": { "yfov": 0.8, "znear": 0.02 } }));
    glb.push("nodes", json!({ "name": "flat", "camera": 0 }));
    glb.push("nodes", json!({ "name": "eye", "camera": 1, "matrix": Mat4::from(world).to_cols_array() }));
    let scene = glb.scene();
    assert_states(&scene, "orthographic");
    assert_eq!((scene.cameras.len(), scene.cameras[0].0.as_str()), (1, "eye"));
    assert_eq!((scene.camera.position, scene.camera.vertical_fov), (Vec3::new(4.0, 0.0, 0.0), 0.8));
    assert!(scene.camera.forward().abs_diff_eq(Vec3::NEG_X, 1e-6), "{:?}", scene.camera);
    assert_eq!((scene.camera.near, scene.camera.up), (0.02, Vec3::Y));
}

#[test]
fn errors_name_the_file_the_place_and_what_was_expected() {
    let cases: [Spoilt; 15] = [
        (
            "an index out of range",
            &["mesh 0 `mesh`, primitive 0", "index number 2 is 9", "only 4 vertices"],
            |glb| {
                let indices = glb.indices(&[0, 1, 9]);
                glb.primitive()["indices"] = json!(indices);
            },
        ),
        ("no such accessor", &["mesh 0", "no accessor 77: there are 3"], |glb| {
            glb.primitive()["attributes"]["POSITION"] = json!(77);
        }),
        ("an accessor beyond its view", &["accessor 0", "5 elements of 12 bytes", "of 48 bytes"], |glb| {
            glb.json["accessors"][0]["count"] = json!(5);
        }),
        ("an offset that overflows", &["accessor 0", "18446744073709551615"], |glb| {
            glb.json["accessors"][0]["byteOffset"] = json!(u64::MAX);
        }),
        ("a view beyond its buffer", &["buffer view 0", "buffer 0"], |glb| {
            glb.json["bufferViews"][0]["byteLength"] = json!(1_000_000);
        }),
        ("the wrong type", &["accessor 0", "expected 3 components", "Vec2"], |glb| {
            glb.json["accessors"][0]["type"] = json!("VEC2");
        }),
        ("counts that differ", &["mesh 0", "4 positions, but 3 normals"], |glb| {
            glb.json["accessors"][1]["count"] = json!(3);
        }),
        ("a missing material", &["mesh 0", "no material 3: there are 0"], |glb| {
            glb.primitive()["material"] = json!(3);
        }),
        ("a missing mesh", &["node 0 `square`", "no mesh 8: there are 1"], |glb| {
            glb.json["nodes"][0]["mesh"] = json!(8);
        }),
        ("a loop of nodes", &["node 0 `square`", "reached twice"], |glb| {
            glb.json["scenes"] = json!([{ "nodes": [0] }]);
            glb.json["nodes"][0]["children"] = json!([0]);
        }),
        ("a missing light", &["node 0", "no light 1: there are 0"], |glb| {
            glb.json["nodes"][0]["extensions"] = json!({ "KHR_lights_punctual": { "light": 1 } });
        }),
        ("an impossible cone", &["light 0", "outerConeAngle", "found 1 and 0.5"], |glb| {
            let spot = json!({ "innerConeAngle": 1.0, "outerConeAngle": 0.5 });
            glb.json["extensions"] =
                json!({ "KHR_lights_punctual": { "lights": [{ "type": "spot", "spot": spot }] } });
            glb.json["nodes"][0]["extensions"] = json!({ "KHR_lights_punctual": { "light": 0 } });
        }),
        ("an impossible angle", &["camera 0", "between 0 and π, found 4"], |glb| {
            glb.push(
                "cameras",
                json!({ "type": "perspective", "perspective": { "yfov": 4.0, "znear": 0.1 } }),
            );
            glb.json["nodes"][0]["camera"] = json!(0);
        }),
        ("a required extension", &["requires KHR_draco_mesh_compression", "not supported"], |glb| {
            glb.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
        }),
        ("no binary chunk for it", &["buffer 1", "no binary chunk"], |glb| {
            glb.push("buffers", json!({ "byteLength": 4 }));
        }),
    ];
    assert_refused(Glb::square, &cases);
}

#[test]
fn a_file_that_is_cut_off_or_no_gltf_is_refused() {
    let bytes = Glb::square().bytes();
    let error = load_bytes("test.glb", &bytes[..bytes.len() - 10]).expect_err("cut off").to_string();
    assert!(error.contains("cut off"), "{error}");
    for (bytes, words) in [
        (&b""[..], "JSON"),
        (b"glTF", "GLB header"),
        (b"{ \"asset\": ", "JSON"),
        (b"solid stl", "expected a glTF 2.0 document"),
    ] {
        let error = load_bytes("test.gltf", bytes).expect_err("no glTF").to_string();
        assert!(error.contains(words), "expected `{words}` in: {error}");
    }
}

#[test]
fn an_extension_that_is_not_supported_is_stated() {
    let mut glb = Glb::square();
    glb.json["extensionsUsed"] = json!(["KHR_materials_clearcoat", "KHR_lights_punctual"]);
    let scene = glb.scene();
    assert_states(&scene, "KHR_materials_clearcoat");
    assert!(!states(&scene, "KHR_lights"), "{:?}", scene.repairs);
}
