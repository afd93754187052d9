//! The shaders against the CPU reference, on a GPU.

use crate::cpu_reference::Pyramid;
use crate::maps::{Run, halton, importance, independent, map, outputs, run, seeds, warped};
use interfaces::clusters::{NO_TEXEL, state};
use pass_test::random::{hash, hash2, unit_float};
use pass_test::statistics::assert_follows;

#[test]
fn sums_are_those_of_the_cpu_reference() {
    let wide = |i: u32| 10.0_f64.powf(76.0 * unit_float(hash2(i, 5)) - 38.0) as f32;
    for (size, layers) in [([1, 1], 1), ([1, 1], 4), ([3, 1], 2), ([2, 2], 1), ([300, 7], 1), ([33, 65], 3)] {
        let texels = size[0] * size[1] * layers;
        for importance in
            [importance(size, layers), (0..texels).map(wide).collect(), vec![f32::MAX; texels as usize]]
        {
            let map = map(&importance, size);
            let Some(found) = outputs(&map, &seeds(&halton(1)), Run::default()) else { return };
            let sums: Vec<(f64, i32)> = found
                .read::<[u32; 2]>("pyramid")
                .iter()
                .map(|[value, exponent]| (f64::from(f32::from_bits(*value)), *exponent as i32))
                .collect();
            let expected: Vec<f64> = map.sums[1..].iter().flatten().copied().collect();
            assert!(sums.len() >= expected.len());
            for (i, ((value, exponent), expected)) in sums.iter().zip(&expected).enumerate() {
                let found = if *value == 0.0 { 0.0 } else { value * 2.0_f64.powi(*exponent) };
                assert!(
                    (found - expected).abs() <= 1e-6 * expected,
                    "{size:?}, sum {i}: {found} for {expected}"
                );
            }
        }
    }
}

/// Asserts that clusters are where the CPU reference has them, and have what is there.
fn compare(map: &Pyramid, of: &[[f64; 2]], levels: u32) {
    let Some(found) = warped(map, of, levels) else { return };
    let total: f64 = map.sums[0].iter().sum();
    let bottom = if levels == 0 { 0 } else { map.top().saturating_sub(levels) };
    let mut elsewhere = 0;
    for (i, (found, seed)) in found.iter().zip(of).enumerate() {
        let place = map.warp_seed(seed.map(|x| f64::from(x as f32)), bottom);
        let expected = map.cluster_at(&place, 1);
        // A number within rounding of where two squares meet may go to either.
        if found.texel != expected.texel {
            elsewhere += 1;
            continue;
        }
        // Numbers of 24 bits are spread over a texel that had 2^-10 of them: 14 bits are left.
        let share = map.sums[0].get(expected.texel as usize).map_or(0.0, |importance| importance / total);
        let near = |axis: usize| {
            let difference = f64::from((found.uv[axis] - expected.uv[axis]).abs());
            difference <= 1e-4 + 3e-6 / share.max(1e-9) || bottom > 0
        };
        let lit = expected.state == state::ALIVE;
        assert!(!lit || (near(0) && near(1)), "cluster {i}: {:?} for {:?}", found.uv, expected.uv);
        let normals = std::iter::zip(found.normal, expected.normal);
        assert!(normals.into_iter().all(|(a, b)| (a - b).abs() < 1e-6), "cluster {i}: {:?}", found.normal);
        let rounded = interfaces::clusters::Cluster { uv: found.uv, normal: found.normal, ..expected };
        assert_eq!(*found, rounded, "cluster {i}");
    }
    assert!(elsewhere <= 2 + of.len() / 500, "{:?}: {elsewhere} of {} are elsewhere", map.size, of.len());
}

#[test]
fn seeds_go_where_the_cpu_reference_takes_them() {
    for (size, layers) in [
        ([1, 1], 1),
        ([1, 1], 6),
        ([3, 3], 1),
        ([3, 1], 4),
        ([300, 300], 1),
        ([300, 2], 3),
        ([12, 7], 6),
        ([64, 64], 2),
    ] {
        let map = map(&importance(size, layers), size);
        for levels in [0, 1, 3, 15] {
            compare(&map, &halton(1000), levels);
            compare(&map, &independent(1000, 9), levels);
        }
    }
}

#[test]
fn seeds_follow_the_importance() {
    const COUNT: u32 = 65_536;
    for (size, layers) in [([12, 7], 1), ([12, 7], 5), ([31, 17], 2)] {
        let map = map(&importance(size, layers), size);
        for seeds in [halton(COUNT), independent(COUNT, 4)] {
            let Some(found) = warped(&map, &seeds, 0) else { return };
            let mut counts = vec![0; map.texels.len()];
            for cluster in &found {
                assert_eq!(cluster.state, state::ALIVE);
                counts[cluster.texel as usize] += 1;
            }
            let total: f64 = map.sums[0].iter().sum();
            let expected: Vec<f64> = map.sums[0].iter().map(|f| f / total * f64::from(COUNT)).collect();
            assert_follows(&counts, &expected);
            assert!(counts.iter().zip(&map.sums[0]).all(|(n, f)| *n == 0 || *f > 0.0));
        }
    }
}

