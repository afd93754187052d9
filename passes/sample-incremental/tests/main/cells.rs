//! Voronoi cells against brute force, and the directions by which they are counted.

use super::{Frame, Sampling, lamp_at, light, point_at, room};
use glam::DVec3;
use scene::LightKind;

/// Asserts that each probe belongs to the nearest site of its source, and that cells count them.
fn assert_cells_are_nearest(frame: &Frame, sampling: Sampling) {
    let mut counts = vec![0; frame.sites.len()];
    for (i, probe) in frame.probes.iter().enumerate() {
        let [source, first, end, ..] = frame.shares[i / sampling.probes as usize];
        assert_ne!(source, u32::MAX);
        let at = DVec3::from([0, 1, 2].map(|k| f64::from(probe[k])));
        let distance = |slot: usize| frame.place(slot).distance_squared(at);
        let there = (first as usize..end as usize).filter(|slot| frame.sites[*slot][3] >= 2);
        let least = there.map(distance).fold(f64::INFINITY, f64::min);
        let owner = frame.owners[i] as usize;
        assert!((first as usize..end as usize).contains(&owner), "probe {i} belongs to slot {owner}");
        // Of two that are as near up to rounding, either may be.
        assert!(distance(owner) <= least + 2e-6, "probe {i}: {} from its site, {least}", distance(owner));
        counts[owner] += 1;
    }
    let cells: Vec<u32> = frame.cells.iter().map(|cell| cell[0]).collect();
    assert_eq!(cells, counts);
}

#[test]
fn cells_are_those_of_all_pairs() {
    let sampling = Sampling { count: 150, moved: 20, probes: 40 };
    let spot = LightKind::Spot { inner: 0.3, outer: 0.6 };
    let lights = |x: f32| {
        vec![
            point_at([x, 0.1, -0.2], [1.0, 2.0, 3.0]),
            light(spot, [x, 0.0, 0.0], [1.0, 1.0, 0.2], [9.0; 3]),
            light(LightKind::Directional, [0.0; 3], [0.3, -1.0, 0.2], [1.0; 3]),
        ]
    };
    let Some(start) = sampling.frame(&room([0.5; 3], lights(0.0)), None) else { return };
    assert_cells_are_nearest(&start, sampling);
    assert_eq!(start.shares[0][..3], [0, 0, start.shares[0][2]]);
    assert_eq!(start.shares[149][2], 150);
    // After lights were lost, and others placed one after the other.
    let scene = room([0.5; 3], lights(0.4));
    let mut frame = start;
    for _ in 0..3 {
        frame = sampling.frame(&scene, Some(&frame.points)).expect("the adapter is still there");
        assert_eq!(frame.header.marked, 20);
        assert_cells_are_nearest(&frame, sampling);
    }
}

/// Probes are stratified over each domain: equal parts of it hold equally many.
#[test]
fn probes_fill_the_domain_evenly() {
    let sampling = Sampling { count: 64, moved: 1, probes: 64 };
    let Some(frame) = sampling.frame(&lamp_at([0.0; 3]), None) else { return };
    let mut octants = [0_u32; 8];
    for [x, y, z, _] in &frame.probes {
        assert!((x * x + y * y + z * z - 1.0).abs() < 1e-5);
        octants[[x, y, z]
            .into_iter()
            .enumerate()
            .map(|(bit, v)| usize::from(*v > 0.0) << bit)
            .sum::<usize>()] += 1;
    }
    // 4,096 of a (0, 2)-sequence: one in each of as many boxes, whose sides are those of the octants.
    assert!(octants.iter().all(|n| n.abs_diff(512) <= 2), "{octants:?}");

    let axis = DVec3::new(1.0, 1.0, 0.2).normalize();
    let spot = LightKind::Spot { inner: 0.3, outer: 0.6 };
    let scene = room([0.5; 3], vec![light(spot, [0.0; 3], [1.0, 1.0, 0.2], [9.0; 3])]);
    let frame = sampling.frame(&scene, None).expect("the adapter is still there");
    let cosines = frame.probes.iter().map(|p| DVec3::from([0, 1, 2].map(|k| f64::from(p[k]))).dot(axis));
    let mut rings = [0_u32; 16];
    for cosine in cosines {
        let share = (1.0 - cosine) / (1.0 - 0.6_f64.cos());
        assert!((-1e-5..1.00001).contains(&share), "{share}");
        rings[((share.clamp(0.0, 1.0) * 16.0) as usize).min(15)] += 1;
    }
    assert!(rings.iter().all(|n| n.abs_diff(256) <= 2), "{rings:?}");
}
