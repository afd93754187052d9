//! Scenes in which nothing moves: in the end every frame is the same, bit by bit.

use crate::adapter::{bits, renderer, root, shown};
use glam::Vec3;
use renderer::{Assets, Catalog, Renderer};

const SIZE: (u32, u32) = (24, 16);

const FEW: &[&str] = &["lights=16", "rsm.size=32"];

fn moved(renderer: &mut Renderer) {
    let camera = renderer.scene().camera;
    let moved = scene::Camera { position: camera.position + Vec3::X * 0.1, ..camera };
    renderer.set_camera(Some(moved), false);
}

/// Returns the pictures of `frames` frames.
fn pictures(renderer: &mut Renderer, frames: usize) -> Vec<Vec<[u32; 4]>> {
    let picture = |_| bits(&shown(renderer, "image"));
    (0..frames).map(picture).collect()
}

/// k-means that merges and splits has no end by itself.
#[test]
fn clusters_rest_in_a_still_scene() {
    for pipeline in ["acrsm", "acrsm-unshadowed", "rsm-clustering"] {
        let map: &[&str] = if pipeline == "acrsm" { &["map=16"] } else { &[] };
        let Some(mut renderer) = renderer(pipeline, "cornell-box", SIZE, &[FEW, map].concat()) else {
            return;
        };
        let before = pictures(&mut renderer, 68);
        assert!(before[1] != before[64], "{pipeline}: clusters move at first");
        assert!(before[64..].iter().all(|picture| *picture == before[64]), "{pipeline}: they rest");
        assert!(renderer.report().ran.iter().all(|ran| !ran), "{pipeline}: nothing runs");
        moved(&mut renderer);
        let after = pictures(&mut renderer, 3);
        let mapped = renderer.plan().unwrap().pass("lights/map").expect("texels are mapped");
        assert!(renderer.report().ran[mapped.0 as usize], "{pipeline}: they go on");
        // Those that are neither merged nor split have come to the end of k-means.
        let ends = pipeline == "rsm-clustering";
        assert!(ends || (after[0] != after[1] && after[1] != after[2]), "{pipeline}: they move");
    }
}

/// No part of a pixel follows the newest sample alone: not the lamp, and not whether there is a surface.
#[test]
fn the_mean_of_all_samples_stays() {
    for scene in ["cornell-box-lamp", "plane"] {
        let set = [FEW, &["map=16", "frames=3"]].concat();
        let Some(mut renderer) = renderer("ism-invtm-accumulated", scene, SIZE, &set) else { return };
        let of_frames = pictures(&mut renderer, 6);
        assert!(of_frames[1] != of_frames[2], "{scene}: samples differ");
        assert!(of_frames[2..].iter().all(|picture| *picture == of_frames[2]), "{scene}: three are all");
    }
}

/// The work before the first frame is done before all of it rests.
#[test]
fn lights_that_stay_do_not_rest_before_they_are_there() {
    for pipeline in ["smc-ir", "smc-ir-2016"] {
        let Some(renderer) = renderer(pipeline, "cornell-box", SIZE, &["lights=16", "map=16"]) else {
            return;
        };
        let plan = renderer.plan().unwrap();
        let catalog = Catalog::new(Assets::new(Some(root())));
        let of_lights = |resource: &str| resource.starts_with("lights/");
        let rests = plan
            .histories
            .iter()
            .filter(|history| of_lights(&plan.resources[history.resource.0 as usize].name))
            .map(|history| history.rest);
        let least = rests.min().flatten().expect("all rest");
        let settable = renderer.compiled().unwrap().resolved.settable(&catalog);
        let warm_up = settable.iter().find(|settable| settable.path == "lights/replacement.warm_up").unwrap();
        let most = warm_up.setting.max.unwrap();
        assert!(f64::from(least) > most, "{pipeline}: {least} frames, and up to {most} before the first");
    }
}

/// Paths are sampled again in each frame, unless `vary` is false.
#[test]
fn paths_that_do_not_vary_give_one_picture() {
    let frames = |vary: &str| {
        let set = [FEW, &["map=16", vary]].concat();
        let mut renderer = renderer("metropolis-instant-radiosity", "cornell-box", SIZE, &set)?;
        let of_frames = pictures(&mut renderer, 3);
        Some((of_frames[0] == of_frames[1], of_frames[1] == of_frames[2]))
    };
    let Some(same) = frames("lights/seen.vary=false") else { return };
    assert_eq!(same, (true, true));
    assert_eq!(frames("lights/seen.vary=true"), Some((false, false)));
}
