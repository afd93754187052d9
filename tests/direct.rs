//! Direct light and its shadows with the maps that lights see, against closed forms.

use crate::adapter::{SMALL, renderer, shown};
use glam::{DVec3, Vec3, dvec3, vec3};
use scene::{Light, LightKind, Scene, Vertex};
use std::f64::consts::PI;

const WIDTH: u32 = 80;
const HEIGHT: u32 = 60;
/// Height of the small square above the floor \[m\].
const HALF_WAY: f64 = 0.4;
/// Half the side of the small square \[m\].
const HALF_SIDE: f64 = 0.25;
/// Settings, and within which distance of a shadow's edge, in metres on the small square, they blur it: by filtering, or not at all where
/// rays decide there, however coarse the map is.
const SHADOWS: [(&[&str], f64); 2] =
    [(&["direct.settle=false", "rsm.size=512"], 0.03), (&["direct.settle=true", "rsm.size=48"], 1e-3)];

/// Puts a light over `plane`: a floor at y = 0 of side 2 and albedo ½.
fn lit_by(kind: LightKind, position: Vec3, direction: Vec3) -> impl Fn(&mut Scene) {
    move |scene| scene.lights = vec![Light { kind, position, direction, ..scene.lights[0].clone() }]
}

/// With a small square above its middle.
fn screened(scene: &mut Scene) {
    let first = scene.vertices.len() as u32;
    let side = HALF_SIDE as f32;
    let corner =
        |x: f32, z: f32| Vertex { position: [x * side, HALF_WAY as f32, z * side], ..scene.vertices[0] };
    let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    scene.vertices.extend(corners);
    scene.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
}

/// The scene as changed, and the direct light of every pixel.
fn render(change: impl Fn(&mut Scene), values: &[&str]) -> Option<(Scene, Vec<[f32; 4]>)> {
    let values = [SMALL, &["supersampling=1"], values].concat();
    let mut renderer = renderer("ism-uniform", "plane", (WIDTH, HEIGHT), &values)?;
    let mut scene = renderer.scene().clone();
    change(&mut scene);
    renderer.set_scene(scene.clone()).unwrap();
    let direct = shown(&mut renderer, "direct");
    Some((scene, direct.pixels().to_vec()))
}

/// The surface in a pixel.
enum Seen {
    /// Nothing.
    Nothing,
    /// A place on the floor.
    Floor(DVec3),
    /// Something else, or an edge.
    Other,
}

fn seen(scene: &Scene, pixel: usize, screen: bool) -> Seen {
    let axes = scene.camera.view().inverse().as_dmat4();
    let tangent = f64::from(scene.camera.vertical_fov * 0.5).tan();
    let (x, y) = (pixel as u32 % WIDTH, pixel as u32 / WIDTH);
    let ndc_x = (f64::from(x) + 0.5) / f64::from(WIDTH) * 2.0 - 1.0;
    let ndc_y = 1.0 - (f64::from(y) + 0.5) / f64::from(HEIGHT) * 2.0;
    let aspect = f64::from(WIDTH) / f64::from(HEIGHT);
    let ray = axes.transform_vector3(dvec3(ndc_x * tangent * aspect, ndc_y * tangent, -1.0));
    let eye = scene.camera.position.as_dvec3();
    // How far within a square at some height the ray passes, and where; every ray of this camera goes down.
    let within = |height: f64, half_side: f64| {
        let at = eye + ray * ((height - eye.y) / ray.y);
        (half_side - at.x.abs().max(at.z.abs()), at)
    };
    assert!(ray.y < 0.0, "the camera looks down");
    let (on_screen, _) = within(HALF_WAY, HALF_SIDE);
    let (on_floor, at) = within(0.0, 1.0);
    const EDGE: f64 = 1e-3;
    if screen && on_screen > -EDGE {
        Seen::Other
    } else if on_floor > EDGE {
        Seen::Floor(at)
    } else if on_floor < -EDGE {
        Seen::Nothing
    } else {
        Seen::Other
    }
}

/// Compares every pixel of the floor with the irradiance that `unshadowed` gives for its place; `None` where an edge of the light is too
/// near to say. `to_light` is the way to the light from there.
fn compare(
    light: impl Fn(&mut Scene),
    to_light: impl Fn(DVec3) -> DVec3,
    unshadowed: impl Fn(DVec3) -> Option<f64>,
) {
    for (values, rim) in SHADOWS {
        compare_by(values, &light, |at| {
            let shadow = depth_of_shadow(at, to_light(at));
            let unshadowed = unshadowed(at)?;
            (shadow.abs() > rim).then_some(if shadow > 0.0 { 0.0 } else { unshadowed })
        });
    }
}

