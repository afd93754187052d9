//! Scene files: what they say, and what is wrong with them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use glam::Vec3;
use scene::codes::CODES;
use scene::{LightKind, SceneError, load};
use serde_json::json;

use crate::common::{
    Glb, Shipped, assert_states, built_in, folder_of, load_path, load_text_in, scene_of, shipped, states,
    try_load,
};

#[test]
fn a_description_sets_camera_and_lights() {
    let scene = scene_of(
        r#"Scene(
            about: "a test",
            geometry: BuiltIn("cube"),
            camera: Camera(position: (0, 1, 4), target: (0, 0, 0), vertical_fov_deg: 60, near: 0.5),
            lights: [
                Spot(name: "key", position: (1, 2, 3), direction: (0, -2, 0), intensity: (4, 5, 6), outer_deg: 45, inner_deg: 30),
                Point(position: (0, 3, 0), intensity: (1, 1, 1)),
                Directional(direction: (3, 0, 4), irradiance: (7, 8, 9)),
            ],
        )"#,
    );
    assert_eq!((scene.name.as_str(), scene.about.as_str()), ("test", "a test"));
    assert_eq!(scene.camera.position, Vec3::new(0.0, 1.0, 4.0));
    assert_eq!((scene.camera.vertical_fov, scene.camera.near), (60f32.to_radians(), 0.5));
    let [key, bulb, sun] = &scene.lights[..] else { panic!("three lights: {:?}", scene.lights) };
    let cone = LightKind::Spot { inner: 30f32.to_radians(), outer: 45f32.to_radians() };
    assert_eq!(
        (key.name.as_str(), key.kind, key.direction),
        ("key", cone, Vec3::NEG_Y),
        "direction made unit"
    );
    assert_eq!((bulb.name.as_str(), bulb.kind), ("light 1", LightKind::Point));
    assert!(sun.direction.abs_diff_eq(Vec3::new(0.6, 0.0, 0.8), 1e-6), "{}", sun.direction);
    assert_eq!(sun.intensity, Vec3::new(7.0, 8.0, 9.0));
}

#[test]
fn what_is_not_given_is_made_up_and_stated() {
    let scene = built_in("cube");
    assert!(states(&scene, "no camera") && states(&scene, "no lights"), "{:?}", scene.repairs);
    for vertex in &scene.vertices {
        let pixel = scene.camera.project(vertex.position.into(), [100, 100]).expect("in front");
        assert!(pixel.min_element() > 0.0 && pixel.max_element() < 100.0, "the cube is seen: {pixel}");
    }
    let given = r#"Scene(geometry: BuiltIn("cube"), camera: Camera(position: (0, 0, 9), target: (0, 0, 0), vertical_fov_deg: 9))"#;
    let near = scene_of(given).camera.near;
    assert!((near - 3f32.sqrt() * 1e-4).abs() < 1e-9, "a ten-thousandth of the extent: {near}");
}

#[test]
fn objects_stand_where_they_are_put() {
    let scene = scene_of(
        r#"Scene(geometry: Objects([
            Object(name: "a", geometry: BuiltIn("cube"), transform: Transform(translate: (10, 0, 0), rotate_deg: (0, 0, 90), scale: (4, 2, 2))),
            Object(name: "group", transform: Transform(translate: (0, 0, -5)), geometry: Objects([
                Object(name: "b", geometry: BuiltIn("plane")),
            ])),
        ]))"#,
    );
    let (min, max) = scene.bounds();
    // The cube, 4 m long in x, is turned upright about z; the plane lies at z = −5, at the group's place.
    assert!(min.abs_diff_eq(Vec3::new(-1.0, -2.0, -6.0), 1e-5), "{min}");
    assert!(max.abs_diff_eq(Vec3::new(11.0, 2.0, 1.0), 1e-5), "{max}");
    assert_eq!(scene.instances.len(), 2, "cube and plane");
}

