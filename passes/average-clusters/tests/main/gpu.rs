//! The shaders against the CPU reference, on a GPU.

use crate::cpu_reference::{Area, Averaged, average, map_flux, summarise};
use average_clusters::PASS;
use glam::{DVec3, Vec2, Vec3, uvec2};
use gpu_algorithms::reference::clustering::{Texel, Texels, window_of};
use interfaces::cluster_map::NONE;
use interfaces::clusters::{Cluster, ClustersHeader, NO_TEXEL, from_bytes, state};
use pass_test::random::{hash2, unit_float};
use pass_test::{Harness, RsmTexel};

/// A number in [0, 1).
pub(crate) fn number(element: u32, dimension: u32) -> f32 {
    unit_float(hash2(element, dimension)) as f32
}

/// Three numbers in [-1, 1).
pub(crate) fn vector(element: u32, dimension: u32) -> Vec3 {
    Vec3::from([0, 1, 2].map(|c| 2.0 * number(element, 3 * dimension + c) - 1.0))
}

/// A map, its importance, and clusters with their texels.
#[derive(Clone)]
pub(crate) struct World {
    pub(crate) size: (u32, u32),
    pub(crate) texels: Vec<RsmTexel>,
    pub(crate) importance: Option<Vec<f32>>,
    pub(crate) clusters: Vec<Cluster>,
    /// The cluster of each texel.
    pub(crate) map: Vec<u32>,
    pub(crate) area: Area,
}

impl World {
    /// A map whose texels are all lit and in the first cluster, unless `texel` and `of` say otherwise.
    pub(crate) fn new(
        size: (u32, u32),
        texel: impl Fn(u32, u32) -> RsmTexel,
        of: impl Fn(u32, u32) -> u32,
    ) -> World {
        let places = || (0..size.0 * size.1).map(|i| (i % size.0, i / size.0));
        let map: Vec<u32> = places().map(|(x, y)| of(x, y)).collect();
        let count = map.iter().filter(|cluster| **cluster != NONE).max().map_or(1, |last| last + 1);
        let cluster = Cluster { normal: [0.6, 0.8, 0.0], state: state::ALIVE, ..Cluster::default() };
        World {
            size,
            texels: places().map(|(x, y)| texel(x, y)).collect(),
            importance: None,
            clusters: vec![cluster; count as usize],
            map,
            area: Area::Texels,
        }
    }

    /// Everything at random: a seventh of the texels is unlit, others are within a window of this side around their cluster, or in a
    /// cluster that may not be alive or is in another layer.
    fn random(size: (u32, u32), layers: u32, clusters: u32, window: u32) -> World {
        let texel = |i| {
            let seen = if i % 7 == 3 { 0.0 } else { 1.0 };
            let (normal, flux) = (vector(i, 2), vector(i, 3).abs());
            RsmTexel {
                position: vector(i, 1).extend(seen).to_array(),
                normal: (normal + Vec3::Y).to_array(),
                flux: flux.extend(0.1 * number(i, 20)).to_array(),
            }
        };
        let cluster = |i: u32| Cluster {
            position: vector(i, 11).to_array(),
            normal: [0.0, 0.6, 0.8],
            uv: [size.0 as f32 * number(i, 71), size.1 as f32 * number(i, 72)],
            layer: hash2(i, 73) % layers,
            state: if i % 11 == 5 { state::SEEDED } else { state::ALIVE },
            generation: i,
            delta: 0.25,
            ..Cluster::default()
        };
        let clusters: Vec<Cluster> = (0..clusters).map(cluster).collect();
        let texels: Vec<RsmTexel> = (0..size.0 * size.1 * layers).map(texel).collect();
        let of = |i: u32| {
            let (x, y, layer) = (i % size.0, i / size.0 % size.1, i / (size.0 * size.1));
            let takes = |c: &u32| {
                let cluster = &clusters[*c as usize];
                let window = window_of(Vec2::from(cluster.uv).as_dvec2(), window, size.into());
                texels[i as usize].position[3] > 0.0 && cluster.layer == layer && window.holds(uvec2(x, y))
            };
            let tried = (0..40).map(|k| hash2(i, 100 + k) % clusters.len() as u32);
            let stray = hash2(i, 99) % clusters.len() as u32;
            let is_stray = i % 50 == 9 && texels[i as usize].position[3] > 0.0;
            if is_stray { stray } else { tried.clone().find(takes).unwrap_or(NONE) }
        };
        let map = (0..texels.len() as u32).map(of).collect();
        let importance = Some((0..texels.len() as u32).map(|i| number(i, 80)).collect());
        World { size, importance, clusters, map, texels, area: Area::Texels }
    }

