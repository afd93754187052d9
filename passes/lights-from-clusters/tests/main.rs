//! Lights of clusters carry the flux of the map.

mod cpu_reference;

use cpu_reference::{Energy, light_fluxes};
use glam::{DVec3, Vec3};
use interfaces::clusters::{Cluster, ClustersHeader, NO_TEXEL, state};
use interfaces::virtual_lights::VirtualLight;
use lights_from_clusters::PASS;
use pass::Value;
use pass_test::Harness;
use pass_test::random::{hash2, unit_float};

pass_test::shaders_are_valid!(PASS);

fn vector(element: u32, dimension: u32) -> Vec3 {
    Vec3::from([0, 1, 2].map(|c| unit_float(hash2(element, 3 * dimension + c)) as f32))
}

/// Clusters of textured surfaces: the texel at the centre is not like the others. Every fifth has lost its texels.
fn clusters(count: u32) -> Vec<Cluster> {
    (0..count)
        .map(|i| {
            let lost = i % 5 == 3;
            let texels = if lost { 0 } else { 1 + hash2(i, 50) % 1000 };
            Cluster {
                position: (10.0 * vector(i, 1)).to_array(),
                area: 0.5 * vector(i, 2).x,
                normal: vector(i, 3).normalize().to_array(),
                flux: (texels as f32 * vector(i, 4)).to_array(),
                centre_flux: vector(i, 5).powf(5.0).to_array(),
                texel: if lost { NO_TEXEL } else { 7 * i },
                texels,
                state: if lost { state::TO_SEED } else { state::ALIVE },
                ..Cluster::default()
            }
        })
        .collect()
}

fn lights(clusters: &[Cluster], map_flux: [f32; 3], set: &[(&str, Value)]) -> Option<Vec<VirtualLight>> {
    let header = ClustersHeader { map_flux, ..ClustersHeader::default() };
    let harness = Harness::new(PASS).clusters(&header, clusters);
    let harness = set.iter().fold(harness, |harness, (name, value)| harness.set(name, value.clone()));
    Some(harness.run()?.lights("lights"))
}

const ENERGIES: [(&str, Energy); 2] = [("texels", Energy::Texels), ("centre", Energy::Centre)];

#[test]
fn lights_are_those_of_the_cpu_reference_and_carry_the_flux_of_the_map() {
    let map_flux = [1000.0f32, 250.0, 3e5];
    for count in [1, 2, 63, 64, 65, 700] {
        let clusters = clusters(count);
        for (word, energy) in ENERGIES {
            let Some(lights) = lights(&clusters, map_flux, &[("energy", Value::from(word))]) else { return };
            assert_eq!(lights.len(), clusters.len());
            let expected = light_fluxes(&clusters, map_flux.into(), energy);
            let mut sum = DVec3::ZERO;
            for (i, (light, cluster)) in lights.iter().zip(&clusters).enumerate() {
                let flux = Vec3::from(light.flux).as_dvec3();
                sum += flux;
                assert!(
                    flux.distance(expected[i]) <= 1e-5 * expected[i].length(),
                    "{word}: light {i} has {flux}"
                );
                if cluster.texels == 0 {
                    assert_eq!((light.flux, light.area, light.texel), ([0.0; 3], 0.0, NO_TEXEL));
                    assert_eq!(light.normal, [0.0, 0.0, 1.0], "frames are built around it");
                    continue;
                }
                assert_eq!((light.position, light.normal), (cluster.position, cluster.normal));
                assert_eq!((light.area, light.texel), (cluster.area, cluster.texel));
            }
            let whole = Vec3::from(map_flux).as_dvec3();
            assert!((sum / whole - 1.0).abs().max_element() < 1e-5, "{word}, {count}: {sum} of {whole}");
        }
    }
}

#[test]
fn points_have_no_area() {
    let clusters = clusters(20);
    let Some(lights) = lights(&clusters, [1.0; 3], &[("area", Value::Bool(false))]) else { return };
    assert!(lights.iter().all(|light| light.area == 0.0));
}

#[test]
fn where_nothing_is_mapped_all_lights_are_dark() {
    let mut clusters = clusters(20);
    for cluster in &mut clusters {
        (cluster.texels, cluster.flux, cluster.centre_flux) = (0, [0.0; 3], [0.0; 3]);
    }
    let Some(lights) = lights(&clusters, [1.0, 2.0, 3.0], &[]) else { return };
    assert_eq!(lights.len(), 20);
    assert!(lights.iter().all(|light| light.flux == [0.0; 3]), "{lights:?}");
}

/// Only the channel that no centre has is lost, and nothing is infinite.
#[test]
fn a_color_that_no_centre_has_is_lost() {
    let mut clusters = clusters(20);
    for cluster in &mut clusters {
        cluster.centre_flux = [cluster.centre_flux[0], 0.0, f32::NAN];
    }
    let set = [("energy", Value::from("centre"))];
    let Some(lights) = lights(&clusters, [5.0, 5.0, 5.0], &set) else { return };
    let sum: f32 = lights.iter().map(|light| light.flux[0]).sum();
    assert!((sum - 5.0).abs() < 1e-4, "{sum}");
    assert!(lights.iter().all(|light| light.flux[1..] == [0.0; 2]), "{lights:?}");
}

#[test]
fn flux_at_the_ends_of_the_range_stays_finite() {
    for flux in [1e-38f32, 1e38] {
        let cluster = Cluster { flux: [flux; 3], centre_flux: [flux; 3], ..clusters(1)[0] };
        for (word, _) in ENERGIES {
            for map_flux in [[1e-30; 3], [f32::MAX; 3], [f32::NAN, f32::INFINITY, 1.0]] {
                let set = [("energy", Value::from(word))];
                let Some(lights) = lights(&[cluster; 9], map_flux, &set) else { return };
                let finite =
                    lights.iter().flat_map(|light| light.flux).all(|flux| (0.0..=1e37).contains(&flux));
                assert!(finite, "{flux} in {map_flux:?}: {lights:?}");
            }
        }
    }
}

/// The header says how many clusters there are: what stands behind them is no light, and before the first frame all is dark.
#[test]
fn what_is_behind_the_clusters_is_no_light() {
    let clusters: Vec<Cluster> = clusters(9).into_iter().filter(|cluster| cluster.texels > 0).collect();
    for count in [0, 1, clusters.len() as u32 - 1] {
        let header = ClustersHeader { count, map_flux: [1.0; 3], ..ClustersHeader::default() };
        let mut bytes = interfaces::clusters::to_bytes(&header, &clusters);
        bytes[..4].copy_from_slice(&count.to_ne_bytes());
        let members = pass_test::elements(&bytes);
        let given = [("count", clusters.len() as u32)];
        let Some(outputs) = Harness::new(PASS).input("clusters", "Clusters", &given, members).run() else {
            return;
        };
        for (i, light) in (0..).zip(outputs.lights("lights")) {
            assert_eq!(light.flux == [0.0; 3], i >= count, "{count} clusters, light {i}: {light:?}");
        }
    }
}
