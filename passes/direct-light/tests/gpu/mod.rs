//! The pass on a GPU with the maps that it is made for, against closed forms.

use glam::{DVec3, Vec3, dvec3, vec3};
use pass::{Format, ResourceDesc};
use pass_test::{Outputs, Stand};
use scene::{Light, LightKind, Scene, Vertex};
use std::f64::consts::PI;

const WIDTH: u32 = 80;
const HEIGHT: u32 = 60;

struct Folder;

impl scene::SceneFiles for Folder {
    fn read(&self, path: &str) -> Option<std::sync::Arc<frame_graph::Source>> {
        let text = std::fs::read_to_string(pass_test::root().join("scenes").join(path)).ok()?;
        Some(frame_graph::Source::new(path, text))
    }

    fn list(&self) -> Vec<String> {
        Vec::new()
    }
}

/// The square of the scene `plane` (side 2, albedo ½) under a light, with a small square (side ½) at `HALF_WAY` above
/// its middle.
fn screened_square(light: LightKind, position: Vec3, direction: Vec3) -> Scene {
    let mut scene = scene::load("plane", &Folder).unwrap_or_else(|error| panic!("{error}"));
    let first = scene.vertices.len() as u32;
    let corner = |x: f32, z: f32| Vertex {
        position: [0.25 * x, HALF_WAY as f32, 0.25 * z],
        normal: [0.0, 1.0, 0.0],
        ..scene.vertices[0]
    };
    let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    scene.vertices.extend(corners);
    scene.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
    scene.lights = vec![Light { kind: light, position, direction, ..scene.lights[0].clone() }];
    scene
}

const HALF_WAY: f64 = 0.4;

/// The bytes of a member with its description, to hand on.
fn member<'a>(outputs: &Outputs, port: &str, name: &'a str) -> (&'a str, ResourceDesc, Vec<u8>) {
    let resource = format!("{port}.{name}");
    (name, outputs.desc(&resource).clone(), outputs.read(&resource))
}

