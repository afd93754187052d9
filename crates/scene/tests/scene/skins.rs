//! Skins: meshes that follow joints.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

use glam::{Mat4, Quat, Vec3, Vec4};
use scene::{Changes, MovedVertices, Scene};
use serde_json::{Value, json};

use crate::common::{
    Glb, Spoilt, assert_near, assert_refused, assert_states, assert_trait, assert_windings, folder_of,
    load_path, normal, position, scene_in, shared, states,
};

/// The influences on every vertex of the square: pairs of a joint and a weight.
type Bound<'a> = &'a [(u16, f32)];

/// A square whose vertices all follow the same joints. Its own node, which counts for nothing, is far away;
/// joint i is node i + 1, and bound where it is with no transform.
fn skinned(joints: &[Value], bound: Bound<'_>) -> Glb {
    let mut glb = Glb::square();
    glb.json["nodes"][0]["translation"] = json!([100.0, 0.0, 0.0]);
    glb.json["nodes"][0]["skin"] = json!(0);
    let nodes: Vec<usize> = joints.iter().map(|joint| glb.push("nodes", joint.clone())).collect();
    glb.push("skins", json!({ "joints": nodes }));
    for (set, four) in bound.chunks(4).enumerate() {
        let of = |i: usize| four.get(i).copied().unwrap_or_default();
        let joints: [u16; 4] = std::array::from_fn(|i| of(i).0);
        let weights: [f32; 4] = std::array::from_fn(|i| of(i).1);
        let joints = glb.fours(&joints.repeat(4), false);
        glb.attribute(&format!("JOINTS_{set}"), joints);
        let weights = glb.floats("VEC4", &weights.repeat(4));
        glb.attribute(&format!("WEIGHTS_{set}"), weights);
    }
    glb
}

fn inverse_binds(glb: &mut Glb, matrices: &[Mat4]) {
    let floats: Vec<f32> = matrices.iter().flat_map(Mat4::to_cols_array).collect();
    let accessor = glb.floats("MAT4", &floats);
    glb.json["skins"][0]["inverseBindMatrices"] = json!(accessor);
}

fn turned(axis: Vec3, angle: f32) -> Value {
    json!(Quat::from_axis_angle(axis, angle).to_array())
}

/// A joint at (1, 0, 0), turned by a right angle about z there, for a mesh that was bound to it unturned.
fn hinged() -> Glb {
    let joint = json!({ "translation": [1.0, 0.0, 0.0], "rotation": turned(Vec3::Z, FRAC_PI_2) });
    let mut glb = skinned(&[joint], &[(0, 1.0)]);
    inverse_binds(&mut glb, &[Mat4::from_translation(Vec3::NEG_X)]);
    glb
}

fn assert_corners(scene: &Scene, expected: [[f32; 3]; 4]) {
    for (vertex, expected) in expected.into_iter().enumerate() {
        let found = position(scene, vertex);
        assert!(found.abs_diff_eq(expected.into(), 1e-6), "vertex {vertex}: {found}, not {expected:?}");
    }
}

#[test]
fn a_joint_turns_vertices_about_itself_and_their_node_counts_for_nothing() {
    let scene = hinged().scene();
    // About (1, 0, 0), (x, y) − (1, 0) goes to (−y, x − 1).
    assert_corners(&scene, [[1.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, -1.0, 0.0]]);
    assert_trait(&scene, "moving_geometry", false);
    assert!(!scene.instances[0].moves, "it stays so");
    // About y, the normal turns too: z goes to x.
    let scene = skinned(&[json!({ "rotation": turned(Vec3::Y, FRAC_PI_2) })], &[(0, 1.0)]).scene();
    assert_near(normal(&scene, 0), Vec3::X);
}

#[test]
fn joints_move_with_the_joints_above_them() {
    let mut glb = skinned(&[json!({ "translation": [0.0, 0.0, 2.0] }), json!({})], &[(1, 1.0)]);
    glb.json["nodes"][1]["children"] = json!([2]);
    glb.json["scenes"] = json!([{ "nodes": [0, 1] }]);
    assert_eq!(position(&glb.scene(), 2), Vec3::new(1.0, 1.0, 2.0));
}

