//! Choices of shaders/light-tree.wgsl against the probabilities that it gives.

use crate::cpu_reference::geometry;
use crate::lights;
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, dvec3};
use interfaces::light_tree::NO_LIGHT;
use interfaces::virtual_lights::VirtualLight;
use pass::FromWgsl;
use pass_test::{Harness, elements};

/// Chooses a light at each receiver by each of a row of random numbers.
const CHOICES: FromWgsl = FromWgsl::new("choices", "passes/gather-light-tree/tests");

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Choice {
    index: u32,
    probability: f32,
}

/// Returns what `count` numbers choose at each receiver, of a position and a normal.
fn choices(lights: &[VirtualLight], receivers: &[(DVec3, DVec3)], count: u32) -> Option<Vec<Vec<Choice>>> {
    let padded = |v: DVec3| v.as_vec3().extend(0.0).to_array();
    let given: Vec<[f32; 4]> =
        receivers.iter().flat_map(|(at, normal)| [padded(*at), padded(*normal)]).collect();
    let receivers = ("count", receivers.len() as u32);
    let harness = Harness::new(&CHOICES).light_tree(lights).set("count", count);
    let outputs = harness.input("receivers", "Buffer", &[receivers], elements(&given)).run()?;
    Some(outputs.read::<Choice>("choices").chunks(count as usize).map(<[Choice]>::to_vec).collect())
}

#[test]
fn lights_are_chosen_as_often_as_their_probability_says() {
    let count = 1 << 15;
    let receivers = [
        (dvec3(0.0, 0.0, 0.0), DVec3::Y),
        (dvec3(1.9, 1.0, -0.3), DVec3::NEG_X),
        (dvec3(0.5, 0.7, 1.0), dvec3(0.6, -0.8, 0.0)),
        (dvec3(30.0, 20.0, -10.0), dvec3(-0.8, -0.6, 0.0)),
    ];
    // Of a perfect tree, of one with empty leaves, and of one whose root is below the first node.
    for number in [1, 5, 64, 300] {
        let lights = lights(number);
        let Some(all) = choices(&lights, &receivers, count) else { return };
        for ((at, normal), chosen) in receivers.iter().zip(all) {
            let mut probabilities = vec![0.0; lights.len()];
            let mut counts = vec![0u32; lights.len()];
            for choice in chosen.iter().filter(|choice| choice.index != NO_LIGHT) {
                let light = choice.index as usize;
                assert!(choice.probability > 0.0 && choice.probability <= 1.000_001, "{choice:?}");
                assert!(
                    counts[light] == 0 || probabilities[light] == f64::from(choice.probability),
                    "light {light} has one probability"
                );
                probabilities[light] = f64::from(choice.probability);
                counts[light] += 1;
            }
            // Lights that were never chosen have little of the sum, and so has what ends where no light shines.
            let sum: f64 = probabilities.iter().sum();
            let lost = chosen.iter().filter(|choice| choice.index == NO_LIGHT).count();
            let lost = lost as f64 / f64::from(count);
            assert!((sum + lost - 1.0).abs() < 0.02, "{number} lights: {sum}, and {lost} without a light");
            let mut expected: Vec<f64> = probabilities.iter().map(|p| p * f64::from(count)).collect();
            expected.push((1.0 - sum) * f64::from(count));
            counts.push(count - counts.iter().sum::<u32>());
            if expected.iter().filter(|n| **n >= 5.0).count() > 1 {
                pass_test::statistics::assert_follows(&counts, &expected);
            }
            // The mean of the geometry term over its probability is the sum over all lights: none is lost.
            let terms: Vec<f32> = chosen
                .iter()
                .map(|choice| match choice.index {
                    NO_LIGHT => 0.0,
                    index => {
                        let light = &lights[index as usize];
                        light.flux[0] * (geometry(light, *at, *normal, 0.0).0 as f32) / choice.probability
                    }
                })
                .collect();
            let (mean, deviation) = pass_test::statistics::spread(terms.into_iter());
            let exact: f64 =
                lights.iter().map(|l| f64::from(l.flux[0]) * geometry(l, *at, *normal, 0.0).0).sum();
            assert!(
                (mean - exact).abs() <= 5.0 * deviation + 1e-4 * exact,
                "{number} lights at {at}: {mean} ± {deviation} for {exact}"
            );
        }
    }
}

#[test]
fn the_lesser_of_two_lights_is_chosen_by_its_share() {
    let light = |x: f32, flux: f32| VirtualLight {
        position: [x, 1.0, 0.0],
        normal: [0.0, -1.0, 0.0],
        flux: [flux; 3],
        ..VirtualLight::default()
    };
    let lights = [light(-0.5, 1.0), light(0.5, 1e-3), light(0.5, 1e-3), light(0.5, 1e-3)];
    let Some(all) = choices(&lights, &[(DVec3::ZERO, DVec3::Y)], 1 << 17) else { return };
    let share = |index: u32| all[0].iter().filter(|choice| choice.index == index).count();
    for index in 1..4 {
        // 131 are expected: within five standard deviations.
        let times = share(index);
        assert!((times as f64 - 131.0).abs() < 58.0, "light {index}: {times} times");
    }
}

#[test]
fn a_light_that_faces_a_point_behind_its_node_is_chosen() {
    // The point is behind the mean plane of the first two lights, and the farther of them is tilted towards it.
    let light = |x: f32, y: f32, normal: [f32; 3]| VirtualLight {
        position: [x, y, 0.0],
        normal,
        flux: [1.0; 3],
        ..VirtualLight::default()
    };
    let (sin, cos) = 20f32.to_radians().sin_cos();
    let lights = [
        light(-1.0, 0.0, [sin, -cos, 0.0]),
        light(1.0, 0.0, [-sin, -cos, 0.0]),
        light(-2.0, 3.0, [0.0, -1.0, 0.0]),
        light(-2.0, 3.1, [0.0, -1.0, 0.0]),
    ];
    let (at, normal) = (dvec3(0.9, 0.5, 0.0), DVec3::NEG_X);
    assert!(geometry(&lights[0], at, normal, 0.0).0 > 0.0, "it gives light to the point");
    let Some(all) = choices(&lights, &[(at, normal)], 4096) else { return };
    assert!(all[0].iter().any(|choice| choice.index == 0));
}
