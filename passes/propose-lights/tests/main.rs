//! The lights that pixels choose: by which probabilities, and with which weights.

use interfaces::reservoirs::Reservoir;
use interfaces::virtual_lights::VirtualLight;
use pass_test::Harness;
use pass_test::reservoirs::{SIDE, TARGET, assert_unbiased, counts, flat, lights, shares};
use pass_test::statistics::assert_follows;
use propose_lights::PASS;
use std::collections::BTreeSet;

fn harness<'a>(lights: &[VirtualLight], candidates: u32) -> Harness<'a> {
    let (bound, least, doubt) = TARGET;
    let set = [("bound", bound), ("least", least), ("doubt", doubt)];
    let harness = Harness::new(PASS).middle_of_plane(flat).set("candidates", candidates).lights(lights);
    set.into_iter().fold(harness, |harness, (name, value)| harness.set(name, value))
}

fn choose(harness: Harness<'_>) -> Option<Vec<Reservoir>> {
    Some(harness.run()?.read("reservoirs"))
}

#[test]
fn every_variant_of_the_shaders_is_valid() {
    pass_test::assert_shaders_are_valid(PASS);
}

/// The pass with a way in which it chooses candidates.
fn proposing<'a>(by: &str, lights: &[VirtualLight], candidates: u32) -> Harness<'a> {
    let harness = harness(lights, candidates);
    match by {
        "tree" => harness.light_tree(lights).set("descend", true),
        "leaves" => harness.light_tree(lights).set("proposal", "uniform"),
        by => harness.set("proposal", by),
    }
}

/// Also that of a light below the plane, which another pixel might need.
#[test]
fn weights_are_unbiased_for_any_number_of_candidates() {
    let mut lights = lights();
    let texel = lights.len() as u32;
    lights.push(VirtualLight {
        position: [0.1, -0.4, 0.2],
        normal: [0.0, 1.0, 0.0],
        texel,
        flux: [20.0; 3],
        ..lights[0]
    });
    for (by, candidates) in [
        ("power", 1),
        ("power", 3),
        ("uniform", 2),
        ("uniform", 16),
        ("leaves", 5),
        ("tree", 1),
        ("tree", 3),
        ("tree", 16),
    ] {
        let Some(found) = choose(proposing(by, &lights, candidates)) else { return };
        assert!(found.iter().all(|reservoir| reservoir.count == candidates as f32));
        assert_unbiased(&found, lights.len() as u32);
    }
}

#[test]
fn many_candidates_follow_the_target() {
    let lights = lights();
    let shares = shares(&lights, [0.0; 3], [0.0, 1.0, 0.0]);
    let expected: Vec<f64> = shares.iter().map(|share| share * f64::from(SIDE * SIDE)).collect();
    for by in ["power", "leaves", "tree"] {
        let Some(found) = choose(proposing(by, &lights, 512)) else { return };
        assert_follows(&counts(&found, lights.len()), &expected);
    }
}

/// A guess moves choices to the lights that seem to be seen, and no sum. Where it takes long, candidates are divided among dispatches.
#[test]
fn a_guess_decides_how_often_a_light_is_chosen_and_not_its_weight() {
    let lights = lights();
    let guessed = harness(&lights, 16)
        .input("visibility", "Visibility", &[], Vec::new())
        .module("passes/propose-lights/tests/half-hidden.wgsl")
        // A dispatch takes four candidates.
        .fact("iterations", 8_000u32);
    let (Some(plain), Some(guessed)) = (choose(harness(&lights, 16)), choose(guessed)) else { return };
    assert_unbiased(&guessed, lights.len() as u32);
    let hidden = |found: &[Reservoir]| counts(found, lights.len()).iter().step_by(2).sum::<u32>();
    assert!(3 * hidden(&guessed) < 2 * hidden(&plain), "{} and {}", hidden(&guessed), hidden(&plain));
    let wrong = guessed.iter().find(|r| r.guess != if r.light.texel % 2 == 1 { 1.0 } else { TARGET.2 });
    assert!(wrong.is_none(), "{wrong:?}");
}

/// Lights that give all pixels the same.
fn alike(count: u32) -> Vec<VirtualLight> {
    (0..count).map(|texel| VirtualLight { texel, ..lights()[0] }).collect()
}

/// The number of lights among those that were chosen.
fn different<'a>(chosen: impl Iterator<Item = &'a Reservoir>) -> usize {
    chosen.map(|reservoir| reservoir.light.texel).collect::<BTreeSet<_>>().len()
}

/// Reservoirs of a pixel choose in parts of the sum: of lights that give the same, each once. The sum over them stays without bias.
#[test]
fn reservoirs_of_a_pixel_share_the_lights() {
    let Some(found) = choose(harness(&alike(6), 12).set("per_pixel", 6)) else { return };
    assert!(found.chunks(6).all(|pixel| different(pixel.iter()) == 6));
    let lights = lights();
    let Some(found) = choose(harness(&lights, 2).set("per_pixel", 3)) else { return };
    assert_eq!(found.len() as u32, 3 * SIDE * SIDE);
    assert_unbiased(&found, lights.len() as u32);
    assert!(found.chunks(3).any(|pixel| pixel[0].light.texel != pixel[1].light.texel));
}

/// The samples of a picture choose at numbers of one sequence, whose first 2^k elements lie one in each of 2^k parts; pixels choose
/// at different ones.
#[test]
fn samples_of_a_picture_share_the_lights() {
    let lights = alike(16);
    let sample = |number| choose(proposing("leaves", &lights, 16).sample(number));
    let Some(samples) = (0..16).map(sample).collect::<Option<Vec<_>>>() else { return };
    for pixel in 0..samples[0].len() {
        assert_eq!(different(samples.iter().map(|sample| &sample[pixel])), 16, "pixel {pixel}");
    }
    assert!(different(samples[0].iter()) > 8);
}

#[test]
fn without_light_nothing_is_chosen() {
    let mut dark = lights();
    dark.iter_mut().for_each(|light| light.flux = [0.0; 3]);
    let one = &lights()[..1];
    for by in ["power", "uniform", "leaves", "tree"] {
        for (lights, weight) in [(&dark[..], 0.0), (&[], 0.0), (one, 1.0)] {
            let Some(found) = choose(proposing(by, lights, 4)) else { return };
            let off = found.iter().find(|r| (r.weight - weight).abs() > 1e-5 || r.count != 4.0);
            assert!(off.is_none(), "{by}: {off:?}");
        }
    }
}

#[test]
fn what_is_not_a_number_is_never_chosen() {
    let mut lights = lights();
    lights[1].flux = [f32::NAN; 3];
    let Some(found) = choose(harness(&lights, 8)) else { return };
    assert!(found.iter().all(|r| r.weight.is_finite() && r.light.texel != 1));
}
