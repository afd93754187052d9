//! Hole filling on maps whose answer is known.

mod cpu_reference;

use cpu_reference::{Level, pull_push, pull_push_by, pulled, pulled_median};
use pass::LARGEST_WINDOW;
use pass_test::{Harness, elements};

const HOLE: f64 = f64::INFINITY;

fn level(side: usize, value: impl Fn(usize, usize) -> f64) -> Level {
    Level { side, depth: (0..side * side).map(|i| value(i % side, i / side)).collect() }
}

/// A hash in [0, 1) of a texel.
fn noise(x: usize, y: usize) -> f64 {
    let mixed = (x as u64 * 0x9e37_79b9 + y as u64 * 0x85eb_ca6b + 1).wrapping_mul(0xff51_afd7_ed55_8ccd);
    (mixed >> 40) as f64 / f64::from(1 << 24)
}

#[test]
fn a_flat_map_with_holes_fills_to_the_flat_depth() {
    for side in [2, 3, 8, 64, 65] {
        let holes = level(side, |x, y| if noise(x, y) < 0.7 && (x, y) != (1, 1) { HOLE } else { 3.0 });
        // As many levels as reach across a map of holes but one.
        let filled = pull_push(&holes, 4, 0.05, 0.05);
        assert_eq!(filled, level(side, |_, _| 3.0), "side {side}");
    }
}

#[test]
fn holes_larger_than_the_pyramid_stay() {
    // One texel of level 2 reaches its own 4×4 block, and by interpolation half of that beyond.
    let one = level(64, |x, y| if (x, y) == (33, 33) { 2.0 } else { HOLE });
    let filled = pull_push(&one, 2, 0.05, 0.05);
    let at = |x: usize, y: usize| filled.depth[y * 64 + x];
    assert_eq!(at(32, 35), 2.0, "the block of the texel is filled");
    assert_eq!(at(20, 33), HOLE, "twelve texels away nothing is known");
}

#[test]
fn nothing_stays_nothing() {
    for side in [1, 2, 3, 64] {
        let empty = level(side, |_, _| HOLE);
        assert_eq!(pull_push(&empty, 2, 0.05, 0.05), empty, "side {side}");
    }
}

#[test]
fn a_single_texel_is_kept() {
    let one = level(1, |_, _| 7.0);
    for levels in 0..=4 {
        assert_eq!(pull_push(&one, levels, 0.05, 0.05), one, "{levels} levels");
    }
}

#[test]
fn no_level_leaves_the_map_as_it_is() {
    let map = level(16, |x, y| if noise(x, y) < 0.5 { HOLE } else { 1.0 + noise(y, x) });
    assert_eq!(pull_push(&map, 0, 0.05, 0.05), map);
}

#[test]
fn background_seen_through_a_surface_is_an_outlier() {
    // A wall at 1 m with a texel of the wall behind it, at 5 m, showing through in each 4×4 block.
    let leaky = level(64, |x, y| if x % 4 == 1 && y % 4 == 2 { 5.0 } else { 1.0 });
    let closed = pull_push(&leaky, 2, 0.05, 0.05);
    assert_eq!(closed, level(64, |_, _| 1.0));
}

#[test]
fn surfaces_that_lie_close_together_are_kept() {
    let slanted = level(64, |x, _| 2.0 + 0.001 * x as f64);
    assert_eq!(pull_push(&slanted, 2, 0.05, 0.05), slanted);
}

#[test]
fn both_sides_of_a_silhouette_keep_their_depth() {
    // The edge lies between blocks, so no coarse texel has both surfaces.
    let edge = level(64, |x, y| {
        if noise(x, y) < 0.5 {
            HOLE
        } else if x < 32 {
            1.0
        } else {
            6.0
        }
    });
    let filled = pull_push(&edge, 2, 0.05, 0.05);
    for (i, depth) in filled.depth.iter().enumerate() {
        // A block of the finest level without any point takes its neighbour's depth, on either side.
        assert!(*depth == 1.0 || *depth == 6.0, "texel {i} is between the surfaces: {depth}");
    }
    let kept =
        edge.depth.iter().zip(&filled.depth).filter(|(own, _)| own.is_finite()).all(|(own, new)| own == new);
    assert!(kept, "what was splatted is not an outlier");
}

#[test]
fn only_values_close_to_each_other_are_averaged() {
    assert_eq!(pulled([1.0, 1.5, HOLE, 1.25], 0.5), 1.25);
    assert_eq!(pulled([1.0, 1.2, HOLE, 9.0], 0.5), HOLE);
    assert_eq!(pulled([HOLE; 4], 0.5), HOLE);
    assert_eq!(pulled([4.0, HOLE, HOLE, HOLE], 0.0), 4.0);
}

#[test]
fn the_median_leaves_out_holes_and_outliers_but_mixes_no_surfaces() {
    assert_eq!(pulled_median([HOLE; 4], 0.5), HOLE);
    assert_eq!(pulled_median([HOLE, 4.0, HOLE, HOLE], 0.0), 4.0);
    assert_eq!(pulled_median([1.5, HOLE, HOLE, 1.0], 0.5), 1.25);
    assert_eq!(pulled_median([HOLE, 9.0, HOLE, 1.0], 0.5), HOLE, "no surface has the majority");
    assert_eq!(pulled_median([9.0, 1.0, HOLE, 1.2], 0.5), 1.2, "the middle one of three");
    assert_eq!(pulled_median([9.0, 1.0, 2.0, 1.5], 0.5), 1.75);
    assert_eq!(pulled_median([9.0, 1.0, 9.0, 1.0], 0.5), HOLE);
}

