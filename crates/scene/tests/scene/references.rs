//! The scenes of the independent renderer, where they are beside the project. (The size of its images is in
//! the JSON only: glTF has none.)

use glam::Vec3;
use scene::LightKind;
use serde_json::Value;

use crate::common::{load_path, shared};

fn vector(json: &Value) -> Vec3 {
    Vec3::from(std::array::from_fn(|i| json[i].as_f64().expect("a number") as f32))
}

#[test]
fn cameras_and_lights_are_those_of_the_references() {
    let Some(folder) = shared() else { return };
    for name in ["cornell_spot", "cornell_glossy_spot", "sponza_spot", "sponza_sun"] {
        let file = folder.join(format!("references/{name}.glb"));
        let scene = load_path(&file);
        let text = std::fs::read_to_string(file.with_extension("json")).expect("the JSON beside it");
        let json: Value = serde_json::from_str(&text).expect("JSON");
        let (position, target) = (vector(&json["camera"]["position"]), vector(&json["camera"]["target"]));
        assert!(scene.camera.position.abs_diff_eq(position, 1e-6), "{name}: {:?}", scene.camera);
        let forward = (target - position).normalize();
        assert!(scene.camera.forward().abs_diff_eq(forward, 1e-6), "{name}: {:?}", scene.camera);
        let fov = (json["camera"]["vfov_deg"].as_f64().expect("a number") as f32).to_radians();
        assert!((scene.camera.vertical_fov - fov).abs() < 1e-6, "{name}: {:?}", scene.camera);

        let [light] = &scene.lights[..] else { panic!("{name}: one light, found {:?}", scene.lights) };
        let expected = &json["light"];
        let direction = vector(&expected["direction"]).normalize();
        assert!(light.direction.abs_diff_eq(direction, 1e-6), "{name}: {light:?}");
        if let LightKind::Spot { inner, outer } = light.kind {
            let degrees = |key: &str| expected[key].as_f64().expect("a number") as f32;
            assert!((outer.to_degrees() - degrees("cutoff_deg")).abs() < 1e-4, "{name}: {light:?}");
            assert!((inner.to_degrees() - degrees("beam_deg")).abs() < 1e-4, "{name}: {light:?}");
            assert!(light.position.abs_diff_eq(vector(&expected["position"]), 1e-6), "{name}: {light:?}");
            assert_eq!(light.intensity, vector(&expected["intensity"]), "{name}");
        } else {
            assert_eq!(light.kind, LightKind::Directional, "{name}");
            assert_eq!(light.intensity, vector(&expected["irradiance"]), "{name}");
        }
    }
}

#[test]
fn every_scene_of_the_folder_loads_with_its_size() {
    let Some(folder) = shared() else { return };
    // Triangles and textures as the folder's README lists them.
    let listed = [
        ("CesiumMan", 4672, 1),
        ("Fox", 576, 1),
        ("armadillo", 30000, 0),
        ("bunny", 69451, 0),
        ("cornell_box", 34, 0),
        ("cornell_fox_anim", 586, 1),
        ("cornell_glossy", 1110, 0),
        ("dragon", 19332, 0),
        ("maze", 1020, 0),
        ("sponza", 66453, 0),
        ("sponza_tex", 66453, 10),
    ];
    for (name, triangles, textures) in listed {
        let scene = load_path(&folder.join(format!("{name}.glb")));
        assert_eq!((scene.triangles(), scene.textures.len()), (triangles, textures), "{name}");
        let camera = scene.at(0.7).camera;
        assert!(camera.view().is_finite(), "{name}: {camera:?}");
        if name == "sponza" {
            let (min, max) = scene.bounds();
            assert!(min.abs_diff_eq(Vec3::new(-17.403, -0.907, -7.799), 1e-3), "{min}");
            assert!(max.abs_diff_eq(Vec3::new(17.417, 15.653, 7.801), 1e-3), "{max}");
        }
    }
}
