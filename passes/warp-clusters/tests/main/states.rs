//! Clusters that are no seeds, and the header.

use crate::cpu_reference::{Pyramid, Texel};
use crate::maps::{Run, importance, map, run};
use interfaces::clusters::{Cluster, ClustersHeader, state};
use pass_test::random::{halton3, hash2, unit_float};

const SIZE: [u32; 2] = [24, 18];

/// A map of which a third is unlit.
fn holes() -> Pyramid {
    let texels = map(&importance(SIZE, 2), SIZE).texels.into_iter().enumerate();
    let texels = texels.map(|(i, texel)| Texel {
        position: texel.position.filter(|_| !hash2(i as u32, 8).is_multiple_of(3)),
        ..texel
    });
    Pyramid::new(texels.collect(), SIZE)
}

/// Clusters in all states; places of splits reach beyond the map.
fn clusters(count: u32) -> Vec<Cluster> {
    let number = |i: u32, salt: u32| unit_float(hash2(hash2(i, 90), salt)) as f32;
    let cluster = |i: u32| {
        let state = hash2(i, 91) % 4;
        let uv = match state {
            state::SEEDED => [number(i, 0), number(i, 1)],
            _ => [number(i, 0) * 30.0 - 3.0, number(i, 1) * 24.0 - 3.0],
        };
        Cluster {
            position: [1.0, i as f32, 3.0],
            area: 2.0,
            radius: 0.5,
            texels: 7,
            uv,
            layer: hash2(i, 92) % 2,
            generation: 1 + hash2(i, 93) % 3,
            state,
            delta: 0.25,
            mean_delta: 0.5,
            ..Cluster::default()
        }
    };
    (0..count).map(cluster).collect()
}

#[test]
fn clusters_in_all_states_become_what_the_cpu_reference_makes_of_them() {
    let map = holes();
    for (count, seed) in [(1, 0), (700, 0), (700, 4)] {
        let given = clusters(count);
        let header =
            ClustersHeader { alive: 3, merged: 2, iteration: 9, map_flux: [1.0; 3], ..Default::default() };
        let Some(found) = run(&map, &given, Run { seed, header, ..Run::default() }) else { return };
        let pass_seed = pass::pass_seed(seed, "warp-clusters");
        let (mut elsewhere, mut again) = (0, 0);
        for (i, (found, before)) in (0..).zip(found.iter().zip(&given)) {
            let halton = |element| [halton3(element, pass_seed)[0], halton3(element, pass_seed)[1]];
            let expected = map.warp(i, count, before, 0, halton);
            again += u32::from(before.state == state::PLACED && expected.generation > before.generation);
            if found.texel != expected.texel {
                elsewhere += 1;
                continue;
            }
            let near = std::iter::zip(found.uv, expected.uv).all(|(a, b)| (a - b).abs() < 0.02);
            assert!(near, "cluster {i}: {:?} for {:?}", found.uv, expected.uv);
            let normals = std::iter::zip(found.normal, expected.normal);
            assert!(normals.into_iter().all(|(a, b)| (a - b).abs() < 1e-6));
            assert_eq!(*found, Cluster { uv: found.uv, normal: found.normal, ..expected }, "cluster {i}");
        }
        assert!(elsewhere <= 2, "{elsewhere} of {count} are elsewhere");
        assert!(count == 1 || again > 20, "{again} splits met unlit texels, which is what this is to test");
    }
}

#[test]
fn clusters_that_are_no_seeds_pass_unchanged() {
    let given = clusters(300);
    let Some(found) = run(&holes(), &given, Run::default()) else { return };
    for (before, after) in given.iter().zip(&found) {
        let waits = [state::SEEDED, state::PLACED].contains(&before.state);
        assert_eq!(before == after, !waits, "{before:?} became {after:?}");
    }
}

/// A split stays where it is, whatever the importance, and at the edge if it is beyond.
#[test]
fn splits_stay_where_they_are() {
    let map = map(&importance(SIZE, 2), SIZE);
    let given: Vec<Cluster> =
        clusters(300).into_iter().map(|cluster| Cluster { state: state::PLACED, ..cluster }).collect();
    let Some(found) = run(&map, &given, Run::default()) else { return };
    for (before, after) in given.iter().zip(&found) {
        let within = |axis: usize| before.uv[axis].clamp(0.0, (SIZE[axis] as f32).next_down());
        assert_eq!((after.uv, after.layer), ([within(0), within(1)], before.layer));
        assert_eq!((after.state, after.generation), (state::ALIVE, before.generation));
        let [x, y] = after.uv.map(|at| at as u32);
        assert_eq!(after.texel, (before.layer * SIZE[1] + y) * SIZE[0] + x);
    }
}