    pub(crate) fn run(&self) -> Option<(ClustersHeader, Vec<Cluster>)> {
        let header = ClustersHeader { merged: 3, split: 2, iteration: 41, ..ClustersHeader::default() };
        let harness = Harness::new(PASS)
            .set("area", if self.area == Area::Disk { "disk" } else { "texels" })
            .rsm(self.size, &self.texels)
            .clusters(&header, &self.clusters)
            .cluster_map(self.size, &self.map, self.clusters.len() as u32);
        let harness = match &self.importance {
            Some(importance) => harness.importance(self.size, importance),
            None => harness,
        };
        from_bytes(&harness.run()?.read("averaged"))
    }

    pub(crate) fn rsm(&self) -> Texels {
        let importance = |i: usize| self.importance.as_ref().map_or(1.0, |importance| importance[i]);
        let texels = self.texels.iter().enumerate();
        let read = |(i, at): (usize, &RsmTexel)| Texel::read(at.position, at.normal, at.flux, importance(i));
        Texels { size: self.size.into(), texels: texels.map(read).collect() }
    }

    pub(crate) fn expected(&self) -> Vec<Option<Averaged>> {
        let rsm = self.rsm();
        let numbered = (0..).zip(&self.clusters);
        numbered.map(|(i, old)| average(i, old, &self.map, &rsm, self.area)).collect()
    }
}

/// Whether a number differs by no more than that share of the other, and of `unit`.
fn assert_close(found: f32, wanted: f64, share: f64, note: &str) {
    let error = (f64::from(found) - wanted).abs();
    assert!(error <= share * wanted.abs().max(1e-3), "{note}: {found} for {wanted}");
}

fn assert_near(found: [f32; 3], wanted: DVec3, share: f64, note: &str) {
    let error = Vec3::from(found).as_dvec3().distance(wanted);
    assert!(error <= share * wanted.length().max(1.0), "{note}: {found:?} for {wanted}");
}

