//! Scenes that lie far from the origin of their files.

use std::collections::BTreeMap;

use data_file::{Files, Source};
use glam::{DVec3, Quat, Vec3};
use scene::{Camera, CameraKey, LightKey, Pose, Scene, SceneEdit, built_in_names, keys_of, scene_file_for};
use serde_json::json;

use crate::common::{
    Glb, Shipped, assert_states, built_in, folder_of, load_path, load_text, scene_in, scene_of, shipped,
    states,
};

/// The offsets of the scenes of these tests: far along each axis alone and along all, and where numbers are not round.
const FAR: [DVec3; 7] = [
    DVec3::new(1e6, 0.0, 0.0),
    DVec3::new(0.0, -1e6, 0.0),
    DVec3::new(0.0, 0.0, 1e6),
    DVec3::new(1e6, 1e6, 1e6),
    DVec3::new(-123_456.789, 0.0, 98_765.432),
    DVec3::new(1e3, 1e4, 1e5),
    DVec3::new(3e7, 0.0, -4e8),
];

/// The Cornell box at an offset, with a model, objects within an object, a camera, lights and keys. What is placed
/// within another object is not moved.
fn furnished(offset: DVec3) -> String {
    let at = |x: f64, y: f64, z: f64| {
        let place = offset + DVec3::new(x, y, z);
        format!("({:?}, {:?}, {:?})", place.x, place.y, place.z)
    };
    format!(
        r#"Scene(
    geometry: Objects([
        Object(name: "box", geometry: BuiltIn("cornell-box"), transform: Transform(translate: {})),
        Object(name: "model", geometry: File("model.glb"), transform: Transform(
            translate: {}, rotate_deg: (0, 40, 10), scale: (0.1, 0.2, 0.1))),
        Object(name: "still", geometry: File("model.glb"), transform: Transform(
            translate: {}, scale: (0.1, 0.1, 0.1))),
        Object(name: "group", transform: Transform(translate: {}, rotate_deg: (0, 90, 0), scale: (0.5, 0.5, 0.5)),
            geometry: Objects([
                Object(name: "inner", geometry: BuiltIn("cube"), transform: Transform(
                    translate: (0.1, 0.2, 0.3), scale: (0.05, 0.05, 0.05))),
            ])),
    ]),
    camera: Camera(position: {}, target: {}, vertical_fov_deg: 39.3077), // it moves
    lights: [
        Spot(name: "spot", position: {}, direction: (1.0, -0.75, 0.55), intensity: (0.8, 0.8, 0.8), outer_deg: 30),
        Point(name: "bulb", position: {}, intensity: (0.1, 0.1, 0.1)),
        Directional(direction: (0, -1, 0), irradiance: (1, 1, 1)),
    ],
    keyframes: Keyframes(
        camera: [Key(time: 0, position: {}, target: {}), Key(time: 1, position: {}), Key(time: 2, target: {})],
        lights: {{ "spot": [Key(time: 0, position: {}), Key(time: 2, position: {}, direction: (0, -1, 0))] }},
        objects: {{
            "model": [Key(time: 0, translate: {}), Key(time: 2, translate: {}, rotate_deg: (0, 90, 0))],
            "inner": [Key(time: 0, translate: (0.1, 0.2, 0.3)), Key(time: 2, translate: (0.1, 0.4, 0.3))],
        }},
    ),
)"#,
        at(0.0, 0.0, 0.0),
        at(0.3, 0.1, 0.2),
        at(0.4, 0.3, 0.3),
        at(0.2, 0.1, 0.1),
        at(0.278, 0.273, -0.8),
        at(0.278, 0.273, 0.0),
        at(0.13, 0.5, 0.1),
        at(0.3, 0.4, 0.2),
        at(0.278, 0.273, -0.8),
        at(0.278, 0.273, 0.1),
        at(0.3, 0.3, -0.7),
        at(0.25, 0.25, 0.125),
        at(0.13, 0.5, 0.1),
        at(0.4, 0.45, 0.3),
        at(0.3, 0.1, 0.2),
        at(0.1, 0.1, 0.4),
    )
}

/// A folder with the model that the scene names.
fn folder() -> tempfile::TempDir {
    folder_of(&[("model.glb", &Glb::square().bytes())])
}