#[test]
fn the_median_fills_where_the_mean_gives_up() {
    // Of each 2×2 block a hole, an outlier and two of the wall.
    let rough = level(32, |x, y| match (x % 2, y % 2) {
        (0, 0) => HOLE,
        (1, 1) => 7.0,
        _ => 1.0,
    });
    let closed = level(32, |_, _| 1.0);
    assert_eq!(pull_push_by(pulled_median, &rough, 2, 0.05, 0.05), closed);
    assert_eq!(pull_push(&rough, 2, 0.05, 0.05), rough, "by the mean, all coarse texels are holes");
}

/// A map with holes, two surfaces and points of the far one showing through.
fn rough(side: usize, salt: usize) -> Level {
    level(side, |x, y| {
        let surface = if (x + salt) % 11 < 6 { 1.0 } else { 2.5 };
        match noise(x + 31 * salt, y) {
            r if r < 0.55 => HOLE,
            r if r < 0.65 => 3.0 + r,
            r => surface + 0.1 * r,
        }
    })
}

#[test]
fn the_gpu_agrees_with_the_cpu_reference() {
    // The scene `plane` is a square of 2 m.
    let extent = 8f64.sqrt();
    let mean = ("mean", pulled as fn([f64; 4], f64) -> f64);
    let median = ("median", pulled_median as fn([f64; 4], f64) -> f64);
    // The last atlases have a layer for each map.
    // By a threshold of the whole extent, only holes are pushed into.
    for (side, levels, layer, (by, combined), push) in [
        (1, 2, 8192, mean, 0.05),
        (2, 1, 8192, mean, 0.05),
        (3, 2, 8192, mean, 1.0),
        (5, 0, 8192, mean, 0.05),
        (8, 4, 8192, mean, 0.05),
        (64, 2, 8192, mean, 0.05),
        (65, 3, 8192, mean, 0.05),
        (65, 3, 8192, mean, 0.3),
        (65, 3, 8192, mean, 1.0),
        (130, 2, 8192, mean, 0.05),
        (3, 2, 8192, median, 0.05),
        (65, 3, 8192, median, 1.0),
        (8, 2, 15, mean, 0.05),
        (5, 1, 9, median, 0.05),
    ] {
        let maps: Vec<Level> = (0..3).map(|salt| rough(side, salt)).collect();
        let bits: Vec<u32> =
            maps.iter().flat_map(|map| &map.depth).map(|depth| (*depth as f32).to_bits()).collect();
        let pass = pull_push::PullPush { side: layer, window: LARGEST_WINDOW };
        let outputs = Harness::new(&pass)
            .scene("plane")
            .set("levels", levels)
            .set("pull", by)
            .set("push_threshold", push)
            .input("depth", "DepthAtlas", &[("tile", side as u32), ("count", 3)], elements(&bits))
            .fact("depth_bias", 1.0)
            .fact("slope_bias", 0.0)
            .run();
        let Some(outputs) = outputs else { return };
        let layers = outputs.desc("visibility.atlas").texture().map(|texture| texture.layers);
        assert_eq!(layers, Some(if layer < 8192 { 3 } else { 1 }));
        let atlas: Vec<f32> = outputs.read("visibility.atlas");
        let columns = outputs.fact("visibility", "columns").as_u32().expect("a number") as usize;
        for (m, map) in maps.iter().enumerate() {
            let push = f64::from(push) * extent;
            let wanted = pull_push_by(combined, map, levels, 0.05 * extent, push);
            for (i, wanted) in wanted.depth.iter().enumerate() {
                let (x, y) = (m % columns * side + i % side, m / columns * side + i / side);
                let got = f64::from(atlas[y * columns * side + x]);
                let wanted = wanted.min(3.0e38);
                assert!(
                    (got - wanted).abs() <= 1e-5 * wanted,
                    "map {m} of {side}², {levels} levels, texel {i}: {got} for {wanted}"
                );
            }
        }
    }
}

#[test]
fn maps_that_are_bound_in_parts_are_filled_as_in_one() {
    // 130 maps in parts of 64, and in layers of 25: a part ends within a layer, and a layer within a part.
    let bits: Vec<u32> =
        (0..130).flat_map(|salt| rough(8, salt).depth).map(|depth| (depth as f32).to_bits()).collect();
    let filled = |window| {
        let pass = pull_push::PullPush { side: 40, window };
        let outputs = Harness::new(&pass)
            .scene("plane")
            .set("levels", 3)
            .input("depth", "DepthAtlas", &[("tile", 8), ("count", 130)], elements(&bits))
            .fact("depth_bias", 1.0)
            .fact("slope_bias", 0.0)
            .run()?;
        Some(outputs.read::<u32>("visibility.atlas"))
    };
    let Some(whole) = filled(LARGEST_WINDOW) else { return };
    assert!(whole == filled(1).expect("the adapter is still there"), "texels differ");
}
