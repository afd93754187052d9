//! Tests of the table by which triangles are sampled.

use crate::common::{Glb, load_text, shipped};

#[test]
fn the_table_rises_to_the_end_in_proportion_to_area() {
    let scene = shipped("cornell-box");
    let table = scene.area_table();
    assert_eq!(table.len(), scene.triangles() + 1, "one more than triangles");
    assert_eq!((table[0], table[table.len() - 1]), (0, u32::MAX), "from none to all");
    assert!(table.windows(2).all(|pair| pair[0] < pair[1]), "every triangle of the box has area");
    // The share of the first triangle, by Heron's formula on the floor's corners.
    let corner = |i: usize| glam::Vec3::from(scene.vertices[scene.indices[i] as usize].position).as_dvec3();
    let [a, b, c] =
        [corner(0).distance(corner(1)), corner(1).distance(corner(2)), corner(2).distance(corner(0))];
    let s = (a + b + c) / 2.0;
    let share = (s * (s - a) * (s - b) * (s - c)).sqrt() / scene.area();
    assert!((f64::from(table[1]) / 4_294_967_296.0 - share).abs() < 1e-9, "share {share}");
}

/// Between two entries of the guide table lies what a search through the whole table finds.
#[test]
fn the_guide_says_where_to_search() {
    let found = |table: &[u32], number: u32| {
        let last = table.len() - 2;
        (0..=last).rev().find(|i| table[*i] <= number).expect("the first begins at 0") as u32
    };
    let empty_at_both_ends = vec![0, 0, 0, 7, 1 << 31, 1 << 31, u32::MAX, u32::MAX];
    for table in [shipped("cornell-box").area_table(), vec![0, u32::MAX], empty_at_both_ends] {
        let guide = scene::Scene::area_guide(&table);
        let bits = (guide.len() - 1).ilog2();
        assert_eq!(guide.len(), (1 << bits) + 1);
        assert_eq!(bits, (table.len() - 1).max(2).ilog2());
        for i in 0..1u32 << bits {
            let (low, high) = (i << (32 - bits), ((i + 1) << (32 - bits)).wrapping_sub(1));
            for number in [low, low + 1, high - 1, high.min(u32::MAX - 1)] {
                let between = guide[i as usize]..=guide[i as usize + 1];
                assert!(between.contains(&found(&table, number)), "{number} in {table:?}: {guide:?}");
            }
        }
    }
    assert_eq!(scene::Scene::area_guide(&[0]), [0, 0, 0], "no triangles");
}

#[test]
fn triangles_without_area_are_never_drawn() {
    let mut glb = Glb::square();
    let indices = glb.indices(&[0, 0, 1, 0, 1, 2, 3, 3, 3, 0, 2, 3]);
    glb.json["meshes"][0]["primitives"][0]["indices"] = indices.into();
    let table = glb.load().expect("degenerate triangles are legal").area_table();
    assert_eq!(table, [0, 0, 1 << 31, 1 << 31, u32::MAX], "half and half");
}

#[test]
fn without_any_area_triangles_count_alike() {
    let mut glb = Glb::square();
    let indices = glb.indices(&[0, 0, 1, 2, 2, 3]);
    glb.json["meshes"][0]["primitives"][0]["indices"] = indices.into();
    assert_eq!(glb.load().expect("legal").area_table(), [0, 1 << 31, u32::MAX], "half and half");
    let empty = load_text(r#"Scene(geometry: BuiltIn("empty"))"#).expect("legal");
    assert_eq!(empty.area_table(), [0], "no triangles");
}
