//! Clusters of a reflective shadow map, as pipelines use them over frames.

use crate::adapter::{gpu, mean, renderer};
use interfaces::virtual_lights::VirtualLight;
use renderer::{PortFigures, Renderer};

const CLUSTERED: [&str; 4] = ["acrsm", "acrsm-2017", "rsm-clustering", "clustered-visibility"];

/// Returns the figures of the clusters of a frame.
fn clusters(renderer: &Renderer) -> PortFigures {
    let figures = renderer.figures().unwrap();
    figures
        .into_iter()
        .find(|port| port.port == "lights/average.averaged")
        .expect("the clusters are averaged")
}

/// A pipeline with few lights and small maps, after some frames.
fn after(pipeline: &str, scene: &str, frames: u32, more: &[&str]) -> Option<Renderer> {
    let own: &[&str] = match pipeline {
        "acrsm" | "acrsm-2017" | "rsm-clustering" => &["lights=64", "map=32", "window=64"],
        "clustered-visibility" => &["lights=64", "map=32", "clusters=32"],
        _ => &[],
    };
    let values: Vec<&str> = ["rsm.size=128"].iter().chain(own).chain(more).copied().collect();
    let mut renderer = renderer(pipeline, scene, (48, 36), &values)?;
    for _ in 0..frames {
        renderer.frame().unwrap();
    }
    Some(renderer)
}

/// Area lights of clusters give the light that as many points give, and keep it from frame to frame.
#[test]
fn clusters_light_as_points_do() {
    let Some(exact) = after("exhaustive", "cornell-box", 1, &["lights=1024"]) else { return };
    let exact = mean(&exact.output("indirect").unwrap());
    for pipeline in CLUSTERED {
        for frames in [1, 6] {
            let clustered = after(pipeline, "cornell-box", frames, &[]).expect("the adapter is still there");
            let found = mean(&clustered.output("indirect").unwrap());
            for (found, exact) in found.iter().zip(exact) {
                // Without shadows there is more light; with discs, less where they touch what they light.
                let most = if pipeline == "rsm-clustering" { 1.6 } else { 1.15 };
                assert!(
                    (0.8..most).contains(&(found / exact)),
                    "{pipeline} after {frames} frames: {found} for {exact}"
                );
            }
        }
    }
}

/// Seeds that follow what the view gets take texels by another importance, which has other units: none of them loses its own texel.
#[test]
fn all_seeds_take_texels_in_the_first_frame() {
    let Some(first) = after("acrsm", "nave", 1, &[]) else { return };
    let figures = clusters(&first);
    assert!(figures.value("vanished").unwrap() <= 2.0, "{figures:?}");
}

#[test]
fn clusters_stay_alive_while_the_light_glides() {
    if gpu().is_none() {
        return;
    }
    let more = ["interleave_x=4", "interleave_y=4"];
    let mut gliding = after("acrsm-2017", "cornell-box-glide", 0, &more).expect("there is an adapter");
    let (mut moved, mut before) = (0, Vec::new());
    // From the red wall over the edge to the back wall.
    for frame in 0..40 {
        gliding.set_frame_index(80 + 2 * frame);
        gliding.frame().unwrap();
        let figures = clusters(&gliding);
        let (alive, vanished) = (figures.value("alive").unwrap(), figures.value("vanished").unwrap());
        assert_eq!(alive + vanished, 64.0, "frame {frame}: those that have vanished are back in the next");
        assert!(vanished <= 8.0, "frame {frame}: {vanished} vanish at once");
        let (mapped, all) = flux(&gliding);
        assert!(mapped > 0.97 * all, "frame {frame}: clusters hold {mapped} W of {all} W");
        let lights = gliding.output("indirect").unwrap();
        moved += usize::from(mean(&lights).to_vec() != before);
        before = mean(&lights).to_vec();
    }
    assert!(moved > 35, "the light moves");
}

/// The flux of the texels that are in a cluster, and of all: see `struct Clusters`.
fn flux(renderer: &Renderer) -> (f32, f32) {
    let bytes = resource(renderer, "lights/average.averaged");
    let (header, _) = interfaces::clusters::from_bytes(&bytes).expect("a buffer of clusters");
    (header.mapped_flux.iter().sum(), header.map_flux.iter().sum())
}

/// The virtual lights of the clusters.
fn lights(renderer: &Renderer) -> Vec<VirtualLight> {
    let bytes = resource(renderer, "lights/lights.lights");
    interfaces::virtual_lights::from_bytes(&bytes).expect("a buffer of lights")
}

