//! Filtered lookups against the CPU reference, and against a bilinear lookup of four texels.

mod cpu_reference;

use cpu_reference::filtered;
use gpu_algorithms::reference::paraboloid::{paraboloid_from_direction, tile_position};
use interfaces::virtual_lights::VirtualLight;
use pass::{ResourceDesc, Value};
use pass_test::visibility::{Plane, Receiver, atlas, direction, lookups, map_of, receivers_around};

const MODULE: &str = "passes/percentage-closer-filtering/lookup.wgsl";
const BILINEAR: &str = "passes/percentage-closer-filtering/tests/bilinear.wgsl";
const TILE: u32 = 8;
const RECEIVERS: u32 = 500;

/// Two maps, of which every texel is open or closed by a hash of its place.
fn maps() -> Vec<f32> {
    (0..2 * TILE * TILE)
        .map(|i: u32| if i.wrapping_mul(0x9e37_79b9) >> 31 == 0 { 3.0e38 } else { 0.01 })
        .collect()
}

/// For each receiver what a module answers, in an atlas with one map a layer.
fn answers(
    module: &str,
    (tile, maps): (u32, &[f32]),
    (taps, depth_bias): (u32, f32),
    receivers: &[Receiver],
) -> Option<Vec<f32>> {
    let light = VirtualLight { normal: [0.0, 0.0, 1.0], flux: [1.0; 3], ..VirtualLight::default() };
    let facts = [("tile", tile), ("columns", 1), ("rows", 1), ("taps", taps)];
    let outputs = lookups(&[light; 2], receivers)
        .input("visibility", "Visibility", &facts, vec![atlas(tile, maps)])
        .fact("depth_bias", depth_bias)
        .fact("slope_bias", 0.0)
        .module(module)
        .run()?;
    Some(outputs.read("answers"))
}

#[test]
fn lookups_agree_with_the_cpu_reference() {
    let maps = maps();
    let wide: Vec<f64> = maps.iter().map(|distance| f64::from(*distance)).collect();
    let size = (TILE * TILE) as usize;
    for taps in [1, 2, 3, 7] {
        let Some(answers) = answers(MODULE, (TILE, &maps), (taps, 0.5), &receivers_around(RECEIVERS, 2))
        else {
            return;
        };
        let mut between = 0;
        for (i, got) in (0..).zip(answers) {
            let map = &wide[i as usize % 2 * size..][..size];
            let position = tile_position(paraboloid_from_direction(direction(i)), TILE).to_array();
            // At 2 m all that is closed is nearer and all that is open is not, whatever the bias.
            let wanted = filtered(map, TILE, position, 1.0, taps);
            assert!((f64::from(got) - wanted).abs() < 1e-5, "receiver {i}, {taps} taps: {got} for {wanted}");
            between += usize::from(got > 0.0 && got < 1.0);
        }
        assert!(between > 400, "{between} receivers are in penumbrae");
    }
}

#[test]
fn one_tap_is_bilinear_to_the_bit() {
    let by = |module| answers(module, (TILE, &maps()), (1, 0.5), &receivers_around(RECEIVERS, 2));
    let (Some(filtered), Some(bilinear)) = (by(MODULE), by(BILINEAR)) else { return };
    assert!(filtered.iter().zip(&bilinear).all(|(filtered, other)| filtered.to_bits() == other.to_bits()));
}

#[test]
fn a_window_over_an_open_map_sees_all_and_over_a_closed_one_nothing() {
    for taps in 1..=16 {
        for position in [[0.0, 0.0], [3.3, 7.9], [8.0, 4.5]] {
            let uniform = |distance| filtered(&[distance; 64], TILE, position, 1.0, taps);
            assert!((uniform(2.0) - 1.0).abs() < 1e-12 && uniform(0.5) == 0.0, "{taps} taps at {position:?}");
        }
    }
}

