//! Lights of pixels around each: which are chosen, and with which weights.

use interfaces::reservoirs::Reservoir;
use pass_test::Harness;
use pass_test::reservoirs::{SIDE, assert_unbiased, chosen_by, flat, lights, reservoir, shares};
use reuse_in_space::PASS;

fn reuse(harness: Harness<'_>) -> Option<Vec<Reservoir>> {
    Some(harness.run()?.read("reused"))
}

/// Reservoirs of pixels that have chosen by two distributions, as in a chessboard: all lights alike, and by what they give; the
/// latter three times as sure.
fn mixed() -> Vec<Reservoir> {
    let lights = lights();
    let alike = vec![1.0 / lights.len() as f64; lights.len()];
    let by_light = shares(&lights, [0.0; 3], [0.0, 1.0, 0.0]);
    let (even, odd) = (chosen_by(&lights, &alike, 3, 4.0), chosen_by(&lights, &by_light, 4, 12.0));
    let is_odd = |i: u32| (i % SIDE + i / SIDE) % 2 == 1;
    (0..SIDE * SIDE).map(|i| if is_odd(i) { odd[i as usize] } else { even[i as usize] }).collect()
}

#[test]
fn every_variant_of_the_shaders_is_valid() {
    pass_test::assert_shaders_are_valid(PASS);
}

#[test]
fn lights_of_many_pixels_have_unbiased_weights() {
    let own = mixed();
    for weights in ["pairwise", "balance", "constant"] {
        let harness = Harness::new(PASS).middle_of_plane(flat).reservoirs("reservoirs", 1, &own);
        let Some(found) = reuse(harness.set("weights", weights).set("neighbours", 3)) else { return };
        for parity in 0..2 {
            let is_of = |i: &u32| (i % SIDE + i / SIDE) % 2 == parity;
            let of_parity: Vec<Reservoir> =
                (0..SIDE * SIDE).filter(is_of).map(|i| found[i as usize]).collect();
            assert_unbiased(&of_parity, lights().len() as u32);
        }
        let changed = found.iter().zip(&own).filter(|(a, b)| a.light != b.light).count();
        assert!(changed > found.len() / 3, "{weights}: {changed} lights are those of other pixels");
        let counts = found.iter().map(|reservoir| reservoir.count);
        assert!(counts.clone().all(|count| count % 4.0 == 0.0) && counts.fold(0.0, f32::max) > 12.0);
    }
}

/// Where pixels differ in what lights give them, so do the distributions by which they choose.
#[test]
fn weights_are_unbiased_where_pixels_differ() {
    let lights = lights();
    // Every other column is inclined the other way, by less than what makes another surface.
    let see = |x: u32, _: u32| {
        let tilt = if x.is_multiple_of(2) { [0.3f32, 0.954, 0.0] } else { [-0.1, 0.995, 0.0] };
        (1.0, tilt)
    };
    let by = |normal| shares(&lights, [0.0; 3], normal);
    let own: [Vec<Reservoir>; 2] = [
        chosen_by(&lights, &by([0.3, 0.954, 0.0]), 5, 4.0),
        chosen_by(&lights, &by([-0.1, 0.995, 0.0]), 6, 4.0),
    ];
    let own: Vec<Reservoir> = (0..(SIDE * SIDE) as usize).map(|i| own[i % 2][i]).collect();
    for weights in ["pairwise", "balance"] {
        let harness = Harness::new(PASS).middle_of_plane(see).reservoirs("reservoirs", 1, &own);
        let Some(found) = reuse(harness.set("weights", weights)) else { return };
        assert_unbiased(&found, lights.len() as u32);
    }
}

#[test]
fn lights_of_other_surfaces_are_not_taken() {
    let lights = lights();
    let left = |i: u32| i % SIDE < SIDE / 2;
    let see = |x: u32, _: u32| (if left(x) { 1.0 } else { 1.5 }, [0.0, 1.0, 0.0]);
    let own: Vec<Reservoir> =
        (0..SIDE * SIDE).map(|i| reservoir(lights[usize::from(left(i))], 1.0, 1.0)).collect();
    let harness = Harness::new(PASS).middle_of_plane(see).reservoirs("reservoirs", 1, &own);
    let Some(found) = reuse(harness.set("neighbours", 8).set("radius", 0.2f32)) else { return };
    assert!(found.iter().zip(&own).all(|(found, own)| found.light == own.light));
    assert!(found.iter().all(|reservoir| (reservoir.weight - 1.0).abs() < 1e-4 && reservoir.count >= 1.0));
    assert!(found.iter().any(|reservoir| reservoir.count > 4.0));
}

#[test]
fn without_neighbours_nothing_changes() {
    let own = mixed();
    let harness = Harness::new(PASS).middle_of_plane(flat).reservoirs("reservoirs", 1, &own);
    let Some(found) = reuse(harness.set("neighbours", 0)) else { return };
    assert_eq!(found, own);
}
