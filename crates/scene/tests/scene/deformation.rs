//! Morph targets.

use glam::{Quat, Vec3};
use scene::{Changes, Scene};
use serde_json::json;

use crate::common::{
    Glb, assert_near, assert_refused, assert_states, assert_trait, assert_windings, normal, position,
};

/// A square with morph targets that move each vertex by these.
fn morphed(targets: &[[f32; 3]]) -> Glb {
    let mut glb = Glb::square();
    let targets: Vec<_> =
        targets.iter().map(|by| json!({ "POSITION": glb.floats("VEC3", &by.repeat(4)) })).collect();
    glb.primitive()["targets"] = json!(targets);
    glb
}

/// Returns the position of the square's third vertex, at (1, 1, 0) in its mesh.
fn third(scene: &Scene, time: f32) -> Vec3 {
    scene.at(time).moved[0].vertices[2].position.into()
}

#[test]
fn half_a_weight_moves_half_way_and_a_nodes_weights_win() {
    let mut glb = morphed(&[[0.0, 0.0, 4.0], [2.0, 0.0, 0.0]]);
    let loaded = |glb: &Glb| position(&glb.scene(), 2);
    assert_eq!(loaded(&glb), Vec3::new(1.0, 1.0, 0.0), "no weights: the base shape");
    glb.json["meshes"][0]["weights"] = json!([0.5, 0.0]);
    assert_eq!(loaded(&glb), Vec3::new(1.0, 1.0, 2.0), "the mesh's weights");
    glb.json["nodes"][0]["weights"] = json!([0.25, -0.5]);
    assert_eq!(loaded(&glb), Vec3::new(0.0, 1.0, 1.0), "the node's weights");
    glb.json["nodes"][0]["scale"] = json!([1.0, 1.0, 3.0]);
    let scene = glb.scene();
    assert_eq!(position(&scene, 2), Vec3::new(0.0, 1.0, 3.0), "first the targets, then the node");
    assert_trait(&scene, "moving_geometry", false);
    assert!(!scene.instances[0].moves && scene.at(1.0).moved.is_empty(), "made once");
}

#[test]
fn nodes_that_share_a_mesh_have_weights_of_their_own() {
    let mut glb = morphed(&[[0.0, 0.0, 4.0]]);
    glb.json["nodes"][0]["weights"] = json!([0.5]);
    glb.push("nodes", json!({ "mesh": 0, "weights": [0.75] }));
    let scene = glb.scene();
    assert_eq!((position(&scene, 0).z, position(&scene, 4).z), (2.0, 3.0));
}

