//! The shaders against the CPU reference, on a GPU.

use crate::cpu_reference::Cdf;
use crate::distribution::{SIZE, importance};
use interfaces::virtual_lights::VirtualLight;
use pass_test::random::{halton3, hash, hash2, unit_float};
use pass_test::{Harness, Outputs, RsmTexel};
use sample_inverse_transform::PASS;

/// Flux of a texel: 1 W in red, so that Φ is 1 / (N p) there, and some other in green.
fn flux(texel: u32) -> [f32; 3] {
    [1.0, unit_float(hash(texel)) as f32, 0.0]
}

/// Samples a reflective shadow map whose texel i lies at (i, 0, 0).
fn draw(map: &[f32], size: (u32, u32), settings: (u32, u32), seed: u32) -> Option<Outputs> {
    draw_sample(map, size, settings, seed, 0)
}

/// The same in a sample of a picture.
fn draw_sample(
    map: &[f32],
    size: (u32, u32),
    settings: (u32, u32),
    seed: u32,
    sample: u32,
) -> Option<Outputs> {
    let texel = |i: u32| {
        let [red, green, blue] = flux(i);
        RsmTexel {
            position: [i as f32, 0.0, 0.0, 1.0],
            normal: [0.0, 1.2, 1.6],
            flux: [red, green, blue, 0.0],
        }
    };
    let texels: Vec<RsmTexel> = (0..map.len() as u32).map(texel).collect();
    let harness = Harness::new(PASS).set("count", settings.0).set("dimensions", settings.1).seed(seed);
    let harness = harness.sample(sample);
    harness.rsm(size, &texels).importance_sums(size, map).run()
}

fn lights(outputs: &Outputs) -> Vec<VirtualLight> {
    outputs.lights("lights")
}

/// The lights of all samples of a picture are those of one sequence, and a place among the lights of a sample has other parts of it in each.
#[test]
fn samples_of_a_picture_are_one_sequence() {
    const COUNT: u32 = 48;
    const SAMPLES: u32 = 8;
    let texels = |count: u32, sample: u32| -> Option<Vec<u32>> {
        let outputs = draw_sample(&importance(1), SIZE, (count, 3), 7, sample)?;
        Some(lights(&outputs).iter().map(|light| light.texel).collect())
    };
    let Some(mut whole) = texels(COUNT * SAMPLES, 0) else { return };
    let of_samples: Vec<Vec<u32>> = (0..SAMPLES).map(|sample| texels(COUNT, sample).unwrap()).collect();
    assert_eq!(of_samples[0], whole[..COUNT as usize]);
    let second = &whole[COUNT as usize..2 * COUNT as usize];
    let turn =
        (0..COUNT as usize).find(|turn| [&second[*turn..], &second[..*turn]].concat() == of_samples[1]);
    assert!(turn.is_some_and(|turn| turn > 0), "{turn:?}");
    let mut together = of_samples.concat();
    together.sort_unstable();
    whole.sort_unstable();
    assert_eq!(together, whole);
}

#[test]
fn lights_are_those_of_the_cpu_reference() {
    const COUNT: u32 = 2000;
    let decades = |texels: u32, decades: f64| -> Vec<f32> {
        (0..texels).map(|i| 10.0_f64.powf(decades * (unit_float(hash2(i, 5)) - 0.5)) as f32).collect()
    };
    let maps = [
        (importance(1), SIZE),
        (importance(2), SIZE),
        (importance(6), SIZE),
        // Rows and columns of more than one chunk; the range of weights that f32 has.
        (decades(300 * 5 * 2, 4.0), (300, 5)),
        (decades(5 * 700 * 3, 60.0), (5, 700)),
    ];
    for (map, size) in maps {
        let total: f64 = map.iter().map(|f| f64::from(*f)).sum();
        let cdf = Cdf::new(&map, size);
        for (dimensions, seed) in [(3, 0), (2, 0), (3, 7), (2, 7)] {
            let Some(outputs) = draw(&map, size, (COUNT, dimensions), seed) else { return };
            let lights = lights(&outputs);
            assert_eq!(lights.len(), COUNT as usize);
            let numbers = |j: u32| halton3(j + 1, pass::pass_seed(seed, "sample-inverse-transform"));
            let mut elsewhere = 0;
            for (j, light) in (0..).zip(&lights) {
                let texel = cdf.draw(numbers(j), dimensions).expect("the map is not zero");
                elsewhere +=
                    u32::from(light.texel != (texel.layer * size.1 + texel.row) * size.0 + texel.column);
                // Φ = flux / (N p) at whatever texel it is. The sums in f32 are off by some 2^-24 of their totals,
                // which is the more of a weight the less of the total it is.
                let weight = f64::from(map[light.texel as usize]);
                let expected = total / (weight * f64::from(COUNT));
                let carried = f64::from(light.flux[0]);
                let tolerance = 1e-5 + 2e-7 * total / weight;
                assert!((carried / expected - 1.0).abs() < tolerance, "{carried} of {expected}");
                assert_eq!(light.position, [light.texel as f32, 0.0, 0.0]);
                assert!((light.normal[2] - 0.8).abs() < 1e-6 && light.area == 0.0);
            }
            // A number within rounding of an interval's edge may fall to either side.
            assert!(elsewhere <= 2, "{elsewhere} lights of {COUNT} are at another texel");
        }
    }
}