/// Returns the content of a resource after the last frame.
fn resource(renderer: &Renderer, name: &str) -> Vec<u8> {
    let id = renderer.plan().unwrap().resource(name).expect("a resource of the plan");
    renderer.resource_bytes(id).unwrap()
}

/// Merged clusters are split elsewhere or seeded again: figures add up, and a restart forgets the past.
#[test]
fn a_restart_forgets_the_frames_before() {
    let Some(first) = after("acrsm", "cornell-box", 1, &["lights.restart=true"]) else { return };
    let later =
        after("acrsm", "cornell-box", 5, &["lights.restart=true"]).expect("the adapter is still there");
    let kept = after("acrsm", "cornell-box", 5, &[]).expect("the adapter is still there");
    let variance = |renderer: &Renderer| clusters(renderer).value("share_variance").expect("a figure");
    assert_eq!(variance(&first), variance(&later), "each frame begins from the same seeds");
    assert_ne!(variance(&first), variance(&kept), "iterations go on from frame to frame");
}

/// More clusters than lit texels, one cluster, the least and the greatest windows and thresholds, no light, several, and the
/// faces of a point light: every frame is finite, nothing is in two clusters, and the flux of the lights is that of the map.
#[test]
#[ignore = "slow"]
fn at_the_edges_of_what_can_be_asked() {
    if gpu().is_none() {
        return;
    }
    let cases: [(&str, &[&str]); 10] = [
        ("cornell-box", &["rsm.size=8", "lights=200"]),
        ("cornell-box", &["lights=1", "window=0"]),
        ("cornell-box", &["window=1"]),
        ("cornell-box", &["window=8192"]),
        ("cornell-box", &["lights/evaluate.merge=0", "lights/evaluate.split=0"]),
        ("cornell-box", &["lights/evaluate.merge=1", "lights/evaluate.split=1"]),
        ("cornell-box", &["importance.view_weight=0", "importance.diffuse_weight=0"]),
        ("cornell-box-lights", &[]),
        ("cornell-box-point", &["lights/lights.place=texel"]),
        ("empty", &[]),
    ];
    for (scene, values) in cases {
        let more = [&["map=8", "interleave_x=1", "interleave_y=1", "rsm.size=64"], values].concat();
        let renderer = after("acrsm", scene, 5, &more).expect("there is an adapter");
        let case = format!("{scene}, {values:?}");
        let figures = clusters(&renderer);
        let (alive, vanished) = (figures.value("alive").unwrap(), figures.value("vanished").unwrap());
        let side: f64 = if values.contains(&"rsm.size=8") { 8.0 } else { 64.0 };
        assert!(alive <= side * side * 7.0, "{case}: {alive} clusters of fewer texels");
        assert!(figures.values.iter().all(|(_, value)| value.is_finite()), "{case}: {figures:?}");
        let picture = renderer.output("indirect").unwrap();
        assert!(picture.pixels().iter().flatten().all(|value| value.is_finite()), "{case}");
        let (mapped, all) = flux(&renderer);
        assert!((0.0..=1.0001 * all).contains(&mapped), "{case}: clusters hold {mapped} W of {all} W");
        if scene == "empty" {
            assert_eq!((alive, all), (0.0, 0.0), "{case}: {vanished}");
            continue;
        }
        assert!(alive > 0.0 && mapped > 0.0, "{case}: {figures:?}");
        let shining: f32 = lights(&renderer).iter().flat_map(|light| light.flux).sum();
        assert!((shining / all - 1.0).abs() < 1e-3, "{case}: lights have {shining} W of {all} W");
    }
}

/// A light at a texel of its cluster is on a surface of the box; the mean of a cluster that goes around an edge is not.
#[test]
fn lights_at_texels_are_on_surfaces() {
    let outside = |place: &str| {
        let place = format!("lights/lights.place={place}");
        let renderer = after("acrsm", "cornell-box-point", 4, &["lights=16", "window=0", &place])?;
        // The walls, floor and ceiling are planes of constant coordinates; boxes within are turned.
        let beside = |at: [f32; 3]| {
            let [x, y, z] = at;
            [x, 0.5528 - x, y, 0.5488 - y, z, 0.5592 - z]
                .iter()
                .fold(f32::MAX, |least, at| least.min(at.abs()))
        };
        Some(
            lights(&renderer)
                .iter()
                .filter(|light| light.flux[1] > 0.0 && beside(light.position) > 0.015)
                .count(),
        )
    };
    let (Some(mean), Some(texel)) = (outside("mean"), outside("texel")) else { return };
    assert!(texel < mean, "{texel} of 16 lights are off the walls, and {mean} at the means");
}