#[test]
fn a_file_is_found_beside_the_description_and_its_lights_can_be_left_out() {
    let mut glb = Glb::square();
    glb.json["extensions"] =
        json!({ "KHR_lights_punctual": { "lights": [{ "type": "point", "intensity": 2.0 }] } });
    glb.push("nodes", json!({ "extensions": { "KHR_lights_punctual": { "light": 0 } } }));
    let folder = folder_of(&[("square.glb", &glb.bytes())]);
    let path = folder.path().join("scene.ron");
    for (option, lights) in [("", 1), (", lights_from_file: false", 0)] {
        std::fs::write(&path, format!(r#"Scene(geometry: File("square.glb"){option})"#)).unwrap();
        let scene = load_path(&path);
        assert_eq!((scene.triangles(), scene.lights.len()), (2, lights), "with `{option}`");
        assert_eq!(scene.files, [path.clone(), folder.path().join("square.glb")], "what to watch");
    }
}

#[test]
fn an_unknown_name_offers_the_nearest() {
    for (spec, words) in [
        ("cornel-box", "did you mean `cornell-box`?"),
        ("nowhere/scene.ron", "nowhere/scene.ron"),
        ("nowhere.glb", "nowhere.glb"),
    ] {
        let Err(error) = load(spec, &Shipped) else { panic!("there is none") };
        assert!(matches!(error, SceneError::NotFound { .. }), "{error}");
        assert!(error.to_string().contains(words), "{error}");
    }
}

#[test]
fn every_broken_file_gives_its_errors() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/broken");
    let entries =
        std::fs::read_dir(&folder).expect("the folder").map(|entry| entry.expect("an entry").path());
    let mut paths: Vec<PathBuf> =
        entries.filter(|path| path.extension().is_some_and(|e| e == "ron")).collect();
    paths.sort();
    let mut shown = BTreeSet::new();
    for path in paths {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let text = std::fs::read_to_string(&path).expect("text");
        let error = match load_text_in(&folder, &text) {
            Err(SceneError::Description(errors)) => errors,
            other => panic!("{name} is not broken so: {other:?}"),
        };
        shown.extend(error.0.iter().map(|error| error.code));
        let text = error.to_string().replace(&folder.display().to_string(), "scenes");
        insta::with_settings!({ prepend_module_to_snapshot => false, snapshot_path => "../snapshots", omit_expression => true }, {
            insta::assert_snapshot!(name, text);
        });
    }
    for code in CODES {
        assert!(shown.contains(code.code), "no file shows {}", code.code);
    }
}

#[test]
fn a_folder_or_a_file_of_no_text_is_unreadable() {
    let folder = folder_of(&[("binary.ron", &[0xff, 0xfe, 0x00]), ("folder.glb/inner", &[])]);
    for name in ["binary.ron", "folder.glb"] {
        let result = try_load(&folder.path().join(name));
        assert!(matches!(result, Err(SceneError::Unreadable { .. })), "{name}: {result:?}");
    }
}

#[test]
fn the_hash_is_of_the_content() {
    let hash = |text: &str| scene_of(text).hash;
    let cube =
        r#"Scene(geometry: BuiltIn("cube"), lights: [Point(position: (0, 2, 0), intensity: (1, 1, 1))])"#;
    assert_eq!(hash(cube), hash(cube), "the same twice");
    assert_ne!(hash(cube), hash(&cube.replace("(0, 2, 0)", "(0, 3, 0)")), "another light");
    assert_ne!(hash(cube), hash(&cube.replace("\"cube\"", "\"sphere\"")), "another body");
    assert_ne!(shipped("cornell-box").hash, shipped("cornell-box-point").hash, "other scenes");
}

#[test]
fn values_that_look_as_if_they_were_in_another_unit_are_stated() {
    let scene = |fov: f32, cone: f32, scale: f32| {
        scene_of(&format!(
            r#"Scene(
                geometry: Objects([Object(name: "cube", geometry: BuiltIn("cube"), transform: Transform(scale: ({scale:?}, 1, 1)))]),
                camera: Camera(position: (0, 0, 9), target: (0, 0, 0), vertical_fov_deg: {fov:?}),
                lights: [Spot(name: "lamp", position: (0, 0, 2), direction: (0, 0, -1), intensity: (1, 1, 1), outer_deg: {cone:?})],
            )"#
        ))
    };
    assert_eq!(scene(40.0, 30.0, 1.0).repairs, [""; 0]);
    let radians = scene(0.686, 0.52, 1.0);
    assert_states(
        &radians,
        "half the cone of the light `lamp` is 0.52°: in scene files angles are in degrees",
    );
    assert_states(&radians, "what the camera sees from top to bottom is 0.69°");
    assert_states(&scene(40.0, 30.0, 4000.0), "m wide: lengths are in metres");
}