#[test]
fn two_joints_of_half_the_weight_blend_their_matrices() {
    let joints =
        [json!({}), json!({ "rotation": turned(Vec3::Y, FRAC_PI_2), "translation": [0.0, 0.0, 4.0] })];
    let scene = skinned(&joints, &[(0, 0.5), (1, 0.5)]).scene();
    // (x, y, 0) goes to the mean of itself and of (0, y, 4 − x).
    assert_corners(&scene, [[0.0, 0.0, 2.0], [0.5, 0.0, 1.5], [0.5, 1.0, 1.5], [0.0, 1.0, 2.0]]);
    // The mean of no turn and of a right angle is half a right angle, and shorter.
    let (sin, cos) = FRAC_PI_4.sin_cos();
    assert_near(normal(&scene, 3), Vec3::new(sin, 0.0, cos));
}

#[test]
fn sets_of_joints_add_up() {
    let joints: Vec<Value> = (0..6).map(|i| json!({ "translation": [0.0, 0.0, i] })).collect();
    let bound: Vec<(u16, f32)> = (0..6).map(|i| (i, [0.1, 0.1, 0.1, 0.1, 0.2, 0.4][i as usize])).collect();
    let scene = skinned(&joints, &bound).scene();
    // 0.1 (0 + 1 + 2 + 3) + 0.2 · 4 + 0.4 · 5.
    assert!((position(&scene, 0).z - 3.4).abs() < 1e-5, "{}", position(&scene, 0));
}

#[test]
fn joints_and_weights_are_read_in_every_format() {
    let joints: Vec<Value> = (0..300).map(|i| json!({ "translation": [0.0, 0.0, i] })).collect();
    let with = |joint: &dyn Fn(&mut Glb) -> usize, weight: &dyn Fn(&mut Glb) -> usize| {
        let mut glb = skinned(&joints, &[]);
        let (joint, weight) = (joint(&mut glb), weight(&mut glb));
        glb.attribute("JOINTS_0", joint);
        glb.attribute("WEIGHTS_0", weight);
        let scene = glb.scene();
        assert!(!states(&scene, "weights"), "{:?}", scene.repairs);
        position(&scene, 0).z
    };
    let bytes = |glb: &mut Glb| glb.fours(&[20u8, 200, 9, 9].repeat(4), false);
    let shorts = |glb: &mut Glb| glb.fours(&[20u16, 290, 9, 9].repeat(4), false);
    let floats = |glb: &mut Glb| glb.floats("VEC4", &[0.2, 0.8, 0.0, 0.0].repeat(4));
    let unit_bytes = |glb: &mut Glb| glb.fours(&[51u8, 204, 0, 0].repeat(4), true);
    let unit_shorts = |glb: &mut Glb| glb.fours(&[13107u16, 52428, 0, 0].repeat(4), true);
    for weights in [&floats as &dyn Fn(&mut Glb) -> usize, &unit_bytes, &unit_shorts] {
        assert!((with(&bytes, weights) - (0.2 * 20.0 + 0.8 * 200.0)).abs() < 1e-3, "u8");
        assert!((with(&shorts, weights) - (0.2 * 20.0 + 0.8 * 290.0)).abs() < 1e-3, "u16");
    }
}

#[test]
fn morph_targets_come_before_joints() {
    let mut glb = hinged();
    let by = glb.floats("VEC3", &[2.0, 0.0, 0.0].repeat(4));
    glb.primitive()["targets"] = json!([{ "POSITION": by }]);
    glb.json["meshes"][0]["weights"] = json!([0.5]);
    // One to the right before the turn is one up after it.
    let scene = glb.scene();
    assert_corners(&scene, [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]]);
}

#[test]
fn normals_and_windings_stay_together_through_any_joints() {
    let shear = Mat4::from_cols(Vec4::X, Vec4::new(0.7, 1.0, 0.3, 0.0), Vec4::Z, Vec4::W);
    let pairs = [
        [Mat4::from_scale(Vec3::new(1.0, 5.0, 0.2)), Mat4::IDENTITY],
        [shear, Mat4::from_quat(Quat::from_rotation_x(1.0))],
        [Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0)), Mat4::from_scale(Vec3::new(-2.0, 1.0, 0.5))],
    ];
    for [a, b] in pairs {
        let joints = [a, b].map(|matrix| json!({ "matrix": matrix.to_cols_array() }));
        let mut glb = skinned(&joints, &[(0, 0.75), (1, 0.25)]);
        let slanted = Vec3::new(0.0, -1.0, 1.0).normalize();
        let positions = glb.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 1.0, 1.0]);
        glb.attribute("POSITION", positions);
        let normals = glb.floats("VEC3", &slanted.to_array().repeat(4));
        glb.attribute("NORMAL", normals);
        let scene = glb.scene();
        assert_windings(&scene, 1e-5);
        let above = (a * 0.75 + b * 0.25).transform_point3(slanted);
        let side = (above - position(&scene, 0)).dot(normal(&scene, 0));
        assert!(side > 0.0, "{a}, {b}: the normal changes sides");
    }
}

