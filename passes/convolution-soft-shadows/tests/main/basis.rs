//! The basis images themselves.

use crate::cpu_reference::{Expansion, Map};
use crate::{Atlas, NOTHING, Random, expansion, stride};
use glam::{DVec2, UVec2};

/// The pairs of a packed word.
fn unpacked(word: u32) -> [f64; 2] {
    [word as u16, (word >> 16) as u16].map(|half| f64::from(half as i16) / 32767.0)
}

#[test]
fn images_agree_with_the_cpu_reference() {
    for (tile, order) in [(16, 4), (13, 4), (5, 1), (8, 6), (24, 16), (1, 4), (2, 16)] {
        let atlas = Atlas::rough(tile, 3);
        let by = expansion(tile, order);
        let Some(words) = atlas.basis(by) else { return };
        let order = order as usize;
        let stride = stride(tile, by);
        for (map, words) in atlas.reference(by).iter().zip(words.chunks(stride)) {
            let far = f64::from(f32::from_bits(words[0]));
            assert!((far - map.far).abs() <= 1e-6 * map.far, "{far} m for {} m", map.far);
            let mut images = words[1..].chunks(2 * order + 1);
            for (level, texels) in (1..).zip(&map.levels) {
                for (i, texel) in texels.iter().enumerate() {
                    let image = images.next().expect("an image for each texel");
                    let mean = f64::from(f32::from_bits(image[2 * order])) - texel[order][0];
                    assert!(mean.abs() < 1e-6, "{tile}², level {level}, {i}: {mean}");
                    for k in 0..order {
                        let pairs = [image[k], image[order + k]].map(unpacked);
                        for (got, wanted) in pairs.iter().flatten().zip(&texel[k]) {
                            // Rounding to 16 bits once a level, and sines of f32.
                            let most = 1.6e-5 * f64::from(level) + 1e-5;
                            let error = (got - wanted).abs();
                            assert!(
                                error < most,
                                "{tile}², order {k} of {order}, level {level}, {i}: {error}"
                            );
                        }
                    }
                }
            }
            assert!(images.next().is_none(), "{tile}²: there are images that no texel has");
        }
    }
}

/// A map of one level whose texels have these depths below `far` m, all straight ahead of the light or nearly.
fn level_of(depths: &[f64], by: Expansion) -> Map {
    let tile = 64;
    let side = (depths.len() as f64).sqrt() as u32;
    let stored = |i: u32| {
        // The middle, where directions are near the light's normal; farthest in one corner.
        let place = UVec2::new(i % tile, i / tile);
        let begin = (tile - side) / 2;
        let inside = place.cmpge(UVec2::splat(begin)).all() && place.cmplt(UVec2::splat(begin + side)).all();
        let at = gpu_algorithms::reference::paraboloid::texel_centre(place, tile);
        let r2 = at.length_squared();
        let up = (1.0 + r2) / (1.0 - r2);
        let depth = match inside {
            true => depths[((place.y - begin) * side + place.x - begin) as usize] / by.greatest(),
            false => 1.0,
        };
        if r2 < 0.99 { depth * 3.0 * up } else { NOTHING }
    };
    Map::new((0..tile * tile).map(stored).collect(), tile, by)
}

/// The share in front of a depth and its mean depth, by Eq. 3.4 and 3.5, are those of the texels of a region.
#[test]
fn blockers_of_a_region_are_those_of_brute_force() {
    let mut random = Random(3);
    for (order, most_share, most_depth) in [(4, 0.012, 0.02), (8, 0.01, 0.012), (16, 0.01, 0.01)] {
        let by = Expansion { levels: 4, ..expansion(64, order) };
        for _ in 0..20 {
            // Nothing within the width of the step about what is compared, nor where the step repeats itself.
            let compared = 0.45 + 0.1 * random.unit();
            let wide = 0.6 / f64::from(order);
            let depth = |random: &mut Random| match random.below(3) {
                0 => (compared + wide + (by.greatest() - compared - wide) * random.unit()).min(by.greatest()),
                _ => 0.1 + (compared - wide - 0.1) * random.unit(),
            };
            let depths: Vec<f64> = (0..1024).map(|_| depth(&mut random)).collect();
            let map = level_of(&depths, by);
            for level in [1_u32, 3, 4] {
                let texel = UVec2::splat(32 >> level);
                let centre = (texel.as_dvec2() + 0.5) * f64::from(1 << level);
                let region = map.depths(level, texel);
                let front: Vec<f64> = region.iter().copied().filter(|z| *z < compared).collect();
                let share = front.len() as f64 / region.len() as f64;
                let got = map.find_blockers(compared, &map.interpolated(level, centre));
                assert!((got.share - share).abs() < most_share, "order {order}: {} for {share}", got.share);
                if share > 0.2 {
                    let wanted = front.iter().sum::<f64>() / front.len() as f64;
                    let error = (got.depth - wanted).abs();
                    assert!(error < most_depth / share, "order {order}, {share}: {} for {wanted}", got.depth);
                }
            }
        }
    }
}

