//! Keyframes and animations.

use glam::Vec3;
use scene::Changes;
use serde_json::json;

use crate::common::{Glb, assert_states, assert_trait, scene_of, shipped};

#[test]
fn keys_are_met_and_hold_outside() {
    let scene = scene_of(
        r#"Scene(
            geometry: Objects([Object(name: "cube", geometry: BuiltIn("cube"))]),
            camera: Camera(position: (0, 0, 9), target: (0, 0, 0), vertical_fov_deg: 40),
            lights: [Point(name: "bulb", position: (0, 5, 0), intensity: (1, 1, 1)), Point(position: (0, 6, 0), intensity: (1, 1, 1))],
            keyframes: Keyframes(
                frames_per_second: 10,
                camera: [Key(time: 1, position: (0, 0, 9)), Key(time: 2, position: (0, 3, 9))],
                lights: { "bulb": [Key(time: 0, intensity: (1, 2, 3)), Key(time: 2, intensity: (3, 2, 1))] },
                objects: { "cube": [Key(time: 0, translate: (0, 0, 0)), Key(time: 4, translate: (8, 0, 0), rotate_deg: (0, 90, 0))] },
            ),
        )"#,
    );
    assert_eq!((scene.duration, scene.frame_time(25)), (4.0, 2.5), "the last key; 10 frames a second");
    assert_eq!(scene.at(0.5).camera.position, Vec3::new(0.0, 0.0, 9.0), "holds before the first key");
    assert_eq!(scene.at(7.0).camera.position, Vec3::new(0.0, 3.0, 9.0), "holds after the last");
    assert_eq!(scene.at(1.0).lights[0].intensity, Vec3::splat(2.0), "half way between");
    let moved = &scene.at(4.0).moved;
    assert_eq!((moved.len(), moved[0].first_vertex, moved[0].vertices.len()), (1, 0, 24), "the cube");
    let centre: Vec3 = moved[0].vertices.iter().map(|v| Vec3::from(v.position)).sum::<Vec3>() / 24.0;
    assert!(centre.abs_diff_eq(Vec3::new(8.0, 0.0, 0.0), 1e-5), "at its last key: {centre}");

    let at_rest = &scene.at(0.0).moved[0].vertices;
    assert!(
        at_rest
            .iter()
            .zip(&scene.vertices)
            .all(|(a, b)| a.material == b.material && a.instance == b.instance)
    );
    let none = Changes::default();
    assert_eq!(scene.changes(0.3, 0.3), none, "the same time");
    assert_eq!(scene.changes(5.0, 6.0), none, "all holds");
    assert_eq!(scene.changes(2.5, 3.5), Changes { geometry: true, ..none }, "only the cube still moves");
    assert_eq!(scene.changes(1.0, 1.5), Changes { camera: true, lights: true, geometry: true }, "all move");
    for name in ["moving_camera", "moving_lights", "moving_geometry"] {
        assert_trait(&scene, name, true);
    }
}

#[test]
fn keyframes_can_repeat() {
    let text = r#"Scene(geometry: BuiltIn("cube"), lights: [Point(name: "bulb", position: (0, 5, 0), intensity: (1, 1, 1))],
        keyframes: Keyframes(repeat: true, lights: { "bulb": [Key(time: 0, position: (0, 5, 0)), Key(time: 2, position: (4, 5, 0))] }))"#;
    let scene = scene_of(text);
    let x = |time: f32| scene.at(time).lights[0].position.x;
    assert!((x(0.5) - 1.0).abs() < 1e-5 && (x(4.5) - 1.0).abs() < 1e-5, "{} and {}", x(0.5), x(4.5));
}

#[test]
fn a_still_scene_does_not_move() {
    let scene = shipped("cornell-box");
    let (a, b) = (scene.at(0.0), scene.at(17.0));
    assert_eq!((&a.camera, &a.lights, a.moved.len()), (&b.camera, &b.lights, 0), "nothing moves");
    assert_eq!(scene.duration, 0.0, "no keys");
}

/// A square that goes from x = 0 to x = 2 in one second, with a light and a camera as its children.
fn animated(interpolation: &str, values: &[f32]) -> Glb {
    let mut glb = Glb::square();
    glb.json["extensions"] =
        json!({ "KHR_lights_punctual": { "lights": [{ "type": "spot", "intensity": 3.0, "spot": {} }] } });
    glb.json["nodes"][0]["children"] = json!([1, 2]);
    glb.push("nodes", json!({ "extensions": { "KHR_lights_punctual": { "light": 0 } } }));
    glb.push("nodes", json!({ "camera": 0, "translation": [0.0, 0.0, 5.0] }));
    glb.push("cameras", json!({ "type": "perspective", "perspective": { "yfov": 0.7, "znear": 0.1 } }));
    let input = glb.floats("SCALAR", &[0.0, 1.0]);
    let output = glb.floats("VEC3", values);
    glb.animate(0, "translation", interpolation, input, output);
    glb
}

#[test]
fn a_gltf_animation_moves_mesh_light_and_camera_and_repeats() {
    let scene = animated("LINEAR", &[0.0, 0.0, 0.0, 2.0, 0.0, 0.0]).scene();
    for time in [0.25, 3.25] {
        let pose = scene.at(time);
        assert_eq!(pose.moved[0].vertices[0].position, [0.5, 0.0, 0.0], "the first corner at {time} s");
        assert_eq!(pose.lights[0].position, Vec3::new(0.5, 0.0, 0.0), "the light at {time} s");
        assert_eq!(pose.camera.position, Vec3::new(0.5, 0.0, 5.0), "the camera at {time} s");
    }
    let step = animated("STEP", &[0.0, 0.0, 0.0, 2.0, 0.0, 0.0]).scene();
    assert_eq!(step.at(0.9).lights[0].position.x, 0.0, "steps hold");
    let mut cubic = vec![0.0; 18];
    cubic[12] = 2.0;
    let cubic = animated("CUBICSPLINE", &cubic).scene();
    assert!((cubic.at(0.25).lights[0].position.x - 2.0 * 0.15625).abs() < 1e-6, "smooth step of a quarter");
}

#[test]
fn an_animation_that_makes_no_sense_is_left_out_and_stated() {
    let scene = animated("LINEAR", &[0.0, 0.0, 0.0]).scene();
    assert_states(&scene, "expected 2 values for 2 times, found 1");
    assert_eq!(scene.at(0.5).lights[0].position, Vec3::ZERO, "nothing moves");
}

#[test]
fn the_shipped_moving_scene_moves_everything() {
    let scene = shipped("cornell-box-moving");
    assert_eq!(scene.changes(0.0, 1.0), Changes { camera: true, lights: true, geometry: true });
    // A ball of radius 6 cm rolls: its lowest point stays on the floor.
    for frame in 0..60 {
        let pose = scene.at(scene.frame_time(frame));
        let lowest = pose.moved[0].vertices.iter().map(|v| v.position[1]).fold(f32::INFINITY, f32::min);
        assert!(lowest.abs() < 1e-3, "frame {frame}: {lowest} m above the floor");
    }
}

/// A light that a program adds to a loaded scene is there at every time, and does not move.
#[test]
fn a_light_that_was_added_shines() {
    let mut scene = shipped("cornell-box-glide");
    let added = scene.lights[0].clone();
    scene.lights.push(added.clone());
    let lights = scene.at(1.0).lights;
    assert!(lights.len() == 2 && lights[0] != added && lights[1] == added, "{lights:?}");
}