#[test]
fn a_mesh_without_normals_is_bent_flat() {
    let mut glb = hinged();
    glb.without_normals();
    // Only vertex 2, at (1, 1, 0), follows the joint wholly; it goes to the origin.
    let still = glb.push("nodes", json!({}));
    glb.json["skins"][0]["joints"] = json!([1, still]);
    inverse_binds(&mut glb, &[Mat4::from_translation(Vec3::NEG_X), Mat4::IDENTITY]);
    let joints = glb.fours(&[1u8, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0], false);
    glb.attribute("JOINTS_0", joints);
    glb.json["nodes"][1]["translation"] = json!([1.0, 0.0, 1.0]);
    let scene = glb.scene();
    // Triangles (0, 1, 2) and (0, 2, 3), where 2 is now at (0, 0, 1): the planes y = 0 and x = 0.
    let corners = [0, 1, 2, 3, 4, 5].map(|vertex| position(&scene, vertex));
    assert!(corners[2].abs_diff_eq(Vec3::Z, 1e-6) && corners[4].abs_diff_eq(Vec3::Z, 1e-6), "{corners:?}");
    assert_near(normal(&scene, 0), Vec3::NEG_Y);
    assert_near(normal(&scene, 5), Vec3::NEG_X);
}

/// A joint that turns by a right angle about z in a second.
fn turning() -> Glb {
    let mut glb = skinned(&[json!({})], &[(0, 1.0)]);
    let input = glb.floats("SCALAR", &[0.0, 1.0]);
    let [a, b] = [0.0, FRAC_PI_2].map(|angle| Quat::from_rotation_z(angle).to_array());
    let output = glb.floats("VEC4", &[a, b].concat());
    glb.animate(1, "rotation", "LINEAR", input, output);
    glb
}

#[test]
fn animated_joints_move_the_mesh() {
    let scene = turning().scene();
    assert!(scene.instances[0].moves, "it moves");
    assert_trait(&scene, "moving_geometry", true);
    for time in [0.5, 3.5] {
        let corner = Vec3::from(scene.at(time).moved[0].vertices[1].position);
        let expected = Vec3::new(FRAC_PI_4.cos(), FRAC_PI_4.sin(), 0.0);
        assert!(corner.abs_diff_eq(expected, 1e-6), "{corner} at {time} s");
    }
    let geometry = Changes { geometry: true, ..Changes::default() };
    assert_eq!((scene.changes(0.2, 0.3), scene.changes(0.2, 1.2)), (geometry, Changes::default()));
    assert!(scene.bounds().0.x < -0.95, "the box holds the turn: {:?}", scene.bounds());
}

#[test]
fn a_skinned_meshs_own_node_may_move_and_changes_nothing() {
    let mut glb = turning();
    let (input, output) =
        (glb.floats("SCALAR", &[0.0, 2.0]), glb.floats("VEC3", &[0.0, 0.0, 0.0, 9.0, 0.0, 0.0]));
    glb.animate(0, "translation", "LINEAR", input, output);
    let scene = glb.scene();
    // From 1 to 2 s the joint holds, and only the node goes on.
    assert_eq!((scene.duration, scene.changes(1.2, 1.8)), (2.0, Changes::default()));
    assert_eq!(scene.at(1.2).moved, scene.at(1.8).moved);
}