#[test]
fn weights_are_animated_with_every_interpolation() {
    // Two targets; of CUBICSPLINE, for each key: the slopes in of both, their values, their slopes out.
    let cubic = [0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 3.0, 0.0, 0.0];
    let steps = [0.0, 1.0, 1.0, 3.0];
    // At a quarter: h₀₁ = 3t² − 2t³ = 0.15625, and h₁₀ = t³ − 2t² + t = 0.140625 for the slope out of 1.
    for (interpolation, values, expected) in [
        ("STEP", &steps[..], [0.0, 1.0]),
        ("LINEAR", &steps[..], [0.25, 1.5]),
        ("CUBICSPLINE", &cubic[..], [0.15625 + 0.140625, 1.0 + 2.0 * 0.15625]),
    ] {
        let mut glb = morphed(&[[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]);
        let (input, output) = (glb.floats("SCALAR", &[0.0, 1.0]), glb.floats("SCALAR", values));
        glb.animate(0, "weights", interpolation, input, output);
        let scene = glb.scene();
        for time in [0.25, 2.25] {
            let expected = Vec3::new(1.0 + expected[1], 1.0, expected[0]);
            let found = third(&scene, time);
            assert!(
                found.abs_diff_eq(expected, 1e-6),
                "{interpolation} at {time} s: {found}, not {expected}"
            );
        }
        assert_eq!((scene.duration, scene.instances[0].moves), (1.0, true), "{interpolation}");
        assert_trait(&scene, "moving_geometry", true);
        let geometry = Changes { geometry: true, ..Changes::default() };
        assert_eq!(scene.changes(0.0, 2.0), Changes::default(), "{interpolation}: a period later");
        if interpolation != "STEP" {
            assert_eq!(scene.changes(0.0, 0.3), geometry, "{interpolation}");
        }
        for (vertex, moved) in scene.vertices.iter().zip(&scene.at(0.0).moved[0].vertices) {
            assert_eq!(vertex, moved, "{interpolation}: loaded as at 0 s");
        }
    }
}

#[test]
fn the_box_around_the_scene_holds_all_that_moves() {
    let mut glb = morphed(&[[0.0, 0.0, 4.0]]);
    let (input, output) = (glb.floats("SCALAR", &[0.0, 1.0, 2.0]), glb.floats("SCALAR", &[0.0, 1.0, -0.5]));
    glb.animate(0, "weights", "LINEAR", input, output);
    let scene = glb.scene();
    // The scene's 65 times meet the keys at 0, 1 and, as the animation repeats, nearly that at 2 s.
    let (min, max) = scene.bounds();
    assert_eq!((max, min.truncate()), (Vec3::new(1.0, 1.0, 4.0), Vec3::ZERO.truncate()));
    assert!(min.z < -1.8 && min.z >= -2.0, "{min}");
    assert!((scene.area() - 1.0).abs() < 1e-6, "the area is that at 0 s");
}

#[test]
fn normals_are_displaced_and_of_length_1() {
    let mut glb = morphed(&[[0.0, 0.0, 1.0]]);
    let normals = glb.floats("VEC3", &[1.0, 0.0, 0.0].repeat(4));
    glb.primitive()["targets"][0]["NORMAL"] = json!(normals);
    glb.json["meshes"][0]["weights"] = json!([0.75]);
    let of = |glb: &Glb| normal(&glb.scene(), 0);
    // (0, 0, 1) + ¾ (1, 0, 0), made 1 long: a triangle of sides 3, 4, 5.
    assert_near(of(&glb), Vec3::new(0.6, 0.0, 0.8));
    glb.json["nodes"][0]["rotation"] = json!(Quat::from_rotation_z(std::f32::consts::FRAC_PI_2).to_array());
    assert_near(of(&glb), Vec3::new(0.0, 0.6, 0.8));
    let against = glb.floats("VEC3", &[0.0, 0.0, -1.0].repeat(4));
    glb.primitive()["targets"][0]["NORMAL"] = json!(against);
    glb.json["meshes"][0]["weights"] = json!([1.0]);
    assert_eq!(of(&glb), Vec3::Z, "nothing is left of it: the base shape's");
}

#[test]
fn a_mesh_without_normals_stays_flat_as_it_deforms() {
    for scale in [1.0, -1.0] {
        let mut glb = Glb::square();
        glb.without_normals();
        // Lifts the edge at x = 1, whose vertices are 1 and 2, by its length.
        let lift = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
        let lift = glb.floats("VEC3", &lift);
        glb.primitive()["targets"] = json!([{ "POSITION": lift }]);
        glb.json["meshes"][0]["weights"] = json!([1.0]);
        glb.json["nodes"][0]["scale"] = json!([scale, 1.0, 1.0]);
        let scene = glb.scene();
        assert_eq!(position(&scene, 2), Vec3::new(scale, 1.0, 1.0), "a corner of the first triangle");
        let expected = Vec3::new(-scale, 0.0, 1.0).normalize();
        assert_windings(&scene, 1e-6).into_iter().for_each(|face| assert_near(face, expected));
    }
}

#[test]
fn displacements_that_are_no_numbers_drop_triangles_as_positions_do() {
    let mut glb = morphed(&[[0.0, 0.0, 1.0]]);
    let bad = glb.floats("VEC3", &[0.0, 0.0, 0.0, f32::NAN, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    glb.primitive()["targets"][0]["POSITION"] = json!(bad);
    assert_eq!(glb.scene().triangles(), 2, "at weight 0 it does not count");
    glb.json["meshes"][0]["weights"] = json!([0.5]);
    let scene = glb.scene();
    assert_states(&scene, "1 triangles are left out");
}

#[test]
fn weights_and_channels_that_fit_no_targets_are_stated() {
    let mut glb = morphed(&[[0.0, 0.0, 1.0]]);
    glb.json["meshes"][0]["weights"] = json!([0.5, 1.0]);
    let (input, output) = (glb.floats("SCALAR", &[0.0, 1.0]), glb.floats("SCALAR", &[0.0, 0.5, 1.0]));
    glb.animate(0, "weights", "LINEAR", input, output);
    glb.push("nodes", json!({}));
    glb.animate(1, "weights", "LINEAR", input, output);
    let scene = glb.scene();
    for words in [
        "node 0 `square`: 2 weights for 1 morph targets",
        "channel 0 is left out: expected 2 values for 2 times and 1 morph targets, found 3",
        "channel 1 is left out: its node's mesh has no morph targets",
    ] {
        assert_states(&scene, words);
    }
    assert_eq!(position(&scene, 0).z, 0.5, "the weight there is");
    glb.json["meshes"][0]["weights"] = json!([1e39]);
    let scene = glb.scene();
    assert_states(&scene, "not finite are taken as 0");
    assert_eq!(position(&scene, 0).z, 0.0);
}

#[test]
fn a_target_of_another_size_is_refused() {
    let words = &["mesh 0 `mesh`, primitive 0, target 0", "4 positions, but 3 displacements of normals"];
    let case = |glb: &mut Glb| {
        let short = glb.floats("VEC3", &[0.0; 9]);
        glb.primitive()["targets"][0]["NORMAL"] = json!(short);
    };
    assert_refused(|| morphed(&[[0.0, 0.0, 1.0]]), &[("three for four", words, case)]);
}