/// Every place of a scene at one time, in the world of its file.
fn places(scene: &Scene, pose: &Pose) -> Vec<DVec3> {
    let vertices = scene.vertices.iter().chain(pose.moved.iter().flat_map(|moved| &moved.vertices));
    let vertices = vertices.map(|vertex| Vec3::from(vertex.position));
    // That of a directional light is no place.
    let lights = pose.lights.iter().filter(|light| light.kind != scene::LightKind::Directional);
    let others = lights.map(|light| light.position).chain([pose.camera.position, pose.camera.target]);
    vertices.chain(others).map(|place| scene.origin + place.as_dvec3()).collect()
}

/// Checks that a scene is another, moved by an offset, to few of the steps that `f32` makes over its extent.
fn assert_moved(scene: &Scene, near: &Scene, offset: DVec3) {
    assert_eq!(near.origin, DVec3::ZERO);
    assert!((scene.origin - offset).length() < 2.0 * f64::from(near.extent()), "{offset}: {}", scene.origin);
    assert!(states(scene, "from the origin of its file"), "{:?}", scene.repairs);
    let tolerance = 8.0 * f64::from(f32::EPSILON * near.extent());
    for time in [0.0, 0.4, 1.0, 1.7, 5.0] {
        let (pose, expected) = (scene.at(time), near.at(time));
        let (found, known) = (places(scene, &pose), places(near, &expected));
        assert_eq!(found.len(), known.len());
        for (i, (found, known)) in found.into_iter().zip(known).enumerate() {
            let error = (found - offset - known).abs().max_element();
            assert!(error <= tolerance, "{offset} at {time} s: place {i} is off by {error} m");
        }
        let vertices = |scene: &Scene, pose: &Pose| {
            let moved = pose.moved.iter().flat_map(|moved| &moved.vertices);
            scene.vertices.iter().chain(moved).map(|v| Vec3::from(v.normal)).collect::<Vec<_>>()
        };
        for (found, known) in vertices(scene, &pose).into_iter().zip(vertices(near, &expected)) {
            assert!(found.abs_diff_eq(known, 1e-6), "{offset} at {time} s: normal {found}, not {known}");
        }
        for (found, known) in pose.lights.iter().zip(&expected.lights) {
            assert_eq!(
                (&found.name, found.kind, found.intensity),
                (&known.name, known.kind, known.intensity)
            );
            assert!(found.direction.abs_diff_eq(known.direction, 1e-6), "{found:?}, not {known:?}");
        }
        assert!((pose.camera.near / expected.camera.near - 1.0).abs() < 1e-6);
        assert!(pose.camera.forward().abs_diff_eq(expected.camera.forward(), 1e-5), "{:?}", pose.camera);
    }
    for (found, known) in [(scene.bounds().0, near.bounds().0), (scene.bounds().1, near.bounds().1)] {
        let found = scene.origin + found.as_dvec3() - offset;
        assert!(found.abs_diff_eq(known.as_dvec3(), tolerance), "{offset}: bounds to {found}, not {known}");
    }
    assert!((scene.area() / near.area() - 1.0).abs() < 1e-5, "{} m², not {}", scene.area(), near.area());
}

#[test]
fn a_scene_file_far_out_makes_the_scene_that_it_makes_at_the_origin() {
    let folder = folder();
    let near = scene_in(folder.path(), &furnished(DVec3::ZERO));
    for offset in FAR {
        let scene = scene_in(folder.path(), &furnished(offset));
        assert_moved(&scene, &near, offset);
        assert_eq!(scene.files, near.files, "what to watch");
        assert_ne!(scene.hash, near.hash, "a camera from elsewhere would see something else");
    }
}

#[test]
fn an_object_without_a_place_is_at_the_origin_of_the_file() {
    let mut glb = Glb::square();
    glb.json["nodes"][0]["translation"] = json!([1e6, 0.0, 0.0]);
    let folder = folder_of(&[("far.glb", &glb.bytes())]);
    let placed = r#"Scene(geometry: Objects([Object(name: "far", geometry: File("far.glb"))]))"#;
    for text in [placed, r#"Scene(geometry: File("far.glb"))"#] {
        let scene = scene_in(folder.path(), text);
        assert_eq!(scene.origin, DVec3::new(1e6, 0.0, 0.0), "{text}");
        assert_eq!(scene.vertices[2].position, [1.0, 1.0, 0.0], "{text}");
    }
}

