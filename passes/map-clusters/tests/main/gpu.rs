//! The shader against the CPU reference, on a GPU.

use crate::cpu_reference::{Metric, NormalDistance};
use gpu_algorithms::reference::clustering::{Texel, Texels};
use interfaces::cluster_map::NONE;
use interfaces::clusters::{Cluster, ClustersHeader, state};
use map_clusters::PASS;
use pass::Value;
use pass_test::random::{hash2, unit_float};
use pass_test::{Harness, RsmTexel};

/// The diagonal of the scene `plane`, a square of 2 m.
pub(crate) const EXTENT: f64 = 2.828_427_124_746_19;

/// A number in [0, 1).
pub(crate) fn number(element: u32, dimension: u32) -> f32 {
    unit_float(hash2(element, dimension)) as f32
}

/// Three numbers in [-1, 1).
pub(crate) fn vector(element: u32, dimension: u32) -> [f32; 3] {
    [0, 1, 2].map(|c| 2.0 * number(element, 3 * dimension + c) - 1.0)
}

/// A map, its importance, and clusters.
#[derive(Clone)]
pub(crate) struct World {
    pub(crate) size: (u32, u32),
    pub(crate) texels: Vec<RsmTexel>,
    pub(crate) importance: Option<Vec<f32>>,
    pub(crate) clusters: Vec<Cluster>,
}

impl World {
    /// Everything at random. A seventh of the texels is unlit.
    fn random(size: (u32, u32), layers: u32, clusters: u32) -> World {
        let texel = |i| {
            let [x, y, z] = vector(i, 1);
            let [r, g, b] = vector(i, 2).map(f32::abs);
            let seen = if i % 7 == 3 { 0.0 } else { 1.0 };
            RsmTexel { position: [x, y, z, seen], normal: vector(i, 3), flux: [r, g, b, 0.01] }
        };
        let cluster = |i: u32| Cluster {
            position: vector(i, 11),
            normal: vector(i, 12),
            importance: number(i, 70),
            centre_flux: vector(i, 13).map(f32::abs),
            uv: [size.0 as f32 * number(i, 71), size.1 as f32 * number(i, 72)],
            layer: hash2(i, 73) % layers,
            state: if i % 11 == 5 { state::TO_SEED } else { state::ALIVE },
            texels: i % 3,
            ..Cluster::default()
        };
        let texels: Vec<RsmTexel> = (0..size.0 * size.1 * layers).map(texel).collect();
        let importance = Some((0..texels.len() as u32).map(|i| number(i, 80)).collect());
        World { size, texels, importance, clusters: (0..clusters).map(cluster).collect() }
    }

    pub(crate) fn run(&self, set: &[(&str, Value)]) -> Option<Vec<u32>> {
        let harness = Harness::new(PASS)
            .scene("plane")
            .rsm(self.size, &self.texels)
            .clusters(&ClustersHeader::default(), &self.clusters);
        let harness = match &self.importance {
            Some(importance) => harness.importance(self.size, importance),
            None => harness,
        };
        let harness = set.iter().fold(harness, |harness, (name, value)| harness.set(name, value.clone()));
        Some(harness.run()?.read("map"))
    }

    pub(crate) fn map(&self) -> Texels {
        let importance = |i: usize| self.importance.as_ref().map_or(1.0, |importance| importance[i]);
        let texels = self.texels.iter().enumerate();
        let read = |(i, at): (usize, &RsmTexel)| Texel::read(at.position, at.normal, at.flux, importance(i));
        Texels { size: self.size.into(), texels: texels.map(read).collect() }
    }

    /// The clusters with what they are compared by: until they have texels, the importance of the one where they are.
    fn compared(&self) -> Vec<Cluster> {
        let at = |cluster: &Cluster| {
            let [x, y] = cluster.uv.map(|at| at as u32);
            ((cluster.layer * self.size.1 + y) * self.size.0 + x) as usize
        };
        let importance = |cluster: &Cluster| match &self.importance {
            Some(importance) if cluster.texels == 0 => importance[at(cluster)],
            _ => cluster.importance,
        };
        self.clusters.iter().map(|cluster| Cluster { importance: importance(cluster), ..*cluster }).collect()
    }

