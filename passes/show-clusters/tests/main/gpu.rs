//! The shader against the CPU reference, on a floor under a spot.

use crate::cpu_reference::{IN_SHADOW, Projection, color_of};
use glam::{DVec2, DVec3, UVec2, Vec3, dvec3, uvec2};
use interfaces::cluster_map::NONE;
use interfaces::clusters::{Cluster, ClustersHeader};
use pass_test::random::hash;
use pass_test::view::floor_seen;
use pass_test::{Harness, RsmTexel};
use scene::{LightKind, Scene};
use show_clusters::PASS;

const WIDTH: u32 = 80;
const HEIGHT: u32 = 60;
const MAP: u32 = 64;

/// The square of the scene `plane` (y = 0, side 2) under a spot 1 m above it, whose map reaches 0.7 m to each side.
fn scene() -> Scene {
    let mut scene = pass_test::scene("plane");
    let outer = 0.7f32.atan();
    scene.lights[0].kind = LightKind::Spot { inner: outer, outer };
    scene
}

fn projection() -> Projection {
    Projection { size: UVec2::splat(MAP), half_extent: DVec2::splat(0.7), perspective: true }
}

/// Right and up of the spot's layer.
fn axes() -> [DVec3; 2] {
    let along = Vec3::NEG_Y;
    let right = along.cross(along.any_orthonormal_vector()).normalize();
    [right, right.cross(along)].map(|axis| axis.as_dvec3())
}

/// A point in the space of the layer.
fn in_layer(at: DVec3) -> DVec3 {
    let offset = at - DVec3::Y;
    let [right, up] = axes();
    dvec3(offset.dot(right), offset.dot(up), offset.y)
}

/// The point where the ray of a texel's centre meets the floor.
fn on_floor(texel: UVec2) -> DVec3 {
    let plane = ((texel.as_dvec2() + 0.5) / f64::from(MAP) * 2.0 - 1.0) * DVec2::new(0.7, -0.7);
    let [right, up] = axes();
    plane.x * right + plane.y * up
}

/// The cluster of a texel: cells of 9×9, and a column of none.
fn cluster_of(texel: UVec2) -> u32 {
    if texel.x >= 60 { NONE } else { texel.x / 9 + 8 * (texel.y / 9) }
}

/// Distance along the axis: a plate half way, in a corner of the map.
fn seen(texel: UVec2) -> f32 {
    if texel.x < 20 && texel.y < 25 { 0.5 } else { 1.0 }
}

fn show(scene: &Scene, clusters: &[Cluster], dot: f32) -> Option<Vec<[u8; 4]>> {
    show_with(scene, clusters, dot, &[])
}

/// The same with further layers of the map.
fn show_with(scene: &Scene, clusters: &[Cluster], dot: f32, more: &[RsmTexel]) -> Option<Vec<[u8; 4]>> {
    let texels = || (0..MAP * MAP).map(|i| uvec2(i % MAP, i / MAP));
    let mut rsm: Vec<RsmTexel> = texels()
        .map(|texel| {
            let position = on_floor(texel).as_vec3().extend(seen(texel)).to_array();
            RsmTexel { position, normal: [0.0, 1.0, 0.0], flux: [1.0; 4] }
        })
        .collect();
    rsm.extend(more);
    let depth = |i| floor_seen(scene, (WIDTH, HEIGHT), i).map_or(0.0, |(depth, _)| depth);
    let outputs = Harness::new(PASS)
        .set("dot", dot)
        .with_scene(scene.clone())
        .frame(WIDTH, HEIGHT)
        .rsm((MAP, MAP), &rsm)
        .clusters(&ClustersHeader::default(), clusters)
        .cluster_map((MAP, MAP), &texels().map(cluster_of).collect::<Vec<_>>(), clusters.len() as u32)
        .seen(|x, y| (depth(y * WIDTH + x), [0.0, 1.0, 0.0]))
        .run()?;
    Some(outputs.read("display"))
}

/// The clusters, whose centres are at the middle of their cells.
fn clusters() -> Vec<Cluster> {
    (0..64)
        .map(|i| Cluster {
            texel: (9 * (i / 8) + 4).min(MAP - 1) * MAP + 9 * (i % 8) + 4,
            ..Cluster::default()
        })
        .collect()
}

