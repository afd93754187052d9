//! Cells of known shape.

use crate::cpu_reference::Area;
use crate::gpu::{World, assert_averaged, vector};
use interfaces::cluster_map::NONE;
use interfaces::clusters::Cluster;
use pass_test::RsmTexel;
use std::f64::consts::PI;

const SIDE: u32 = 64;

/// Distance of neighbouring texels on a floor of 2 m [m].
const STEP: f32 = 2.0 / SIDE as f32;

/// Whether a texel is in a cell.
type Holds<'a> = &'a dyn Fn(u32, u32) -> bool;

/// A floor as a sun above it sees it.
fn floor(x: u32, y: u32) -> RsmTexel {
    RsmTexel {
        position: [STEP * (x as f32 + 0.5) - 1.0, 0.0, STEP * (y as f32 + 0.5) - 1.0, 1.0],
        normal: [0.0, 1.0, 0.0],
        flux: [1.0, 2.0, 3.0, STEP * STEP],
    }
}

/// The one cluster of a cell on that floor.
fn cell(area: Area, holds: impl Fn(u32, u32) -> bool) -> Option<Cluster> {
    let world = World::new((SIDE, SIDE), floor, |x, y| if holds(x, y) { 0 } else { NONE });
    let world = World { area, ..world };
    let (header, found) = world.run()?;
    assert_averaged(&world, &header, &found);
    Some(found[0])
}

fn is_in(low: (u32, u32), high: (u32, u32)) -> impl Fn(u32, u32) -> bool {
    move |x, y| x >= low.0 && y >= low.1 && x < high.0 && y < high.1
}

