//! The element of the sequence that each cluster gets, and when all begin again.

mod cpu_reference;

use cpu_reference::{element, seed};
use interfaces::clusters::{self, Cluster, ClustersHeader, NO_TEXEL, state};
use pass_test::Harness;
use pass_test::random::{halton3, hash2};
use seed_clusters::PASS;
use std::collections::HashSet;

type Clusters = (ClustersHeader, Vec<Cluster>);

fn halton(seed: u32) -> impl Fn(u32) -> [f64; 2] {
    let seed = pass::pass_seed(seed, "seed-clusters");
    move |element| {
        let [u, v, _] = halton3(element, seed);
        [u, v]
    }
}

fn run(harness: Harness<'_>) -> Option<Clusters> {
    let bytes: Vec<u8> = harness.run()?.read("seeded");
    Some(clusters::from_bytes(&bytes).expect("there are as many clusters as the header says"))
}

/// The pass with this past.
fn after(past: &Clusters) -> Harness<'static> {
    Harness::new(PASS).clusters(&past.0, &past.1)
}

/// Clusters in all states, seeded up to three times.
fn some(count: u32) -> Clusters {
    let cluster = |i: u32| Cluster {
        position: [i as f32, 2.0, 3.0],
        area: 1.5,
        importance: 0.25,
        flux: [1.0, 2.0, i as f32],
        texel: i,
        uv: [i as f32 + 0.5, 7.5],
        layer: i % 3,
        texels: 12,
        generation: hash2(i, 1) % 4,
        state: hash2(i, 2) % 4,
        delta: 0.5,
        mean_delta: 0.75,
        ..Cluster::default()
    };
    let header = ClustersHeader {
        count,
        alive: 5,
        vanished: 2,
        merged: 3,
        split: 1,
        iteration: 17,
        greatest_area: 1.5,
        mean_share: 0.375,
        share_variance: 0.125,
        mapped_flux: [1.0, 2.0, 3.0],
        map_flux: [4.0, 5.0, 6.0],
        ..ClustersHeader::default()
    };
    (header, (0..count).map(cluster).collect())
}

/// Asserts that all is equal, a seed but for rounding.
fn assert_same(found: &Clusters, expected: &Clusters) {
    assert_eq!(found.0, expected.0);
    assert_eq!(found.1.len(), expected.1.len());
    for (i, (found, expected)) in std::iter::zip(&found.1, &expected.1).enumerate() {
        let rounded = std::iter::zip(found.uv, expected.uv).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(rounded, "cluster {i}: {:?} for {:?}", found.uv, expected.uv);
        assert_eq!(*found, Cluster { uv: found.uv, ..*expected }, "cluster {i}");
    }
}

#[test]
fn all_variants_of_the_shader_are_valid() {
    pass_test::assert_shaders_are_valid(PASS);
}

#[test]
fn the_first_frame_has_the_first_elements() {
    for count in [1, 2, 128, 1000, 65_536] {
        for run_seed in [0, 7] {
            let harness = || Harness::new(PASS).set("count", count).seed(run_seed);
            let Some(found) = run(harness()) else { return };
            assert_same(&found, &seed(None, count, halton(run_seed)));
            // A history buffer that holds nothing yet is as none.
            let looped = run(harness().feedback("clusters", "seeded")).unwrap();
            assert_eq!(looped, found);
        }
    }
    let plain = run(Harness::new(PASS).set("count", 3)).unwrap().1;
    let third = 1.0 / 3.0;
    let expected = [[0.5, third], [0.25, 2.0 * third], [0.75, third / 3.0]];
    for (cluster, expected) in plain.iter().zip(expected) {
        let near = std::iter::zip(cluster.uv, expected).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(
            near && (cluster.generation, cluster.texels, cluster.texel) == (1, 0, NO_TEXEL),
            "{cluster:?}"
        );
    }
}

#[test]
fn only_clusters_that_wait_are_seeded() {
    for count in [1, 64, 65, 300] {
        let past = some(count);
        let Some(found) = run(after(&past).set("count", count).seed(3)) else { return };
        assert_same(&found, &seed(Some(past.clone()), count, halton(3)));
        let waited = past.1.iter().filter(|cluster| cluster.state == state::TO_SEED).count();
        let changed = std::iter::zip(&past.1, &found.1).filter(|(before, now)| before != now).count();
        assert_eq!(changed, waited);
    }
}

/// A seeded cluster stays so until another pass sends it back.
#[test]
fn seeds_wait_to_be_warped() {
    let harness = || Harness::new(PASS).feedback("clusters", "seeded");
    let Some(one) = run(harness()) else { return };
    assert_eq!(run(harness().frames(4)).unwrap(), one);
}

#[test]
fn another_number_of_clusters_begins_anew() {
    for before in [1, 63, 65, 4096] {
        let Some(found) = run(after(&some(before)).set("count", 64)) else { return };
        assert_same(&found, &seed(None, 64, halton(0)));
    }
}

#[test]
fn a_restart_forgets_all() {
    let Some(found) = run(after(&some(100)).set("count", 100).set("restart", true).seed(5)) else { return };
    assert_same(&found, &seed(None, 100, halton(5)));
}

/// Whichever clusters are seeded again, and how often: an element that one has had is never had again.
#[test]
fn no_element_is_used_twice() {
    for count in [1, 7, 128] {
        let mut used = HashSet::new();
        let mut clusters =
            (ClustersHeader { count, ..Default::default() }, vec![Cluster::default(); count as usize]);
        for frame in 0..200 {
            for (i, cluster) in (0..).zip(&mut clusters.1) {
                if frame > 0 && hash2(frame, i).is_multiple_of(3) {
                    cluster.state = state::TO_SEED;
                }
                if cluster.state == state::TO_SEED {
                    assert!(used.insert(element(i, cluster.generation, count)), "{count}, frame {frame}");
                }
            }
            clusters = seed(Some(clusters), count, halton(0));
        }
        // Together with all that are yet to come they are the sequence without gaps.
        let most = clusters.1.iter().map(|cluster| cluster.generation).max().unwrap_or(0);
        for (i, cluster) in (0..).zip(&clusters.1) {
            let rest = cluster.generation..most;
            assert!(rest.into_iter().all(|generation| used.insert(element(i, generation, count))));
        }
        assert_eq!(used, (1..=count * most).collect());
    }
}

/// The number of elements passes 2³² after 65,536 generations of the most clusters: the sequence begins again.
#[test]
fn elements_wrap_around() {
    assert_eq!(element(65_535, 65_535, 65_536), 0);
    assert_eq!(element(0, 65_536, 65_536), 1);
    let old = |generation| Cluster { generation, ..Cluster::default() };
    let past =
        (ClustersHeader { count: 2, ..Default::default() }, vec![old(u32::MAX / 2), old(2_000_000_000)]);
    let Some(found) = run(after(&past).set("count", 2)) else { return };
    for cluster in found.1 {
        assert!(cluster.uv.iter().all(|x| (0.0..1.0).contains(x)), "{cluster:?}");
    }
}
