//! Points of the scene: generated on the fly and stored, they give the same pictures.

use crate::adapter::{SMALL, bits, mean, renderer, shown};
use crate::program::{Done, Folder, command_of_tree};
use metrics::{Image, Pair};

const SEEDS: u32 = 4;

/// Indirect light of a pipeline, by seed. Lights, too, are others for each seed.
fn pictures(pipeline: &str, scene: &str, values: &[&str]) -> Option<Vec<Image>> {
    let mut renderer = renderer(pipeline, scene, (48, 32), values)?;
    let picture = |seed| {
        renderer.set_seed(seed);
        renderer.run_everything();
        shown(&mut renderer, "indirect")
    };
    Some((1..=SEEDS).map(picture).collect())
}

/// The lights of one seed are the same in both, so pictures differ by the points alone: around the same energy, and by
/// less, the more points there are. No ray settles a lookup or
/// gives what is near: most of what the points differ in would go. In the atrium a
/// texel of these small maps sees many surfaces, of which the nearest point decides: which it is differs however many
/// there are.
#[test]
fn points_on_the_fly_give_the_pictures_of_stored_points() {
    assert_points_agree(&["cornell-box"]);
}

#[test]
#[ignore = "slow"]
fn points_on_the_fly_give_the_pictures_of_stored_points_in_other_scenes() {
    assert_points_agree(&["atrium-spot", "cornell-box-cloth"]);
}

fn assert_points_agree(scenes: &[&str]) {
    for &scene in scenes {
        let mut differences = Vec::new();
        for per_map in [500, 8000] {
            let (wanted, stored) =
                (format!("shadows.points_per_map={per_map}"), format!("shadows.points={}", 64 * per_map));
            let values = [
                "lights=64",
                "map=32",
                "rsm.size=64",
                "interleave_x=1",
                "interleave_y=1",
                "settle=false",
                "near=1",
                "near.rays_per_pixel=0",
                &wanted,
            ];
            let Some(fly) = pictures("tcas", scene, &values) else { return };
            let stored = pictures("tcas-stored", scene, &[&values[..], &[&stored]].concat()).unwrap();
            let energy = |pictures: &[Image]| pictures.iter().flat_map(mean).sum::<f64>();
            let difference: f64 =
                std::iter::zip(&fly, &stored).map(|(a, b)| Pair::new(a, b).unwrap().mse()).sum();
            // Measured: 1.6 % with 500 points a map, 0.3 % with 8,000.
            let (ratio, slack) = (energy(&fly) / energy(&stored), if per_map == 500 { 0.03 } else { 0.01 });
            assert!((ratio - 1.0).abs() < slack, "{scene}, {per_map} points: energy {ratio}");
            differences.push(difference);
        }
        let falls = differences[1] < 0.8 * differences[0];
        assert!(falls || scene == "atrium-spot", "{scene}: {differences:?} by the number of points");
    }
}

/// The triangles of this frame are amplified: a run of frames and a jump give the same bits.
#[test]
fn deforming_geometry_is_followed_in_the_same_frame() {
    for rule in ["area", "tessellation"] {
        let rule = format!("shadows/points.rule={rule}");
        let values = [SMALL, &[&rule]].concat();
        let Some(mut walked) = renderer("tcas", "cornell-box-cloth", (32, 24), &values) else { return };
        let mut starts = Vec::new();
        walked.keep("shadows/points.points").unwrap();
        for _ in 0..8 {
            walked.frame().unwrap();
            let points = walked.plan().unwrap().resource("shadows/points.points").unwrap();
            starts.push(walked.resource_bytes(points).unwrap());
        }
        // By tessellation all of the cloth's triangles are small, and have the least number of points.
        let changed = starts.windows(2).all(|pair| pair[0] != pair[1]);
        assert_eq!(changed, rule.ends_with("area"), "the cloth's triangles change in every frame");
        let mut jumped = renderer("tcas", "cornell-box-cloth", (32, 24), &values).unwrap();
        jumped.set_frame_index(7);
        jumped.frame().unwrap();
        let picture = |renderer: &renderer::Renderer| bits(&renderer.output("indirect").unwrap());
        assert!(picture(&walked) == picture(&jumped), "{rule}: frame 7 depends on the frames before");
        jumped.set_frame_index(0);
        jumped.frame().unwrap();
        assert!(picture(&walked) != picture(&jumped), "{rule}: what deforms is seen");
    }
}

/// A rule that asks for more than the budget gets the budget, and the counters are printed.
#[test]
fn more_points_than_the_budget_are_reported() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    let run = |points: &str| {
        let values = ["lights=16", "map=16", "rsm.size=32", "shadows/points.rule=tessellation", points];
        let mut command = command_of_tree(&folder);
        command.args(["render", "tcas", "cornell-box", "-o", "x.exr", "--size", "16x12"]);
        Done::of(command.args(values.map(|value| ["--set", value]).as_flattened())).success()
    };
    let words = ["shadows/splat.counters: requested ", ", produced 6400"];
    run("shadows.points_per_map=100").says(&words);
    let done = run("shadows.points_per_map=20000");
    assert!(!done.out.contains("counters"), "all were produced: {done}");
}

/// The maps of this many lights are twice the bytes of a buffer that an adapter need bind: they are splatted and filled in parts.
#[test]
fn maps_of_more_bytes_than_a_step_binds_are_rendered() {
    let Some(coarse) = mean_of_indirect(64) else { return };
    let fine = mean_of_indirect(128).expect("the adapter is still there");
    assert!((fine / coarse - 1.0).abs() < 0.05, "{fine} with maps of 128², {coarse} with those of 64²");
}

/// The mean indirect light of `ism` in the Cornell box with 4,096 lights; `None`, with a note, where there is no adapter.
fn mean_of_indirect(map: u32) -> Option<f64> {
    let map = format!("map={map}");
    let mut renderer = renderer("ism", "cornell-box", (24, 24), &["lights=4096", "rsm.size=128", &map])?;
    renderer.frame().unwrap();
    Some(mean(&renderer.output("indirect").unwrap())[1])
}
