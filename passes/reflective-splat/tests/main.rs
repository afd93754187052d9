//! Lights of the next bounce against closed forms.

use glam::{DVec3, Vec3, dvec3, uvec2};
use gpu_algorithms::reference::paraboloid::{direction_from_paraboloid, frame_from_normal, texel_centre};
use interfaces::virtual_lights::VirtualLight;
use pass_test::random::{radical_inverse, unit_float};
use pass_test::rooms::{floor_and_lamp, furnace, half_plane, matte, quad, room, view_factor};
use pass_test::{Harness, elements, light_at};
use reflective_splat::PASS;
use scene::{Encoding, Scene, Texture, Wrap};
use std::f64::consts::PI;

pass_test::shaders_are_valid!(PASS);

/// The module of points that lie in a buffer.
const STORED: &str = "shaders/points-stored.wgsl";

/// Splats of each map.
const SPLATS: u32 = 4000;

/// Returns points that are spread uniformly over the triangles of a scene, in no order.
fn points(scene: &Scene, count: u32) -> Vec<[u32; 8]> {
    let corners: Vec<[Vec3; 3]> = scene
        .indices
        .chunks_exact(3)
        .map(|triangle| [0, 1, 2].map(|i| Vec3::from(scene.vertices[triangle[i] as usize].position)))
        .collect();
    let across = |[a, b, c]: &[Vec3; 3]| (b - a).cross(c - a);
    let total: f32 = corners.iter().map(|triangle| across(triangle).length()).sum();
    let point = |i: u32| {
        let mut rest = unit_float(pass_test::random::hash(i)) as f32 * total;
        let area = |at: usize| across(&corners[at]).length();
        let mut at = 0;
        while at + 1 < corners.len() && rest > area(at) {
            rest -= area(at);
            at += 1;
        }
        let [u, v] = [2, 3].map(|base| radical_inverse(base, i + 1) as f32);
        let [a, b, c] = corners[at];
        let position = a + (b - a) * (1.0 - u.sqrt()) + (c - a) * v * u.sqrt();
        let normal = across(&corners[at]).normalize();
        let [x, y, z] = position.to_array().map(f32::to_bits);
        let [p, q, r] = normal.to_array().map(f32::to_bits);
        [x, y, z, at as u32, p, q, r, 0]
    };
    (0..count).map(point).collect()
}

/// Splats a scene for some lights; the harness of it.
fn splatted(scene: &Scene, lights: &[VirtualLight]) -> Harness<'static> {
    let points = points(scene, 4 * SPLATS);
    Harness::new(PASS)
        .with_scene(scene.clone())
        .set("points_per_map", SPLATS)
        .input("points", "Points", &[("count", points.len() as u32)], elements(&points))
        .module(STORED)
        .lights(lights)
}

/// Lights of the next bounce.
fn reflected(scene: &Scene, lights: &[VirtualLight], count: u32) -> Option<Vec<VirtualLight>> {
    Some(splatted(scene, lights).set("count", count).run()?.lights("reflected"))
}

fn flux(lights: &[VirtualLight], channel: usize) -> f64 {
    lights.iter().map(|light| f64::from(light.flux[channel])).sum()
}

/// Red flux of the lights that lie in a part of the scene, over that of all.
fn share(lights: &[VirtualLight], is_inside: impl Fn(DVec3) -> bool) -> f64 {
    let inside = lights.iter().filter(|light| is_inside(Vec3::from(light.position).as_dvec3()));
    inside.map(|light| f64::from(light.flux[0])).sum::<f64>() / flux(lights, 0)
}

fn light(position: DVec3, normal: DVec3, flux: [f32; 3]) -> VirtualLight {
    VirtualLight { flux, ..light_at(position, normal) }
}