#[test]
fn a_scene_file_places_a_skinned_model() {
    let folder = folder_of(&[("hinged.glb", &hinged().bytes())]);
    let text = r#"Scene(geometry: Objects([
        Object(name: "left", geometry: File("hinged.glb"), transform: Transform(translate: (-5, 0, 0))),
        Object(name: "right", geometry: File("hinged.glb"), transform: Transform(translate: (5, 0, 0))),
    ]), keyframes: Keyframes(objects: { "right": [Key(time: 0, translate: (5, 0, 0)), Key(time: 1, translate: (5, 9, 0))] }))"#;
    let scene = scene_in(folder.path(), text);
    assert!(position(&scene, 0).abs_diff_eq(Vec3::new(-4.0, -1.0, 0.0), 1e-5), "{}", position(&scene, 0));
    assert!(position(&scene, 4).abs_diff_eq(Vec3::new(6.0, -1.0, 0.0), 1e-5), "{}", position(&scene, 4));
    let moved = scene.at(1.0).moved;
    assert_eq!((moved.len(), moved[0].first_vertex), (1, 4), "only the right one moves");
    let corner = Vec3::from(moved[0].vertices[0].position);
    assert!(corner.abs_diff_eq(Vec3::new(6.0, 8.0, 0.0), 1e-5), "{corner}");
}

#[test]
fn a_mesh_is_shared_by_skins_and_by_nodes_without() {
    let mut glb = hinged();
    glb.push("nodes", json!({ "name": "stiff", "mesh": 0, "translation": [0.0, 0.0, 7.0] }));
    let joint = glb.push("nodes", json!({ "translation": [0.0, 0.0, 3.0] }));
    glb.push("skins", json!({ "joints": [joint] }));
    glb.push("nodes", json!({ "name": "other", "mesh": 0, "skin": 1 }));
    let scene = glb.scene();
    let names: Vec<_> = scene.instances.iter().map(|i| i.name.as_str()).collect();
    assert_eq!(names, ["square", "stiff", "other"]);
    let corners = [2, 6, 10].map(|vertex| position(&scene, vertex));
    assert!(corners[0].abs_diff_eq(Vec3::ZERO, 1e-6), "{corners:?}");
    assert_eq!(corners[1..], [Vec3::new(1.0, 1.0, 7.0), Vec3::new(1.0, 1.0, 3.0)]);
}