/// The circle through the farthest texel is as large as the cell only if that is a disc.
#[test]
fn the_area_of_a_cell_is_that_of_its_texels() {
    let square = is_in((20, 12), (36, 28));
    let strip = is_in((4, 30), (60, 34));
    let disc = |x: u32, y: u32| (f64::from(x) - 31.5).hypot(f64::from(y) - 31.5) < 20.0;
    let cells: [(Holds<'_>, f64); 3] = [(&square, 1.38), (&strip, 10.6), (&disc, 0.995)];
    for (holds, factor) in cells {
        let texels = (0..SIDE * SIDE).filter(|i| holds(i % SIDE, i / SIDE)).count() as f64;
        let covered = texels * f64::from(STEP * STEP);
        let Some(found) = cell(Area::Texels, holds) else { return };
        assert!((f64::from(found.area) / covered - 1.0).abs() < 1e-5, "{} for {covered}", found.area);
        let Some(circle) = cell(Area::Disk, holds) else { return };
        let found = f64::from(circle.area) / covered;
        assert!((found / factor - 1.0).abs() < 0.01, "the circle is {found} times the cell, not {factor}");
    }
}

#[test]
fn a_square_has_its_middle_and_half_its_diagonal() {
    let Some(found) = cell(Area::Texels, is_in((20, 12), (28, 20))) else { return };
    let (centre, half) = ([STEP * 24.0 - 1.0, 0.0, STEP * 16.0 - 1.0], 3.5 * f64::from(STEP));
    for (found, wanted) in found.position.into_iter().zip(centre) {
        assert!((found - wanted).abs() < 1e-6, "{found} for {wanted}");
    }
    assert!((f64::from(found.radius) - half * 2f64.sqrt()).abs() < 1e-6, "{}", found.radius);
    assert_eq!((found.uv, found.texels, found.normal), ([24.0, 16.0], 64, [0.0, 1.0, 0.0]));
    // Four texels are as near to the mean: the first of them.
    assert_eq!(found.texel, 15 * SIDE + 23);
    assert_eq!((found.flux, found.centre_flux), ([64.0, 128.0, 192.0], [1.0, 2.0, 3.0]));
    let Some(circle) = cell(Area::Disk, is_in((20, 12), (28, 20))) else { return };
    assert!((f64::from(circle.area) - 2.0 * PI * half * half).abs() < 1e-6, "{}", circle.area);
}

#[test]
fn the_centre_of_a_ring_or_a_hook_is_a_texel_of_its_own() {
    let ring = |x: u32, y: u32| {
        let radius = (f64::from(x) - 32.0).hypot(f64::from(y) - 32.0);
        (12.0..16.0).contains(&radius)
    };
    let hook = |x: u32, y: u32| (10..14).contains(&x) || ((10..50).contains(&x) && y >= 60);
    let cells: [Holds<'_>; 2] = [&ring, &hook];
    for holds in cells {
        // The hole is another cluster's, and the texels at the mean are bright.
        let bright = |x: u32, y: u32| {
            let flux = if holds(x, y) { [1.0, 1.0, 1.0, 0.1] } else { [100.0, 100.0, 100.0, 0.1] };
            RsmTexel { flux, ..floor(x, y) }
        };
        let world = World::new((SIDE, SIDE), bright, |x, y| u32::from(!holds(x, y)));
        let Some((header, found)) = world.run() else { return };
        assert_averaged(&world, &header, &found);
        let mean = found[0].uv.map(|at| at as u32);
        assert!(!holds(mean[0], mean[1]), "the mean lies elsewhere: {mean:?}");
        assert_eq!(found[0].centre_flux, [1.0; 3]);
    }
}

#[test]
fn clusters_far_from_the_origin_have_their_centre() {
    // Positions are multiples of 1/16 m there; the sum of 4096 of them, of 256 m.
    let far = |x: u32, y: u32| {
        let texel = floor(x, y);
        let [px, _, pz, lit] = texel.position;
        RsmTexel { position: [1e6 + 50.0 * px, -1e6, 1e6 + 50.0 * pz, lit], ..texel }
    };
    let mut world = World::new((SIDE, SIDE), far, |_, _| 0);
    world.clusters[0].position = [1e6 - 30.0, -1e6, 1e6 + 10.0];
    let (Some((_, found)), Some(wanted)) = (world.run(), &world.expected()[0]) else { return };
    for (found, wanted) in found[0].position.into_iter().zip(wanted.position.to_array()) {
        let error = (f64::from(found) - wanted).abs();
        assert!(error <= 0.04, "{found} for {wanted}: {} of the cell", error / 100.0);
    }
}

#[test]
fn opposed_normals_keep_the_old_one() {
    let wall = |x: u32, y: u32| {
        let normal = if x.is_multiple_of(2) { [0.0, 0.0, 1.0] } else { [0.0, 0.0, -1.0] };
        RsmTexel { normal, ..floor(x, y) }
    };
    let world = World::new((SIDE, SIDE), wall, |_, _| 0);
    let Some((_, found)) = world.run() else { return };
    assert_eq!(found[0].normal, [0.6, 0.8, 0.0]);
}

#[test]
fn no_flux_is_lost_or_found() {
    let textured = |x: u32, y: u32| {
        let [r, g, b] = vector(y * SIDE + x, 5).abs().powf(4.0).to_array();
        RsmTexel { flux: [r, 10.0 * g, 0.1 * b, 0.1], ..floor(x, y) }
    };
    let cells = |x: u32, y: u32| if x < 5 { NONE } else { x / 9 + 8 * (y / 9) };
    let world = World::new((SIDE, SIDE), textured, cells);
    let Some((header, found)) = world.run() else { return };
    for channel in 0..3 {
        let of = |texel: &RsmTexel| f64::from(texel.flux[channel]);
        let whole: f64 = world.texels.iter().map(of).sum();
        let mapped = world.map.iter().zip(&world.texels).filter(|(cluster, _)| **cluster != NONE);
        let mapped: f64 = mapped.map(|(_, texel)| of(texel)).sum();
        let clusters: f64 = found.iter().map(|cluster| f64::from(cluster.flux[channel])).sum();
        for (found, wanted) in [
            (clusters, mapped),
            (f64::from(header.mapped_flux[channel]), mapped),
            (f64::from(header.map_flux[channel]), whole),
        ] {
            assert!((found / wanted - 1.0).abs() < 1e-5, "channel {channel}: {found} of {wanted}");
        }
    }
}

/// Of texels that are as near to the middle, the first is that of the centre: the same on every adapter.
#[test]
fn the_first_of_the_nearest_texels_is_the_centre() {
    for size in [(2, 1), (1, 2), (2, 2), (6, 4), (40, 40)] {
        let world = World::new(size, floor, |_, _| 0);
        let Some((_, found)) = world.run() else { return };
        let (x, y) = ((size.0 - 1) / 2, (size.1 - 1) / 2);
        assert_eq!(found[0].texel, y * size.0 + x, "{size:?}");
    }
}
