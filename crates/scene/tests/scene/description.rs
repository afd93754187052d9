//! Scene files: what they say, and what is wrong with them.

use std::collections::BTreeMap;

use glam::Vec3;
use scene::{LightKind, SceneError, load};

use crate::common::{Glb, InMemory, Shipped, load_text, shipped, states};

#[test]
fn a_description_sets_camera_and_lights() {
    let scene = load_text(
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
    )
    .expect("a good file");
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
    let scene = load_text(r#"Scene(geometry: BuiltIn("cube"))"#).expect("a good file");
    assert!(states(&scene, "no camera") && states(&scene, "no lights"), "{:?}", scene.repairs);
    for vertex in &scene.vertices {
        let pixel = scene.camera.project(vertex.position.into(), [100, 100]).expect("in front");
        assert!(pixel.min_element() > 0.0 && pixel.max_element() < 100.0, "the cube is seen: {pixel}");
    }
    let given = r#"Scene(geometry: BuiltIn("cube"), camera: Camera(position: (0, 0, 9), target: (0, 0, 0), vertical_fov_deg: 9))"#;
    let near = load_text(given).expect("a good file").camera.near;
    assert!((near - 3f32.sqrt() * 1e-4).abs() < 1e-9, "a ten-thousandth of the extent: {near}");
}

#[test]
fn objects_stand_where_they_are_put() {
    let scene = load_text(
        r#"Scene(geometry: Objects([
            Object(name: "a", geometry: BuiltIn("cube"), transform: Transform(translate: (10, 0, 0), rotate_deg: (0, 0, 90), scale: (4, 2, 2))),
            Object(name: "group", transform: Transform(translate: (0, 0, -5)), geometry: Objects([
                Object(name: "b", geometry: BuiltIn("plane")),
            ])),
        ]))"#,
    )
    .expect("a good file");
    let (min, max) = scene.bounds();
    // The cube, 4 m long in x, is turned upright about z; the plane lies at z = −5, at the group's place.
    assert!(min.abs_diff_eq(Vec3::new(-1.0, -2.0, -6.0), 1e-5), "{min}");
    assert!(max.abs_diff_eq(Vec3::new(11.0, 2.0, 1.0), 1e-5), "{max}");
    assert_eq!(scene.instances.len(), 2, "cube and plane");
}