#[test]
fn what_cannot_be_followed_is_stated() {
    /// The words of the repair, where vertex 0 is then, how it is spoilt.
    type Case = (&'static str, [f32; 3], fn(&mut Glb));
    let cases: [Case; 5] = [
        ("weights of 4 vertices are scaled to a sum of 1", [1.0, -1.0, 0.0], |glb| {
            let weights = glb.floats("VEC4", &[0.5, 0.0, 0.0, 0.0].repeat(4));
            glb.attribute("WEIGHTS_0", weights);
        }),
        ("4 vertices have no usable weights", [1.0, -1.0, 0.0], |glb| {
            let weights = glb.floats("VEC4", &[f32::NAN, 0.0, f32::INFINITY, -1.0].repeat(4));
            glb.attribute("WEIGHTS_0", weights);
        }),
        ("part 0 of mesh `mesh` has no joints", [100.0, 0.0, 0.0], |glb| {
            let attributes = &mut glb.primitive()["attributes"];
            attributes.as_object_mut().expect("an object").retain(|name, _| !name.ends_with("_0"));
        }),
        ("its joints are not all in the scene", [100.0, 0.0, 0.0], |glb| {
            glb.json["scenes"] = json!([{ "nodes": [0] }]);
        }),
        ("2 triangles are left out", [0.0; 3], |glb| {
            glb.json["nodes"][1]["scale"] = json!([1e30, 1e30, 1e30]);
            glb.push("nodes", json!({ "mesh": 0 }));
        }),
    ];
    for (words, corner, change) in cases {
        let mut glb = hinged();
        change(&mut glb);
        let scene = glb.scene();
        assert_states(&scene, words);
        assert!(position(&scene, 0).abs_diff_eq(corner.into(), 1e-6), "{words}: {}", position(&scene, 0));
    }
}

#[test]
fn a_joint_of_no_size_gives_a_point_and_unit_normals() {
    let mut glb = hinged();
    glb.json["nodes"][1]["scale"] = json!([0.0, 0.0, 0.0]);
    let scene = glb.scene();
    assert_corners(&scene, [[1.0, 0.0, 0.0]; 4]);
    assert!((normal(&scene, 0).length() - 1.0).abs() < 1e-6, "{}", normal(&scene, 0));
}

#[test]
fn errors_name_the_skin_and_what_was_expected() {
    let cases: [Spoilt; 9] = [
        ("a missing skin", &["node `square`", "no skin 4: there are 1"], |glb| {
            glb.json["nodes"][0]["skin"] = json!(4);
        }),
        ("a missing joint", &["skin 0", "no node 9: there are 2"], |glb| {
            glb.json["skins"][0]["joints"] = json!([9]);
        }),
        ("a joint out of range", &["skin 0 has 1 joints, but vertex 3", "follows joint 5"], |glb| {
            let joints = glb.fours(&[0u8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 5, 0, 0, 0], false);
            glb.attribute("JOINTS_0", joints);
        }),
        ("no such accessor", &["skin 0", "no accessor 77"], |glb| {
            glb.json["skins"][0]["inverseBindMatrices"] = json!(77);
        }),
        ("too few matrices", &["skin 0", "1 joints, but 0 inverse bind matrices"], |glb| {
            inverse_binds(glb, &[]);
        }),
        ("a matrix of no numbers", &["skin 0", "inverse bind matrix 0 is not finite"], |glb| {
            inverse_binds(glb, &[Mat4::NAN]);
        }),
        ("joints as floats", &["expected Vec4 of U8 or U16 for joints", "F32"], |glb| {
            let joints = glb.floats("VEC4", &[0.0; 16]);
            glb.attribute("JOINTS_0", joints);
        }),
        ("weights without joints", &["mesh 0", "it has WEIGHTS_1, but no JOINTS_1"], |glb| {
            glb.attribute("WEIGHTS_1", 4);
        }),
        ("counts that differ", &["mesh 0", "4 positions, but 3 elements of WEIGHTS_0"], |glb| {
            let weights = glb.floats("VEC4", &[1.0; 12]);
            glb.attribute("WEIGHTS_0", weights);
        }),
    ];
    assert_refused(hinged, &cases);
}

/// The longest edge of each triangle of a scene, whose moved vertices are these.
fn longest_edges(scene: &Scene, moved: &[MovedVertices]) -> Vec<f32> {
    let mut positions: Vec<Vec3> = scene.vertices.iter().map(|v| v.position.into()).collect();
    for range in moved {
        for (i, vertex) in range.vertices.iter().enumerate() {
            positions[range.first_vertex as usize + i] = vertex.position.into();
            assert!((Vec3::from(vertex.normal).length() - 1.0).abs() < 1e-4, "{vertex:?}");
        }
    }
    let edges = |t: &[u32]| {
        let [a, b, c] = [0, 1, 2].map(|i| positions[t[i] as usize]);
        a.distance(b).max(b.distance(c)).max(c.distance(a))
    };
    scene.indices.chunks_exact(3).map(edges).collect()
}

#[test]
fn real_figures_move_without_tearing() {
    let Some(folder) = shared() else { return };
    // The vertices that move; how high the figure is, as the folder's README has its bind pose.
    for (name, vertices, height) in
        [("CesiumMan", 3273, 1.507), ("Fox", 1728, 78.9), ("cornell_fox_anim", 1728, 0.59)]
    {
        let scene = load_path(&folder.join(format!("{name}.glb")));
        assert!(!states(&scene, "skin") && !states(&scene, "weights"), "{name}: {:?}", scene.repairs);
        let rest = longest_edges(&scene, &[]);
        for step in 0..12 {
            let pose = scene.at(scene.duration * step as f32 / 12.0);
            assert_eq!((pose.moved.len(), pose.moved[0].vertices.len()), (1, vertices), "{name}");
            let ys = || pose.moved[0].vertices.iter().map(|v| v.position[1]);
            let (low, high) = (ys().fold(f32::INFINITY, f32::min), ys().fold(f32::NEG_INFINITY, f32::max));
            assert!(
                ((high - low) / height - 1.0).abs() < 0.15,
                "{name}: from {low} to {high} at {} s",
                pose.time
            );
            let edges = longest_edges(&scene, &pose.moved);
            let torn = edges.iter().zip(&rest).filter(|(now, rest)| **now > 2.5 * **rest + 0.02 * height);
            assert_eq!(torn.count(), 0, "{name}: edges grow too long at {} s", pose.time);
        }
        let (a, b) = (&scene.at(0.0).moved[0].vertices, &scene.at(scene.duration / 3.0).moved[0].vertices);
        let furthest = a
            .iter()
            .zip(b)
            .map(|(a, b)| Vec3::from(a.position).distance(b.position.into()))
            .fold(0.0, f32::max);
        assert!(furthest > 0.02 * height, "{name}: a limb goes {furthest}");
    }
}
