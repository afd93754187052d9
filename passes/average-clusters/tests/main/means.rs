//! Averaging is the half of a step of k-means that shortens distances for given cells.

use crate::cpu_reference::Averaged;
use crate::gpu::{World, vector};
use glam::{DVec3, Vec3};
use interfaces::cluster_map::NONE;
use interfaces::clusters::{Cluster, state};
use pass_test::RsmTexel;

const COUNT: u32 = 12;

fn centres_of(clusters: &[Cluster]) -> Vec<DVec3> {
    clusters.iter().map(|cluster| Vec3::from(cluster.position).as_dvec3()).collect()
}

/// Sum of the squared distances of all texels from the centres of their clusters.
fn spread(world: &World, centres: &[DVec3]) -> f64 {
    let rsm = world.rsm();
    let texels = rsm.lit().filter(|(i, ..)| world.map[*i] != NONE);
    texels.map(|(i, _, texel)| texel.position.distance_squared(centres[world.map[i] as usize])).sum()
}

/// Gives each texel to the nearest cluster that is alive.
fn map(world: &mut World, centres: &[DVec3]) {
    let rsm = world.rsm();
    for (i, _, texel) in rsm.lit() {
        let alive = (0..).zip(&world.clusters).filter(|(_, cluster)| cluster.state == state::ALIVE);
        let distance = |c: u32| centres[c as usize].distance_squared(texel.position);
        let nearest = alive.map(|(c, _)| (c, distance(c))).min_by(|(_, a), (_, b)| a.total_cmp(b));
        world.map[i] = nearest.map_or(NONE, |(c, _)| c);
    }
}

fn heaps() -> World {
    let texel = |x: u32, y: u32| {
        let i = 60 * y + x;
        let at = vector(i % 5, 9) + 0.2 * vector(i, 1) * vector(i, 2).abs();
        RsmTexel { position: at.extend(1.0).to_array(), normal: [0.0, 0.0, 1.0], flux: [1.0; 4] }
    };
    let mut world = World::new((60, 50), texel, |x, _| x % COUNT);
    for (i, cluster) in (0..).zip(&mut world.clusters) {
        cluster.position = vector(i, 30).to_array();
    }
    world
}

/// Runs eight steps; `average` gives the centres of the next, or `None` where there is no GPU.
fn assert_converges(mut world: World, average: impl Fn(&World) -> Option<Vec<Cluster>>) {
    let mut spreads = Vec::new();
    for _ in 0..8 {
        let centres = centres_of(&world.clusters);
        map(&mut world, &centres);
        let before = spread(&world, &centres);
        let Some(averaged) = average(&world) else { return };
        let after = spread(&world, &centres_of(&averaged));
        assert!(after <= before * (1.0 + 1e-6), "averages spread {before} to {after}");
        let last = spreads.last().copied().unwrap_or(f64::INFINITY);
        assert!(after <= last * (1.0 + 1e-6), "the spread rises from {last} to {after}");
        spreads.push(after);
        world.clusters = averaged;
    }
    assert!(spreads[7] < 0.9 * spreads[0], "nothing was clustered: {spreads:?}");
}

#[test]
fn k_means_never_spreads_what_it_clusters() {
    assert_converges(heaps(), |world| {
        let moved = |(old, now): (&Cluster, Option<Averaged>)| match now {
            Some(now) => Cluster { position: now.position.as_vec3().to_array(), ..*old },
            None => Cluster { state: state::TO_SEED, ..*old },
        };
        Some(world.clusters.iter().zip(world.expected()).map(moved).collect())
    });
}

#[test]
fn k_means_never_spreads_what_it_clusters_on_the_gpu() {
    assert_converges(heaps(), |world| Some(world.run()?.1));
}