#[test]
fn the_scale_of_the_importance_does_not_matter() {
    let size = [40, 30];
    let base = importance(size, 3);
    let of_scale = |scale: f32| {
        let scaled: Vec<f32> = base.iter().map(|f| f / 128.0 * scale).collect();
        let found = warped(&map(&scaled, size), &halton(2000), 0)?;
        Some(found.iter().map(|cluster| (cluster.texel, cluster.uv.map(f32::to_bits))).collect::<Vec<_>>())
    };
    let Some(one) = of_scale(1.0) else { return };
    // Powers of two, so that no rounding differs; the least is not denormal.
    for exponent in [-110, -40, 40, 127] {
        assert!(of_scale(2.0_f32.powi(exponent)).unwrap() == one, "2^{exponent}");
    }
}

#[test]
fn all_orders_of_magnitude_in_one_map() {
    let size = [40, 40];
    let wide: Vec<f32> = (0..3200_u32)
        .map(|i| if i % 5 == 0 { 0.0 } else { 10.0_f64.powf(76.0 * unit_float(hash(i)) - 38.0) as f32 })
        .collect();
    compare(&map(&wide, size), &halton(1000), 0);
    // Of the least and the greatest weight that a layer can have, the greatest alone counts.
    let mut far = vec![1e-38_f32; 3200];
    far[1700] = 3e38;
    let Some(found) = warped(&map(&far, size), &halton(1000), 0) else { return };
    assert!(found.iter().all(|cluster| cluster.texel == 1700));
    // All of them greatest: their sum is 10^42. Elements of the sequence would lie where texels of one weight meet.
    compare(&map(&[f32::MAX; 3200], size), &independent(1000, 6), 0);
    compare(&map(&[f32::MIN_POSITIVE; 3200], size), &independent(1000, 6), 0);
}

#[test]
fn strange_importance_counts_as_none() {
    let mut strange = vec![0.0_f32; 64];
    (strange[3], strange[9], strange[20], strange[40]) = (f32::NAN, -f32::NAN, -5.0, f32::NEG_INFINITY);
    strange[33] = 0.5;
    let Some(found) = warped(&map(&strange, [8, 8]), &halton(500), 0) else { return };
    assert!(found.iter().all(|cluster| cluster.texel == 33));
    strange[50] = f32::INFINITY;
    let found = warped(&map(&strange, [8, 8]), &halton(500), 0).unwrap();
    assert!(found.iter().all(|cluster| cluster.texel == 50));
}

#[test]
fn a_single_lit_texel_takes_all() {
    for (size, layers, at) in [([8, 8], 1, 63), ([300, 3], 1, 299), ([5, 5], 6, 130), ([1, 1], 3, 2)] {
        let mut map = map(&vec![1.0; (size[0] * size[1] * layers) as usize], size);
        for (i, texel) in map.texels.iter_mut().enumerate() {
            if i != at {
                texel.position = None;
            }
        }
        let map = Pyramid::new(map.texels, size);
        let Some(found) = warped(&map, &halton(200), 0) else { return };
        assert!(found.iter().all(|cluster| cluster.texel == at as u32 && cluster.state == state::ALIVE));
        compare(&map, &halton(200), 0);
    }
}

/// Seeds stay as even as they are; those that fall to unlit texels wait for their next.
#[test]
fn without_importance_seeds_are_even() {
    let size = [20, 12];
    let texels = map(&[0.0; 720], size).texels.into_iter().enumerate();
    let half = texels.map(|(i, texel)| crate::cpu_reference::Texel {
        position: texel.position.filter(|_| i % 2 == 0),
        ..texel
    });
    let map = Pyramid::new(half.collect(), size);
    compare(&map, &halton(1000), 0);
    let Some(found) = run(&map, &seeds(&halton(1000)), Run::default()) else { return };
    let lost = found.iter().filter(|cluster| cluster.state == state::TO_SEED).count();
    assert!((450..550).contains(&lost), "{lost} of 1000 fell to the unlit half");
    for cluster in found.iter().filter(|cluster| cluster.state == state::TO_SEED) {
        assert_eq!(
            (cluster.texel, cluster.texels, cluster.generation, cluster.flux),
            (NO_TEXEL, 0, 1, [0.0; 3])
        );
    }
    // Nothing is lit at all.
    let dark: Vec<_> = map.texels.iter().map(|_| Default::default()).collect();
    let found = run(&Pyramid::new(dark, size), &seeds(&halton(70)), Run::default()).unwrap();
    assert!(found.iter().all(|cluster| cluster.state == state::TO_SEED && cluster.texel == NO_TEXEL));
}