/// Depth and direct light of every pixel.
fn light(scene: &Scene, set: impl Fn(Stand<'static>) -> Stand<'static>) -> Option<(Vec<f32>, Vec<[f32; 4]>)> {
    let view = Stand::new(gbuffer::PASS).with_scene(scene.clone()).frame(WIDTH, HEIGHT).run()?;
    let rsm = Stand::new(reflective_shadow_map::PASS).with_scene(scene.clone()).run()?;
    let stand = Stand::new(direct_light::PASS).with_scene(scene.clone()).frame(WIDTH, HEIGHT);
    let view_members = ["depth", "normal", "albedo"].map(|name| member(&view, "view", name)).to_vec();
    let stand = stand.input("view", "GBuffer", &[], view_members);
    let rsm_members = ["position", "normal", "flux"].map(|name| member(&rsm, "rsm", name)).to_vec();
    let outputs = set(stand.input("rsm", "ReflectiveShadowMap", &[], rsm_members)).run()?;
    Some((view.read("view.depth"), outputs.read("direct")))
}

/// What a pixel sees.
fn position(scene: &Scene, pixel: usize, depth: f32) -> DVec3 {
    let axes = scene.camera.view().inverse().as_dmat4();
    let tangent = f64::from(scene.camera.vertical_fov * 0.5).tan();
    let (x, y) = (pixel as u32 % WIDTH, pixel as u32 / WIDTH);
    let ndc_x = (f64::from(x) + 0.5) / f64::from(WIDTH) * 2.0 - 1.0;
    let ndc_y = 1.0 - (f64::from(y) + 0.5) / f64::from(HEIGHT) * 2.0;
    let aspect = f64::from(WIDTH) / f64::from(HEIGHT);
    let ray = axes.transform_vector3(dvec3(ndc_x * tangent * aspect, ndc_y * tangent, -1.0));
    scene.camera.position.as_dvec3() + ray * f64::from(depth)
}

/// Compares every pixel of the large square with the irradiance that `expected` gives for its place; `None` where an
/// edge is too near to say.
fn compare(scene: &Scene, expected: impl Fn(DVec3) -> Option<f64>) {
    let Some((depth, direct)) = light(scene, |stand| stand) else { return };
    let (mut lit, mut dark) = (0, 0);
    for (i, (&depth, found)) in depth.iter().zip(&direct).enumerate() {
        if depth == 0.0 {
            assert_eq!(*found, [0.0; 4]);
            continue;
        }
        assert_eq!(found[3], 1.0);
        let at = position(scene, i, depth);
        let Some(expected) = (at.y.abs() < 1e-3).then(|| expected(at)).flatten() else { continue };
        let radiance = 0.5 / PI * expected;
        let error = (f64::from(found[0]) - radiance).abs();
        assert!(error <= 2e-3 * radiance, "at {at}: {} for {radiance}", found[0]);
        if expected > 0.0 { lit += 1 } else { dark += 1 }
    }
    assert!(lit > 200 && dark > 30, "{lit} pixels are lit and {dark} dark");
}

/// How far within the shadow of the small square a place is, in metres on the small square; negative outside.
fn depth_of_shadow(at: DVec3, to_light: DVec3) -> f64 {
    let on_screen = at + to_light * ((HALF_WAY - at.y) / to_light.y);
    0.25 - on_screen.x.abs().max(on_screen.z.abs())
}

/// Within this of a shadow's edge, in metres on the small square, filtering blurs it.
const RIM: f64 = 0.03;

#[test]
fn a_spot_lights_its_cone_but_for_the_shadow() {
    let outer = 40f32.to_radians();
    let place = vec3(0.1, 1.0, -0.1);
    let scene = screened_square(LightKind::Spot { inner: outer, outer }, place, Vec3::NEG_Y);
    compare(&scene, |at| {
        let offset = place.as_dvec3() - at;
        let cosine = offset.normalize().y;
        let from_rim = cosine.acos() - f64::from(outer);
        if from_rim.abs() < 5e-3 {
            return None;
        }
        let shadow = depth_of_shadow(at, offset);
        let unshadowed = if from_rim > 0.0 { 0.0 } else { cosine / offset.length_squared() };
        (shadow.abs() > RIM).then_some(if shadow > 0.0 { 0.0 } else { unshadowed })
    });
}

/// Low and from the side, so that the square is seen at a slant and over the edge of two faces.
#[test]
fn a_point_light_lights_all_but_the_shadow() {
    let place = vec3(0.9, 0.7, 0.3);
    let scene = screened_square(LightKind::Point, place, Vec3::NEG_Y);
    compare(&scene, |at| {
        let offset = place.as_dvec3() - at;
        let shadow = depth_of_shadow(at, offset);
        let unshadowed = offset.normalize().y / offset.length_squared();
        (shadow.abs() > RIM).then_some(if shadow > 0.0 { 0.0 } else { unshadowed })
    });
}

#[test]
fn the_sun_lights_all_but_the_shadow() {
    let direction = vec3(0.4, -1.0, 0.2).normalize();
    let scene = screened_square(LightKind::Directional, Vec3::ZERO, direction);
    compare(&scene, |at| {
        let to_light = -direction.as_dvec3();
        let shadow = depth_of_shadow(at, to_light);
        (shadow.abs() > RIM).then_some(if shadow > 0.0 { 0.0 } else { to_light.y })
    });
}

/// A sun at 5° above a floor: without the receiver's plane, the floor would shadow itself.
#[test]
fn grazing_light_leaves_no_specks() {
    let direction = vec3(1.0, -(5f32.to_radians().tan()), 0.3).normalize();
    let mut scene = screened_square(LightKind::Directional, Vec3::ZERO, direction);
    scene.indices.truncate(scene.indices.len() - 6);
    let Some((depth, direct)) = light(&scene, |stand| stand.set("bias", 0.1f32).set("pcf", 9u32)) else {
        return;
    };
    let expected = 0.5 / std::f32::consts::PI * -direction.y;
    for (depth, found) in depth.iter().zip(&direct).filter(|(depth, _)| **depth > 0.0) {
        assert!((found[0] / expected - 1.0).abs() < 5e-3, "{} for {expected} at depth {depth}", found[0]);
    }
}

#[test]
fn the_glossy_part_is_the_twins() {
    let place = vec3(0.0, 1.0, 0.0);
    let mut scene = screened_square(LightKind::Point, place, Vec3::NEG_Y);
    scene.indices.truncate(scene.indices.len() - 6);
    let (f0, roughness) = (0.6, 0.4);
    let pixels = (WIDTH * HEIGHT) as usize;
    let specular = half_bytes([f0, f0, f0, roughness], pixels);
    let Some((depth, matte)) = light(&scene, |stand| stand) else { return };
    let view = Stand::new(gbuffer::PASS).with_scene(scene.clone()).frame(WIDTH, HEIGHT).run();
    let rsm = Stand::new(reflective_shadow_map::PASS).with_scene(scene.clone()).run();
    let (Some(view), Some(rsm)) = (view, rsm) else { return };
    let mut members = ["depth", "normal", "albedo"].map(|name| member(&view, "view", name)).to_vec();
    members.push(("specular", ResourceDesc::texture_2d(Format::Rgba16Float, (WIDTH, HEIGHT)), specular));
    let outputs = Stand::new(direct_light::PASS)
        .with_scene(scene.clone())
        .frame(WIDTH, HEIGHT)
        .input("view", "GBuffer", &[], members)
        .input("rsm", "ReflectiveShadowMap", &[], vec![member(&rsm, "rsm", "position")])
        .run();
    let Some(outputs) = outputs else { return };
    let glossy: Vec<[f32; 4]> = outputs.read("direct");
    for i in (0..pixels).filter(|i| depth[*i] > 0.0) {
        let at = position(&scene, i, depth[i]);
        let offset = place.as_dvec3() - at;
        let to_camera = (scene.camera.position.as_dvec3() - at).normalize();
        let to_light = offset.normalize();
        let reflected = direct_light::twin::ggx(
            [0.0, 1.0, 0.0],
            to_light.to_array(),
            to_camera.to_array(),
            f64::from(f0),
            f64::from(roughness),
        );
        let expected = reflected * to_light.y / offset.length_squared();
        let found = f64::from(glossy[i][0] - matte[i][0]);
        // Half floats hold f0 and roughness to 5e-4; the peak goes with the fourth power of the roughness.
        assert!((found / expected - 1.0).abs() < 1e-2, "at {at}: {found} for {expected}");
    }
}

fn half_bytes(texel: [f32; 4], count: usize) -> Vec<u8> {
    texel.map(|x| half::f16::from_f32(x).to_le_bytes()).concat().repeat(count)
}
