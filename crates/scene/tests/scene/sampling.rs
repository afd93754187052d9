//! Tests of the table by which triangles are sampled.

use crate::common::{Glb, built_in, shipped};

#[test]
fn the_table_rises_to_the_end_in_proportion_to_area() {
    let scene = shipped("cornell-box");
    let table = scene.area_table();
    assert_eq!(table.len(), scene.triangles() + 1, "one more than triangles");
    assert_eq!((table[0], table[table.len() - 1]), (0, u32::MAX), "from none to all");
    assert!(table.windows(2).all(|pair| pair[0] < pair[1]), "every triangle of the box has area");
    // The share of each triangle, by Heron's formula on its corners.
    let corner = |i: usize| glam::Vec3::from(scene.vertices[scene.indices[i] as usize].position).as_dvec3();
    for (i, pair) in table.windows(2).enumerate() {
        let [a, b, c] = [0, 1, 2].map(|k| corner(3 * i + k).distance(corner(3 * i + (k + 1) % 3)));
        let s = (a + b + c) / 2.0;
        let share = (s * (s - a) * (s - b) * (s - c)).sqrt() / scene.area();
        let found = f64::from(pair[1] - pair[0]) / 4_294_967_296.0;
        assert!((found - share).abs() < 1e-9, "triangle {i}: {found}, not {share}");
    }
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
    glb.primitive()["indices"] = indices.into();
    let table = glb.scene().area_table();
    assert_eq!(table, [0, 0, 1 << 31, 1 << 31, u32::MAX], "half and half");
}

#[test]
fn without_any_area_triangles_count_alike() {
    let mut glb = Glb::square();
    let indices = glb.indices(&[0, 0, 1, 2, 2, 3]);
    glb.primitive()["indices"] = indices.into();
    assert_eq!(glb.scene().area_table(), [0, 1 << 31, u32::MAX], "half and half");
    let empty = built_in("empty");
    assert_eq!(empty.area_table(), [0], "no triangles");
}

/// The share of the numbers that sample each emitter, by the columns of the table.
fn probabilities(emitters: &scene::Emitters) -> Vec<[f64; 2]> {
    let share = |from: u32, to: u32| f64::from(to - from) / 4_294_967_296.0;
    let of = |pair: &[scene::Emitter]| {
        [share(pair[0].for_photons, pair[1].for_photons), share(pair[0].for_paths, pair[1].for_paths)]
    };
    emitters.table.windows(2).map(of).collect()
}

fn assert_near(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-6 * expected.abs(), "{found}, not {expected}");
}

#[test]
fn the_lamp_is_two_emitters() {
    let scene = shipped("cornell-box-lamp");
    let emitters = scene.emitters();
    let emits = |triangle: u32| {
        let vertex = scene.indices[3 * triangle as usize] as usize;
        scene.materials[scene.vertices[vertex].material as usize].is_emissive()
    };
    let triangles: Vec<u32> = emitters.table.iter().map(|emitter| emitter.triangle).collect();
    let lamp: Vec<u32> = (0..scene.triangles() as u32).filter(|triangle| emits(*triangle)).collect();
    assert_eq!(triangles, [lamp, vec![u32::MAX]].concat());
    assert_eq!(triangles.len(), 3);
    for shares in probabilities(&emitters) {
        shares.iter().for_each(|share| assert_near(*share, 0.5));
    }
    // 130 mm × 105 mm, from both sides.
    let luminance = 0.2126 * 17.0 + 0.7152 * 12.0 + 0.0722 * 4.0;
    let power = 2.0 * std::f64::consts::PI * 0.13 * 0.105 * luminance;
    assert_near(f64::from(emitters.power), power);
}

#[test]
fn without_emitters_the_table_is_one_entry() {
    let end = scene::Emitter { triangle: u32::MAX, for_photons: 0, for_paths: 0 };
    let dark = shipped("cornell-box").emitters();
    assert_eq!((dark.power, dark.table), (0.0, vec![end]));
    let empty = built_in("empty");
    assert_eq!(empty.emitters().table, [end]);
}

/// The first of three squares emits nothing, the second a quarter of the third, by the mean of its texture.
#[test]
fn emitters_count_by_power_and_paths_sample_the_brighter_ones() {
    let mut scene = shipped("plane");
    let (vertices, indices) = (scene.vertices.clone(), scene.indices.clone());
    let dark = scene.materials[0].clone();
    scene.materials = vec![dark; 3];
    (1..3).for_each(|i| scene.materials[i].emission = glam::Vec3::splat(8.0));
    // Half of the texels are black, half as bright as 188 in sRGB: 0.5029 of linear light.
    let pixels = [[0, 0, 0, 255], [188, 188, 188, 0]].concat();
    scene.textures.push(scene::Texture {
        name: String::new(),
        width: 2,
        height: 1,
        pixels,
        encoding: scene::Encoding::Srgb,
        wrap: [scene::Wrap::Repeat; 2],
    });
    scene.materials[1].emission_texture = Some(0);
    for material in 1..3 {
        let first = scene.vertices.len() as u32;
        scene.vertices.extend(vertices.iter().map(|vertex| scene::Vertex { material, ..*vertex }));
        scene.indices.extend(indices.iter().map(|i| first + i));
    }
    let emitters = scene.emitters();
    let mean = 0.5 * ((188.0 / 255.0 + 0.055) / 1.055_f64).powf(2.4);
    let area = scene.area() / 3.0;
    assert!(
        (f64::from(emitters.power) / (2.0 * std::f64::consts::PI * area * 8.0 * (1.0 + mean)) - 1.0).abs()
            < 1e-6
    );
    let [textured, plain] = [mean / (1.0 + mean), 1.0 / (1.0 + mean)];
    // The mean of all surfaces is 8 (1 + mean) / 3: the third is 2.4 times as bright.
    let expected = [[textured / 2.0, 0.0], [textured / 2.0, 0.0], [plain / 2.0, 0.5], [plain / 2.0, 0.5]];
    for (found, expected) in probabilities(&emitters).into_iter().zip(expected) {
        std::iter::zip(found, expected).for_each(|(found, expected)| assert_near(found, expected));
    }
    // Where everything emits alike, paths sample nothing.
    scene.materials.iter_mut().for_each(|material| material.emission = glam::Vec3::ONE);
    scene.materials[1].emission_texture = None;
    assert!(scene.emitters().table.iter().all(|emitter| emitter.for_paths == 0));
    assert!(probabilities(&scene.emitters()).iter().all(|[photons, _]| (photons - 1.0 / 6.0).abs() < 1e-6));
}

/// The triangles emit any power, and are of any size.
#[test]
fn tables_of_extreme_emitters_rise_to_the_end() {
    for emission in [1e-38, 1e37, f32::MAX] {
        let mut scene = shipped("cornell-box-lamp");
        let lamp = scene.materials.iter_mut().find(|material| material.is_emissive()).expect("it emits");
        lamp.emission = glam::Vec3::splat(emission);
        let emitters = scene.emitters();
        assert!(emitters.power.is_finite(), "{emission}");
        let last = emitters.table[2];
        assert_eq!((last.for_photons, last.for_paths), (u32::MAX, u32::MAX), "{emission}");
    }
}