fn compare_by(values: &[&str], light: impl Fn(&mut Scene), expected: impl Fn(DVec3) -> Option<f64>) {
    let change = |scene: &mut Scene| {
        screened(scene);
        light(scene);
    };
    let Some((scene, direct)) = render(change, values) else { return };
    let (mut lit, mut dark) = (0, 0);
    for (i, found) in direct.iter().enumerate() {
        let at = match seen(&scene, i, true) {
            Seen::Nothing => {
                assert_eq!(*found, [0.0; 4]);
                continue;
            }
            Seen::Floor(at) => at,
            Seen::Other => continue,
        };
        assert_eq!(found[3], 1.0);
        let Some(expected) = expected(at) else { continue };
        let radiance = 0.5 / PI * expected;
        let error = (f64::from(found[0]) - radiance).abs();
        assert!(error <= 2e-3 * radiance, "at {at}: {} for {radiance}", found[0]);
        if expected > 0.0 { lit += 1 } else { dark += 1 }
    }
    assert!(lit > 200 && dark > 30, "{lit} pixels are lit and {dark} dark");
}

/// Returns the depth of a place in the shadow of the small square, in metres on the small square; negative outside.
fn depth_of_shadow(at: DVec3, to_light: DVec3) -> f64 {
    let on_screen = at + to_light * ((HALF_WAY - at.y) / to_light.y);
    HALF_SIDE - on_screen.x.abs().max(on_screen.z.abs())
}

#[test]
fn a_spot_lights_its_cone_but_for_the_shadow() {
    let outer = 40f32.to_radians();
    let place = vec3(0.1, 1.0, -0.1);
    let to_light = |at| place.as_dvec3() - at;
    compare(lit_by(LightKind::Spot { inner: outer, outer }, place, Vec3::NEG_Y), to_light, |at| {
        let cosine = to_light(at).normalize().y;
        let from_rim = cosine.acos() - f64::from(outer);
        let inside = if from_rim > 0.0 { 0.0 } else { cosine / to_light(at).length_squared() };
        (from_rim.abs() > 5e-3).then_some(inside)
    });
}

/// Low and from the side, so that the floor is seen at a slant and over the edge of two faces.
#[test]
fn a_point_light_lights_all_but_the_shadow() {
    let place = vec3(0.9, 0.7, 0.3);
    let to_light = |at| place.as_dvec3() - at;
    compare(lit_by(LightKind::Point, place, Vec3::NEG_Y), to_light, |at| {
        Some(to_light(at).normalize().y / to_light(at).length_squared())
    });
}

#[test]
fn the_sun_lights_all_but_the_shadow() {
    let direction = vec3(0.4, -1.0, 0.2).normalize();
    let to_light = -direction.as_dvec3();
    compare(lit_by(LightKind::Directional, Vec3::ZERO, direction), |_| to_light, |_| Some(to_light.y));
}

/// A sun at 5° above the floor: without the receiver's plane, the floor would shadow itself.
#[test]
fn grazing_light_leaves_no_specks() {
    let direction = vec3(1.0, -(5f32.to_radians().tan()), 0.3).normalize();
    let light = lit_by(LightKind::Directional, Vec3::ZERO, direction);
    let Some((scene, direct)) =
        render(light, &["direct.settle=false", "rsm.size=512", "direct.bias=0.1", "direct.pcf=9"])
    else {
        return;
    };
    let expected = 0.5 / std::f32::consts::PI * -direction.y;
    let mut pixels = 0;
    for (i, found) in direct.iter().enumerate() {
        if let Seen::Floor(at) = seen(&scene, i, false) {
            assert!((found[0] / expected - 1.0).abs() < 5e-3, "{} for {expected} at {at}", found[0]);
            pixels += 1;
        }
    }
    assert!(pixels > 200, "{pixels} pixels see the floor");
}

/// Shadow tests take the plane of the surface: by the bent normal, the map's texels around would shade it.
#[test]
fn a_normal_map_casts_no_shadow() {
    let (bent, normal) = pass_test::rooms::bent_plane(30.0);
    let direction = vec3(-0.6, -0.8, 0.0);
    let light = lit_by(LightKind::Directional, Vec3::ZERO, direction);
    let change = |scene: &mut Scene| {
        (scene.textures, scene.materials) = (bent.textures.clone(), bent.materials.clone());
        light(scene);
    };
    let Some((scene, direct)) = render(change, &["direct.settle=false", "rsm.size=512"]) else { return };
    let expected = 0.5 / PI * normal.dot(-direction.as_dvec3());
    let mut pixels = 0;
    for (i, found) in direct.iter().enumerate() {
        if let Seen::Floor(at) = seen(&scene, i, false) {
            assert!(
                (f64::from(found[0]) / expected - 1.0).abs() < 5e-3,
                "{} for {expected} at {at}",
                found[0]
            );
            pixels += 1;
        }
    }
    assert!(pixels > 200, "{pixels} pixels see the floor");
}
