//! Lights of two frames: which are chosen, and with which weights.

use interfaces::reservoirs::Reservoir;
use pass::Format;
use pass_test::reservoirs::{SIDE, assert_unbiased, chosen_by, flat, lights, shares};
use pass_test::view::picture;
use pass_test::{Harness, elements, halves};
use reuse_in_time::PASS;

/// Where the pixels of the frame before were \[m\], on the other side of the plane's normal by a bend of it.
const BEFORE: [f32; 3] = [0.5, 0.0, -0.5];

/// The normal there.
const BENT: [f64; 3] = [0.6, 0.8, 0.0];

/// A frame whose pixels each chose by `own`, and those of the frame before, four times as sure, by `past`. All showed the surface
/// of the texel in their place, or of none if not `found`.
fn harness<'a>(own: &[Reservoir], past: &[Reservoir], found: bool) -> Harness<'a> {
    let size = (SIDE, SIDE);
    let place = |x: u32, y: u32| [x as f32 + 0.5, y as f32 + 0.5];
    let seen = |_, _| [BEFORE[0], BEFORE[1], BEFORE[2], 1.0];
    Harness::new(PASS)
        .middle_of_plane(flat)
        .reservoirs("reservoirs", 1, own)
        .input(
            "reprojection",
            "Reprojection",
            &[],
            vec![
                picture("place", Format::Rg32Float, size, place),
                picture("texels", Format::R32Uint, size, |_, _| u32::from(found)),
            ],
        )
        .past(
            "seen",
            "SeenSurfaces",
            1,
            vec![
                picture("position", Format::Rgba32Float, size, seen),
                picture("normal", Format::Rgba16Float, size, |_, _| halves([BENT[0], BENT[1], BENT[2], 0.0])),
            ],
        )
        .past_reservoirs("past", past)
}

fn reuse(harness: Harness<'_>) -> Option<Vec<Reservoir>> {
    Some(harness.run()?.read("reused"))
}

/// Reservoirs of this frame, of lights that are all alike; and of the frame before, of lights by what they gave there.
fn both() -> (Vec<Reservoir>, Vec<Reservoir>) {
    let lights = lights();
    let alike = vec![1.0 / lights.len() as f64; lights.len()];
    let there = shares(&lights, BEFORE.map(f64::from), BENT);
    (chosen_by(&lights, &alike, 7, 2.0), chosen_by(&lights, &there, 8, 8.0))
}

#[test]
fn every_variant_of_the_shaders_is_valid() {
    pass_test::assert_shaders_are_valid(PASS);
}

#[test]
fn lights_of_two_frames_have_unbiased_weights() {
    let (own, past) = both();
    for most in [0.5f32, 20.0] {
        let Some(found) = reuse(harness(&own, &past, true).set("most", most)) else { return };
        assert_unbiased(&found, lights().len() as u32);
        let count = 2.0 + (2.0 * most).min(8.0);
        assert!(found.iter().all(|reservoir| reservoir.count == count));
        let changed = found.iter().zip(&own).filter(|(a, b)| a.light.texel != b.light.texel).count();
        assert!(
            changed > found.len() / 8,
            "{changed} of {} lights are those of the frame before",
            found.len()
        );
    }
}

#[test]
fn nothing_is_reused_of_another_surface_or_of_light_that_moved() {
    let (own, past) = both();
    let still = |step: u32| elements(&[step, 0, 0, 0]);
    let moved = harness(&own, &past, true).input("still", "Progress", &[], still(0));
    for harness in [harness(&own, &past, false), moved.set("most_moved", 0.0f32)] {
        let Some(found) = reuse(harness) else { return };
        let off = found.iter().zip(&own).find(|(found, own)| {
            found.light != own.light
                || found.count != own.count
                || (found.weight / own.weight - 1.0).abs() > 1e-5
        });
        assert!(off.is_none(), "{off:?}");
    }
    let rests = harness(&own, &past, true).input("still", "Progress", &[], still(1));
    let Some(found) = reuse(rests) else { return };
    assert!(found.iter().zip(&own).any(|(found, own)| found.light != own.light));
}

/// A history buffer that has just been reset holds zeros.
#[test]
fn nothing_is_reused_after_a_reset() {
    let (own, past) = both();
    let cut = harness(&own, &past, true).event(1, pass_test::ResetCause::Cut);
    let Some(found) = reuse(cut) else { return };
    assert!(found.iter().zip(&own).all(|(found, own)| found.light == own.light && found.count == own.count));
    assert!(found.iter().all(|reservoir| reservoir.weight > 0.0));
}

/// What is not seen has no light, and a light that could not be chosen none of its weight.
#[test]
fn empty_reservoirs_stay_empty() {
    let (mut own, mut past) = both();
    for reservoir in own.iter_mut().chain(&mut past) {
        (reservoir.weight, reservoir.light.flux) = (0.0, [0.0; 3]);
    }
    let Some(found) = reuse(harness(&own, &past, true)) else { return };
    assert!(found.iter().all(|reservoir| reservoir.weight == 0.0 && reservoir.count == 10.0));
}
