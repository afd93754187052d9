//! Bounces of indirect light by imperfect reflective shadow maps.

use crate::adapter::{bits, done, energy, renderer, renderer_in, shown};
use crate::program::Folder;

/// Of the random numbers of lights. With 512 lights, the energy of a bounce has a standard deviation of 2 to 3 %.
const SEEDS: std::ops::Range<u32> = 0..8;

const SIZE: (u32, u32) = (32, 24);

/// Energies of the first bounce, the second and the third, each apart.
fn apart([first, second, third]: [f64; 3]) -> [f64; 3] {
    [first, second - first, third - second]
}

/// Returns the energy of so many bounces by path tracing, in a frame of this size.
pub(crate) fn path_traced(scene: &str, size: (u32, u32), bounces: u32) -> Option<f64> {
    let bounces = format!("bounces={bounces}");
    let values = [&bounces[..], "samples=256", "samples_per_frame=64", "filter=centre"];
    let mut renderer = renderer("reference", scene, size, &values)?;
    done(&mut renderer);
    Some(energy(&renderer.output("indirect").unwrap()))
}

/// Returns the energy of so many bounces by a pipeline of the folder with few lights and small maps, over the seeds.
fn by_lights(folder: &Folder, pipeline: &str, scene: &str, bounces: u32) -> f64 {
    let bounces = format!("bounces={bounces}");
    let lights = ["lights=512", "second_lights=512", "third_lights=512"];
    let maps = ["second.map=32", "second.points_per_map=2000", "third.map=32", "third.points_per_map=2000"];
    let pixels = ["interleave_x=1", "interleave_y=1", "supersampling=1"];
    let values = [&lights[..], &maps, &pixels, &[&bounces]].concat();
    let mut renderer =
        renderer_in(folder, pipeline, scene, SIZE, &values).expect("the adapter is still there");
    let of_seed = |seed| {
        renderer.set_seed(seed);
        energy(&shown(&mut renderer, "indirect"))
    };
    SEEDS.map(of_seed).sum::<f64>() / SEEDS.len() as f64
}

/// By rays, the light of each bounce has the energy of path tracing, in a box that stands still and about a waving cloth.
#[test]
#[ignore = "slow"]
fn each_bounce_has_the_energy_of_path_tracing() {
    let folder = Folder::new(&[]);
    let by_rays = r#"Replace("shadows", Pass(kind: "visibility-ray-traced"))"#;
    let text = format!(r#"Pipeline(extends: "ism-multibounce.ron", patch: [{by_rays}])"#);
    folder.write("pipelines/by-rays.ron", &text);
    for scene in ["cornell-box", "cornell-box-cloth"] {
        let mut truth = [0.0; 3];
        for (i, truth) in truth.iter_mut().enumerate() {
            let Some(energy) = path_traced(scene, SIZE, i as u32 + 1) else { return };
            *truth = energy;
        }
        let found = [1, 2, 3].map(|bounces| by_lights(&folder, "by-rays", scene, bounces));
        for (bounce, (found, truth)) in apart(found).into_iter().zip(apart(truth)).enumerate() {
            let ratio = found / truth;
            assert!((ratio - 1.0).abs() < 0.05, "{scene}, bounce {}: {ratio} of the energy", bounce + 1);
        }
    }
}

/// Bounces follow lights of any sampler: by rays, the second bounce has the energy of path tracing after lights drawn uniformly, by
/// chains that keep the mean, and by photons.
#[test]
#[ignore = "slow"]
fn a_second_bounce_follows_lights_of_any_sampler() {
    let folder = Folder::new(&[]);
    let samplers = [
        ("uniform", r#"kind: "sample-uniform", in: { "rsm": "rsm" }, set: { "count": "$lights" }"#),
        (
            "chains",
            r#"kind: "sample-metropolis", in: { "rsm": "rsm", "importance": "importance" },
            set: { "count": "$lights", "weights": "reservoir" }"#,
        ),
        ("photons", r#"kind: "trace-photons", set: { "count": "$lights", "bounces": 1 }"#),
    ];
    for (name, first) in samplers {
        let text = format!(
            r#"Pipeline(extends: "ism-multibounce.ron", patch: [
                Replace("first", Pass({first})),
                Replace("shadows", Pass(kind: "visibility-ray-traced")),
            ])"#
        );
        folder.write(&format!("pipelines/{name}.ron"), &text);
    }
    let scene = "cornell-box";
    let (Some(one), Some(two)) = (path_traced(scene, SIZE, 1), path_traced(scene, SIZE, 2)) else { return };
    for (name, _) in samplers {
        let found = [1, 2].map(|bounces| by_lights(&folder, name, scene, bounces));
        for (bounce, ratio) in [found[0] / one, (found[1] - found[0]) / (two - one)].into_iter().enumerate() {
            assert!((ratio - 1.0).abs() < 0.05, "{name}, bounce {}: {ratio} of the energy", bounce + 1);
        }
    }
}

/// With imperfect maps and in blocks of pixels, three bounces are as bright as path tracing says; one is the picture of `ism`, to the bit.
#[test]
fn bounces_add_up_and_one_is_that_of_ism() {
    let values = ["lights=256", "map=32", "rsm.size=128"];
    // In smaller frames blocks lose more at edges.
    let size = (48, 36);
    let Some(mut ism) = renderer("ism", "cornell-box", size, &values) else { return };
    let picture = |bounces: &str| {
        let lights = ["second_lights=512", "third_lights=512", bounces];
        let values = [&values[..], &lights].concat();
        let mut renderer =
            renderer("ism-multibounce", "cornell-box", size, &values).expect("the adapter is still there");
        shown(&mut renderer, "indirect")
    };
    let [one, three] = ["bounces=1", "bounces=3"].map(picture);
    assert!(bits(&one) == bits(&shown(&mut ism, "indirect")), "a bounce is that of ism");
    let values = ["bounces=3", "samples=256", "samples_per_frame=64", "filter=centre"];
    let mut truth = renderer("reference", "cornell-box", size, &values).expect("the adapter is still there");
    done(&mut truth);
    let ratio = energy(&three) / energy(&truth.output("indirect").unwrap());
    assert!((ratio - 1.0).abs() < 0.05, "{ratio} of the energy");
}
