//! Lights on emitters against closed forms.

use emitter_lights::PASS;
use glam::{DVec3, Vec3, dvec3};
use interfaces::virtual_lights::VirtualLight;
use pass_test::Harness;
use pass_test::rooms::{floor_and_lamp, quad, room, view_factor};
use scene::{Encoding, Scene, Texture, Vertex, Wrap};
use std::f64::consts::PI;

pass_test::shaders_are_valid!(PASS);

fn lights(scene: &Scene, count: u32) -> Option<Vec<VirtualLight>> {
    Some(Harness::new(PASS).with_scene(scene.clone()).set("count", count).run()?.lights("lights"))
}

fn flux(lights: &[VirtualLight]) -> f64 {
    lights.iter().map(|light| f64::from(light.flux[0])).sum()
}

/// Irradiance of unshadowed lights on a point that faces up \[W/m²\].
fn irradiance(lights: &[VirtualLight], at: DVec3) -> f64 {
    let of = |light: &VirtualLight| {
        let [from, normal] = [light.position, light.normal].map(|v| Vec3::from(v).as_dvec3());
        let offset = at - from;
        let d2 = offset.length_squared();
        f64::from(light.flux[0]) * normal.dot(offset).max(0.0) * (-offset.y).max(0.0) / (PI * d2 * d2)
    };
    lights.iter().map(of).sum()
}

/// A lamp gives what its radiance and view factor say, on the floor below it and beside it.
#[test]
fn a_square_lamp_gives_its_view_factor() {
    let Some(found) = lights(&floor_and_lamp(0.5, 0.6), 4096) else { return };
    for (x, z) in [(0.0, 0.0), (0.2, -0.1), (0.7, 0.4)] {
        let wanted = PI * view_factor(0.5, [-0.3 - x, 0.3 - x], [-0.3 - z, 0.3 - z]);
        let got = irradiance(&found, dvec3(x, 0.0, z));
        assert!((got / wanted - 1.0).abs() < 2e-3, "({x}, {z}): {got} for {wanted}");
    }
    // Emission of 1 W/(m² sr) over 0.36 m², on both sides: each light stands for the same area of one of them.
    assert!((flux(&found) / (2.0 * PI * 0.36) - 1.0).abs() < 1e-5, "{}", flux(&found));
    let (area, up) = (f64::from(found[0].area), found.iter().filter(|light| light.normal[1] > 0.0).count());
    assert!((area / (2.0 * 0.36 / 4096.0) - 1.0).abs() < 1e-5, "{area}");
    assert_eq!(up, 2048, "half of them upwards");
    assert!(found.iter().all(|light| (light.position[1] - 0.5).abs() < 1e-6));
}

/// Of a disc with the radius a at the height h, the point below its middle sees the share a² / (a² + h²).
#[test]
fn a_disc_gives_its_view_factor() {
    let mut scene = floor_and_lamp(0.5, 0.1);
    scene.materials[0].emission = Vec3::ZERO;
    let (radius, height, pieces) = (0.4_f64, 0.7_f64, 64);
    // Triangles about the middle, as large as the disc together.
    let step = 2.0 * PI / f64::from(pieces);
    let rim = radius * (step / step.sin()).sqrt();
    let first = scene.vertices.len() as u32 - 4;
    scene.vertices.truncate(first as usize);
    scene.indices.truncate(6);
    let vertex = |x: f64, z: f64| Vertex {
        position: [x as f32, height as f32, z as f32],
        material: 1,
        normal: [0.0, -1.0, 0.0],
        ..scene.vertices[0]
    };
    let ring: Vec<Vertex> = (0..pieces)
        .map(|i| (f64::from(i) * step).sin_cos())
        .map(|(sine, cosine)| vertex(rim * cosine, rim * sine))
        .collect();
    let middle = vertex(0.0, 0.0);
    scene.vertices.push(middle);
    scene.vertices.extend(ring);
    for i in 0..pieces as u32 {
        scene.indices.extend([first, first + 1 + i, first + 1 + (i + 1) % pieces as u32]);
    }
    scene.instances[0].vertex_count = scene.vertices.len() as u32;
    scene.instances[0].index_count = scene.indices.len() as u32;
    let Some(found) = lights(&scene, 4096) else { return };
    let wanted = PI * radius * radius / (radius * radius + height * height);
    let got = irradiance(&found, DVec3::ZERO);
    assert!((got / wanted - 1.0).abs() < 2e-3, "{got} for {wanted}");
}

