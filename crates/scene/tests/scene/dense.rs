//! The extent without empty space: that of all triangles, but where something lies far from all else.

use crate::common::{Shipped, scene_of, shipped};
use data_file::Files;

/// A scene of cubes of 1 m at these places.
fn cubes(places: &[[f32; 3]]) -> scene::Scene {
    let objects: String = places
        .iter()
        .enumerate()
        .map(|(i, [x, y, z])| {
            format!(
                "Object(name: \"cube {i}\", geometry: BuiltIn(\"cube\"), \
                 transform: Transform(translate: ({x:?}, {y:?}, {z:?}))),"
            )
        })
        .collect();
    scene_of(&format!("Scene(about: \"Cubes\", geometry: Objects([{objects}]))"))
}

#[test]
fn the_extent_of_scenes_as_they_are_is_that_of_all_triangles() {
    for name in Shipped.list() {
        let scene = shipped(&name);
        assert_eq!(scene.dense_extent(), scene.extent(), "{name}");
    }
    let apart = cubes(&[[0.0; 3], [90.0, 0.0, 0.0], [0.0, 0.0, 150.0]]);
    assert_eq!(apart.dense_extent(), apart.extent(), "not far enough");
}

#[test]
fn empty_space_around_what_lies_far_away_does_not_count() {
    let alone = cubes(&[[0.0; 3], [2.0, 0.0, 0.0]]).extent();
    for far in [[0.0, 0.0, 1e4], [1e4, 1e4, 1e4], [-1e6, 0.0, 0.0]] {
        let scene = cubes(&[[0.0; 3], [2.0, 0.0, 0.0], far]);
        assert!(scene.extent() > 9e3);
        let (dense, most) = (scene.dense_extent(), alone + 3f32.sqrt());
        assert!((alone * 0.99..=most * 1.01).contains(&dense), "{far:?}: {dense} m, alone {alone} m");
    }
    // Each is far from all that is nearer.
    let scene = cubes(&[[0.0; 3], [2.0, 0.0, 0.0], [0.0, 1e4, 0.0], [0.0, 0.0, 1e7]]);
    assert!(scene.dense_extent() < 3.0 * alone, "{}", scene.dense_extent());
}

#[test]
fn a_scene_without_triangles_or_without_thickness_has_its_extent() {
    for name in ["empty", "plane"] {
        let scene = shipped(name);
        assert_eq!(scene.dense_extent(), scene.extent(), "{name}");
    }
}