#[test]
fn a_file_is_found_beside_the_description_and_its_lights_can_be_left_out() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut glb = Glb::square();
    glb.json["extensions"] =
        serde_json::json!({ "KHR_lights_punctual": { "lights": [{ "type": "point", "intensity": 2.0 }] } });
    glb.push("nodes", serde_json::json!({ "extensions": { "KHR_lights_punctual": { "light": 0 } } }));
    std::fs::write(folder.path().join("square.glb"), glb.bytes()).expect("a file");
    let path = folder.path().join("scene.ron");
    for (option, lights) in [("", 1), (", lights_from_file: false", 0)] {
        std::fs::write(&path, format!(r#"Scene(geometry: File("square.glb"){option})"#)).expect("a file");
        let scene = load(path.to_str().expect("UTF-8"), &Shipped).expect("a good file");
        assert_eq!((scene.triangles(), scene.lights.len()), (2, lights), "with `{option}`");
        assert_eq!(scene.files, [path.clone(), folder.path().join("square.glb")], "what to watch");
    }
}

#[test]
fn an_unknown_name_offers_the_nearest() {
    let Err(error) = load("cornel-box", &Shipped) else { panic!("there is none") };
    assert!(matches!(error, SceneError::NotFound { .. }), "{error}");
    assert!(error.to_string().contains("did you mean `cornell-box`?"), "{error}");
    let Err(error) = load("nowhere/scene.ron", &Shipped) else { panic!("there is none") };
    assert!(error.to_string().contains("nowhere/scene.ron"), "{error}");
    let Err(error) = load("nowhere.glb", &Shipped) else { panic!("there is none") };
    assert!(error.to_string().contains("nowhere.glb"), "{error}");
}

/// Line, column, and the whole text of the only error of a description.
fn error_of(text: &str) -> ((usize, usize), String) {
    match load_text(text) {
        Err(SceneError::Description(diagnostics)) => {
            let text = diagnostics.to_string();
            (diagnostics.0[0].labels[0].span.line_column(), text)
        }
        other => panic!("expected an error of the description for {text}, found {other:?}"),
    }
}

#[test]
fn errors_name_the_place_what_was_expected_and_the_nearest_name() {
    let cases = [
        ("Scene(geometri: BuiltIn(\"cube\"))", (1, 7), "did you mean `geometry`?"),
        ("Scene(\n  geometry: Builtin(\"cube\"))", (2, 13), "did you mean `BuiltIn`?"),
        ("Scene(\n  geometry: BuiltIn(\"cubes\"))", (2, 21), "did you mean `cube`?"),
        ("Scene(about: \"x\")", (1, 17), "field `geometry` is missing"),
        ("Scene(geometry: BuiltIn(\"cube\"),\n  lights: 3)", (2, 11), "[`"),
        ("Scene(geometry: BuiltIn(\"cube\")", (1, 31), "omma"),
        ("Scene(geometry: File(\"none.glb\"))", (1, 22), "there is no file none.glb"),
        (
            "Scene(geometry: BuiltIn(\"cube\"), camera: Camera(\n position: (0, 0, 0), target: (0, 0, 1), vertical_fov_deg: 180))",
            (2, 60),
            "between 0 and 180, found 180",
        ),
        (
            "Scene(geometry: BuiltIn(\"cube\"), camera: Camera(position: (1, 2, 3), target: (1, 2, 3), vertical_fov_deg: 9))",
            (1, 34),
            "the same point",
        ),
        (
            "Scene(geometry: BuiltIn(\"cube\"), lights: [\n Point(position: (0, NaN, 0), intensity: (1, 1, 1))])",
            (2, 18),
            "three finite numbers, found (0, NaN, 0)",
        ),
        (
            "Scene(geometry: BuiltIn(\"cube\"), lights: [\n Directional(direction: (0, 0, 0), irradiance: (1, 1, 1))])",
            (2, 25),
            "not all 0",
        ),
        (
            "Scene(geometry: BuiltIn(\"cube\"), lights: [\n Point(position: (0, 0, 0), intensity: (1, -1, 1))])",
            (2, 40),
            "not negative",
        ),
        (
            "Scene(geometry: BuiltIn(\"cube\"), lights: [\n Spot(position: (0, 0, 0), direction: (0, 1, 0), intensity: (1, 1, 1), outer_deg: 10, inner_deg: 20)])",
            (2, 87),
            "wider than the outer",
        ),
        (
            "Scene(geometry: BuiltIn(\"cube\"), lights: [Point(name: \"bulb\", position: (0, 0, 0), intensity: (1, 1, 1))],\n keyframes: Keyframes(lights: { \"blub\": [Key(time: 0)] }))",
            (2, 33),
            "did you mean `bulb`?",
        ),
        (
            "Scene(geometry: BuiltIn(\"cube\"),\n keyframes: Keyframes(objects: { \"cube\": [Key(time: 0)] }))",
            (2, 34),
            "there are none",
        ),
        (
            "Scene(geometry: BuiltIn(\"cube\"),\n keyframes: Keyframes(camera: [Key(time: 1, position: (0, 0, 0)), Key(time: 1, position: (0, 1, 0))]))",
            (2, 23),
            "key 1 is not later",
        ),
        (
            "Scene(geometry: Objects([\n Object(name: \"a\", geometry: BuiltIn(\"cube\")),\n Object(name: \"a\", geometry: BuiltIn(\"cube\"))]))",
            (2, 15),
            "two objects are named `a`",
        ),
    ];
    for (text, place, words) in cases {
        let (found, message) = error_of(text);
        assert_eq!(found, place, "the place of: {message}");
        assert!(message.contains(words), "expected `{words}` in: {message}");
        assert!(
            message.contains(&format!("test.ron:{}:{}", place.0, place.1)),
            "file and line in: {message}"
        );
    }
}

#[test]
fn a_folder_or_a_file_of_no_text_is_unreadable() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("binary.ron");
    std::fs::write(&path, [0xff, 0xfe, 0x00]).expect("a file");
    let nothing = InMemory(BTreeMap::new());
    let result = load(path.to_str().expect("UTF-8"), &nothing);
    assert!(matches!(result, Err(SceneError::Unreadable { .. })), "{result:?}");
    let path = folder.path().join("folder.glb");
    std::fs::create_dir(&path).expect("a folder");
    let result = load(path.to_str().expect("UTF-8"), &nothing);
    assert!(matches!(result, Err(SceneError::Unreadable { .. })), "{result:?}");
}

#[test]
fn the_hash_is_of_the_content() {
    let hash = |text: &str| load_text(text).expect("a good file").hash;
    let cube =
        r#"Scene(geometry: BuiltIn("cube"), lights: [Point(position: (0, 2, 0), intensity: (1, 1, 1))])"#;
    assert_eq!(hash(cube), hash(cube), "the same twice");
    assert_ne!(hash(cube), hash(&cube.replace("(0, 2, 0)", "(0, 3, 0)")), "another light");
    assert_ne!(hash(cube), hash(&cube.replace("\"cube\"", "\"sphere\"")), "another body");
    assert_ne!(shipped("cornell-box").hash, shipped("cornell-box-point").hash, "other scenes");
}
