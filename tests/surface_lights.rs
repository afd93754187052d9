//! Lights that are made of points on surfaces: what they carry, and what a frame changes of them.

use crate::adapter::renderer;
use interfaces::virtual_lights::{self, VirtualLight};
use renderer::Renderer;
use std::collections::BTreeMap;
use std::ops::ControlFlow;

/// Runs a frame until it is done. Returns the lights.
pub(crate) fn lights(renderer: &mut Renderer) -> Vec<VirtualLight> {
    renderer.keep("lights").unwrap();
    renderer.frame_until_done(|_, _| ControlFlow::Continue(())).unwrap();
    let id = renderer.plan().unwrap().output("lights").unwrap().members[0].1;
    virtual_lights::from_bytes(&renderer.resource_bytes(id).unwrap()).expect("the lights are whole")
}

/// Green flux of the lights on surfaces of each direction, up to its sign \[W\].
pub(crate) fn fluxes(lights: &[VirtualLight]) -> BTreeMap<String, f64> {
    let mut sums = BTreeMap::new();
    for light in lights {
        let [x, y, z] = light.normal.map(f32::abs);
        *sums.entry(format!("{x:.1} {y:.1} {z:.1}")).or_insert(0.0) += f64::from(light.flux[1]);
    }
    sums
}

/// Whether a light of `cornell-box-lamp` lies where the camera sees nothing of it.
fn is_above_the_lamp(light: &VirtualLight) -> bool {
    let [x, y, z] = light.position;
    y > 0.5482 && (0.213..0.343).contains(&x) && (0.227..0.332).contains(&z)
}

/// Photons carry what the surfaces reflect of the light; so do the lights at the ends of paths from the camera, wherever the
/// camera sees all of them indirectly. Neither knows of the other.
#[test]
fn paths_from_the_camera_carry_the_flux_of_photons() {
    for (scene, seed) in
        [("cornell-box", 0), ("cornell-box", 5), ("cornell-box-lamp", 0), ("cornell-box-lamp", 5)]
    {
        let mut found = Vec::new();
        for pipeline in ["instant-radiosity", "metropolis-instant-radiosity"] {
            let values = ["lights=2048", "bounces=1", "map=4", "interleave_x=1", "interleave_y=1"];
            let rate = (pipeline != "instant-radiosity").then_some("lights.rate=16");
            let values: Vec<&str> = values.into_iter().chain(rate).collect();
            let Some(mut renderer) = renderer(pipeline, scene, (32, 32), &values) else { return };
            renderer.set_seed(seed);
            let mut lights = lights(&mut renderer);
            // Half of the lamp's light stays between it and the ceiling, half a millimetre above it.
            lights.retain(|light| !is_above_the_lamp(light));
            found.push(fluxes(&lights));
        }
        let [photons, paths] = &found[..] else { panic!("two of them") };
        for (direction, flux) in photons {
            // Surfaces that are hardly lit have too few lights.
            if *flux < 0.05 {
                continue;
            }
            let ratio = paths.get(direction).copied().unwrap_or(0.0) / flux;
            assert!((ratio - 1.0).abs() < 0.15, "{scene}, seed {seed}, {direction}: {ratio} times {flux} W");
        }
        let sum = |of: &BTreeMap<String, f64>| of.values().sum::<f64>();
        let ratio = sum(paths) / sum(photons);
        assert!((ratio - 1.0).abs() < 0.05, "{scene}, seed {seed}: {ratio} times the flux of photons");
    }
}

/// With three bounces, the picture of paths from the camera and that of photons have the energy of path tracing.
#[test]
fn three_bounces_have_the_energy_of_path_tracing() {
    for scene in ["cornell-box", "cornell-box-lamp"] {
        assert_energy_of_three_bounces(scene);
    }
}

