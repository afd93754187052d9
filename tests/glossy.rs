//! Glossy reflection by virtual lights, against path tracing.

use crate::adapter::{bits, done, energy, mean, renderer, renderer_in, shown};
use crate::program::Folder;

const SIZE: (u32, u32) = (40, 30);

const SEEDS: [u32; 3] = [0, 1, 2];

/// By rays, light that glossy surfaces reflect to others and to the camera has the energy of path tracing: a gold ring with its
/// caustic.
#[test]
#[ignore = "slow"]
fn light_by_glossy_surfaces_has_the_energy_of_path_tracing() {
    let values = ["samples=1024", "samples_per_frame=64", "bounces=1", "filter=centre"];
    let Some(mut truth) = renderer("reference", "ring", SIZE, &values) else { return };
    done(&mut truth);
    let truth = energy(&truth.output("indirect").unwrap());
    let values = ["lights=16384", "rsm.size=1024"];
    let mut renderer =
        renderer("ism-glossy-ray-traced", "ring", SIZE, &values).expect("the adapter is still there");
    let of_seed = |seed| {
        renderer.set_seed(seed);
        energy(&shown(&mut renderer, "indirect"))
    };
    let found = SEEDS.map(of_seed).iter().sum::<f64>() / SEEDS.len() as f64;
    assert!((found / truth - 1.0).abs() < 0.03, "{} of the energy", found / truth);
}

/// Where nothing is glossy, pictures are those of `gather` to the bit.
#[test]
fn dull_scenes_are_those_of_gather_to_the_bit() {
    let text = r#"Pipeline(extends: "ism.ron", patch: [
        Replace("gather", Pass(kind: "gather-glossy", set: { "interleave_x": "$interleave_x", "interleave_y": "$interleave_y" })),
        Replace("filter", Pass(kind: "geometry-aware-blur", in: { "irradiance": "gather.irradiance" })),
    ])"#;
    let Some(folder) = Folder::with_gpu(&[("pipelines/glossy.ron", text)]) else { return };
    for blocks in [["interleave_x=1", "interleave_y=1"], ["interleave_x=8", "interleave_y=8"]] {
        let values = [&["lights=64", "map=32", "rsm.size=64"], &blocks[..]].concat();
        let mut plain = renderer("ism", "cornell-box", SIZE, &values).expect("there is an adapter");
        let mut glossy =
            renderer_in(&folder, "glossy", "cornell-box", SIZE, &values).expect("there is an adapter");
        let pictures = [&mut plain, &mut glossy].map(|renderer| bits(&shown(renderer, "image")));
        assert!(pictures[0] == pictures[1], "{blocks:?}");
    }
}

/// A metal has no diffuse part: in indirect light it is black without glossy reflection, and not with it.
#[test]
fn a_metal_reflects_indirect_light_by_its_lobe_alone() {
    let light = |pipeline: &str| {
        let values = ["lights=256", "map=32", "rsm.size=128", "interleave_x=1", "interleave_y=1"];
        let mut renderer = renderer(pipeline, "cornell-box", (24, 24), &values)?;
        let mut scene = renderer.scene().clone();
        // The first is the white of walls and blocks.
        let white = &mut scene.materials[0];
        (white.metallic, white.roughness) = (1.0, 0.4);
        renderer.set_scene(scene).unwrap();
        let image = shown(&mut renderer, "indirect");
        assert!(image.pixels().iter().flatten().all(|x| x.is_finite() && *x >= 0.0), "{pipeline}");
        // The middle of the back wall.
        Some((image.pixels()[12 * 24 + 12], mean(&image)))
    };
    let Some((dull, _)) = light("ism") else { return };
    assert_eq!(dull[..3], [0.0; 3]);
    let (glossy, whole) = light("ism-glossy").expect("the adapter is still there");
    assert!(glossy[0] > 0.0 && whole[0] > 0.0, "{glossy:?}");
}
