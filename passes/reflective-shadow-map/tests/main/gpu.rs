//! The pass on a GPU, against closed forms and the CPU reference.

use crate::cpu_reference::{Layer, incident_flux};
use glam::{DVec2, UVec2, Vec3, Vec4, Vec4Swizzles, vec3};
use half::f16;
use pass_test::{Harness, Outputs};
use scene::{Light, LightKind, Scene};
use std::f64::consts::PI;

struct Map {
    position: Vec<glam::Vec4>,
    normal: Vec<[f16; 4]>,
    albedo: Vec<[f16; 4]>,
    flux: Vec<glam::Vec4>,
}

fn run(scene: &Scene, size: u32) -> Option<(Map, Outputs)> {
    let outputs =
        Harness::new(reflective_shadow_map::PASS).with_scene(scene.clone()).set("size", size).run()?;
    let vectors = |name: &str| outputs.read::<[f32; 4]>(name).into_iter().map(Into::into).collect();
    let (position, flux) = (vectors("rsm.position"), vectors("rsm.flux"));
    let (normal, albedo) = (outputs.read("rsm.normal"), outputs.read("rsm.albedo"));
    Some((Map { position, normal, albedo, flux }, outputs))
}

fn layers(outputs: &Outputs) -> u32 {
    outputs.desc("rsm.position").texture().expect("a texture array").layers
}

/// The square of the scene `plane` reflects half of the cone: all of it falls on the square.
#[test]
fn a_square_reflects_the_flux_of_a_spot() {
    let Some((map, outputs)) = run(&pass_test::scene("plane"), 256) else { return };
    let sum: f64 = map.flux.iter().map(|flux| f64::from(flux.x)).sum();
    let cone = 2.0 * PI * (1.0 - (30f64).to_radians().cos());
    assert!((sum / (0.5 * cone) - 1.0).abs() < 2e-3, "{sum} W of {} W", 0.5 * cone);
    assert_eq!(layers(&outputs), 1);
    // The texels within the cone are those of a disc of radius tan 30° on the square.
    let in_cone = |(flux, position): &(&Vec4, &Vec4)| flux.x > 0.0 && position.w > 0.0;
    let disc: f64 =
        map.flux.iter().zip(&map.position).filter(in_cone).map(|(flux, _)| f64::from(flux.w)).sum();
    let expected = PI * 30f64.to_radians().tan().powi(2);
    assert!((disc / expected - 1.0).abs() < 1e-2, "{disc} m² of {expected} m²");
    for (position, normal) in map.position.iter().zip(&map.normal).filter(|(position, _)| position.w > 0.0) {
        assert!(position.y.abs() < 1e-5 && (position.w - 1.0).abs() < 1e-5, "{position}");
        assert!(normal[1].to_f32() > 0.999, "{normal:?}");
    }
}

/// Above the middle of a square of side 2 at distance 1, a point light sends it a sixth of all it emits.
#[test]
fn a_square_reflects_a_sixth_of_a_point_light() {
    let mut scene = pass_test::scene("plane");
    scene.lights[0].kind = LightKind::Point;
    for size in [1, 2, 63] {
        let Some((map, outputs)) = run(&scene, size) else { return };
        let sum: f64 = map.flux.iter().map(|flux| f64::from(flux.y)).sum();
        assert!((sum / (0.5 * 4.0 * PI / 6.0) - 1.0).abs() < 2e-2 / f64::from(size), "{size}: {sum} W");
        assert_eq!(layers(&outputs), 6);
    }
}

