//! Maps of which a few are exact, against rays of the same lights: the more there are, the nearer they come to them.

use crate::adapter::{rel_mse, renderer};
use metrics::Image;

/// All lights at each pixel, so that pixels differ by their maps alone.
const SET: &[&str] =
    &["lights=64", "rsm.size=64", "map=64", "interleave_x=1", "interleave_y=1"];

fn irradiance(pipeline: &str, values: &[&str]) -> Option<Image> {
    let mut renderer = renderer(pipeline, "blinds", (48, 36), &[SET, values].concat())?;
    renderer.keep_only(["irradiance"]).unwrap();
    renderer.frame().unwrap();
    Some(renderer.output("irradiance").unwrap())
}

#[test]
fn maps_of_which_more_are_exact_come_nearer_to_rays() {
    let Some(rays) = irradiance("ism-invtm-ray-traced", &[]) else { return };
    let error = |pipeline, values: &[&str]| rel_mse(&irradiance(pipeline, values).expect("an adapter"), &rays);
    let none = error("ism-invtm", &["settle=false"]);
    // Not in the order of the lights: those that pixels choose most.
    let [few, all] = ["exact=16", "exact=64"].map(|exact| error("ism-mixed-maps", &[exact, "exact_map=128"]));
    eprintln!("RATIO 16 of 64 exact {:.3}, all {:.3}", few / none, all / none);
    assert!(few < 0.75 * none, "a quarter of the maps exact: {few} against {none}");
    assert!(all < 0.25 * none, "all maps exact: {all} against {none}");
}
