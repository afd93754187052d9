//! Maps that go on filling where a light stays.

use interfaces::stands::Stand;
use interfaces::virtual_lights::VirtualLight;
use pass_test::{Harness, elements, light_at};

use super::{STORED, grid, on_the_floor, stored};
use glam::DVec3;

const TILE: u32 = 32;

/// A light 1 m above the scene `plane` that looks down.
fn above() -> VirtualLight {
    light_at(DVec3::Y, DVec3::NEG_Y)
}

/// The pass with a point a frame of those of a grid over the scene `plane`, each in the place of the whole plane.
fn harness<'a>(lights: &[VirtualLight]) -> Harness<'a> {
    let points = stored(&grid());
    Harness::new(splat::PASS)
        .scene("plane")
        .set("map", TILE)
        .set("candidates", 1)
        .set("points_per_map", 1)
        .set("keep", true)
        .input("points", "Points", &[("count", points.len() as u32)], elements(&points))
        .module(STORED)
        .lights(lights)
}

/// The first disc reaches beyond the plane; it goes when triangles have taken its place.
#[test]
fn maps_of_lights_that_stay_become_exact() {
    let after = |frames: u32| {
        let harness = harness(&[above()]).feedback("past", "kept").feedback("rendered", "stands");
        let outputs = harness.frames(frames).run()?;
        let stands: Vec<Stand> = outputs.read("stands");
        assert_eq!((stands[0].is_rendered, stands[0].frames), (1, frames));
        Some(outputs.read::<u32>("depth").into_iter().map(|bits| f64::from(f32::from_bits(bits))))
    };
    let (Some(first), Some(last)) = (after(1), after(8)) else { return };
    let side = |texel: usize| on_the_floor(texel).abs().max_element();
    assert!(first.enumerate().any(|(i, depth)| depth.is_finite() && side(i) > 1.1), "the disc is cut");
    let mut covered = 0;
    for (i, depth) in last.enumerate() {
        let at = on_the_floor(i);
        // Behind the light there is no floor.
        if at.y.abs() < 1e-9 && side(i) < 0.999 {
            let wanted = at.distance(DVec3::Y);
            assert!((depth - wanted).abs() < 1e-5 * wanted, "texel {i} at {at}: {depth} for {wanted}");
            covered += 1;
        } else {
            assert!(depth.is_infinite() || side(i) < 1.001, "texel {i} at {at} has {depth}");
        }
    }
    assert!(covered > 150, "{covered} texels see the plane");
}

/// Runs a frame after one whose maps had these bits in each texel, where the lights stood so.
fn after(lights: &[VirtualLight], frames: u32, bits: u32, stands: &[Stand]) -> Option<Vec<u32>> {
    let maps = vec![bits; lights.len() * (TILE * TILE) as usize];
    let outputs = harness(lights)
        .set("frames", frames)
        .past("past", "FillingMaps", 1, elements(&maps))
        .past("rendered", "Stands", 1, elements(stands))
        .fact("count", lights.len() as u32)
        .run()?;
    Some(outputs.read("depth"))
}

fn stand(light: &VirtualLight, frames: u32) -> Stand {
    Stand { position: light.position, is_rendered: 1, normal: light.normal, frames }
}

#[test]
fn maps_of_lights_that_moved_begin_anew() {
    let lights = [above(), VirtualLight { position: [0.1, 0.9, 0.0], ..above() }];
    // Nothing is nearer than this.
    let bits = 0.0625f32.to_bits();
    let Some(depth) = after(&lights, 64, bits, &[stand(&lights[0], 5), stand(&lights[0], 5)]) else { return };
    let (stays, moved) = depth.split_at((TILE * TILE) as usize);
    assert!(stays.iter().all(|texel| *texel == bits), "the map of a light that stays is kept");
    assert!(moved.iter().all(|texel| f32::from_bits(*texel) > 0.5), "that of another begins anew");
    assert!(moved.iter().any(|texel| f32::from_bits(*texel).is_finite()), "and is filled");
    // A light that was dark.
    let Some(lit) = after(&lights[..1], 64, bits, &[Stand::default()]) else { return };
    assert!(lit.iter().all(|texel| f32::from_bits(*texel) > 0.5));
}

/// A ray a frame, somewhere in the map: over frames its hits cover what the light sees.
#[test]
fn rays_of_other_frames_go_elsewhere() {
    let after = |frames: u32, traced: bool| {
        let harness =
            harness(&[above()]).set("traced", traced).set("texels_per_ray", 8).set("splat_scale", 0.1);
        let outputs = harness.feedback("past", "kept").feedback("rendered", "stands").frames(frames).run()?;
        Some(
            outputs.read::<u32>("depth").into_iter().filter(|bits| f32::from_bits(*bits).is_finite()).count(),
        )
    };
    let (Some(points), Some(one), Some(many)) = (after(8, false), after(1, true), after(8, true)) else {
        return;
    };
    assert!(
        many > points + 3 * one,
        "{points} texels by points, {one} after a frame of rays, {many} after eight"
    );
}

#[test]
fn keep_without_its_links_is_refused() {
    let Some(said) = harness(&[above()]).set("keep", true).refusal() else { return };
    assert!(said.contains("the links `past` and `rendered`"), "{said}");
}

#[test]
fn discs_are_taken_out_in_time() {
    let light = above();
    let nearest = 0.0625f32.to_bits();
    // Of a disc, the binary logarithm of the frames after which it goes; frames before, the most frames; and whether it stays.
    for (kind, before, most, stays) in [
        (0, 63, 64, true),
        (2, 2, 64, true),
        (2, 3, 64, false),
        (4, 14, 64, true),
        (4, 15, 64, false),
        (15, 63, 64, true),
        // A map that is done is left alone.
        (2, 3, 3, true),
    ] {
        let kept = nearest + if kind > 0 { 0x8000 | kind << 11 } else { 0 };
        let Some(depth) = after(&[light], most, kept, &[stand(&light, before)]) else { return };
        let kept = depth.iter().filter(|texel| **texel == nearest).count();
        let all = (TILE * TILE) as usize;
        assert_eq!(kept, if stays { all } else { 0 }, "kind {kind}, {before} frames of {most}");
    }
}
