//! Mapping is the half of a step of k-means that shortens distances for given centres.

use crate::gpu::{World, number, vector};
use glam::{DVec3, Vec3};
use interfaces::cluster_map::NONE;
use interfaces::clusters::{Cluster, state};
use pass::Value;
use pass_test::RsmTexel;

/// Sum of the squared distances of all texels from the centres of their clusters.
fn spread(world: &World, map: &[u32]) -> f64 {
    let texels = map.iter().zip(&world.texels).filter(|(cluster, _)| **cluster != NONE);
    texels
        .map(|(cluster, texel)| position(texel).distance_squared(centre(&world.clusters[*cluster as usize])))
        .sum()
}

fn position(texel: &RsmTexel) -> DVec3 {
    let [x, y, z, _] = texel.position;
    Vec3::new(x, y, z).as_dvec3()
}

fn centre(cluster: &Cluster) -> DVec3 {
    Vec3::from(cluster.position).as_dvec3()
}

#[test]
fn mapping_never_moves_texels_away_from_centres() {
    let size = (60, 50);
    let texel = |i| {
        let [x, y, z] = vector(i, 1);
        // Heaps: what k-means is for.
        let heap = vector(i % 5, 9);
        RsmTexel {
            position: [heap[0] + 0.2 * x, heap[1] + 0.2 * y, heap[2] + 0.2 * z * z, 1.0],
            normal: vector(i, 2),
            flux: [1.0; 4],
        }
    };
    let cluster = |i| Cluster {
        position: vector(i, 30),
        uv: [number(i, 31), number(i, 32)],
        state: state::ALIVE,
        ..Cluster::default()
    };
    let mut world = World {
        size,
        texels: (0..size.0 * size.1).map(texel).collect(),
        importance: None,
        clusters: (0..12).map(cluster).collect(),
    };
    let settings = [("window", Value::U32(0)), ("normal_weight", Value::F32(0.0))];
    let mut before = f64::INFINITY;
    let mut spreads = Vec::new();
    let mut last = Vec::new();
    for _ in 0..8 {
        let Some(map) = world.run(&settings) else { return };
        let mapped = spread(&world, &map);
        if !last.is_empty() {
            let unmapped = spread(&world, &last);
            assert!(mapped <= unmapped * (1.0 + 1e-6), "mapping spreads {unmapped} to {mapped}");
        }
        assert!(mapped <= before * (1.0 + 1e-6), "the spread rises from {before} to {mapped}");
        before = mapped;
        spreads.push(mapped);
        for (i, cluster) in (0..).zip(&mut world.clusters) {
            let own =
                map.iter().zip(&world.texels).filter(|(of, _)| **of == i).map(|(_, texel)| position(texel));
            let (sum, count) = own.fold((DVec3::ZERO, 0.0), |(sum, count), at| (sum + at, count + 1.0));
            if count > 0.0 {
                cluster.position = (sum / count).as_vec3().to_array();
            }
        }
        last = map;
    }
    assert!(spreads[7] < 0.7 * spreads[0], "nothing was clustered: {spreads:?}");
}