/// A glTF file whose roots are moved by an offset: a mesh with a camera and a light below an animated root, another root
/// that stands still, and a skinned mesh with its joints.
fn model(offset: DVec3) -> Glb {
    let at = |x: f64, y: f64, z: f64| (offset + DVec3::new(x, y, z)).as_vec3().to_array();
    let mut glb = Glb::square();
    let light = json!({ "type": "spot", "intensity": 3.0, "spot": {} });
    glb.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [light] } });
    let half = std::f32::consts::FRAC_1_SQRT_2;
    glb.json["nodes"][0] = json!({ "mesh": 0, "translation": [0.5, 0.0, 0.0], "scale": [2.0, 1.0, 1.0] });
    glb.push(
        "nodes",
        json!({ "extensions": { "KHR_lights_punctual": { "light": 0 } }, "translation": [0, 2, 1] }),
    );
    glb.push("nodes", json!({ "camera": 0, "translation": [0.0, 0.0, 5.0] }));
    glb.push("cameras", json!({ "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.1 } }));
    let turned = [0.0, half, 0.0, half];
    glb.push("nodes", json!({ "children": [0, 1, 2], "translation": at(0.0, 0.0, 0.0), "rotation": turned }));
    let [x, y, z] = at(1.0, -2.0, 0.5);
    let matrix = [0.5, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, x, y, z, 1.0];
    glb.push("nodes", json!({ "mesh": 0, "matrix": matrix }));
    let joints = [
        glb.push("nodes", json!({ "translation": at(0.0, 1.0, 2.0) })),
        glb.push("nodes", json!({ "translation": at(-2.0, 1.0, 2.0), "rotation": turned })),
    ];
    let mut primitive = glb.json["meshes"][0]["primitives"][0].clone();
    primitive["attributes"]["JOINTS_0"] = json!(glb.fours(&[0u8, 1, 0, 0].repeat(4), false));
    primitive["attributes"]["WEIGHTS_0"] = json!(glb.floats("VEC4", &[0.25f32, 0.75, 0.0, 0.0].repeat(4)));
    let displaced = glb.floats("VEC3", &[0.0, 0.0, 0.5].repeat(4));
    primitive["targets"] = json!([{ "POSITION": displaced }]);
    let skinned = glb.mesh(primitive);
    glb.push("skins", json!({ "joints": joints }));
    glb.push(
        "nodes",
        json!({ "mesh": skinned, "skin": 0, "weights": [0.5], "translation": at(9.0, 9.0, 9.0) }),
    );
    let times = glb.floats("SCALAR", &[0.0, 2.0]);
    let output = glb.floats("VEC3", &[at(0.0, 0.0, 0.0), at(1.0, 0.5, 0.0)].concat());
    glb.animate(3, "translation", "LINEAR", times, output);
    let slope = [0.5, 0.0, -1.0];
    let keys = [[0.0; 3], at(0.0, 1.0, 2.0), slope, slope, at(2.0, 1.0, 2.5), [0.0; 3]];
    let output = glb.floats("VEC3", &keys.concat());
    glb.animate(joints[0], "translation", "CUBICSPLINE", times, output);
    let rotations = glb.floats("VEC4", &[turned, [0.0, 0.0, 0.0, 1.0]].concat());
    glb.animate(joints[1], "rotation", "LINEAR", times, rotations);
    glb
}

#[test]
fn the_roots_of_a_gltf_file_far_out_keep_what_is_below_them() {
    let near = model(DVec3::ZERO).scene();
    // Places that f32 holds, since the file has no more.
    for offset in [1e6 * DVec3::X, -1e6 * DVec3::Y, 1e5 * DVec3::ONE, DVec3::new(0.0, 65_536.0, -1_048_576.0)]
    {
        let scene = model(offset).scene();
        assert_moved(&scene, &near, offset);
    }
}

#[test]
fn nodes_below_a_turned_root_keep_their_distances() {
    let turned = |offset: f32| {
        let mut glb = Glb::square();
        let turn = Quat::from_axis_angle(Vec3::new(0.6, 0.8, 0.0), 0.7).to_array();
        let at = |x: f32, y: f32| json!([offset + x, -offset, offset + y]);
        glb.json["nodes"][0] = json!({ "mesh": 0, "translation": at(0.0, 0.0) });
        let children: Vec<usize> = (0..8)
            .map(|i| {
                let (x, y) = (i as f32 * 0.25, (i * i) as f32 * 0.125);
                glb.push("nodes", json!({ "mesh": 0, "translation": at(x, y), "scale": [0.1, 0.1, 0.1] }))
            })
            .collect();
        let children = [vec![0], children].concat();
        glb.push("nodes", json!({ "children": children, "rotation": turn }));
        let scene = glb.scene();
        let first = Vec3::from(scene.vertices[0].position);
        scene.vertices.iter().map(|vertex| Vec3::from(vertex.position) - first).collect::<Vec<_>>()
    };
    for (found, known) in turned(1e6).into_iter().zip(turned(0.0)) {
        assert!(found.abs_diff_eq(known, 1e-5), "{found}, not {known}");
    }
}

#[test]
fn vertices_far_out_in_their_file_stay_where_it_has_them() {
    let mut glb = Glb::new();
    let corners: Vec<f32> =
        [[0.0, 0.0], [3.0, 0.25], [1.5, 2.0625]].iter().flat_map(|[x, y]| [1e6 + x, *y, 0.0]).collect();
    let positions = glb.floats("VEC3", &corners);
    glb.mesh(json!({ "attributes": { "POSITION": positions } }));
    glb.push("nodes", json!({ "mesh": 0 }));
    let scene = glb.scene();
    assert!(scene.origin.x > 999_990.0, "{}", scene.origin);
    for (vertex, corner) in scene.vertices.iter().zip(corners.chunks_exact(3)) {
        let place = scene.origin + Vec3::from(vertex.position).as_dvec3();
        assert_eq!(place, Vec3::from_slice(corner).as_dvec3());
    }
}

#[test]
fn scenes_near_the_origin_keep_it_wherever_their_camera_is() {
    for file in Shipped.list() {
        let scene = shipped(file.trim_end_matches(".ron"));
        assert_eq!(scene.origin, DVec3::ZERO, "{file}");
        assert!(!states(&scene, "origin"), "{file}: {:?}", scene.repairs);
    }
    for name in built_in_names() {
        let scene = built_in(name);
        assert_eq!(scene.origin, DVec3::ZERO, "{name}");
    }
    let text = r#"Scene(geometry: BuiltIn("cube"), lights: [Point(position: (0, 1000000, 0), intensity: (1, 1, 1))],
        camera: Camera(position: (1000000, 0, 0), target: (0, 0, 0), vertical_fov_deg: 1))"#;
    let scene = scene_of(text);
    assert_eq!((scene.origin, scene.camera.position), (DVec3::ZERO, Vec3::new(1e6, 0.0, 0.0)));
}

#[test]
fn a_camera_far_out_may_look_at_what_is_near_it() {
    let text = |target: &str| {
        format!(
            r#"Scene(geometry: Objects([Object(name: "cube", geometry: BuiltIn("cube"),
            transform: Transform(translate: (1000000, 0, 0)))]),
            camera: Camera(position: (1000000.25, 0, 3), target: {target}, vertical_fov_deg: 40))"#
        )
    };
    let scene = scene_of(&text("(1000000.26, 0, 3)"));
    assert!(scene.camera.forward().abs_diff_eq(Vec3::X, 1e-6), "{:?}", scene.camera);
    let error = load_text(&text("(1000000.250, 0.0, 3)")).expect_err("refused").to_string();
    assert!(error.contains("the same point"), "{error}");
    let scene = scene_of(&text("(1000000.2500000001, 0.0, 3)"));
    assert_states(&scene, "too near each other");
}

