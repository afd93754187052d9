//! k-means on the GPU against the CPU reference, and against what holds of every clustering.

mod cpu_reference;

use cpu_reference::{Centre, Metric};
use interfaces::virtual_lights::{VirtualLight, VirtualLightsHeader};
use pass_test::{Harness, Outputs};

/// The diagonal of the scene `plane` \[m\].
const EXTENT: f64 = 2.828_427_124_746_19;

fn metric(squared: bool) -> Metric {
    let position = if squared { EXTENT.powi(-2) } else { EXTENT.recip() };
    Metric { position, normal: f64::from(0.1_f32), squared }
}

/// A light with a normal within a cone about z.
fn light(position: [f32; 3], tilt: [f32; 2]) -> VirtualLight {
    let length = (tilt[0] * tilt[0] + tilt[1] * tilt[1] + 1.0).sqrt();
    VirtualLight {
        position,
        normal: [tilt[0] / length, tilt[1] / length, 1.0 / length],
        flux: [1.0, 2.0 + position[0], 0.5],
        area: 0.25 + 0.1 * tilt[0].abs(),
        texel: 7,
        ..Default::default()
    }
}

/// Lights all over a cube of 2 m.
fn scattered(count: u32) -> Vec<VirtualLight> {
    let step = |i: u32, step: f64| (f64::from(i) * step).fract() as f32 * 2.0 - 1.0;
    let of = |i: u32| {
        let position = [0.819_172_5, 0.671_043_6, 0.549_700_5].map(|alpha| step(i, alpha));
        light(position, [0.754_877_7, 0.569_840_3].map(|alpha| 2.0 * step(i, alpha)))
    };
    (0..count).map(of).collect()
}

/// Five groups of lights, one after the other, each 0.1 m wide and 1 m from the others.
fn groups() -> Vec<VirtualLight> {
    let centres = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.2], [0.5, 0.5, 1.0]];
    let of = |(i, spread): (usize, VirtualLight)| {
        let centre: [f32; 3] = centres[i / 40];
        let offset = spread.position.map(|x| 0.05 * x);
        light([0, 1, 2].map(|axis| centre[axis] + offset[axis]), [offset[2], offset[0]])
    };
    scattered(200).into_iter().enumerate().map(of).collect()
}

fn clustered(lights: &[VirtualLight], count: u32, iterations: u32, metric: &str) -> Option<Outputs> {
    Harness::new(cluster_lights::PASS)
        .scene("plane")
        .set("count", count)
        .set("iterations", iterations)
        .set("metric", metric)
        .lights(lights)
        .run()
}

/// The clusters of `count` lights; a buffer may be longer.
fn owners(outputs: &Outputs, count: usize) -> Vec<u32> {
    let mut owners: Vec<u32> = outputs.read("owners");
    owners.truncate(count);
    owners
}

fn centres(clusters: &[VirtualLight]) -> Vec<Centre> {
    clusters.iter().map(Centre::of).collect()
}

fn assert_close(got: &[Centre], wanted: &[Centre]) {
    for (c, (got, wanted)) in got.iter().zip(wanted).enumerate() {
        let apart = got.position.distance(wanted.position).max(got.normal.distance(wanted.normal));
        assert!(apart < 1e-5, "cluster {c}: {got:?} for {wanted:?}");
    }
}

/// Sums of flux and area of all lights, as the clusters have them.
fn assert_sums(lights: &[VirtualLight], clusters: &[VirtualLight]) {
    let sums = |lights: &[VirtualLight]| {
        [0, 1, 2, 3].map(|i| {
            let of = |light: &VirtualLight| f64::from(if i < 3 { light.flux[i] } else { light.area });
            lights.iter().map(of).sum::<f64>()
        })
    };
    for (got, wanted) in sums(clusters).into_iter().zip(sums(lights)) {
        assert!((got - wanted).abs() < 1e-5 * wanted, "{got} for {wanted}");
    }
}

#[test]
fn groups_far_apart_are_the_clusters_of_the_cpu_reference() {
    let lights = groups();
    for (name, squared) in [("squared", true), ("linear", false)] {
        let Some(outputs) = clustered(&lights, 5, 32, name) else { return };
        let (clusters, owners) = (outputs.lights("clusters"), owners(&outputs, lights.len()));
        let (wanted, wanted_owners, iterations) = metric(squared).clustered(&lights, 5, 32);
        assert!(iterations < 32, "it converges");
        assert_eq!(owners, wanted_owners);
        assert_eq!(owners, (0..200).map(|i| i / 40).collect::<Vec<u32>>(), "a cluster is a group");
        assert_close(&centres(&clusters), &wanted);
        assert_sums(&lights, &clusters);
    }
}

#[test]
fn no_iteration_makes_the_sum_of_distances_greater() {
    let lights = scattered(1000);
    let metric = metric(true);
    let mut before = f64::INFINITY;
    let mut last = Vec::new();
    for iterations in [1, 2, 3, 5, 8, 16, 64, 128] {
        let Some(outputs) = clustered(&lights, 24, iterations, "squared") else { return };
        let (clusters, owners) = (outputs.lights("clusters"), owners(&outputs, lights.len()));
        let objective = metric.objective(&lights, &centres(&clusters), &owners);
        // Sums of a thousand in single precision.
        assert!(objective <= before * (1.0 + 1e-6), "{objective} after {iterations}, {before} before");
        assert_sums(&lights, &clusters);
        if iterations == 1 {
            let first = metric.clustered(&lights, 24, 1);
            assert_eq!(owners, first.1, "the first lights are the first centres");
            assert_close(&centres(&clusters), &first.0);
            let (centres, owners, _) = metric.clustered(&lights, 24, 99);
            assert!(
                objective > 1.05 * metric.objective(&lights, &centres, &owners),
                "there is something to gain"
            );
        }
        if iterations == 128 {
            assert_eq!((last, before), ((owners.clone()), objective), "it has converged after 64");
            // Every light is in the cluster nearest to it.
            assert_eq!(metric.assign(&lights, &centres(&clusters)), owners);
        }
        (before, last) = (objective, owners);
    }
}

