//! Passes that take some of the lights of a scene by their names.

use crate::adapter::{bits, energy, mean, renderer, root, shown};
use crate::program::lightloom;
use glam::Vec3;
use metrics::Image;

const SCENE: &str = "cornell-box-lights";

const NAMES: [&str; 3] = ["spot", "bulb", "sky"];

/// Returns an output of a pipeline of which these passes take the lights of these names, and that of a scene in which the others are
/// dark.
fn chosen_and_dark(
    (pipeline, passes): (&str, &[&str]),
    (output, few): (&str, &[&str]),
    names: &[&str],
) -> Option<[Image; 2]> {
    let set: Vec<String> = passes.iter().map(|pass| format!("{pass}.lights={}", names.join(","))).collect();
    let values: Vec<&str> = few.iter().copied().chain(set.iter().map(String::as_str)).collect();
    let mut chosen = renderer(pipeline, SCENE, (32, 32), &values)?;
    let mut dark = renderer(pipeline, SCENE, (32, 32), few)?;
    let mut lights = dark.scene().lights.clone();
    for light in lights.iter_mut().filter(|light| !names.contains(&light.name.as_str())) {
        light.intensity = Vec3::ZERO;
    }
    dark.set_lights(Some(lights)).unwrap();
    Some([shown(&mut chosen, output), shown(&mut dark, output)])
}

/// Lights that a pass does not take are dark to it: to the bit, of maps, of photons and of direct light.
#[test]
fn lights_that_a_pass_does_not_take_are_dark_to_it() {
    let maps: &[&str] = &["lights=64", "map=32", "rsm.size=64", "interleave_x=1", "interleave_y=1"];
    let photons: &[&str] = &["lights=60", "map=32", "interleave_x=1", "interleave_y=1"];
    let cases: [(&str, &[&str], _, _); 3] = [
        ("ism", &["rsm", "direct"], maps, "direct"),
        ("ism", &["rsm", "direct"], maps, "indirect"),
        ("instant-radiosity", &["lights", "near"], photons, "indirect"),
    ];
    for (pipeline, passes, few, output) in cases {
        for names in [&NAMES[..1], &NAMES[1..2], &NAMES[1..]] {
            let of = (pipeline, passes);
            let Some([chosen, dark]) = chosen_and_dark(of, (output, few), names) else { return };
            assert!(mean(&dark)[0] > 0.0, "{pipeline}, {names:?}");
            assert_eq!(bits(&chosen), bits(&dark), "{pipeline}, {output}, {names:?}");
        }
    }
}

/// The direct light of all lights is the sum of that of each.
#[test]
fn direct_light_is_the_sum_over_lights() {
    let direct = |names: &str| {
        let values = ["lights=16".to_owned(), "map=16".to_owned(), format!("direct.lights={names}")];
        let values: Vec<&str> = values.iter().map(String::as_str).collect();
        Some(shown(&mut renderer("ism", SCENE, (32, 32), &values)?, "direct"))
    };
    let Some(all) = direct("") else { return };
    let each = NAMES.map(|name| direct(name).expect("the adapter is still there"));
    for (at, whole) in all.pixels().iter().enumerate() {
        for (c, whole) in whole.iter().enumerate().take(3) {
            let sum: f32 = each.iter().map(|image| image.pixels()[at][c]).sum();
            assert!((sum - whole).abs() <= 1e-5 * whole, "pixel {at}: {sum} and {whole}");
        }
    }
}

/// A material that emits is a source as lights are: photons leave it, or do not.
#[test]
fn photons_leave_the_materials_that_are_named() {
    let light = |values: &[&str]| {
        let few = ["lights=64", "map=32", "bounces=1"];
        let values: Vec<&str> = few.iter().chain(values).copied().collect();
        Some(mean(&shown(
            &mut renderer("instant-radiosity", "cornell-box-lamp", (24, 24), &values)?,
            "indirect",
        )))
    };
    let (Some(all), Some(lamp)) = (light(&[]), light(&["lights.lights=lamp"])) else { return };
    assert!(all[0] > 0.0);
    assert_eq!(all, lamp);
}

/// Lights follow as they change, and one that is given another name is no longer that which is chosen.
#[test]
fn chosen_lights_follow_the_lights() {
    let values = ["lights=16", "map=16", "direct.lights=bulb"];
    let Some(mut renderer) = renderer("ism", SCENE, (24, 24), &values) else { return };
    let first = mean(&shown(&mut renderer, "direct"));
    let mut lights = renderer.scene().lights.clone();
    lights[1].intensity *= 2.0;
    lights[0].intensity *= 5.0;
    renderer.set_lights(Some(lights.clone())).unwrap();
    let brighter = mean(&shown(&mut renderer, "direct"));
    for c in 0..3 {
        assert!((brighter[c] / first[c] - 2.0).abs() < 1e-4, "{brighter:?} after {first:?}");
    }
    (lights[0].name, lights[1].name) = ("bulb".to_owned(), "lantern".to_owned());
    renderer.set_lights(Some(lights.clone())).unwrap();
    let other = mean(&shown(&mut renderer, "direct"));
    assert!(other != brighter && other[0] > 0.0, "{other:?}");
    lights[0].name = "lantern".to_owned();
    assert!(renderer.set_lights(Some(lights)).is_err(), "no light is called `bulb` any more");
}

/// Two methods in one picture give the light of both.
#[test]
fn each_light_has_a_method_of_its_own() {
    let few = [
        "lights=512",
        "photon_lights=512",
        "map=32",
        "rsm.size=128",
        "shadow_map.size=64",
        "interleave_x=1",
        "interleave_y=1",
    ];
    let example = root().join("docs/examples/lights-by-name.ron").display().to_string();
    let indirect = |more: &[&str]| {
        let values: Vec<&str> = few.iter().chain(more).copied().collect();
        Some(energy(&shown(&mut renderer(&example, SCENE, (24, 24), &values)?, "indirect")))
    };
    let Some(one_way) = indirect(&[]) else { return };
    for [mapped, traced] in [["bulb,sky", "spot"], ["sky", "spot,bulb"]] {
        let values = [format!("mapped={mapped}"), format!("traced={traced}")];
        let other = indirect(&[&values[0], &values[1]]).expect("the adapter is still there");

        assert!((other / one_way - 1.0).abs() < 0.03, "{values:?}: {other} and {one_way}");
    }
}

/// A name that the scene does not have is an error at its place, with the nearest that it has.
#[test]
fn a_light_that_the_scene_does_not_have_is_named() {
    for (value, words) in [
        ("spott", ["the scene has no light `spott`", "did you mean `spot`?"]),
        ("spot, moon", ["the scene has no light `moon`", "it has spot, bulb, sky"]),
    ] {
        let set = format!("direct.lights={value}");
        lightloom(&["graph", "ism", SCENE, "--set", &set]).failure(1, &words);
    }
}
