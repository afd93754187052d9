//! Scenes without any light but surfaces that emit.

use crate::adapter::{done, mean, renderer, shown};
use glam::Vec3;
use metrics::Image;

/// The direct light of the lamp, by virtual lights.
fn direct(values: &[&str]) -> Option<Image> {
    let mut renderer =
        renderer("ism-area-light", "cornell-box-lamp", (48, 48), &[&["supersampling=1"], values].concat())?;
    Some(shown(&mut renderer, "direct"))
}

/// Lights on the lamp are its direct light, whether imperfect maps or rays shadow them.
#[test]
fn direct_light_of_a_lamp_has_the_energy_of_path_tracing() {
    let values = ["samples=1024", "filter=centre"];
    let Some(mut truth) = renderer("reference", "cornell-box-lamp", (48, 48), &values) else { return };
    done(&mut truth);
    let truth = mean(&truth.output("direct").unwrap());
    let maps = direct(&[]).expect("the adapter is still there");
    let one_block = direct(&["interleave_x=1", "interleave_y=1"]).expect("the adapter is still there");
    for (what, image) in [("8×8", maps), ("1×1", one_block)] {
        for (c, value) in mean(&image).into_iter().enumerate() {
            let energy = value / truth[c];
            assert!((energy - 1.0).abs() < 0.03, "{what}, channel {c}: {energy} of the energy");
        }
    }
}

/// A pipeline for lamps also runs where there are none, or none that has an area, or nothing at all.
#[test]
fn scenes_without_lamps_are_as_dark_as_they_are() {
    let Some(mut renderer) =
        renderer("ism-area-light", "cornell-box-lamp", (16, 16), &["lights=64", "map=16"])
    else {
        return;
    };
    let lamp = renderer.scene().clone();
    let mut without = lamp.clone();
    without.materials.iter_mut().for_each(|material| material.emission = Vec3::ZERO);
    let mut flat = lamp.clone();
    let emits = |vertex: &scene::Vertex| lamp.materials[vertex.material as usize].is_emissive();
    flat.vertices.iter_mut().filter(|vertex| emits(vertex)).for_each(|vertex| vertex.position = [0.2; 3]);
    let [empty, spot] = ["empty", "cornell-box"].map(|name| {
        let other =
            self::renderer("ism-area-light", name, (16, 16), &[]).expect("the adapter is still there");
        other.scene().clone()
    });
    for (name, scene, lit) in
        [("lamp", lamp, true), ("no lamp", without, false), ("flat", flat, false), ("empty", empty, false)]
    {
        renderer.set_scene(scene).unwrap_or_else(|error| panic!("{name}: {error}"));
        let image = shown(&mut renderer, "image");
        assert!(image.pixels().iter().flatten().all(|x| x.is_finite()), "{name}");
        assert_eq!(mean(&image).iter().any(|sum| *sum > 0.0), lit, "{name}");
    }
    // Lights of the other sort are not left out.
    renderer.set_scene(spot).unwrap();
    assert!(mean(&shown(&mut renderer, "direct"))[0] > 0.0);
}