fn bytes(color: DVec3) -> [u8; 4] {
    let [r, g, b] = color.to_array().map(|x| (255.0 * x).round() as u8);
    [r, g, b, 255]
}

#[test]
fn each_pixel_has_the_color_of_its_cell() {
    let scene = scene();
    let Some(found) = show(&scene, &clusters(), 0.0) else { return };
    let (mut lit, mut dark, mut unmapped, mut outside, mut wrong) = (0, 0, 0, 0, 0);
    for (i, found) in (0..).zip(&found) {
        let Some((_, at)) = floor_seen(&scene, (WIDTH, HEIGHT), i) else {
            assert_eq!(*found, [0, 0, 0, 255], "nothing is seen");
            continue;
        };
        let receiver = in_layer(at);
        let expected = match projection().texel_of(receiver) {
            None => {
                outside += 1;
                DVec3::splat(0.1)
            }
            Some(texel) => {
                let index = cluster_of(texel);
                unmapped += u32::from(index == NONE);
                let color = if index == NONE { DVec3::splat(0.4) } else { color_of(index, hash(index)) };
                let is_lit = projection().is_lit(receiver, DVec3::Z, f64::from(seen(texel)));
                *(if is_lit { &mut lit } else { &mut dark }) += 1;
                color * if is_lit { 1.0 } else { IN_SHADOW }
            }
        };
        let differs = bytes(expected).into_iter().zip(*found).any(|(a, b)| a.abs_diff(b) > 1);
        wrong += u32::from(differs);
    }
    assert!(lit > 200 && dark > 50 && unmapped > 20 && outside > 200, "{lit} {dark} {unmapped} {outside}");
    // A pixel on the edge of a texel may fall to either side.
    assert!(wrong <= (lit + dark) / 100, "{wrong} pixels differ");
}

#[test]
fn dots_lie_at_the_centres() {
    let scene = scene();
    let (Some(plain), Some(dotted)) = (show(&scene, &clusters(), 0.0), show(&scene, &clusters(), 2.0)) else {
        return;
    };
    let pixel = 2.0 * f64::from(scene.camera.vertical_fov * 0.5).tan() / f64::from(HEIGHT);
    let mut dots = 0;
    for (i, (plain, dotted)) in (0..).zip(plain.iter().zip(&dotted)) {
        let Some((depth, at)) = floor_seen(&scene, (WIDTH, HEIGHT), i) else { continue };
        let index = projection().texel_of(in_layer(at)).map_or(NONE, cluster_of);
        let centre = clusters()
            .get(index as usize)
            .map(|cluster| on_floor(uvec2(cluster.texel % MAP, cluster.texel / MAP)));
        let away = centre.map_or(f64::INFINITY, |centre| centre.distance(at)) / (pixel * f64::from(depth));
        if (away - 2.0).abs() < 0.01 {
            continue;
        }
        let expected = if away < 2.0 { [0, 0, 0, 255] } else { *plain };
        assert_eq!(*dotted, expected, "pixel {i}, {away} px from the centre of {index}");
        dots += u32::from(away < 2.0);
    }
    assert!(dots > 50, "{dots} pixels are in a dot");
    // Without a texel there is no centre.
    let gone = vec![Cluster { texel: u32::MAX, ..Cluster::default() }; 64];
    assert!(show(&scene, &gone, 2.0).is_some_and(|shown| shown == plain));
}

/// A dot lies where its layer of the map has its texel.
#[test]
fn dots_lie_in_the_layer_of_their_texel() {
    let scene = scene();
    // What the other layer sees is far away.
    let far = vec![
        RsmTexel { position: [1e3, 1e3, 1e3, 1.0], normal: [0.0, 1.0, 0.0], flux: [1.0; 4] };
        (MAP * MAP) as usize
    ];
    let in_the_other: Vec<Cluster> = clusters()
        .into_iter()
        .map(|cluster| Cluster { texel: cluster.texel + MAP * MAP, ..cluster })
        .collect();
    let (Some(plain), Some(alone)) = (show(&scene, &clusters(), 0.0), show(&scene, &clusters(), 2.0)) else {
        return;
    };
    let (Some(own), Some(other)) =
        (show_with(&scene, &clusters(), 2.0, &far), show_with(&scene, &in_the_other, 2.0, &far))
    else {
        return;
    };
    assert!(alone != plain && own == alone, "a further layer moves no dots");
    assert!(other == plain, "dots that are far away are not seen");
}
