//! Walks of 50 frames and more, as TCAS §6.2 has them, through nothing.

use scene::Scene;

use crate::common::{load_path, root, shared, shipped};

fn assert_free(name: &str, scene: &Scene, frames: u16) {
    let pose = |frame: u16| scene.at(f32::from(frame) / 30.0);
    for frame in 0..frames {
        let now = pose(frame);
        let (here, next) = (now.camera.position, pose(frame + 1).camera.position);
        assert!(frame + 1 >= frames || here.distance(next) > 1e-3, "{name}: frame {frame} stands still");
        // As far ahead again: a camera that passes by a wall shows nothing else.
        let hit = scene.pick(&now, here, next - here);
        let free = hit.is_none_or(|hit| hit.distance >= 2.0 * here.distance(next));
        assert!(free, "{name}: something is in the way after frame {frame}, at {here}");
    }
}

#[test]
fn walks_go_through_nothing() {
    let walks = [("atrium", 60), ("atrium-lights", 60), ("nave", 60), ("maze", 660), ("corridor", 600)];
    for (name, frames) in walks {
        assert_free(name, &shipped(name), frames);
    }
}

/// The example of the documentation, beside Sponza.
#[test]
fn the_walk_in_sponza_goes_through_nothing() {
    let Some(shared) = shared() else { return };
    let folder = tempfile::tempdir().unwrap();
    let walk = folder.path().join("sponza-walk.ron");
    std::fs::copy(root().join("docs/examples/sponza-walk.ron"), &walk).expect("the example");
    std::fs::copy(shared.join("sponza.glb"), folder.path().join("sponza.glb")).expect("Sponza");
    let scene = load_path(&walk);
    assert_eq!(scene.lights.len(), 6);
    assert_free("sponza-walk", &scene, 60);
}
