//! The picture of lights: dots against their discs on a floor, colors against their scale.

use glam::{Vec3, vec3};
use interfaces::virtual_lights::VirtualLight;
use pass::{Format, ResourceDesc};
use pass_test::view::floor_seen;
use pass_test::{Harness, halves, member};
use show_lights::PASS;

const WIDTH: u32 = 80;
const HEIGHT: u32 = 60;
const DOT: f64 = 3.0;
const GREY: [u8; 4] = [51, 51, 51, 255];
const WHITE: [u8; 4] = [255, 255, 255, 255];
const BLACK: [u8; 4] = [0, 0, 0, 255];

pass_test::shaders_are_valid!(PASS);

fn light(position: Vec3, flux: f32) -> VirtualLight {
    VirtualLight { position: position.to_array(), flux: [flux; 3], ..VirtualLight::default() }
}

/// Shows lights over the floor; `irradiance` is that of each pixel.
fn show(lights: &[VirtualLight], irradiance: Option<&[f32]>) -> Option<Vec<[u8; 4]>> {
    let scene = pass_test::scene("plane");
    let depth: Vec<f32> = (0..WIDTH * HEIGHT)
        .map(|i| floor_seen(&scene, (WIDTH, HEIGHT), i).map_or(0.0, |(depth, _)| depth))
        .collect();
    let picture = |format| ResourceDesc::texture_2d(format, (WIDTH, HEIGHT));
    let view = vec![member("depth", picture(Format::R32Float), &depth)];
    let mut harness = Harness::new(PASS)
        .set("dot", DOT as f32)
        .set("middle", 2.0)
        .with_scene(scene)
        .frame(WIDTH, HEIGHT)
        .lights(lights)
        .input("view", "GBuffer", &[], view);
    if let Some(irradiance) = irradiance {
        let pixels: Vec<_> = irradiance.iter().map(|e| halves([*e, *e, *e, 1.0].map(f64::from))).collect();
        let members = vec![member("", picture(Format::Rgba16Float), &pixels)];
        harness = harness.input("irradiance", "Irradiance", &[], members);
    }
    Some(harness.run()?.read("display"))
}

#[test]
fn dots_are_discs_around_what_is_seen_of_lights() {
    let shown = [light(vec3(0.3, 0.0, 0.2), 1.0), light(vec3(-0.4, 0.0, -0.3), 0.0)];
    let scene = pass_test::scene("plane");
    let behind = scene.camera.position * 2.0;
    // Below the floor, behind the camera, beside the image, nowhere: no dots.
    let hidden = [vec3(0.0, -0.5, 0.0), behind, vec3(1e4, 0.0, 0.0), Vec3::NAN, Vec3::splat(f32::INFINITY)];
    let lights: Vec<_> = hidden.into_iter().map(|position| light(position, 1.0)).chain(shown).collect();
    let Some(found) = show(&lights, None) else { return };
    let pixel = 2.0 * f64::from(scene.camera.vertical_fov * 0.5).tan() / f64::from(HEIGHT);
    let mut dots = [0; 2];
    for (i, found) in (0..).zip(found) {
        let Some((depth, at)) = floor_seen(&scene, (WIDTH, HEIGHT), i) else {
            assert_eq!(found, BLACK, "pixel {i} sees nothing");
            continue;
        };
        let mut expected = GREY;
        let mut is_at_an_edge = false;
        for (k, (light, color)) in shown.iter().zip([WHITE, BLACK]).enumerate() {
            let away = Vec3::from(light.position).as_dvec3().distance(at) / (pixel * f64::from(depth));
            is_at_an_edge |= (away - DOT).abs() < 0.01;
            if away < DOT {
                expected = color;
                dots[k] += 1;
            }
        }
        assert!(is_at_an_edge || found == expected, "pixel {i} at {at}: {found:?}, not {expected:?}");
    }
    assert!(dots.iter().all(|&pixels| pixels > 10), "{dots:?} pixels are in a dot");
}

#[test]
fn colors_go_from_blue_over_green_to_red() {
    let scene = pass_test::scene("plane");
    let seen: Vec<_> =
        (0..WIDTH * HEIGHT).filter(|&i| floor_seen(&scene, (WIDTH, HEIGHT), i).is_some()).collect();
    for (irradiance, expected) in [(0.0, [0, 0, 1]), (2.0, [0, 1, 0]), (6e4, [1, 0, 0])] {
        let Some(found) = show(&[], Some(&vec![irradiance; (WIDTH * HEIGHT) as usize])) else { return };
        for &i in &seen {
            let [r, g, b, _] = found[i as usize];
            let most = r.max(g).max(b);
            let is_most = [r, g, b].map(|x| i32::from(x == most));
            assert_eq!(is_most, expected, "{irradiance} W/m² is shown as {:?}", found[i as usize]);
        }
    }
}
