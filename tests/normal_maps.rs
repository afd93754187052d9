//! Light of surfaces under normal maps, against path tracing: where it goes, and how much of it where a map is finer than pixels.

use crate::adapter::{done, renderer};
use glam::{DVec2, Vec3, Vec4};
use metrics::Image;
use pass_test::random::{hash, unit_float};
use pass_test::rooms;
use scene::{Camera, Light, LightKind, Scene, Vertex};
use std::f64::consts::PI;

const SIDE: u32 = 32;

/// A floor of 2 m under parallel light, as `floor` has it, between two walls of 1 m that the light does not reach.
fn between_walls(floor: &Scene, travels: [f32; 3]) -> Scene {
    let mut scene = floor.clone();
    scene.materials.push(rooms::matte([0.8; 3], [0.0; 3]));
    scene.materials[0].base_color = Vec4::new(0.8, 0.8, 0.8, 1.0);
    for x in [-1.0, 1.0] {
        let first = scene.vertices.len() as u32;
        let corner = |y: f32, z: f32| Vertex {
            position: [x, y, z],
            normal: [-x, 0.0, 0.0],
            material: 1,
            ..scene.vertices[0]
        };
        let corners = [corner(0.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(0.0, 1.0)];
        scene.vertices.extend(corners);
        scene.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
    }
    scene.instances[0].vertex_count = scene.vertices.len() as u32;
    scene.instances[0].index_count = scene.indices.len() as u32;
    scene.lights = vec![Light {
        kind: LightKind::Directional,
        direction: Vec3::from(travels).normalize(),
        intensity: Vec3::splat(4.0),
        ..scene.lights[0].clone()
    }];
    scene.camera = Camera { up: Vec3::Y, ..rooms::camera_at([0.0, 0.5, 2.2], [0.0, 0.4, 0.0], 0.9) };
    scene
}

/// Means of an output over the left and the right half of the picture, each over seeds.
fn halves(pipeline: &str, scene: &Scene, output: &str, values: &[&str], seeds: u32) -> Option<[f64; 2]> {
    let mut renderer = renderer(pipeline, "plane", (SIDE, SIDE), values)?;
    renderer.set_scene(scene.clone()).unwrap();
    renderer.keep_only([output]).unwrap();
    let mut sums = [0.0; 2];
    for seed in 0..seeds {
        renderer.set_seed(seed);
        done(&mut renderer);
        let image: Image = renderer.output(output).unwrap();
        for (i, pixel) in image.pixels().iter().enumerate() {
            sums[usize::from(i as u32 % SIDE >= SIDE / 2)] += f64::from(pixel[1]);
        }
    }
    Some(sums.map(|sum| sum / f64::from(seeds)))
}

/// How far the light of a pipeline may be from path tracing's. A cluster sends the light of many texels from one place.
fn tolerance(pipeline: &str) -> f64 {
    if pipeline == "acrsm" { 0.15 } else { 0.04 }
}

/// Light leaves a surface only to where its bent normal faces: the wall on the other side gets a small part of it.
#[test]
fn light_leaves_to_where_bent_normals_face() {
    let (floor, _) = rooms::bent_plane(60.0);
    let scene = between_walls(&floor, [0.0, -1.0, 0.0]);
    let few = ["rsm.size=128", "lights=1024", "supersampling=1"];
    let photons = ("instant-radiosity", &["lights=2048", "supersampling=1"][..]);
    let clusters = ("acrsm", &["rsm.size=128", "supersampling=1"][..]);
    let kept = ("smc-ir", &["lights=2048", "map=64", "supersampling=1"][..]);
    let of_one_bounce = vec![
        ("ism-invtm-ray-traced", &few[..]),
        ("reflective-shadow-maps", &few[..1]),
        clusters,
        photons,
        kept,
    ];
    for (bounces, pipelines) in [("1", of_one_bounce), ("3", vec![photons])] {
        let count = format!("bounces={bounces}");
        let values = ["samples=256", "samples_per_frame=64", "filter=centre", &count];
        let Some([left, right]) = halves("reference", &scene, "indirect", &values, 1) else { return };
        if bounces == "1" {
            assert!(left < 0.5 * right, "the map bends to the right: {left} and {right}");
        }
        for (pipeline, values) in pipelines {
            let mut values = values.to_vec();
            if [photons, kept].iter().any(|(name, _)| *name == pipeline) {
                values.push(&count);
            }
            let found = halves(pipeline, &scene, "indirect", &values, 4).expect("an adapter");
            let ratios = [found[0] / left, found[1] / right];
            eprintln!("RATIO {pipeline}, {bounces}: {ratios:.3?}");
            assert!(
                ratios.iter().all(|ratio| (ratio - 1.0).abs() < tolerance(pipeline)),
                "{pipeline}, {bounces}: {ratios:?}"
            );
        }
    }
}

/// Where a pixel, or a texel of the lights' maps, has many normals, they count as what they are: not as their mean, made a unit vector.
#[test]
fn normals_finer_than_pixels_keep_their_light() {
    let (mut floor, _) = rooms::bent_plane(0.0);
    // Slopes are sums of sixteen waves of 8 to 16 texels, and so nearly normally distributed, with the deviation 0.4.
    let side = 512;
    let number = |i: u32| unit_float(hash(i));
    let waves: Vec<(DVec2, DVec2, f64)> = (0..16)
        .map(|i| {
            let way = DVec2::from_angle(2.0 * PI * number(4 * i));
            let length = 8.0 + 8.0 * number(4 * i + 1);
            (way, way * 2.0 * PI / length, 2.0 * PI * number(4 * i + 2))
        })
        .collect();
    let texel = |i: u32| {
        let at = DVec2::new(f64::from(i % side), f64::from(i / side));
        let slope: DVec2 = waves.iter().map(|(way, k, phase)| *way * (k.dot(at) + phase).cos()).sum();
        let normal = (0.2 * slope).extend(1.0).normalize();
        let [x, y, z] = normal.to_array().map(|x| ((x + 1.0) * 127.5).round() as u8);
        [x, y, z, 255]
    };
    let texture = &mut floor.textures[0];
    (texture.width, texture.height) = (side, side);
    texture.pixels = (0..side * side).flat_map(texel).collect();
    let scene = between_walls(&floor, [0.0, -0.7, -0.7]);
    // The outlines of walls are those at the middles of pixels, but their normals are all that pixels have.
    for (output, filter) in [("direct", "filter=box"), ("indirect", "filter=centre")] {
        let values = ["samples=256", "samples_per_frame=64", "bounces=1", filter];
        let Some(truth) = halves("reference", &scene, output, &values, 1) else { return };
        let texels = ("ism-invtm-ray-traced", &["rsm.size=128", "lights=1024", "supersampling=1"][..]);
        let photons = ("smc-ir", &["bounces=1", "lights=1024", "map=64", "supersampling=1"][..]);
        let clusters = ("acrsm", &["rsm.size=128", "supersampling=1"][..]);
        let pipelines = if output == "direct" { vec![texels] } else { vec![texels, clusters, photons] };
        for (pipeline, values) in pipelines {
            let found = halves(pipeline, &scene, output, values, 4).expect("an adapter");
            let ratios = [found[0] / truth[0], found[1] / truth[1]];
            eprintln!("RATIO {pipeline}, {output}: {ratios:.3?}");
            assert!(
                ratios.iter().all(|ratio| (ratio - 1.0).abs() < tolerance(pipeline)),
                "{pipeline}, {output}: {ratios:?}"
            );
        }
    }
}