/// Layers of many lights share texels, by whole workgroups of 8² where they have as many, and lose no light.
#[test]
fn layers_of_many_lights_are_smaller() {
    let mut scene = pass_test::scene("plane");
    let light = Light { kind: LightKind::Point, ..scene.lights[0].clone() };
    // A point light has six layers.
    for (lights, size, full_layers, side) in
        [(1, 63, 6, 63), (5, 64, 30, 64), (5, 128, 2, 32), (5, 127, 2, 32), (7, 16, 8, 6), (9, 1, 1, 1)]
    {
        scene.lights = vec![light.clone(); lights];
        let harness = Harness::new(reflective_shadow_map::PASS).with_scene(scene.clone());
        let harness = harness.set("size", size).set("full_layers", full_layers);
        let Some(outputs) = harness.run() else { return };
        let desc = outputs.desc("rsm.flux");
        assert_eq!(desc.texture().expect("a texture array").layers, 6 * lights as u32);
        let flux: Vec<[f32; 4]> = outputs.read("rsm.flux");
        assert_eq!(flux.len(), 6 * lights * side * side, "{lights} lights, {full_layers} layers of {size}²");
        let sum: f64 = flux.iter().map(|flux| f64::from(flux[1])).sum();
        let expected = lights as f64 * 0.5 * 4.0 * PI / 6.0;
        assert!(
            (sum / expected - 1.0).abs() < 2e-2,
            "{lights} lights, {full_layers} layers of {size}²: {sum} W"
        );
    }
}

/// It is lit by the cosine of the bent normal, and reflects nothing below the horizon of that, which is (1 - cosα) / 2 of what
/// leaves a Lambertian surface. Its area and its normal stay those of the square.
#[test]
fn a_normal_map_changes_the_flux_alone() {
    for angle in [0.0, 30.0, 75.0] {
        let (mut scene, bent) = pass_test::rooms::bent_plane(angle);
        for direction in [vec3(0.0, -1.0, 0.0), vec3(0.6, -0.8, 0.0), vec3(-0.6, -0.8, 0.0)] {
            scene.lights[0] = Light { kind: LightKind::Directional, direction, ..scene.lights[0].clone() };
            let Some((map, _)) = run(&scene, 64) else { return };
            let sum: f64 = map.flux.iter().map(|flux| f64::from(flux.x)).sum();
            let lit = bent.dot(-direction.as_dvec3()).max(0.0);
            let expected = 0.5 * 4.0 * lit * 0.5 * (1.0 + bent.y);
            assert!(
                (sum - expected).abs() <= 0.02 * expected,
                "{angle}° {direction}: {sum} W of {expected} W"
            );
            let area: f64 = map.flux.iter().map(|flux| f64::from(flux.w)).sum();
            assert!((area / 4.0 - 1.0).abs() < 0.02, "{area} m² of 4 m²");
            for (normal, position) in map.normal.iter().zip(&map.position).filter(|(_, at)| at.w > 0.0) {
                assert!(normal[1].to_f32() > 0.999, "{position}: {normal:?}");
            }
        }
    }
}

#[test]
fn a_square_reflects_its_area_of_parallel_light() {
    let mut scene = pass_test::scene("plane");
    let direction = vec3(0.3, -1.0, -0.2).normalize();
    scene.lights[0] = Light { kind: LightKind::Directional, direction, ..scene.lights[0].clone() };
    let Some((map, _)) = run(&scene, 256) else { return };
    let sum: f64 = map.flux.iter().map(|flux| f64::from(flux.z)).sum();
    let expected = 0.5 * 4.0 * f64::from(-direction.y);
    assert!((sum / expected - 1.0).abs() < 1e-2, "{sum} W of {expected} W");
    // However slanted the light, the texels are parts of the whole square of 4 m².
    let area: f64 = map.flux.iter().map(|flux| f64::from(flux.w)).sum();
    assert!((area / 4.0 - 1.0).abs() < 1e-2, "{area} m² of 4 m²");
    // w grows along the light's way.
    let seen: Vec<_> = map.position.iter().filter(|p| p.w > 0.0).collect();
    let origin = seen[0].xyz().dot(direction) - seen[0].w;
    assert!(seen.iter().all(|p| (p.xyz().dot(direction) - p.w - origin).abs() < 1e-4));
}

