//! The pass on a GPU, on a floor and maps made here. With the maps that lights really see, it is a test of the whole
//! program: tests/direct.rs.

use super::cpu_reference::{Map, ggx};
use glam::{DMat3, DVec2, DVec3, Vec3, dvec3, uvec2, vec3};
use pass::{Format, ResourceDesc};
use pass_test::{Harness, halves, member};
use scene::{Light, LightKind, Scene};
use std::f64::consts::PI;

const WIDTH: u32 = 80;
const HEIGHT: u32 = 60;
const MAP: u32 = 64;

/// The square of the scene `plane` (y = 0, side 2, albedo ½) under another light.
fn square_under(light: LightKind, position: Vec3, direction: Vec3) -> Scene {
    let mut scene = pass_test::scene("plane");
    scene.lights = vec![Light { kind: light, position, direction, ..scene.lights[0].clone() }];
    scene
}

/// The distance along the camera's axis at which a pixel sees the square, and where.
fn floor(scene: &Scene, pixel: u32) -> Option<(f64, DVec3)> {
    let axes = scene.camera.view().inverse().as_dmat4();
    let tangent = f64::from(scene.camera.vertical_fov * 0.5).tan();
    let ndc_x = (f64::from(pixel % WIDTH) + 0.5) / f64::from(WIDTH) * 2.0 - 1.0;
    let ndc_y = 1.0 - (f64::from(pixel / WIDTH) + 0.5) / f64::from(HEIGHT) * 2.0;
    let aspect = f64::from(WIDTH) / f64::from(HEIGHT);
    let ray = axes.transform_vector3(dvec3(ndc_x * tangent * aspect, ndc_y * tangent, -1.0));
    let eye = scene.camera.position.as_dvec3();
    let depth = -eye.y / ray.y;
    let at = eye + ray * depth;
    (depth > 0.0 && at.x.abs() < 1.0 && at.z.abs() < 1.0).then_some((depth, at))
}

/// Direct light on the square. `distance` is what the maps hold; `specular` is reflectance and roughness.
fn light(scene: &Scene, distance: impl Fn(u32) -> f32, specular: Option<[f32; 4]>) -> Option<Vec<[f32; 4]>> {
    let pixels = WIDTH * HEIGHT;
    let depth: Vec<f32> =
        (0..pixels).map(|i| floor(scene, i).map_or(0.0, |(depth, _)| depth as f32)).collect();
    let texture = |format| ResourceDesc::texture_2d(format, (WIDTH, HEIGHT));
    let same = |name, texel: [f32; 4]| {
        let texels = vec![halves(texel.map(f64::from)); pixels as usize];
        member(name, texture(Format::Rgba16Float), &texels)
    };
    let mut view = vec![
        member("depth", texture(Format::R32Float), &depth),
        same("normal", [0.0, 1.0, 0.0, 0.0]),
        same("albedo", [0.5, 0.5, 0.5, 1.0]),
    ];
    view.extend(specular.map(|specular| same("specular", specular)));
    let layers = scene.lights[0].layers();
    let maps = ResourceDesc::texture_2d_array(Format::Rgba32Float, (MAP, MAP), layers);
    let position: Vec<[f32; 4]> = (0..MAP * MAP * layers).map(|i| [0.0, 0.0, 0.0, distance(i)]).collect();
    let outputs = Harness::new(direct_light::PASS)
        .with_scene(scene.clone())
        .frame(WIDTH, HEIGHT)
        .input("view", "GBuffer", &[], view)
        .input("rsm", "ReflectiveShadowMap", &[], vec![member("position", maps, &position)])
        .run()?;
    Some(outputs.read("direct"))
}

/// Asserts that every pixel that sees the square has the irradiance that `expected` gives for its place; `None` where
/// an edge is too near to say. Gives how many were lit.
fn compare(scene: &Scene, direct: &[[f32; 4]], expected: impl Fn(DVec3) -> Option<f64>) -> u32 {
    let mut lit = 0;
    for (i, found) in (0..).zip(direct) {
        let Some((_, at)) = floor(scene, i) else {
            assert_eq!(*found, [0.0; 4]);
            continue;
        };
        assert_eq!(found[3], 1.0);
        let Some(expected) = expected(at) else { continue };
        let radiance = 0.5 / PI * expected;
        let error = (f64::from(found[0]) - radiance).abs();
        assert!(error <= 2e-3 * radiance, "at {at}: {} for {radiance}", found[0]);
        lit += u32::from(expected > 0.0);
    }
    lit
}