#[test]
fn after_convergence_iterations_change_no_bit() {
    let lights = groups();
    let bits = |iterations| {
        let outputs = clustered(&lights, 5, iterations, "squared")?;
        let dispatches = outputs.read::<u32>("dispatches")[..6].to_vec();
        Some((outputs.read::<u32>("clusters"), owners(&outputs, lights.len()), dispatches))
    };
    let Some(few) = bits(6) else { return };
    assert!(few == bits(100).expect("the adapter is still there"), "iterations go on");
    assert_eq!(few.2, [0; 6], "nothing is left to dispatch");
}

#[test]
fn one_cluster_is_the_mean_of_all() {
    let lights = scattered(777);
    let Some(outputs) = clustered(&lights, 1, 4, "squared") else { return };
    let clusters = outputs.lights("clusters");
    assert_eq!(clusters.len(), 1);
    assert!(owners(&outputs, lights.len()).iter().all(|owner| *owner == 0));
    assert_close(&centres(&clusters), &metric(true).clustered(&lights, 1, 4).0);
    assert_sums(&lights, &clusters);
}

#[test]
fn as_many_clusters_as_lights_are_the_lights() {
    let lights = scattered(300);
    for count in [300, 301, 4096] {
        let Some(outputs) = clustered(&lights, count, 8, "squared") else { return };
        assert_eq!(outputs.lights("clusters"), lights, "to the bit, and no more of them");
        assert_eq!(owners(&outputs, 300), (0..300).collect::<Vec<u32>>());
    }
}

#[test]
fn lights_in_one_place_are_one_cluster_and_the_others_are_dark() {
    let lights = vec![light([0.3, -0.2, 0.9], [0.1, 0.2]); 50];
    let Some(outputs) = clustered(&lights, 7, 8, "squared") else { return };
    let clusters = outputs.lights("clusters");
    assert!(owners(&outputs, lights.len()).iter().all(|owner| *owner == 0), "the lowest of equals");
    assert_eq!(clusters.len(), 7);
    assert_sums(&lights, &clusters[..1]);
    for empty in &clusters[1..] {
        assert_eq!((empty.flux, empty.area), ([0.0; 3], 0.0));
        assert_eq!(
            (empty.position, empty.normal),
            (lights[0].position, lights[0].normal),
            "it keeps its place"
        );
    }
}

#[test]
fn lights_beyond_the_count_and_dark_ones_do_not_matter() {
    let lights = scattered(200);
    let Some(alone) = clustered(&lights, 9, 16, "squared") else { return };
    // Every fifth light is dark, and lies elsewhere; after 250 lights comes what has no meaning.
    let mut more = Vec::new();
    for (i, light) in lights.iter().enumerate() {
        more.push(*light);
        if i % 4 == 3 {
            more.push(VirtualLight { position: [90.0, 0.0, 0.0], flux: [0.0; 3], ..*light });
        }
    }
    let header = VirtualLightsHeader { count: 250, ..Default::default() };
    let rest = vec![0xff_u8; 50 * size_of::<VirtualLight>()];
    let bytes = [bytemuck::bytes_of(&header), bytemuck::cast_slice(&more), &rest].concat();
    let outputs = Harness::new(cluster_lights::PASS)
        .scene("plane")
        .set("count", 400)
        .set("iterations", 16)
        .input(
            "lights",
            "VirtualLights",
            &[("count", 300)],
            vec![("", pass_test::buffer(bytes.len() as u64), bytes.clone())],
        )
        .run();
    let Some(outputs) = outputs else { return };
    assert_eq!(outputs.fact("clusters", "count").as_u32(), Some(300));
    let clusters = outputs.lights("clusters");
    assert_eq!(clusters.len(), 250, "as many as there are lights");
    let lit: Vec<VirtualLight> = clusters.into_iter().filter(|light| light.flux != [0.0; 3]).collect();
    assert_eq!(lit, lights);
    assert_eq!(owners(&outputs, 300)[250..], [0; 50]);

    // The dark ones join clusters, and move none.
    let with =
        |more: &[VirtualLight]| clustered(more, 1, 4, "squared").map(|outputs| outputs.lights("clusters"));
    let (Some(mixed), Some(plain)) = (with(&more), with(&lights)) else { return };
    assert_close(&centres(&mixed), &centres(&plain));
    assert_sums(&lights, &mixed);
    assert_sums(&lights, &alone.lights("clusters"));
}

#[test]
fn no_light_is_no_cluster() {
    let header = bytemuck::bytes_of(&VirtualLightsHeader::default()).to_vec();
    let outputs = Harness::new(cluster_lights::PASS)
        .scene("plane")
        .input("lights", "VirtualLights", &[("count", 5)], vec![("", pass_test::buffer(16 + 5 * 48), header)])
        .run();
    let Some(outputs) = outputs else { return };
    assert!(outputs.lights("clusters").is_empty());
    assert_eq!(owners(&outputs, 5), [0; 5]);
}

#[test]
fn every_variant_of_its_shader_is_valid() {
    pass_test::assert_shaders_are_valid(cluster_lights::PASS);
}