/// Where 2×2 texels are equal, level 1 is not filtered, and a high order is the depth test of one texel.
#[test]
fn high_orders_without_filtering_are_the_depth_test() {
    let mut random = Random(5);
    let by = Expansion { levels: 1, ..expansion(64, 16) };
    let blocks: Vec<f64> = (0..256).map(|_| by.greatest() * random.unit()).collect();
    let depths: Vec<f64> = (0..1024).map(|i| blocks[i / 64 * 16 + i % 32 / 2]).collect();
    let map = level_of(&depths, by);
    let mut looked_up = 0;
    for i in 0..256_u32 {
        let texel = UVec2::new(8 + i % 16, 8 + i / 16);
        let terms = map.interpolated(1, (texel.as_dvec2() + 0.5) * 2.0);
        for j in 0..40 {
            let compared = by.greatest() * f64::from(j) / 40.0;
            let away = (blocks[i as usize] - compared).abs();
            // Of the width of the step, and of where it repeats itself.
            if away < by.nearer() {
                continue;
            }
            let wanted = if compared <= blocks[i as usize] { 1.0 } else { 0.0 };
            let got = map.seen_share(compared, &terms);
            assert!((got - wanted).abs() < 0.01, "{got} for {wanted}, {away} from the step");
            looked_up += 1;
        }
    }
    assert!(looked_up > 8000, "{looked_up} lookups");
}

#[test]
fn the_step_rings_as_little_as_the_readme_says() {
    for order in 1..=16 {
        let by = expansion(64, order);
        for i in 0..=1000 {
            let depth = f64::from(i) / 1000.0 * by.greatest();
            for j in 0..=1000 {
                let compared = f64::from(j) / 1000.0 * by.greatest();
                let seen = by.seen_at_depth(compared, depth);
                let wanted = if compared <= depth { 1.0 } else { 0.0 };
                let away = (compared - depth).abs();
                assert!(away < by.nearer() || (seen - wanted).abs() < 0.012, "order {order}: {seen}, {away}");
            }
        }
    }
}

/// Bits of a map's images do not depend on the maps beside it, whatever the side.
#[test]
fn a_map_is_filtered_by_itself() {
    for tile in [5, 8, 13] {
        let by = expansion(tile, 4);
        let atlas = Atlas::rough(tile, 3);
        let mut other = atlas.clone();
        let beside = Atlas::rough(tile, 6);
        other.maps[0].clone_from(&beside.maps[4]);
        other.maps[2].clone_from(&beside.maps[5]);
        let (Some(words), Some(others)) = (atlas.basis(by), other.basis(by)) else { return };
        let stride = stride(tile, by);
        assert!(words[..stride] != others[..stride], "the neighbours are others");
        assert_eq!(words[stride..2 * stride], others[stride..2 * stride], "{tile}²");
    }
}

/// Interpolation beyond the edge of a map takes what is at the edge.
#[test]
fn interpolation_stays_in_the_map() {
    let by = expansion(13, 4);
    let map = &Atlas::rough(13, 1).reference(by)[0];
    for level in 1..=4 {
        let inside = map.interpolated(level, DVec2::splat(0.5 * f64::from(1 << level)));
        let corner = map.interpolated(level, DVec2::ZERO);
        assert_eq!(inside, corner, "level {level}");
    }
}