#[test]
fn what_is_saved_far_out_is_read_back() {
    for offset in FAR {
        let folder = folder();
        let path = folder.path().join("scene.ron");
        let text = furnished(offset);
        std::fs::write(&path, &text).unwrap();
        let scene = load_path(&path);
        let origin = scene.origin;
        let keys = keys_of(&path, origin).expect("keys");
        let same = SceneEdit {
            camera: Some(Camera { near: 0.0, ..load_path(&path).camera }),
            lights: scene.lights.clone(),
            camera_keys: Some(keys.camera.clone()),
            light_keys: keys.lights.clone(),
            origin,
            ..SceneEdit::default()
        };
        scene::save(&path, &same).expect("saved");
        let read = keys_of(&path, origin).expect("keys");
        assert_eq!(read, keys, "{offset}");
        assert!(keys.camera[0].position.is_some_and(|at| at.length() < 4.0), "{offset}: {keys:?}");

        // In steps of 2⁻¹⁰ m, which f64 has at all of these places.
        let step = |place: Vec3| (place * 1024.0).round() / 1024.0 + Vec3::splat(1.0 / 512.0);
        let camera = Camera {
            position: step(scene.camera.position),
            target: step(scene.camera.target),
            near: 0.0,
            ..scene.camera
        };
        let mut lights = scene.lights.clone();
        lights.iter_mut().for_each(|light| light.position = step(light.position));
        lights.truncate(2);
        let camera_keys = [0.0, 1.0, 1.5].map(|time| CameraKey {
            time,
            position: Some(step(camera.position) + time),
            target: (time > 0.5).then_some(camera.target),
        });
        let light_keys = [0.0, 3.0].map(|time| LightKey {
            time,
            position: Some(lights[0].position - time),
            direction: None,
            intensity: Some(Vec3::splat(time)),
        });
        let edit = SceneEdit {
            camera: Some(camera),
            lights: lights.clone(),
            camera_keys: Some(camera_keys.to_vec()),
            light_keys: BTreeMap::from([("spot".to_owned(), light_keys.to_vec())]),
            origin,
            ..SceneEdit::default()
        };
        scene::save(&path, &edit).expect("saved");
        let saved = std::fs::read_to_string(&path).expect("a file");
        assert!(saved.contains("// it moves"), "{saved}");
        let now = load_path(&path);
        assert_eq!(now.origin, origin, "the geometry is the same");
        let keys = keys_of(&path, origin).expect("keys");
        assert_eq!(
            (keys.camera.as_slice(), keys.lights["spot"].as_slice()),
            (&camera_keys[..], &light_keys[..])
        );
        for key in camera_keys {
            let camera = now.at(key.time).camera;
            assert!(key.position.is_some_and(|at| at == camera.position), "{offset}: {key:?}, {camera:?}");
            assert!(key.target.is_none_or(|at| at == camera.target), "{offset}: {key:?}, {camera:?}");
        }
        assert_eq!(now.lights[0].position, lights[0].position, "{offset}");
        assert_eq!(now.lights[1].position, lights[1].position, "{offset}");
        let again = scene::edited(&Source::new("again", saved.as_str()), &edit).expect("a good file");
        assert_eq!(again, saved, "the same edit again changes nothing");
    }
}

