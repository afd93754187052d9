//! Scenes as glTF: what is written loads again as the same.

use glam::Vec3;
use scene::{Light, LightKind, Scene};
use serde_json::Value;

use crate::common::{load_bytes, shipped};
use crate::gltf::{png, textured};

/// Checks that the written file has the same triangles, materials, lights and camera at a time.
fn assert_alike(scene: &Scene, time: f32) {
    let pose = scene.at(time);
    let again = load_bytes("test.glb", &scene.to_glb(&pose)).unwrap_or_else(|error| panic!("{error}"));
    let what = format!("{} at {time} s", scene.name);
    assert_eq!(again.repairs, Vec::<String>::new(), "{what}");
    assert_eq!(again.triangles(), scene.triangles(), "{what}");
    let mut vertices = scene.vertices.clone();
    for moved in &pose.moved {
        let first = moved.first_vertex as usize;
        vertices[first..first + moved.vertices.len()].copy_from_slice(&moved.vertices);
    }
    // Of an instance with several materials, triangles are in the order of these: all are there, in some order.
    let corners = |scene: &Scene, vertices: &[scene::Vertex]| {
        let color =
            |material: u32| scene.materials[material as usize].base_color.to_array().map(f32::to_bits);
        let corner = |index: &u32| {
            let vertex = &vertices[*index as usize];
            let place = vertex.position.map(|c| (c + 0.0).to_bits());
            (place, vertex.normal.map(|c| (c * 1e4).round() as i32), color(vertex.material))
        };
        let mut corners: Vec<_> = scene.indices.iter().map(corner).collect();
        corners.sort_unstable();
        corners
    };
    let found = corners(&again, &again.vertices);
    assert!(found == corners(scene, &vertices), "{what}: corners differ");
    let near = |a: Vec3, b: Vec3, what: &str| {
        assert!((a - b).length() <= 1e-5 * (1.0 + b.length()), "{}: {what}: {a} is not {b}", scene.name);
    };
    assert_eq!(again.lights.len(), pose.lights.len(), "{what}");
    for (found, light) in again.lights.iter().zip(&pose.lights) {
        near(found.intensity, light.intensity, "intensity");
        near(found.direction, if is_round(light) { found.direction } else { light.direction }, "direction");
        near(
            found.position,
            if light.kind == LightKind::Directional { found.position } else { light.position },
            "place",
        );
        assert_eq!(std::mem::discriminant(&found.kind), std::mem::discriminant(&light.kind), "{what}");
        assert!((light.falloff(0.9) - found.falloff(0.9)).abs() < 1e-3, "{what}: {:?}", found.kind);
    }
    near(again.camera.position, pose.camera.position, "camera");
    near(again.camera.forward(), pose.camera.forward(), "forward");
    let up = |camera: &scene::Camera| camera.view().row(1).truncate();
    near(up(&again.camera), up(&pose.camera), "up");
    assert!((again.camera.vertical_fov - pose.camera.vertical_fov).abs() < 1e-6, "{what}");
    let used: Vec<_> =
        again.materials.iter().map(|material| (material.emission, material.specular)).collect();
    for (material, (emission, specular)) in scene.materials.iter().zip(used) {
        near(emission, material.emission, "emission");
        near(specular, material.specular, "specular");
    }
}

fn is_round(light: &Light) -> bool {
    light.kind == LightKind::Point
}

#[test]
fn what_is_written_loads_again_as_the_same() {
    let scenes =
        ["cornell-box", "cornell-box-lights", "cornell-box-lamp", "cornell-box-sun", "atrium-spot", "plane"];
    for name in scenes {
        assert_alike(&shipped(name), 0.0);
    }
    assert_alike(&shipped("cornell-box-moving"), 0.7);
    assert_alike(&shipped("cornell-box-cloth"), 0.3);
}

#[test]
fn an_empty_scene_is_written_too() {
    let bytes = shipped("empty").to_glb(&shipped("empty").at(0.0));
    assert!(bytes.starts_with(b"glTF") && bytes.len().is_multiple_of(4));
    let text = String::from_utf8_lossy(&bytes);
    assert!(!text.contains("\"meshes\"") && !text.contains("[]"), "{text}");
}

#[test]
fn textures_are_written() {
    let scene = textured(Value::Null, &png()).scene();
    let again = load_bytes("test.glb", &scene.to_glb(&scene.at(0.0))).unwrap();
    let of = |scene: &Scene| -> Vec<_> {
        scene
            .textures
            .iter()
            .map(|texture| (texture.pixels.clone(), texture.wrap, texture.encoding))
            .collect()
    };
    assert_eq!(of(&again), of(&scene));
    assert_eq!(again.materials[0].base_color_texture, scene.materials[0].base_color_texture);
    assert_eq!(
        again.vertices.iter().map(|v| v.uv).collect::<Vec<_>>(),
        scene.vertices.iter().map(|v| v.uv).collect::<Vec<_>>()
    );
}