#[test]
fn it_filters_maps_and_nothing_else() {
    let outputs = |members: &[&str], facts: &[(&'static str, Value)]| {
        let desc = ResourceDesc::texture_2d(pass::Format::R32Float, (8, 8));
        let maps = pass_test::maps(members, &desc, facts, None);
        pass_test::outputs_of(percentage_closer_filtering::PASS, &[("taps", 3.into())], &[maps], &[])
    };
    let facts = [
        ("tile", Value::U32(8)),
        ("columns", Value::U32(1)),
        ("rows", Value::U32(1)),
        ("depth_bias", Value::F32(0.5)),
        ("slope_bias", Value::F32(0.25)),
    ];
    let made = outputs(&["atlas"], &facts).expect("an atlas with its facts");
    assert_eq!(made[0].facts.get("depth_bias"), Some(&Value::F32(1.0)), "the window is twice as wide");
    assert_eq!(made[0].facts.get("slope_bias"), Some(&Value::F32(0.5)));
    assert!(made[0].members.is_empty() && made[0].handed.len() == 1, "the atlas is handed on");
    let refused = outputs(&[], &facts).expect_err("rays have no maps");
    assert_eq!(refused.input.as_deref(), Some("maps"));
    let refused = outputs(&["atlas"], &facts[1..]).expect_err("no `tile`");
    assert!(refused.message.contains("`tile`"), "{}", refused.message);
}

/// The answers at receivers on a plane that fills the maps of a light, or behind it by a part of their distance.
fn answers_at(plane: Plane, module: &str, tile: u32, behind: f64) -> Option<Vec<f32>> {
    let distances = map_of(tile, |direction| plane.along(direction));
    let map: Vec<f32> = distances.into_iter().map(|distance| distance as f32).collect();
    let receiver = |i| {
        // What the plane does not meet lies behind the light, where nothing is tested.
        let distance = plane.along(direction(i)).unwrap_or(-1.0) * (1.0 + behind);
        Receiver { position: (direction(i) * distance).to_array(), normal: plane.normal.to_array(), light: 0 }
    };
    let receivers: Vec<Receiver> = (0..RECEIVERS).map(receiver).collect();
    answers(module, (tile, &map), (1, 0.02), &receivers)
}

/// Whatever its slope, a plane does not shadow itself with next to no bias, and hides what lies behind it by a tenth of
/// the distance: a bias for the slope would have to be as large as the slope's part of a texel, half of the distance in
/// maps of 8².
#[test]
fn a_plane_is_lit_and_hides_what_is_behind_it() {
    for module in ["shaders/visibility-atlas.wgsl", MODULE] {
        for (tile, degrees) in [(8, 0.0), (8, 30.0), (8, 55.0), (64, 0.0), (64, 30.0), (64, 55.0)] {
            let plane = Plane::tilted(degrees, 1.7);
            let answers = |behind| answers_at(plane, module, tile, behind);
            let (Some(on), Some(behind)) = (answers(0.0), answers(0.1)) else { return };
            let (mut lit, mut leaks, mut all) = (0, 0.0, 0);
            for ((on, behind), i) in on.iter().zip(&behind).zip(0..) {
                // Slopes up to 60°, away from the rim, where texels are not met by the plane.
                let met = plane.along(direction(i)).is_some_and(|distance| plane.height / distance > 0.5);
                if met && direction(i).z > 0.3 {
                    all += 1;
                    lit += usize::from(*on > 0.999);
                    leaks += behind;
                }
            }
            assert!(all > 60, "{all} receivers");
            assert_eq!(lit, all, "{module}, {tile}², {degrees}°: the plane shadows itself");
            // Some rays through centres meet the plane where it is farther than what lies behind it: the more, the wider
            // the texels.
            let (leaks, most) = (leaks / all as f32, if tile == 8 { 0.5 } else { 0.02 });
            assert!(leaks < most, "{module}, {tile}², {degrees}°: {leaks} of the light leaks");
        }
    }
}