    /// Asserts that each texel belongs to the cluster that is the nearest to it of all.
    fn assert_nearest(&self, found: &[u32], metric: &Metric, note: &str) {
        let (map, clusters) = (self.map(), self.compared());
        let mut others = 0;
        for (i, found) in found.iter().enumerate() {
            let candidates = metric.candidates(&clusters, &map, i);
            let least = candidates.iter().min_by(|(_, a), (_, b)| a.total_cmp(b));
            let Some((nearest, least)) = least else {
                assert_eq!(*found, NONE, "{note}: texel {i} is in no window");
                continue;
            };
            let own = candidates.iter().find(|(cluster, _)| cluster == found);
            let own = own.unwrap_or_else(|| panic!("{note}: cluster {found} cannot take texel {i}")).1;
            // A few roundings of numbers of at most 1, and the arc tangent.
            assert!(own <= least + 5e-6, "{note}: texel {i} is at {own} of {found}, {least} of {nearest}");
            others += u32::from(found != nearest);
        }
        assert!(others as usize <= found.len() / 500, "{note}: {others} texels are with another cluster");
    }
}

fn set(window: u32, weights: [f32; 4]) -> Vec<(&'static str, Value)> {
    let names = ["position_weight", "normal_weight", "importance_weight", "flux_weight"];
    let weights = names.into_iter().zip(weights.map(Value::F32));
    weights.chain([("window", Value::U32(window))]).collect()
}

/// The metric of settings whose weights sum to 1.
fn metric(window: u32, weights: [f32; 4]) -> Metric {
    Metric { extent: EXTENT, window, weights: weights.map(f64::from), normals: NormalDistance::Cosine }
}

const EVEN: [f32; 4] = [0.25; 4];

#[test]
fn texels_are_with_the_nearest_of_all_clusters() {
    // Tiles that the map cuts, fewer and more clusters than a chunk has and than there are texels.
    for (size, layers, clusters) in
        [((37, 21), 1, 40), ((16, 16), 3, 300), ((40, 50), 2, 1000), ((9, 5), 1, 700), ((5, 3), 6, 1)]
    {
        let world = World::random(size, layers, clusters);
        for window in [0, 1, 6, 7, 128] {
            let Some(found) = world.run(&set(window, EVEN)) else { return };
            let note = format!("{size:?}, {layers} layers, {clusters} clusters, window {window}");
            world.assert_nearest(&found, &metric(window, EVEN), &note);
        }
    }
}

#[test]
fn each_distance_counts_by_its_weight() {
    let world = World::random((40, 50), 2, 300);
    for weights in [
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
        [0.5, 0.5, 0.0, 0.0],
    ] {
        let Some(found) = world.run(&set(20, weights)) else { return };
        world.assert_nearest(&found, &metric(20, weights), &format!("{weights:?}"));
    }
    // By the angle, the other side of a wall is far away.
    let mut settings = set(20, [0.0, 1.0, 0.0, 0.0]);
    settings.push(("normal_distance", Value::from("angle")));
    let Some(found) = world.run(&settings) else { return };
    let by_angle = Metric { normals: NormalDistance::Angle, ..metric(20, [0.0, 1.0, 0.0, 0.0]) };
    world.assert_nearest(&found, &by_angle, "angle");
}

#[test]
fn weights_are_divided_by_the_sum_of_those_that_count() {
    let mut world = World::random((40, 50), 1, 100);
    let Some(found) = world.run(&set(0, [0.8, 0.4, 0.8, 0.0])) else { return };
    world.assert_nearest(&found, &metric(0, [0.4, 0.2, 0.4, 0.0]), "with importance");
    world.importance = None;
    let Some(found) = world.run(&set(0, [0.6, 0.2, 1.0, 0.0])) else { return };
    world.assert_nearest(&found, &metric(0, [0.75, 0.25, 0.0, 0.0]), "without importance");
}

