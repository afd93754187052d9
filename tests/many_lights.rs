//! Scenes of many lights: layers of reflective shadow maps share texels, and each cluster stands for a large area.

use crate::adapter::{done, mean, renderer};
use glam::{Vec3, vec3};
use pass_test::random::{hash2, unit_float};
use scene::{Light, LightKind};

/// Point lights at random places of the Cornell box, above its blocks, as bright together as one.
fn point_lights(like: &Light, count: u32) -> Vec<Light> {
    let at = |i: u32, axis: u32| unit_float(hash2(i, axis)) as f32;
    let light = |i: u32| Light {
        name: format!("lamp {i}"),
        kind: LightKind::Point,
        position: vec3(0.05 + 0.45 * at(i, 0), 0.36 + 0.16 * at(i, 1), 0.05 + 0.45 * at(i, 2)),
        intensity: Vec3::splat(0.3 / count as f32),
        ..like.clone()
    };
    (0..count).map(light).collect()
}

#[test]
fn many_point_lights_keep_their_energy() {
    let size = (32, 24);
    let of = |pipeline: &str, values: &[&str]| {
        let mut renderer = renderer(pipeline, "cornell-box", size, values)?;
        let mut scene = renderer.scene().clone();
        scene.lights = point_lights(&scene.lights[0], 48);
        renderer.set_scene(scene).unwrap();
        renderer.keep_only(["indirect"]).unwrap();
        done(&mut renderer);
        Some(mean(&renderer.output("indirect").unwrap()))
    };
    let Some(truth) = of("reference", &["samples=1024", "filter=centre"]) else { return };
    for pipeline in ["ism-invtm", "tcas", "acrsm"] {
        let found = of(pipeline, &["rsm.size=64", "rsm.full_layers=18", "supersampling=1"])
            .expect("the adapter is still there");
        for channel in 0..3 {
            let energy = found[channel] / truth[channel];
            assert!((energy - 1.0).abs() < 0.05, "{pipeline}, channel {channel}: {energy} of the energy");
        }
    }
}
