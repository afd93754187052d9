//! Lookups in maps that are right, wrong and empty, where rays know better.

use interfaces::virtual_lights::VirtualLight;
use pass_test::visibility::{Receiver, atlas, direction, lookups, map_of};

const TILE: u32 = 32;
const BY_MAP: &str = "shaders/visibility-atlas.wgsl";
const SETTLED: &str = "passes/settle-by-rays/lookup.wgsl";

#[test]
fn every_variant_of_the_shaders_is_valid() {
    pass_test::assert_shaders_are_valid(settle_by_rays::PASS);
}

/// The least and the greatest answer of a module at receivers of a light whose map stores `stored` times their distance, one in
/// the black and the other in the white squares of a chessboard. The scene is a square in the plane y = 0, towards which the light looks
/// from y = `light` [m]; receivers are on it, or `behind` of the light's distance behind it.
fn answers(module: &str, light: f64, stored: [f64; 2], behind: f64) -> Option<(f32, f32)> {
    let towards = -light.signum();
    let given = VirtualLight {
        position: [0.0, light as f32, 0.0],
        normal: [0.0, towards as f32, 0.0],
        flux: [1.0; 3],
        ..VirtualLight::default()
    };
    let height = -light * behind;
    let depth = (height - light).abs();
    let places = (0..64).map(direction).filter(|direction| direction.z > 0.8);
    let receivers: Vec<Receiver> = places
        .map(|direction| {
            let across = direction * (depth / direction.z);
            let position = [across.x.clamp(-0.9, 0.9), height, across.y.clamp(-0.9, 0.9)];
            Receiver { position, normal: [0.0, -towards, 0.0], light: 0 }
        })
        .collect();
    assert!(receivers.len() > 5, "{} receivers", receivers.len());
    let map = map_of(TILE, |direction| Some(depth / direction.z));
    let colour = |texel: usize| (texel + texel / TILE as usize) % 2;
    let map: Vec<f32> =
        map.iter().enumerate().map(|(i, distance)| (distance * stored[colour(i)]).min(3e38) as f32).collect();
    let facts = [("tile", TILE), ("columns", 1), ("rows", 1)];
    let outputs = lookups(&[given], &receivers)
        .scene("plane")
        .input("visibility", "Visibility", &facts, vec![atlas(TILE, &map)])
        .fact("depth_bias", 0.3)
        .fact("slope_bias", 0.0)
        .fact("doubt", 3.0)
        .module(module)
        .run()?;
    let answers: Vec<f32> = outputs.read("answers");
    // Buffers end with whole vectors.
    let answers = answers.into_iter().take(receivers.len());
    Some(answers.fold((1.0, 0.0), |(least, most), answer| (answer.min(least), answer.max(most))))
}

#[test]
fn rays_decide_what_maps_cannot_tell() {
    // A texel is 0.125 m wide at 1 m.
    for (what, stored, behind, by_map, settled) in [
        ("the receiver's own surface", [1.0, 1.0], 0.0, (1.0, 1.0), (1.0, 1.0)),
        ("what is not there, less than three texels before it", [0.8, 0.8], 0.0, (0.0, 0.0), (1.0, 1.0)),
        ("what is not there, four texels before it", [0.5, 0.5], 0.0, (0.0, 0.0), (0.0, 0.0)),
        ("what is not there, and nothing beside it", [0.5, 1e38], 0.0, (0.0, 1.0), (1.0, 1.0)),
        ("what is in between, and nothing beside it", [0.5, 1e38], 1.0, (0.0, 1.0), (0.0, 0.0)),
        ("its own surface, and what is in between beside it", [0.5, 1.0], 1.0, (0.0, 1.0), (0.0, 0.0)),
        ("what is less than the bias before it", [0.99, 0.99], 0.01, (1.0, 1.0), (0.0, 0.0)),
        ("nothing, of what is in between", [1e38, 1e38], 1.0, (1.0, 1.0), (0.0, 0.0)),
        ("its own surface, of what is in between", [1.0, 1.0], 1.0, (1.0, 1.0), (1.0, 1.0)),
    ] {
        for light in [1.0, -1.0] {
            let Some(found) = answers(BY_MAP, light, stored, behind) else { return };
            assert_eq!(found, by_map, "the map stores {what}, light at {light}");
            let found = answers(SETTLED, light, stored, behind).expect("the adapter is still there");
            assert_eq!(found, settled, "settled, the map stores {what}, light at {light}");
        }
    }
}