/// Empty maps hide nothing; a map of something nearer than all else hides everything.
#[test]
fn each_kind_of_light_shines_on_a_floor() {
    let outer = 40f32.to_radians();
    let place = vec3(0.1, 1.0, -0.1);
    let sun = vec3(0.4, -1.0, 0.2).normalize();
    let cosine = |at: DVec3| (place.as_dvec3() - at).normalize().y;
    let point = |at: DVec3| cosine(at) / (place.as_dvec3() - at).length_squared();
    let cone = |at: DVec3| {
        let from_rim = cosine(at).acos() - f64::from(outer);
        (from_rim.abs() > 5e-3).then(|| if from_rim < 0.0 { point(at) } else { 0.0 })
    };
    let spot = square_under(LightKind::Spot { inner: outer, outer }, place, Vec3::NEG_Y);
    let bulb = square_under(LightKind::Point, place, Vec3::NEG_Y);
    let daylight = square_under(LightKind::Directional, Vec3::ZERO, sun);
    let irradiances: [&dyn Fn(DVec3) -> Option<f64>; 3] =
        [&cone, &|at| Some(point(at)), &|_| Some(f64::from(-sun.y))];
    for (scene, expected) in [spot, bulb, daylight].iter().zip(irradiances) {
        let Some(open) = light(scene, |_| 0.0, None) else { return };
        assert!(compare(scene, &open, expected) > 200, "{:?} lights the floor", scene.lights[0].kind);
        let Some(hidden) = light(scene, |_| -10.0, None) else { return };
        assert_eq!(compare(scene, &hidden, |_| Some(0.0)), 0);
    }
}

/// A disc half way below a spot: lit, dark and in between, as the CPU reference says.
#[test]
fn shadows_are_those_of_the_cpu_reference() {
    let outer = 40f32.to_radians();
    let scene = square_under(LightKind::Spot { inner: outer, outer }, Vec3::Y, Vec3::NEG_Y);
    let tangent = f64::from(outer.tan());
    let mut map = Map {
        size: MAP,
        half_extent: DVec2::splat(tangent),
        perspective: true,
        distances: vec![1.0; (MAP * MAP) as usize],
    };
    for i in 0..MAP * MAP {
        let at = map.on_image_plane(uvec2(i % MAP, i / MAP));
        if at.length() < 0.4 {
            map.distances[i as usize] = 0.5;
        } else if at.x.abs() > 0.37 && at.length() < 0.5 {
            map.distances[i as usize] = 0.0;
        }
    }
    let Some(direct) = light(&scene, |i| map.distances[i as usize] as f32, None) else { return };
    let (mut dark, mut between, mut open, mut wrong) = (0, 0, 0, 0);
    for (i, found) in (0..).zip(&direct) {
        let Some((_, at)) = floor(&scene, i).filter(|(_, at)| at.x.hypot(at.z) < tangent - 0.01) else {
            continue;
        };
        // The disc is the same however the layer's axes lie about the spot's.
        let share = map.visibility(dvec3(at.x, at.z, -1.0), DVec3::Z, 5, 0.25);
        let to_light = DVec3::Y - at;
        let expected = 0.5 / PI * share * to_light.normalize().y / to_light.length_squared();
        wrong += u32::from((f64::from(found[0]) - expected).abs() > 2e-3 * expected);
        *(if share == 0.0 {
            &mut dark
        } else if share < 1.0 {
            &mut between
        } else {
            &mut open
        }) += 1;
    }
    assert!(dark > 50 && between > 50 && open > 50, "{dark} dark, {between} between, {open} open");
    // A tap may fall to the next texel by rounding.
    assert!(wrong <= (dark + between + open) / 100, "{wrong} pixels differ");
}

/// A sheet above the floor that is nearer to it than the depth bias hides nothing. The bias grows with the slope of the
/// floor, and so with the distance from the place below the light.
#[test]
fn the_depth_bias_grows_with_the_slope() {
    let outer = 70f32.to_radians();
    let scene = square_under(LightKind::Spot { inner: outer, outer }, Vec3::Y, Vec3::NEG_Y);
    let (texel, bias) = (2.0 * f64::from(outer.tan()) / f64::from(MAP), 0.25);
    // Reached where the slope is ½.
    let gap = bias * texel * 1.5;
    let Some(direct) = light(&scene, |_| (1.0 - gap) as f32, None) else { return };
    let lit = compare(&scene, &direct, |at| {
        let (slope, to_light) = (at.x.hypot(at.z), DVec3::Y - at);
        let open = to_light.normalize().y / to_light.length_squared();
        ((slope - 0.5).abs() > 1e-3).then_some(if slope > 0.5 { open } else { 0.0 })
    });
    assert!(lit > 200, "{lit} pixels");
}

