//! Bounces of indirect light by imperfect reflective shadow maps.

use crate::adapter::{bits, done, energy, renderer, renderer_in, shown};
use crate::program::Folder;

/// Of the random numbers of lights. With 512 lights, the energy of a bounce has a standard deviation of 2 to 3 %.
const SEEDS: [u32; 3] = [0, 1, 2];

/// Energies of the first bounce, the second and the third, each apart.
fn apart([first, second, third]: [f64; 3]) -> [f64; 3] {
    [first, second - first, third - second]
}

/// By rays, the light of each bounce has the energy of path tracing, in a box that stands still and about a waving cloth.
#[test]
#[ignore = "slow"]
fn each_bounce_has_the_energy_of_path_tracing() {
    let folder = Folder::new(&[]);
    let by_rays = r#"Replace("shadows", Pass(kind: "visibility-ray-traced"))"#;
    let text = format!(r#"Pipeline(extends: "ism-multibounce.ron", patch: [{by_rays}])"#);
    folder.write("pipelines/by-rays.ron", &text);
    let size = (48, 36);
    for scene in ["cornell-box", "cornell-box-cloth"] {
        let energies = |path_traced: bool| {
            let mut energies = [0.0; 3];
            for (i, found) in energies.iter_mut().enumerate() {
                let bounces = format!("bounces={}", i + 1);
                *found = if path_traced {
                    let values = [&bounces[..], "samples=1024", "samples_per_frame=64", "filter=centre"];
                    let mut renderer = renderer("reference", scene, size, &values)?;
                    done(&mut renderer);
                    energy(&renderer.output("indirect").unwrap())
                } else {
                    let lights = ["lights=512", "second_lights=512", "third_lights=512"];
                    let values = [&lights[..], &["interleave_x=1", "interleave_y=1", &bounces]].concat();
                    let mut renderer = renderer_in(&folder, "by-rays", scene, size, &values)?;
                    let of_seed = |seed| {
                        renderer.set_seed(seed);
                        energy(&shown(&mut renderer, "indirect"))
                    };
                    SEEDS.map(of_seed).iter().sum::<f64>() / SEEDS.len() as f64
                };
            }
            Some(apart(energies))
        };
        let Some(truth) = energies(true) else { return };
        let found = energies(false).expect("the adapter is still there");
        for (bounce, (found, truth)) in found.into_iter().zip(truth).enumerate() {
            let ratio = found / truth;
            assert!((ratio - 1.0).abs() < 0.05, "{scene}, bounce {}: {ratio} of the energy", bounce + 1);
        }
    }
}

/// With imperfect maps and in blocks of pixels, three bounces are as bright as path tracing says; one is the picture of `ism`, to the bit.
#[test]
fn bounces_add_up_and_one_is_that_of_ism() {
    let values = ["lights=256", "map=32", "rsm.size=128"];
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