/// Asserts that the GPU gave what the CPU reference says.
pub(crate) fn assert_averaged(world: &World, header: &ClustersHeader, found: &[Cluster]) {
    let (expected, rsm) = (world.expected(), world.rsm());
    assert_eq!(found.len(), expected.len());
    for (i, (found, old)) in found.iter().zip(&world.clusters).enumerate() {
        let note = format!("cluster {i}");
        assert_eq!((found.generation, found.layer, found.delta), (old.generation, old.layer, old.delta));
        let Some(wanted) = &expected[i] else {
            assert_eq!(found.state, state::TO_SEED, "{note}");
            assert_eq!((found.texels, found.texel), (0, NO_TEXEL), "{note}");
            assert_eq!((found.area, found.radius, found.flux), (0.0, 0.0, [0.0; 3]), "{note}");
            assert_eq!(found.centre_flux, [0.0; 3], "{note}");
            continue;
        };
        assert_eq!((found.state, found.texels), (state::ALIVE, wanted.texels.len() as u32), "{note}");
        // Sums of thousands of offsets, in single precision; normals, whose sum may be short, have fewer digits.
        assert_near(found.position, wanted.position, 1e-5, &note);
        assert_near(found.normal, wanted.normal, 1e-3, &note);
        assert_near(found.flux, wanted.flux, 1e-5, &note);
        assert_close(found.importance, wanted.importance, 1e-5, &note);
        assert_close(found.area, wanted.area, 1e-4, &note);
        assert_close(found.radius, wanted.radius, 1e-4, &note);
        let uv = Vec2::from(found.uv).as_dvec2();
        assert!(uv.distance(wanted.uv) < 1e-3, "{note}: {uv} for {}", wanted.uv);
        let texel = found.texel as usize;
        assert!(wanted.texels.contains(&texel), "{note}: texel {texel} is not its own");
        let beside = |texel: usize| (rsm.place(texel).truncate().as_dvec2() + 0.5).distance(wanted.uv);
        assert!(beside(texel) <= beside(wanted.texel) + 1e-3, "{note}: texel {texel} for {}", wanted.texel);
        let flux = rsm.texels[texel].expect("it is lit").flux;
        assert_near(found.centre_flux, flux, 1e-6, &note);
    }
    let summary = summarise(&world.clusters, &expected);
    assert_eq!((header.alive, header.vanished), (summary.alive, summary.vanished));
    assert_eq!((header.count, header.merged, header.split), (found.len() as u32, 3, 2));
    assert_eq!(header.iteration, 42);
    assert_close(header.greatest_area, summary.greatest_area, 1e-4, "the greatest area");
    assert_close(header.mean_share, summary.mean_share, 1e-4, "the mean share");
    assert_close(header.share_variance, summary.share_variance, 1e-3, "the variance of shares");
    assert_near(header.mapped_flux, summary.mapped_flux, 1e-5, "the mapped flux");
    assert_near(header.map_flux, map_flux(&rsm), 1e-5, "the flux of the map");
}

#[test]
fn clusters_are_those_of_the_cpu_reference() {
    // Fewer and more texels than a workgroup has threads and a block elements; clusters without texels.
    for (size, layers, clusters) in [((37, 21), 2, 40), ((70, 90), 3, 9), ((16, 16), 1, 300), ((1, 1), 1, 3)]
    {
        for window in [0, 1, 9, 64] {
            for area in [Area::Texels, Area::Disk] {
                let world = World { area, ..World::random(size, layers, clusters, window) };
                let Some((header, found)) = world.run() else { return };
                assert_averaged(&world, &header, &found);
            }
        }
    }
}

#[test]
fn without_importance_each_texel_counts_as_one() {
    let world = World { importance: None, ..World::random((37, 21), 2, 20, 0) };
    let Some((header, found)) = world.run() else { return };
    assert_averaged(&world, &header, &found);
    assert!(found.iter().all(|cluster| cluster.texels == 0 || (cluster.importance - 1.0).abs() < 1e-6));
}

#[test]
fn an_unlit_map_has_no_clusters_and_no_flux() {
    let mut world = World::random((37, 21), 2, 20, 0);
    for texel in &mut world.texels {
        texel.position[3] = 0.0;
    }
    world.map.fill(NONE);
    let Some((header, found)) = world.run() else { return };
    assert_averaged(&world, &header, &found);
    assert_eq!((header.alive, header.map_flux, header.mean_share), (0, [0.0; 3], 0.0));
}

#[test]
fn what_is_no_number_spoils_nothing() {
    let mut world = World::random((37, 21), 2, 20, 0);
    for (i, texel) in (0..).zip(&mut world.texels) {
        match i % 29 {
            0 => texel.flux = [f32::NAN; 4],
            1 => texel.normal = [f32::NAN; 3],
            2 => texel.flux[1] = -5.0,
            _ => {}
        }
    }
    for importance in world.importance.iter_mut().flatten().step_by(31) {
        *importance = f32::NAN;
    }
    let Some((header, found)) = world.run() else { return };
    assert_averaged(&world, &header, &found);
}