/// A flat wall, on which all clusters are as near: the mean of all that is there.
#[test]
fn of_equally_near_clusters_the_first_takes_the_texel() {
    let texel = |i: u32| RsmTexel {
        position: [0.1 * (i % 20) as f32, 0.1 * (i / 20) as f32, 0.0, 1.0],
        normal: [0.0, 0.0, 1.0],
        flux: [1.0; 4],
    };
    let cluster = |i: u32| Cluster {
        normal: [0.0, 0.0, 1.0],
        uv: [(i % 20) as f32 + 0.5, (i / 20 % 20) as f32 + 0.5],
        state: if i < 3 { state::SEEDED } else { state::ALIVE },
        ..Cluster::default()
    };
    let world = World {
        size: (20, 20),
        texels: (0..400).map(texel).collect(),
        importance: None,
        clusters: (0..600).map(cluster).collect(),
    };
    let normals = [0.0, 1.0, 0.0, 0.0];
    let Some(found) = world.run(&set(0, normals)) else { return };
    assert!(found.iter().all(|cluster| *cluster == 3), "{found:?}");
    // Windows of one texel: the first that lies there.
    let Some(found) = world.run(&set(1, normals)) else { return };
    let wanted: Vec<u32> = (0..400).map(|i| if i < 3 { i + 400 } else { i }).collect();
    assert_eq!(found, wanted);
}

#[test]
fn clusters_that_take_several_dispatches_are_those_of_one() {
    let world = World::random((40, 50), 2, 1000);
    // The same clusters, each behind 99 that take no part.
    let among = |i: u32| match i % 100 {
        99 => world.clusters[i as usize / 100],
        _ => Cluster { state: state::TO_SEED, ..Cluster::default() },
    };
    let far = World { clusters: (0..100_000).map(among).collect(), ..world.clone() };
    for window in [0, 9] {
        let (Some(whole), Some(parts)) = (world.run(&set(window, EVEN)), far.run(&set(window, EVEN))) else {
            return;
        };
        let of_parts = |cluster: &u32| if *cluster == NONE { NONE } else { 100 * cluster + 99 };
        assert_eq!(whole.iter().map(of_parts).collect::<Vec<_>>(), parts, "window {window}");
    }
}

#[test]
fn an_unlit_map_belongs_to_nobody() {
    let mut world = World::random((20, 30), 2, 50);
    for texel in &mut world.texels {
        texel.position[3] = 0.0;
    }
    let Some(found) = world.run(&set(0, EVEN)) else { return };
    assert!(found.iter().all(|cluster| *cluster == NONE));
    // Nor does a map without clusters that are alive.
    let mut world = World::random((20, 30), 2, 50);
    for cluster in &mut world.clusters {
        cluster.state = state::PLACED;
    }
    let Some(found) = world.run(&set(0, EVEN)) else { return };
    assert!(found.iter().all(|cluster| *cluster == NONE));
}

/// NaN counts as the farthest there is, and takes nothing from others.
#[test]
fn what_is_no_number_captures_nothing() {
    let mut world = World::random((40, 50), 1, 100);
    let nan = [f32::NAN; 3];
    for (i, cluster) in (0..).zip(&mut world.clusters) {
        match i % 5 {
            0 => cluster.position = nan,
            1 => cluster.normal = nan,
            2 => cluster.centre_flux = nan,
            3 => cluster.importance = f32::NAN,
            _ => {}
        }
    }
    for (i, texel) in (0..).zip(&mut world.texels) {
        match i % 9 {
            0 => texel.normal = nan,
            1 => texel.flux = [f32::NAN; 4],
            2 => texel.normal = [0.0; 3],
            4 => texel.position[1] = f32::INFINITY,
            _ => {}
        }
    }
    // In small windows, some texels are in those of such clusters alone.
    let Some(found) = world.run(&set(4, EVEN)) else { return };
    world.assert_nearest(&found, &metric(4, EVEN), "with NaN, in windows");
    let Some(found) = world.run(&set(0, EVEN)) else { return };
    world.assert_nearest(&found, &metric(0, EVEN), "with NaN");
    assert!(
        found.iter().all(|cluster| *cluster == NONE || cluster % 5 != 0),
        "a place that is none took texels"
    );
    let lit = world.map().lit().count();
    assert_eq!(found.iter().filter(|cluster| **cluster != NONE).count(), lit, "the others have a cluster");
}
