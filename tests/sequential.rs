//! Sequential Monte Carlo instant radiosity at its edges: numbers of lights, views that change at once, geometry that moves.

use crate::adapter::{mean, renderer};
use crate::surface_lights::lights;
use renderer::Renderer;

const PIPELINES: [&str; 2] = ["smc-ir", "smc-ir-2016"];

/// Searches for neighbours by trees. What they find is the same; among two thousand points all pairs take a processor ten times as
/// long.
fn by_trees(pipeline: &str) -> &'static [&'static str] {
    const BY_TREES: [&str; 3] = [
        "lights/sample_density.structure=tree",
        "lights/vpls/sources.structure=tree",
        "lights/vpls/sources_before.structure=tree",
    ];
    if pipeline == "smc-ir" { &BY_TREES } else { &BY_TREES[..1] }
}

/// The mean indirect luminance of the next frame.
fn brightness(renderer: &mut Renderer) -> f64 {
    renderer.frame().unwrap();
    let [r, g, b] = mean(&renderer.output("indirect").unwrap()).map(|channel| channel as f32);
    f64::from(metrics::luminance([r, g, b]))
}

/// One light, more neighbours than lights, as many lights replaced as there are, none spread evenly, fewer hits than lights:
/// what leaves the pipeline is finite, and not dark where there is a room.
#[test]
fn any_numbers_of_lights_give_a_finite_picture() {
    for (scene, values) in [
        ("cornell-box", ["lights=1", "moved=1", "lights/seen.rate=16"]),
        ("cornell-box", ["lights=1", "moved=0", "lights/seen.rate=1"]),
        ("cornell-box", ["lights=5", "moved=5", "lights/density.k=32"]),
        ("cornell-box", ["lights=64", "moved=64", "resample=true"]),
        ("cornell-box", ["lights=64", "moved=4096", "lights/seen.rate=1"]),
        // No ray from a plane under the sky meets anything.
        ("plane", ["lights=64", "moved=8", "lights/seen.rate=1"]),
    ] {
        for pipeline in PIPELINES {
            let small = ["map=8", "interleave_x=1", "interleave_y=1", "lights/replacement.warm_up=8"];
            let values = [&small[..], &values].concat();
            let Some(mut renderer) = renderer(pipeline, scene, (24, 24), &values) else { return };
            let lights = lights(&mut renderer);
            let finite = |x: f32| x.is_finite() && x >= 0.0;
            let all_finite =
                lights.iter().all(|light| light.flux.into_iter().chain([light.area]).all(finite));
            assert!(all_finite, "{pipeline} on {scene}, {values:?}: {lights:?}");
            for _ in 0..3 {
                let found = brightness(&mut renderer);
                let lit = if scene == "plane" { found == 0.0 } else { found > 0.0 };
                assert!(found.is_finite() && lit, "{pipeline} on {scene}, {values:?}: {found}");
            }
        }
    }
}

/// Enough to replace each of some hundred lights, eight at a time, twice.
const FEW_ITERATIONS: &[&str] = &["lights/replacement.warm_up=32", "interleave_x=1", "interleave_y=1"];

/// A renderer of the maze with 64 lights, of which eight are replaced in a frame.
fn maze(pipeline: &str, frame: u32) -> Option<Renderer> {
    let values = [FEW_ITERATIONS, by_trees(pipeline), &["lights=64", "moved=8", "map=16"]].concat();
    let mut renderer = renderer(pipeline, "maze", (48, 36), &values)?;
    renderer.set_frame_index(frame);
    lights(&mut renderer);
    Some(renderer)
}

/// In another room, of which no light knows anything, its light is there at once where lights have the flux of photons; and after
/// I / M_max frames by the letter of the paper, as it is where lights settled from the beginning.
#[test]
#[ignore = "slow"]
fn the_light_of_another_room_is_there_after_some_frames() {
    const ELSEWHERE: u32 = 640;
    for (pipeline, at_once) in [("smc-ir", true), ("smc-ir-2016", false)] {
        let (Some(mut before), Some(mut settled)) = (maze(pipeline, 0), maze(pipeline, ELSEWHERE)) else {
            return;
        };
        let wanted = brightness(&mut settled);
        before.set_camera(None, true);
        // A frame more, since what is invalid is known after the first.
        let found: Vec<f64> = (0..=9)
            .map(|_| {
                before.set_frame_index(ELSEWHERE);
                brightness(&mut before) / wanted
            })
            .collect();
        assert_eq!((found[0] - 1.0).abs() < 0.2, at_once, "{pipeline}: {found:?}");
        assert!((found[9] - 1.0).abs() < if at_once { 0.2 } else { 0.35 }, "{pipeline}: {found:?}");
    }
}

/// Lights on a cloth follow it, and mailboxes too: after frames in which it waved, the picture is as bright as that of lights
/// that settled under the cloth as it hangs then.
#[test]
#[ignore = "slow"]
fn lights_follow_geometry_that_deforms() {
    for pipeline in PIPELINES {
        let values = [FEW_ITERATIONS, by_trees(pipeline), &["lights=128", "moved=8", "map=16"]].concat();
        let at = |frame: u32| -> Option<Renderer> {
            let mut renderer = renderer(pipeline, "cornell-box-cloth", (32, 32), &values)?;
            renderer.set_frame_index(frame);
            lights(&mut renderer);
            Some(renderer)
        };
        let (Some(mut followed), Some(mut settled)) = (at(0), at(20)) else { return };
        for frame in 1..20 {
            followed.set_frame_index(frame);
            followed.frame().unwrap();
        }
        followed.set_frame_index(20);
        let ratio = brightness(&mut followed) / brightness(&mut settled);
        assert!((ratio - 1.0).abs() < 0.2, "{pipeline}: {ratio}");
    }
}