#[test]
fn lights_carry_the_flux_of_the_map() {
    const COUNT: u32 = 4096;
    for layers in [1, 2, 6] {
        let map = importance(layers);
        let total: f64 = map.iter().map(|f| f64::from(*f)).sum();
        let texels = || {
            (0..).zip(&map).filter(|(_, f)| **f > 0.0).map(|(i, f)| (f64::from(flux(i)[1]), f64::from(*f)))
        };
        let reflected: f64 = texels().map(|(flux, _)| flux).sum();
        let second_moment: f64 = texels().map(|(flux, f)| flux * flux * total / f).sum();
        let deviation = ((second_moment - reflected * reflected) / f64::from(COUNT)).sqrt();
        for (dimensions, seed) in [(3, 0), (2, 0), (3, 11), (2, 11)] {
            let Some(outputs) = draw(&map, SIZE, (COUNT, dimensions), seed) else { return };
            let carried: f64 = lights(&outputs).iter().map(|light| f64::from(light.flux[1])).sum();
            let error = (carried - reflected).abs();
            assert!(error < 5.0 * deviation, "{layers} layers, {dimensions} numbers: {error} of {deviation}");
        }
    }
}

#[test]
fn drawn_texels_follow_the_importance() {
    const COUNT: u32 = 100_000;
    let map = importance(6);
    let total: f64 = map.iter().map(|f| f64::from(*f)).sum();
    for dimensions in [3, 2] {
        let Some(outputs) = draw(&map, SIZE, (COUNT, dimensions), 1) else { return };
        let mut observed = vec![0_u32; map.len()];
        lights(&outputs).iter().for_each(|light| observed[light.texel as usize] += 1);
        let expected: Vec<f64> = map.iter().map(|f| f64::from(*f) / total * f64::from(COUNT)).collect();
        crate::distribution::assert_follows(&observed, &expected);
    }
}

#[test]
fn maps_of_nothing_of_one_texel_and_of_extremes() {
    let Some(outputs) = draw(&[0.0; 64], (8, 8), (10, 3), 0) else { return };
    assert!(lights(&outputs).is_empty());
    // Those beyond the count are dark and finite all the same.
    assert!(outputs.read::<f32>("lights")[4..124].iter().all(|x| x.is_finite()));

    let run = |map: &[f32], size, count| {
        draw(map, size, (count, 2), 3).map(|outputs| lights(&outputs)).unwrap_or_default()
    };
    let mut map = [0.0; 128];
    map[77] = 1.2e-38;
    let one = run(&map, (8, 8), 10);
    assert!(one.iter().all(|light| light.texel == 77 && (light.flux[0] - 0.1).abs() < 1e-6), "{one:?}");

    // NaN and negative weights count for nothing, infinity as the greatest number.
    (map[3], map[4], map[2], map[127]) = (f32::NAN, -5.0, 3e38, f32::INFINITY);
    let some = run(&map, (8, 8), 1000);
    assert_eq!(some.len(), 1000);
    assert!(some.iter().all(|light| [2, 127].contains(&light.texel) && light.flux[0].is_finite()));

    for weight in [f32::MAX, 1.0, f32::MIN_POSITIVE] {
        let even = run(&[weight; 6 * 64 * 64], (64, 64), 500);
        let expected = 6.0 * 64.0 * 64.0 / 500.0;
        assert!(even.iter().all(|light| (light.flux[0] / expected - 1.0).abs() < 1e-4), "of {weight}");
    }

    // One texel and one light; more lights than texels.
    assert_eq!(run(&[2.0], (1, 1), 1)[0].flux[0], 1.0);
    assert_eq!(run(&[2.0], (1, 1), 100)[99].texel, 0);
}