fn assert_energy_of_three_bounces(scene: &str) {
    let picture = |pipeline: &str, values: &[&str]| {
        let mut renderer = renderer(pipeline, scene, (48, 48), values)?;
        renderer.frame_until_done(|_, _| ControlFlow::Continue(())).unwrap();
        Some(renderer.output("indirect").unwrap())
    };
    let Some(truth) = picture("reference", &["bounces=3", "samples=256"]) else { return };
    for pipeline in ["instant-radiosity", "metropolis-instant-radiosity"] {
        let values = ["lights=1024", "map=64", "interleave_x=1", "interleave_y=1", "clamp=0.01"];
        let rate = (pipeline != "instant-radiosity").then_some("lights.rate=16");
        let values: Vec<&str> = values.into_iter().chain(rate).collect();
        let image = picture(pipeline, &values).expect("the adapter is still there");
        let mean = |image: &metrics::Image| {
            image
                .pixels()
                .iter()
                .map(|pixel| f64::from(metrics::luminance([pixel[0], pixel[1], pixel[2]])))
                .sum::<f64>()
        };
        let energy = mean(&image) / mean(&truth);
        assert!((energy - 1.0).abs() < 0.06, "{pipeline}, {scene}: {energy}");
    }
}

/// Places whose light is another in the second of two frames.
fn moved(before: &[VirtualLight], after: &[VirtualLight]) -> usize {
    before.iter().zip(after).filter(|(a, b)| a.position != b.position || a.normal != b.normal).count()
}

#[test]
fn a_frame_replaces_no_more_lights_than_it_may() {
    for (most, scene) in [(16, "cornell-box"), (3, "cornell-box-glide"), (0, "cornell-box-glide")] {
        let count = format!("moved={most}");
        let values = ["lights=256", "map=4", "lights/replacement.warm_up=10", count.as_str()];
        let Some(mut renderer) = renderer("smc-ir-2016", scene, (32, 32), &values) else { return };
        let mut before = lights(&mut renderer);
        assert!(before.iter().all(|light| light.area > 0.0), "all places are taken");
        let mut all = 0;
        let camera = renderer.scene().camera;
        for frame in 0..6 {
            // Lights on the floor bring nothing to who sees the floor alone.
            if frame == 3 {
                let [position, target] =
                    [0.1, 0.0].map(|height| glam::vec3(0.45, height, 0.05 - 0.01 * height));
                renderer.set_camera(Some(scene::Camera { position, target, ..camera }), false);
            }
            let after = lights(&mut renderer);
            let moved = moved(&before, &after);
            assert!(moved <= most, "{moved} lights moved, of {most}");
            // A light that stays is as bright as before where neither lights nor surfaces move.
            if scene == "cornell-box" {
                let of = |lights: &[VirtualLight], i: usize| {
                    lights[i].flux.map(|flux| if lights[i].area > 0.0 { flux / lights[i].area } else { 0.0 })
                };
                for i in (0..256).filter(|i| before[*i].position == after[*i].position) {
                    let [a, b] = [of(&before, i), of(&after, i)];
                    assert!(
                        a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-5 * a.abs()),
                        "light {i}: {a:?}, {b:?}"
                    );
                }
            }
            all += moved;
            before = after;
        }
        assert!(most == 0 || all > 0, "no light moved in six frames");
    }
}

/// Without light or view everything stays finite, and the first lit frame has lights again.
#[test]
fn without_light_or_view_everything_is_finite() {
    for scene in ["empty", "cornell-box"] {
        let values = ["lights=64", "map=4", "lights/replacement.warm_up=5", "moved=64"];
        let Some(mut renderer) = renderer("smc-ir", scene, (16, 16), &values) else { return };
        let check = |lights: &[VirtualLight]| {
            let finite = |light: &VirtualLight| {
                light.flux.iter().chain([&light.area]).all(|x| x.is_finite() && *x >= 0.0)
            };
            assert!(lights.iter().all(finite), "{scene}");
        };
        check(&lights(&mut renderer));
        // From inside a wall, and away from everything.
        let camera = renderer.scene().camera;
        for position in [glam::Vec3::new(0.0, 0.3, 0.3), glam::Vec3::splat(1e4)] {
            renderer.set_camera(
                Some(scene::Camera { position, target: position + glam::Vec3::Z, ..camera }),
                false,
            );
            check(&lights(&mut renderer));
        }
        renderer.set_camera(None, true);
        for _ in 0..3 {
            check(&lights(&mut renderer));
        }
        if scene == "cornell-box" {
            assert!(lights(&mut renderer).iter().filter(|light| light.flux[0] > 0.0).count() > 10);
        }
    }
}