#[test]
fn the_glossy_part_is_that_of_the_cpu_reference() {
    let place = vec3(0.0, 1.0, 0.0);
    let scene = square_under(LightKind::Point, place, Vec3::NEG_Y);
    let (f0, roughness) = (0.6, 0.4);
    let Some(matte) = light(&scene, |_| 0.0, None) else { return };
    let Some(glossy) = light(&scene, |_| 0.0, Some([f0, f0, f0, roughness])) else { return };
    for (i, (glossy, matte)) in (0..).zip(glossy.iter().zip(&matte)) {
        let Some((_, at)) = floor(&scene, i) else { continue };
        let offset = place.as_dvec3() - at;
        let to_camera = (scene.camera.position.as_dvec3() - at).normalize();
        let to_light = offset.normalize();
        let reflected = ggx(DVec3::Y, to_light, to_camera, f64::from(f0), f64::from(roughness));
        let expected = reflected * to_light.y / offset.length_squared();
        let found = f64::from(glossy[0] - matte[0]);
        // Half floats hold f0 and roughness to 5e-4; the peak goes with the fourth power of the roughness.
        assert!((found / expected - 1.0).abs() < 1e-2, "at {at}: {found} for {expected}");
    }
}

/// The layer of a sun, as small as the box around the scene allows.
struct Sun {
    /// Right, up and towards the sun.
    axes: DMat3,
    /// The middle of the side that is nearest to the sun.
    origin: DVec3,
    half_extent: DVec2,
}

impl Sun {
    fn of(scene: &Scene) -> Sun {
        let direction = scene.lights[0].direction;
        let right = direction.any_orthonormal_vector();
        let axes =
            DMat3::from_cols(right.as_dvec3(), right.cross(direction).as_dvec3(), -direction.as_dvec3());
        let bounds = [scene.bounds().0, scene.bounds().1];
        let corners =
            (0..8).map(|i| vec3(bounds[i & 1].x, bounds[i >> 1 & 1].y, bounds[i >> 2].z).as_dvec3());
        let (low, high) = corners
            .map(|corner| axes.transpose() * corner)
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
        let margin = (high - low).max_element() * 1e-3;
        let middle = 0.5 * (low + high);
        Sun {
            axes,
            origin: axes * middle.truncate().extend(high.z + margin),
            half_extent: 0.5 * (high - low).truncate() + margin,
        }
    }
}

/// Where the sun is nearly in the plane of the floor, whose slope is bounded; where the map's texels are not square, so that the
/// longer side counts for the bias; and at the map's edge, whose texels count for what lies beyond.
#[test]
fn shadows_of_a_sun_are_those_of_the_cpu_reference() {
    let down = vec3(0.0, -1.0, 0.0);
    let flat = vec3(1.0, -0.02, 0.3).normalize();
    // A second square makes the box around the scene longer, or higher.
    for (direction, second) in
        [(down, [0.0; 3]), (down, [2.0, 0.0, 0.0]), (down, [0.0, 0.0, 2.0]), (flat, [0.0, 2.0, 0.0])]
    {
        let ([x, y, z], [dx, dy, dz]) = (second, direction.to_array());
        let mut scene = pass_test::scene_from(&format!(
            "Scene(
                geometry: Objects([
                    Object(name: \"floor\", geometry: BuiltIn(\"plane\")),
                    Object(name: \"second\", geometry: BuiltIn(\"plane\"), transform: Transform(translate: ({x:?}, {y:?}, {z:?}))),
                ]),
                lights: [Directional(name: \"sun\", direction: ({dx:?}, {dy:?}, {dz:?}), irradiance: (1.0, 1.0, 1.0))],
            )"
        ));
        scene.camera = pass_test::scene("plane").camera;
        let sun = Sun::of(&scene);
        let receiver = |at: DVec3| sun.axes.transpose() * (at - sun.origin);
        let normal = sun.axes.transpose() * DVec3::Y;
        let mut map =
            Map { size: MAP, half_extent: sun.half_extent, perspective: false, distances: Vec::new() };
        // In front of the floor by most of its bias; at one distance, where it is steep; and at the edge hidden.
        let gap = 0.75 * 0.25 * 2.0 * sun.half_extent.max_element() / f64::from(MAP);
        let middle = -receiver(DVec3::ZERO).z;
        map.distances = (0..MAP * MAP)
            .map(|i| {
                let (x, y) = (i % MAP, i / MAP);
                let edge = [x, y].iter().any(|at| *at == 0 || *at == MAP - 1);
                if edge { -10.0 } else { middle - gap }
            })
            .collect();
        let Some(direct) = light(&scene, |i| map.distances[i as usize] as f32, None) else { return };
        let (mut all, mut between, mut wrong) = (0, 0, 0);
        for (i, found) in (0..).zip(&direct) {
            let Some((_, at)) = floor(&scene, i) else { continue };
            let share = map.visibility(receiver(at), normal, 5, 0.25);
            let expected = 0.5 / PI * share * f64::from(-direction.y);
            all += 1;
            between += u32::from(share > 0.0 && share < 1.0);
            wrong += u32::from((f64::from(found[0]) - expected).abs() > 2e-3 * expected);
        }
        assert!(between > 50, "{between} of {all} pixels are lit in part");
        // A tap may fall to the next texel by rounding.
        assert!(wrong <= all / 100, "{direction}, {second:?}: {wrong} of {all} pixels differ");
    }
}