#[test]
fn saved_places_have_no_more_digits_than_they_need() {
    let text = r#"Scene(geometry: Objects([Object(name: "cube", geometry: BuiltIn("cube"),
        transform: Transform(translate: (1000000, 0, 0)))]),
    camera: Camera(position: (1000000.278, 0.3, 5), target: (1e6, 0, 0), vertical_fov_deg: 40))"#;
    let scene = scene_of(text);
    assert_eq!(scene.origin, DVec3::new(1e6, 0.0, 0.0));
    let mut camera = scene.camera;
    let edit = |camera| SceneEdit { camera: Some(camera), origin: scene.origin, ..SceneEdit::default() };
    let edited = |camera| scene::edited(&Source::new("test.ron", text), &edit(camera)).expect("a good file");
    assert_eq!(edited(camera), text, "what is the same stays as it is written");
    camera.position.x = 0.123;
    camera.target = Vec3::new(-0.1, 0.0, 2.0);
    let expected = text.replace("1000000.278", "1000000.123").replace("(1e6, 0, 0)", "(999999.9, 0, 2.0)");
    assert_eq!(edited(camera), expected);
    camera.position.y = 0.4;
    camera.position.x = 1e-20;
    assert!(edited(camera).contains("(1000000.0, 0.4, 5)"), "f64 has no room for it: {}", edited(camera));
}

#[test]
fn a_bare_gltf_file_far_out_gets_a_scene_file_in_its_world() {
    let glb = model(1e6 * DVec3::X);
    let folder = folder_of(&[("model.glb", &glb.bytes())]);
    let scene = glb.scene();
    let key = CameraKey { time: 1.0, position: Some(Vec3::X), target: None };
    let edit = SceneEdit { camera_keys: Some(vec![key]), ..SceneEdit::default() };
    let text = scene_file_for(&scene, "model.glb", &edit).expect("written");
    assert!(text.contains("Key(time: 1.0, position: (1000001.0, "), "{text}");
    let read = scene_in(folder.path(), &text);
    assert_eq!(read.origin, scene.origin, "{text}");
    assert_eq!(read.lights[0].position, scene.lights[0].position, "{text}");
    assert_eq!((read.camera.position, read.camera.target), (Vec3::X, scene.camera.target), "{text}");
}
