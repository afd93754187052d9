//! Lookups in two atlases, against those in each alone.

use interfaces::virtual_lights::VirtualLight;
use pass_test::visibility::{Receiver, atlas, lookups};

const MIXED: &str = "passes/mix-visibility/lookup.wgsl";
const ALONE: &str = "shaders/visibility-atlas.wgsl";
const LIGHTS: u32 = 9;
const RECEIVERS: u32 = 600;
const TILE: u32 = 8;
const EXACT_TILE: u32 = 16;
/// The lights with maps of the other kind, by their places there.
const EXACT: [u32; 3] = [7, 0, 4];

#[test]
fn every_variant_of_the_shaders_is_valid() {
    pass_test::assert_shaders_are_valid(mix_visibility::PASS);
}

/// Lights that look along z, each at a place of its own.
fn lights() -> Vec<VirtualLight> {
    let light = |i: u32| VirtualLight {
        position: [0.1 * i as f32, -0.05 * i as f32, 0.0],
        normal: [0.0, 0.0, 1.0],
        flux: [1.0; 3],
        ..VirtualLight::default()
    };
    (0..LIGHTS).map(light).collect()
}

/// Maps of which every texel is open or closed by a hash of its place.
fn maps(count: u32, tile: u32, key: u32) -> Vec<f32> {
    let is_open = |i: u32| (i ^ key).wrapping_mul(0x9e37_79b9) >> 31 == 0;
    (0..count * tile * tile).map(|i| if is_open(i) { 3.0e38 } else { 0.01 }).collect()
}

/// A receiver for each number, of the light that `of` names.
fn receivers(of: impl Fn(u32) -> u32) -> Vec<Receiver> {
    let receiver = |i: u32| {
        let [u, v] = [0.618_03, 0.414_21].map(|step: f64| 2.0 * (f64::from(i) * step).fract() - 1.0);
        Receiver { position: [u, v, 0.7], normal: [0.0, 0.0, -1.0], light: of(i) }
    };
    (0..RECEIVERS).map(receiver).collect()
}

/// The answers of an atlas alone.
fn alone(lights: &[VirtualLight], tile: u32, maps: &[f32], of: impl Fn(u32) -> u32) -> Option<Vec<f32>> {
    let facts = [("tile", tile), ("columns", 1), ("rows", 1)];
    let outputs = lookups(lights, &receivers(of))
        .input("visibility", "Visibility", &facts, vec![atlas(tile, maps)])
        .fact("depth_bias", 0.02)
        .fact("slope_bias", 0.0)
        .module(ALONE)
        .run()?;
    Some(outputs.read("answers"))
}

#[test]
fn a_light_is_looked_up_in_its_exact_map_where_it_has_one() {
    let (imperfect, exact) = (maps(LIGHTS, TILE, 1), maps(EXACT.len() as u32, EXACT_TILE, 2));
    let light_of = |i: u32| i % LIGHTS;
    let place_of = |light: u32| EXACT.iter().position(|exact| *exact == light).map(|place| place as u32);
    let places: Vec<u32> = (0..LIGHTS).map(|light| place_of(light).unwrap_or(u32::MAX)).collect();
    let places: Vec<u8> = bytemuck::cast_slice(&places).to_vec();
    let (_, exact_atlas, exact_bytes) = atlas(EXACT_TILE, &exact);
    let members = vec![
        atlas(TILE, &imperfect),
        ("exact", exact_atlas, exact_bytes),
        ("exact_places", pass_test::buffer(places.len() as u64), places),
    ];
    let facts = [("tile", TILE), ("columns", 1), ("rows", 1)];
    let outputs = lookups(&lights(), &receivers(light_of))
        .input("visibility", "Visibility", &facts, members)
        .fact("exact_tile", EXACT_TILE)
        .fact("exact_columns", 1u32)
        .fact("exact_rows", 1u32)
        .fact("depth_bias", 0.02)
        .fact("slope_bias", 0.0)
        .fact("exact_depth_bias", 0.02)
        .fact("exact_slope_bias", 0.0)
        .module(MIXED)
        .run();
    let Some(outputs) = outputs else { return };
    let mixed: Vec<f32> = outputs.read("answers");
    let by_imperfect = alone(&lights(), TILE, &imperfect, light_of).expect("the adapter is still there");
    let few: Vec<VirtualLight> = EXACT.iter().map(|light| lights()[*light as usize]).collect();
    let by_exact = alone(&few, EXACT_TILE, &exact, |i| place_of(light_of(i)).unwrap_or(0))
        .expect("the adapter is still there");
    let mut differ = 0;
    for i in 0..RECEIVERS as usize {
        let is_exact = place_of(light_of(i as u32)).is_some();
        let expected = if is_exact { by_exact[i] } else { by_imperfect[i] };
        assert_eq!(mixed[i], expected, "receiver {i}");
        differ += u32::from(is_exact && by_exact[i] != by_imperfect[i]);
    }
    assert!(differ > 50, "the two kinds of maps differ for {differ} receivers alone");
}
