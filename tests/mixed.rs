//! Maps of which a few are exact, against rays of the same lights: the more there are, the nearer they come to them.

use crate::adapter::{mean, rel_mse, renderer};
use crate::program::Folder;
use metrics::Image;

/// All lights at each pixel, so that pixels differ by their maps alone.
const SET: &[&str] =
    &["lights=64", "rsm.size=64", "map=64", "interleave_x=1", "interleave_y=1", "supersampling=1"];

fn irradiance(pipeline: &str, values: &[&str]) -> Option<Image> {
    let mut renderer = renderer(pipeline, "blinds", (48, 36), &[SET, values].concat())?;
    renderer.keep_only(["irradiance"]).unwrap();
    renderer.frame().unwrap();
    Some(renderer.output("irradiance").unwrap())
}

#[test]
fn maps_of_which_more_are_exact_come_nearer_to_rays() {
    let Some(rays) = irradiance("ism-invtm-ray-traced", &[]) else { return };
    let error =
        |pipeline, values: &[&str]| rel_mse(&irradiance(pipeline, values).expect("an adapter"), &rays);
    let none = error("ism-invtm", &["settle=false"]);
    // Not in the order of the lights: those that pixels choose most.
    let [few, all] = ["exact=16", "exact=64"].map(|exact| error("ism-mixed-maps", &[exact, "exact_map=128"]));
    eprintln!("RATIO 16 of 64 exact {:.3}, all {:.3}", few / none, all / none);
    assert!(few < 0.75 * none, "a quarter of the maps exact: {few} against {none}");
    assert!(all < 0.25 * none, "all maps exact: {all} against {none}");
}

/// A spot between the vault of an aisle and the floor above, a fifth of a metre from the vault. The camera is below.
const ABOVE_A_VAULT: &str = r#"Scene(
    about: "Light that stays where nobody looks",
    geometry: BuiltIn("atrium"),
    camera: Camera(position: (-12.5, 1.7, 5.9), target: (-2.0, 2.1, 4.4), vertical_fov_deg: 60),
    lights: [
        Spot(position: (0.0, 4.2, 6.2), direction: (-0.46, -1.0, -0.03), intensity: (25.0, 25.0, 25.0), outer_deg: 35),
    ],
)"#;

/// Of the points of the whole atrium, few lie on the vault. What rays find is there.
#[test]
fn light_above_a_vault_stays_there() {
    let folder = Folder::new(&[("spot.ron", ABOVE_A_VAULT)]);
    let light = |pipeline, values: &[&str]| {
        let few = &["lights=128", "rsm.size=128"];
        let mut renderer = renderer(pipeline, &folder.name("spot.ron"), (64, 48), &[few, values].concat())?;
        renderer.keep_only(["irradiance"]).unwrap();
        renderer.frame().unwrap();
        Some(mean(&renderer.output("irradiance").unwrap()).iter().sum::<f64>())
    };
    let Some(rays) = light("ism-invtm-ray-traced", &[]) else { return };
    assert_eq!(rays, 0.0, "the camera sees nothing of it");
    // Measured: 0.3 and 0.03.
    for (settle, most) in [("settle=false", 0.5), ("settle=true", 0.1)] {
        let [points, both] = ["shadows/splat.traced=false", "shadows/splat.traced=true"]
            .map(|traced| light("ism-invtm", &[settle, traced]).unwrap());
        let said = format!("{settle}: {both} with rays beside points, {points} without");
        eprintln!("RATIO {:.3}, {said}", both / points);
        assert!(points > 0.0 && both < most * points, "{said}");
    }
}