/// Spot, point and directional light at once: each texel's position lies on its ray, and its flux is the CPU reference's.
#[test]
fn every_texel_of_several_lights_agrees_with_the_cpu_reference() {
    let scene = pass_test::scene("cornell-box-lights");
    const SIZE: u32 = 48;
    let Some((map, outputs)) = run(&scene, SIZE) else { return };
    assert_eq!(layers(&outputs), 8);
    let texels = (SIZE * SIZE) as usize;
    let mut lit = 0;
    for (i, position) in map.position.iter().enumerate() {
        let (layer, texel) = (i / texels, UVec2::new(i as u32 % SIZE, i as u32 / SIZE % SIZE));
        let light = &scene.lights[[0, 1, 1, 1, 1, 1, 1, 2][layer]];
        if position.w == 0.0 {
            assert_eq!(map.flux[i].xyz(), Vec3::ZERO);
            continue;
        }
        let offset = position.xyz() - light.position;
        let (spread, half_extent) = match light.kind {
            LightKind::Spot { inner, outer } => {
                let cosine = |angle: f32| f64::from(angle).cos();
                let spread = Layer::Spot { cos_inner: cosine(inner), cos_outer: cosine(outer) };
                assert!((offset.dot(light.direction) - position.w).abs() < 1e-5);
                (spread, f64::from(outer).tan())
            }
            LightKind::Point => {
                // The axis distance is the greatest component, for rays within the face.
                assert!((offset.abs().max_element() - position.w).abs() < 1e-5, "{offset} {}", position.w);
                (Layer::Point, 1.0)
            }
            // The extent is that of the scene's box seen by the light: checked by the sum over the square.
            LightKind::Directional => continue,
        };
        // The radius on the image plane is that of the texel's centre.
        let centre = ((texel.as_dvec2() + 0.5) / f64::from(SIZE) * 2.0 - 1.0) * half_extent;
        let radius = (f64::from(offset.length() / position.w).powi(2) - 1.0).max(0.0).sqrt();
        assert!((radius - centre.length()).abs() < 1e-3, "{texel:?}: {radius} for {centre:?}");
        let sent = incident_flux(spread, texel, SIZE, DVec2::splat(half_extent));
        for k in 0..3 {
            let expected = sent * f64::from(light.intensity[k] * map.albedo[i][k].to_f32());
            let got = f64::from(map.flux[i][k]);
            // At the hard rim of the cone single precision may decide otherwise; the ramp there is at 0.
            assert!(
                (got - expected).abs() <= 1e-3 * expected + 1e-9,
                "{layer} {texel:?}: {got} for {expected}"
            );
        }
        lit += u32::from(sent > 0.0);
        let n = map.normal[i].map(f16::to_f32);
        assert!(vec3(n[0], n[1], n[2]).dot(offset) < 0.0, "a normal on the far side");
    }
    assert!(lit > 1000, "{lit} texels are lit");
}

#[test]
fn without_lights_there_is_one_layer_that_sees_nothing() {
    let outputs = Harness::new(reflective_shadow_map::PASS).scene("cornell-box-lamp").set("size", 4u32).run();
    let Some(outputs) = outputs else { return };
    assert_eq!(layers(&outputs), 1);
    assert_eq!(outputs.read::<[f32; 4]>("rsm.position"), [[0.0; 4]; 16]);
    assert_eq!(outputs.read::<[f32; 4]>("rsm.flux"), [[0.0; 4]; 16]);
}

/// A glossy surface has its reflectance and roughness; elsewhere the map has no such member.
#[test]
fn a_glossy_surface_has_its_specular_reflectance() {
    let mut scene = pass_test::scene("plane");
    let Some((_, outputs)) = run(&scene, 16) else { return };
    assert!(outputs.desc("rsm.albedo").texture().is_some());
    for material in &mut scene.materials {
        (material.metallic, material.roughness) = (1.0, 0.25);
        material.base_color = glam::vec4(0.75, 0.5, 0.25, 1.0);
    }
    let Some((map, outputs)) = run(&scene, 16) else { return };
    let specular: Vec<[f16; 4]> = outputs.read("rsm.specular");
    let seen = map.position.iter().zip(specular).filter(|(position, _)| position.w > 0.0);
    let mut texels = 0;
    for (_, specular) in seen {
        assert_eq!(specular.map(f16::to_f32), [0.75, 0.5, 0.25, 0.25]);
        texels += 1;
    }
    assert!(texels > 100, "{texels} texels see the square");
}