/// Two lamps have lights by their power, and a texture dims what lies under it; so it does where it is one texel.
#[test]
fn lights_follow_power_and_texture() {
    let lamp =
        |x: f32, side: f32, material| quad([x, 0.0, 0.0], [side, 0.0, 0.0], [0.0, 0.0, side], material);
    let matte = |emission| pass_test::rooms::matte([0.0; 3], [emission; 3]);
    let mut scene = room(&[lamp(0.0, 1.0, 0), lamp(3.0, 2.0, 1)], vec![matte(3.0), matte(0.25)]);
    let Some(found) = lights(&scene, 4096) else { return };
    assert!((flux(&found) / (2.0 * PI * 4.0) - 1.0).abs() < 1e-4, "{}", flux(&found));
    let near = found.iter().filter(|light| light.position[0] < 2.0).count();
    assert!((3070..=3074).contains(&near), "{near} of 4096, three quarters of the power");

    // From black to white along u, which is x.
    let uvs = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    (0..4).for_each(|i| scene.vertices[i].uv = uvs[i]);
    let texture = |bytes: &[u8]| Texture {
        name: String::new(),
        width: bytes.len() as u32,
        height: 1,
        pixels: bytes.iter().flat_map(|byte| [*byte, *byte, *byte, 255]).collect(),
        encoding: Encoding::Srgb,
        wrap: [Wrap::Clamp; 2],
    };
    scene.materials[0].emission_texture = Some(0);
    let halves: Vec<u8> = (0..256).map(|i| if i < 128 { 0 } else { 255 }).collect();
    for (bytes, share) in [(&halves[..], 0.5), (&[188][..], 0.5), (&[0], 0.0)] {
        scene.textures = vec![texture(bytes)];
        let found = lights(&scene, 4096).expect("the adapter is still there");
        // 188 of 255 in sRGB is 0.5029.
        let wanted = 2.0 * PI * (3.0 * share + 1.0);
        assert!((flux(&found) / wanted - 1.0).abs() < 6e-3, "{} for {wanted}: {bytes:?}", flux(&found));
        // Textures are filtered: at the edges of its halves, one goes over into the other.
        let as_under_it = |light: &VirtualLight| match light.position[0] {
            x if (0.01..0.49).contains(&x) => light.flux[0] == 0.0,
            x if (0.51..0.99).contains(&x) => light.flux[0] > 0.0,
            _ => true,
        };
        assert!(bytes.len() == 1 || found.iter().all(as_under_it), "{} texels", bytes.len());
    }
}

/// Whatever emits and however much: finite, and dark where nothing does.
#[test]
fn extremes_are_finite() {
    let mut scene = floor_and_lamp(0.5, 0.6);
    for emission in [1e-38, 1e37, f32::MAX] {
        scene.materials[1].emission = Vec3::splat(emission);
        let Some(found) = lights(&scene, 100) else { return };
        assert!(found.iter().all(|light| light.flux[0].is_finite()), "{emission}");
        assert!(emission < 1e-37 || flux(&found) > 0.0, "{emission}");
    }
    scene.materials[1].emission = Vec3::ZERO;
    let dark = |scene: &Scene| {
        let found = lights(scene, 100).expect("the adapter is still there");
        assert_eq!(found.len(), 100);
        let is_dark =
            |light: &VirtualLight| light.flux == [0.0; 3] && light.area == 0.0 && light.normal != [0.0; 3];
        assert!(found.iter().all(is_dark), "{found:?}");
    };
    dark(&scene);
    // A lamp without area, alone.
    let mut scene = floor_and_lamp(0.5, 0.6);
    (4..8).for_each(|i| scene.vertices[i].position = [0.1, 0.5, 0.1]);
    dark(&scene);
    let mut empty = pass_test::scene("empty");
    empty.materials = scene.materials;
    dark(&empty);
}