/// In a closed room all light is reflected: three bounces keep ρ, ρ² and ρ³ of it, channel by channel, and every light lies on
/// a wall and shines into the room.
#[test]
fn a_closed_room_keeps_all_flux_but_what_it_absorbs() {
    let albedo = [0.2, 0.5, 0.8];
    let scene = furnace([0.0; 3], albedo);
    let mut lights = vec![
        light(dvec3(0.3, -1.0, 0.2), DVec3::Y, [1.0, 2.0, 3.0]),
        light(dvec3(-0.4, 0.5, 1.0), DVec3::NEG_Z, [2.0, 4.0, 6.0]),
    ];
    for bounce in 1..=3 {
        let before = [0, 1, 2].map(|c| flux(&lights, c));
        let Some(found) = reflected(&scene, &lights, 64) else { return };
        for c in 0..3 {
            let kept = flux(&found, c) / before[c];
            assert!((kept / albedo[c] - 1.0).abs() < 0.02, "bounce {bounce}, channel {c}: {kept}");
        }
        for light in &found {
            let [at, normal] = [light.position, light.normal].map(Vec3::from);
            assert!((at.abs().max_element() - 1.0).abs() < 1e-4, "{at} is on a wall");
            assert!(at.dot(normal) < -0.99, "{normal} points into the room from {at}");
        }
        // Sums of luminance: lights differ by their colours and by nothing else.
        let luminance = |light: &VirtualLight| {
            let [r, g, b] = light.flux.map(f64::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let all: Vec<f64> = found.iter().map(luminance).collect();
        assert!(all.iter().all(|one| (one / all[0] - 1.0).abs() < 1e-3), "{all:?}");
        lights = found;
    }
}

/// A light 1 m above a square of 2 m: what the square sees of it is a view factor, and the rest leaves the scene. Parts of the
/// square have their own.
#[test]
fn light_that_leaves_the_scene_is_not_reflected() {
    let mut scene = room(&[quad([-1.0, 0.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0], 0)], vec![]);
    scene.materials = vec![matte([0.25, 0.5, 0.75], [0.0; 3])];
    let Some(found) = reflected(&scene, &[light(DVec3::Y, DVec3::NEG_Y, [4.0; 3])], 4096) else { return };
    let whole = view_factor(1.0, [-1.0, 1.0], [-1.0, 1.0]);
    for (c, albedo) in [0.25, 0.5, 0.75].into_iter().enumerate() {
        let ratio = flux(&found, c) / (4.0 * albedo * whole);
        assert!((ratio - 1.0).abs() < 0.02, "channel {c}: {ratio} of the flux");
    }
    for (x, z) in [([-1.0, 0.0], [-1.0, 1.0]), ([-0.5, 0.5], [-0.5, 0.5]), ([0.6, 1.0], [0.2, 0.9])] {
        let inside = |at: DVec3| at.x > x[0] && at.x < x[1] && at.z > z[0] && at.z < z[1];
        let (got, wanted) = (share(&found, inside), view_factor(1.0, x, z) / whole);
        assert!((got - wanted).abs() < 0.015, "{got} for {wanted} in {x:?} × {z:?}");
    }
    // Areas of the lights of a map add up to what it sees, where their densities follow it.
    let area: f64 = found.iter().map(|light| f64::from(light.area)).sum();
    assert!((area / 4.0 - 1.0).abs() < 0.05, "{area} m² of 4");
}

/// Two lights at one place put twice the lights there, each of which stands for half the area.
#[test]
fn areas_are_those_of_the_lights_of_all_maps() {
    let scene = furnace([0.0; 3], [0.5; 3]);
    let one = light(dvec3(0.3, -1.0, 0.2), DVec3::Y, [1.0; 3]);
    let area = |lights: &[VirtualLight]| {
        let found = reflected(&scene, lights, 1024)?;
        Some(found.iter().map(|light| f64::from(light.area)).sum::<f64>())
    };
    let (Some(alone), Some(both)) = (area(&[one]), area(&[one; 2])) else { return };
    assert!((both / alone - 1.0).abs() < 0.05, "{both} m², {alone} m² of one");
}

/// From close to a wall, the wall is half of what a light sees.
#[test]
fn lights_in_corners_lose_nothing() {
    let scene = furnace([0.0; 3], [0.5; 3]);
    for off in [0.03, 0.003, 0.0003] {
        let in_corner = light(dvec3(-1.0 + off, -1.0, 0.2), DVec3::Y, [1.0; 3]);
        let Some(found) = reflected(&scene, &[in_corner], 256) else { return };
        assert!((flux(&found, 0) / 0.5 - 1.0).abs() < 0.01, "{} W of 0.5 at {off} m", flux(&found, 0));
        let on_wall = share(&found, |at| at.x < -0.9999);
        assert!((on_wall - 0.5).abs() < 0.03, "{on_wall} of it on the wall at {off} m");
    }
}

/// What is nearer hides what is behind it: a lamp's dark square between light and floor takes its view factor.
#[test]
fn the_nearest_surface_reflects() {
    let mut scene = floor_and_lamp(0.5, 0.6);
    scene.materials = vec![matte([0.5; 3], [0.0; 3]), matte([0.0; 3], [0.0; 3])];
    // Whole texels are hidden: fine ones.
    let harness = splatted(&scene, &[light(DVec3::Y, DVec3::NEG_Y, [1.0; 3])]).set("map", 256);
    let Some(found) = harness.set("count", 1024).run() else { return };
    let found = found.lights("reflected");
    let floor = view_factor(1.0, [-1.0, 1.0], [-1.0, 1.0]);
    let hidden = view_factor(0.5, [-0.3, 0.3], [-0.3, 0.3]);
    let ratio = flux(&found, 0) / (0.5 * (floor - hidden));
    assert!((ratio - 1.0).abs() < 0.02, "{ratio} of the flux");
    // The shadow of the square ends at ± 0.6 m.
    let in_shadow = |at: DVec3| at.x.abs() < 0.56 && at.z.abs() < 0.56;
    assert_eq!(share(&found, in_shadow), 0.0);
}

/// A beam from infinitely far brings its irradiance to what lies across it.
#[test]
fn lights_infinitely_far_bring_their_irradiance() {
    let mut scene = room(&[quad([-1.0, 0.0, -1.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.0], 0)], vec![]);
    scene.materials = vec![matte([0.5; 3], [0.0; 3])];
    let slanted = dvec3(0.6, -0.8, 0.0);
    for direction in [DVec3::NEG_Y, slanted] {
        let middle = -direction * 0.5 * 8f64.sqrt();
        let sun = VirtualLight { kind: 1, ..light(middle, direction, [3.0; 3]) };
        let Some(found) = splatted(&scene, &[sun]).set("map", 256).run() else { return };
        let found = found.lights("reflected");
        let ratio = flux(&found, 0) / (3.0 * 4.0 * 0.5 * -direction.y);
        assert!((ratio - 1.0).abs() < 0.02, "{ratio} of the flux from {direction}");
        for part in [|at: DVec3| at.x < 0.0, |at: DVec3| at.z < 0.0] {
            assert!((share(&found, part) - 0.5).abs() < 0.03, "from {direction}");
        }
        assert!(found.iter().all(|light| light.kind == 0 && light.normal[1] > 0.99), "{direction}");
    }
}

/// Colours are read where rays meet the surface, and what is cut out reflects nothing.
#[test]
fn textures_and_masks_are_those_of_the_surface() {
    let mut scene = half_plane();
    // Half of it is there, and a red and a blue quarter.
    let above = light(DVec3::Y, DVec3::NEG_Y, [1.0; 3]);
    let Some(found) = reflected(&scene, &[above], 1024) else { return };
    let right = |light: &VirtualLight| light.position[0] > -0.05;
    assert!(flux(&found, 0) > 0.0 && found.iter().all(right), "what is cut out has no lights");
    let whole = flux(&found, 0);

    scene.materials[0].alpha_cutoff = None;
    let Some(found) = reflected(&scene, &[above], 1024) else { return };
    assert!((flux(&found, 0) / whole - 2.0).abs() < 0.1, "{} and {whole}", flux(&found, 0));

    let pixels = (0..64).flat_map(|x| if x < 32 { [255, 0, 0, 255] } else { [0, 0, 255, 255] }).collect();
    let wrap = [Wrap::Clamp; 2];
    scene.textures =
        vec![Texture { name: "halves".into(), width: 64, height: 1, pixels, encoding: Encoding::Srgb, wrap }];
    let Some(found) = reflected(&scene, &[above], 1024) else { return };
    let [red, blue] = [0, 2].map(|c| flux(&found, c));
    assert!((red / blue - 1.0).abs() < 0.05, "{red} W of red, {blue} W of blue");
    // Textures are filtered where colours meet.
    let is_inside = |light: &&VirtualLight| (0.1..0.9).contains(&light.position[0].abs());
    let side = found.iter().find(is_inside).map(|light| (light.position[0] < 0.0) == (light.flux[0] > 0.0));
    for light in found.iter().filter(is_inside) {
        let [red, _, blue] = light.flux;
        assert!(red == 0.0 || blue == 0.0, "{light:?}");
        assert_eq!(Some((light.position[0] < 0.0) == (red > 0.0)), side, "{light:?}");
    }
}

/// Whatever the lights and the maps: finite, and dark where nothing arrives.
#[test]
fn extremes_are_finite() {
    let scene = furnace([0.0; 3], [0.5; 3]);
    let above = |flux: f32| light(dvec3(0.3, -1.0, 0.2), DVec3::Y, [flux; 3]);
    let run = |harness: Harness<'_>| {
        let found = harness.set("count", 16).run()?.lights("reflected");
        assert_eq!(found.len(), 16);
        let finite = |light: &VirtualLight| {
            light.flux.iter().chain(&light.position).chain(&light.normal).all(|x| x.is_finite())
                && light.area.is_finite()
                && Vec3::from(light.normal).length() > 0.9
        };
        assert!(found.iter().all(finite), "{found:?}");
        Some(flux(&found, 0))
    };
    for flux in [0.0, 1e-30, 1e30, f32::MAX] {
        let Some(found) = run(splatted(&scene, &[above(flux)])) else { return };
        assert_eq!(found > 0.0, flux > 0.0, "{found} of {flux}");
    }
    let dark = |harness| assert_eq!(run(harness).expect("the adapter is still there"), 0.0);
    dark(splatted(&scene, &[]));
    // A map of one texel looks along the normal, and has all of the flux.
    let one = run(splatted(&scene, &[above(1.0)]).set("map", 1)).expect("the adapter is still there");
    assert!((one - 0.5).abs() < 1e-3, "{one}");
    // Lights among which most are dark.
    let mut many = vec![above(0.0); 40];
    many[37] = above(1.0);
    let lit = run(splatted(&scene, &many)).expect("the adapter is still there");
    assert!((lit - 0.5).abs() < 0.01, "{lit}");
    dark(
        Harness::new(PASS)
            .input("points", "Points", &[("count", 0)], elements(&[0_u32; 8]))
            .module("shaders/points-on-the-fly.wgsl")
            .lights(&[above(1.0)]),
    );
}

#[test]
fn maps_that_no_buffer_holds_are_refused() {
    let scene = furnace([0.0; 3], [0.5; 3]);
    let many = vec![light_at(DVec3::ZERO, DVec3::Y); 2000];
    let refusal = splatted(&scene, &many).set("map", 256).refusal().expect("it is refused");
    assert!(refusal.contains("2000 maps of 256²") && refusal.contains("512"), "{refusal}");
}

#[test]
fn holes_are_filled_where_there_are_points_on_all_sides() {
    // Surfels that do not meet: holes everywhere.
    let scene = furnace([0.0; 3], [0.5; 3]);
    let lights = [light(dvec3(0.3, -1.0, 0.2), DVec3::Y, [PI as f32; 3])];
    let kept = |fill: u32| {
        let points = points(&scene, 4 * SPLATS);
        let found = Harness::new(PASS)
            .with_scene(scene.clone())
            .set("points_per_map", SPLATS / 4)
            .set("splat_scale", 0.4)
            .set("fill", fill)
            .set("count", 64)
            .input("points", "Points", &[("count", points.len() as u32)], elements(&points))
            .module(STORED)
            .lights(&lights)
            .run()?;
        Some(flux(&found.lights("reflected"), 0) / (0.5 * PI))
    };
    let (Some(open), Some(filled)) = (kept(0), kept(16)) else { return };
    assert!(open < 0.95, "{open} of the flux, with holes");
    assert!((filled - 1.0).abs() < 0.02, "{filled} of the flux");
}

/// A light says which texel of all maps saw it: the ray through it, from the light of its map, meets the light.
#[test]
fn lights_know_the_texels_that_saw_them() {
    let scene = furnace([0.0; 3], [0.5; 3]);
    let lights = [
        light(dvec3(0.3, -1.0, 0.2), DVec3::Y, [1.0; 3]),
        light(dvec3(-0.4, 0.5, 1.0), DVec3::NEG_Z, [1.0; 3]),
        light(dvec3(1.0, 0.2, -0.6), DVec3::NEG_X, [1.0; 3]),
    ];
    let tile = 32;
    let harness = splatted(&scene, &lights).set("map", tile).set("count", 256u32);
    let Some(outputs) = harness.run() else { return };
    let mut maps = [0; 3];
    for seen in outputs.lights("reflected") {
        let (map, texel) = (seen.texel / (tile * tile), seen.texel % (tile * tile));
        let from = Vec3::from(lights[map as usize].position).as_dvec3();
        let frame = frame_from_normal(Vec3::from(lights[map as usize].normal).as_dvec3());
        let ray = frame * direction_from_paraboloid(texel_centre(uvec2(texel % tile, texel / tile), tile));
        let way = Vec3::from(seen.position).as_dvec3() - from;
        assert!(way.normalize().abs_diff_eq(ray, 1e-3), "{way} of map {map} along {ray}");
        maps[map as usize] += 1;
    }
    assert!(maps.iter().all(|count| *count > 20), "{maps:?}");
}
