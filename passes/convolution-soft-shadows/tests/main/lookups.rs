//! Soft lookups.

use crate::cpu_reference::{Expansion, Map};
use crate::{Atlas, DEPTH_BIAS, MODULE, NOTHING, Random, expansion, light};
use glam::{DVec3, dvec2, dvec3};
use pass_test::visibility::{Plane, Receiver, errors_behind_edges, map_of, penumbrae, receivers_around};
use std::f64::consts::{PI, TAU};

const TILE: u32 = 512;

#[test]
fn the_gpu_agrees_with_the_cpu_reference() {
    for (tile, order, area) in [(16, 4, 0.05), (16, 4, 0.8), (13, 4, 0.8), (32, 16, 0.8), (24, 6, 3.0)] {
        let atlas = Atlas::rough(tile, 3);
        for by in [
            expansion(tile, order),
            Expansion { levels: 2, search: 4, nearest: 0.5, ..expansion(tile, order) },
        ] {
            let receivers = receivers_around(600, 3);
            let Some(got) = atlas.answers(by, area, &receivers) else { return };
            let maps = atlas.reference(by);
            let (mut differ, mut between) = (0, 0);
            for (receiver, got) in receivers.iter().zip(got) {
                let map = &maps[receiver.light as usize];
                let wanted =
                    map.visibility(f64::from(area), receiver.position.into(), receiver.normal.into());
                differ += usize::from((f64::from(got) - wanted).abs() > 5e-3);
                between += usize::from(wanted > 0.0 && wanted < 1.0);
            }
            // Images have 16 bits, and contrast multiplies their rounding; a level may be rounded the other way.
            assert!(differ <= 6, "{differ} of 600 differ, {tile}², order {order}, area {area}");
            assert!(
                between > 150,
                "{between} receivers are in penumbrae, {tile}², order {order}, area {area}"
            );
        }
    }
}

/// Where the four sides of a map end, images are read as the CPU reads them: at the edge, not beyond.
#[test]
fn lookups_at_the_edges_of_a_map_agree_with_the_cpu_reference() {
    for tile in [8, 13] {
        let by = Expansion { nearest: 0.1, ..expansion(tile, 4) };
        let atlas = Atlas::rough(tile, 3);
        let mut random = Random(3);
        let receivers: Vec<Receiver> = (0..400)
            .map(|i| {
                let angle = f64::from(i % 4) * 0.25 * TAU + 0.1 * (random.unit() - 0.5);
                let z = 0.01 + 0.1 * random.unit();
                let direction = (dvec2(angle.cos(), angle.sin()) * (1.0 - z * z).sqrt()).extend(z);
                let [position, normal] = [2.0 * direction, -direction].map(|v| v.to_array());
                Receiver { position, normal, light: 1 }
            })
            .collect();
        let Some(got) = atlas.answers(by, 0.02, &receivers) else { return };
        let map = &atlas.reference(by)[1];
        let wanted = |receiver: &Receiver| {
            map.visibility(0.02_f32.into(), receiver.position.into(), receiver.normal.into())
        };
        let differ =
            receivers.iter().zip(&got).filter(|(at, got)| (f64::from(**got) - wanted(at)).abs() > 5e-3);
        assert!(differ.count() <= 4, "{tile}²");
        assert!(got.iter().filter(|seen| **seen > 0.0 && **seen < 1.0).count() > 50, "{tile}²");
    }
}

/// Where visibility rises from a tenth to nine tenths, in the penumbra of an edge.
#[test]
fn penumbrae_are_as_wide_as_similar_triangles_say() {
    let area = PI * 0.3 * 0.3;
    for order in [4, 16] {
        let found = penumbrae(0.3, 4, 2.0, |distances| {
            let map = Map::new(distances, TILE, expansion(TILE, order));
            Box::new(move |at| map.visibility(area, at, DVec3::NEG_Z))
        });
        for penumbra in &found {
            let share = penumbra.width / penumbra.wanted;
            assert!((share - 1.0).abs() < 0.25, "order {order}: {share} of {penumbra:?}");
        }
        assert!(found.is_sorted_by(|a, b| a.width > b.width), "nearer to the receiver is sharper: {found:?}");
    }
}

#[test]
fn a_disc_is_as_visible_as_rays_say() {
    for (order, most_mean, most) in [(4, 0.055, 0.35), (16, 0.055, 0.35)] {
        let (mean, worst) = errors_behind_edges(|distances, radius| {
            let map = Map::new(distances, TILE, expansion(TILE, order));
            Box::new(move |at| map.visibility(PI * radius * radius, at, DVec3::NEG_Z))
        });
        assert!(mean < most_mean && worst < most, "order {order}: off by {mean} on average, {worst} at most");
    }
}

/// Planes that the light stands over or that are its neighbours, seen by lights that are larger than they are high.
#[test]
fn planes_do_not_shadow_themselves() {
    for order in [1, 4, 16] {
        for (tile, degrees) in [(32, 0.0), (32, 30.0), (32, 55.0), (128, 55.0), (128, 75.0), (128, 90.0)] {
            let plane = Plane::tilted(degrees, 1.0);
            let distances = map_of(tile, |direction| plane.along(direction));
            let map = Map::new(distances, tile, expansion(tile, order));
            for radius in [0.0, 0.2, 1.0, 3.0] {
                let seen = plane.seen(1500, |at, normal| map.visibility(PI * radius * radius, at, normal));
                let mean = seen.iter().sum::<f64>() / seen.len() as f64;
                assert!(seen.len() > 75, "{} receivers", seen.len());
                assert!(mean > 0.99, "order {order}, {tile}², {degrees}°, radius {radius}: {mean}");
            }
        }
    }
}

#[test]
fn a_point_light_is_looked_up_once_to_the_bit() {
    let atlas = Atlas::rough(16, 2);
    let by = expansion(16, 4);
    let Some(basis) = atlas.basis(by) else { return };
    let with =
        |module| atlas.answers_with(module, by, &basis, &[light(0.0); 2], &receivers_around(600, 2)).unwrap();
    let (soft, hard) = (with(MODULE), with("shaders/visibility-atlas.wgsl"));
    assert!(soft.iter().zip(&hard).all(|(soft, hard)| soft.to_bits() == hard.to_bits()));
    let lit = hard.iter().filter(|seen| **seen > 0.0).count();
    assert!((60..540).contains(&lit), "{lit} of 600 are lit");
}

/// Maps without anything in them are seen through, by lights of any size; maps that are closed are not. A map of one texel
/// has no levels.
#[test]
fn empty_maps_are_open_and_full_ones_closed() {
    for tile in [1, 2, 7, 16] {
        for (stored, wanted) in [(NOTHING, 1.0), (0.01, 0.0)] {
            for area in [0.0, 0.1, 30.0] {
                let atlas = Atlas { tile, maps: vec![vec![stored; (tile * tile) as usize]] };
                let Some(got) = atlas.answers(expansion(tile, 4), area, &receivers_around(300, 1)) else {
                    return;
                };
                assert!(
                    got.iter().all(|seen| (seen - wanted).abs() < 1e-6),
                    "{tile}², {stored}, area {area}: {got:?}"
                );
            }
        }
    }
}

/// Lookups of a map in the middle are the same bits whatever its neighbours hold.
#[test]
fn no_lookup_leaves_its_own_map() {
    for tile in [8, 13] {
        let by = Expansion { nearest: 0.1, ..expansion(tile, 4) };
        let receivers: Vec<Receiver> =
            receivers_around(600, 1).into_iter().map(|receiver| Receiver { light: 1, ..receiver }).collect();
        let mut atlas = Atlas::rough(tile, 3);
        let with = |atlas: &Atlas| atlas.answers(by, 2.0, &receivers);
        let Some(first) = with(&atlas) else { return };
        let mut random = Random(11);
        for map in [0, 2] {
            atlas.maps[map].iter_mut().for_each(|distance| *distance = 0.2 + random.unit());
        }
        assert_eq!(first, with(&atlas).expect("the adapter is still there"), "{tile}²");
        assert!(first.iter().any(|seen| *seen > 0.0 && *seen < 1.0));
    }
}

#[test]
fn behind_the_light_nothing_is_seen_and_a_blocker_at_the_light_is_no_nan() {
    for stored in [0.0, 1e-30] {
        let atlas = Atlas { tile: 8, maps: vec![vec![stored; 64]] };
        let at = |z: f64| Receiver { position: [0.3, 0.1, z], normal: [0.0, 0.0, -1.0], light: 0 };
        let receivers = [at(-1.0), at(0.0), at(1e-3), at(2.0)];
        let Some(got) = atlas.answers(expansion(8, 4), 0.5, &receivers) else { return };
        assert_eq!(got, [0.0; 4], "{stored} m");
    }
}

/// A wall that stands beside a receiver hides nothing of a light in the same room: searches narrow until it is out of the
/// region.
#[test]
fn walls_beside_a_receiver_do_not_darken_it() {
    // A room of 2 m × 2 m × 2 m whose ceiling is the light's plane.
    let along = |direction: DVec3| {
        let reach = |x: f64, limit: f64| if x.abs() > 1e-9 { limit / x.abs() } else { f64::INFINITY };
        let sides = reach(direction.x, 1.0).min(reach(direction.y, 1.0));
        (direction.z > 0.0).then(|| sides.min(reach(direction.z, 2.0)))
    };
    let distances = map_of(256, along);
    let darkest = |search| {
        let map = Map::new(distances.clone(), 256, Expansion { search, ..expansion(256, 4) });
        let seen = |i: u32| map.visibility(1.5, dvec3(f64::from(i) / 50.0, 0.3, 2.0), DVec3::NEG_Z);
        let sum: f64 = (0..49).map(seen).sum();
        sum / 49.0
    };
    let (once, twice, often) = (darkest(1), darkest(2), darkest(6));
    println!("{once}, {twice}, {often}");
    assert!(once < twice && twice < often && often > 0.97, "{once}, {twice}, {often}");
    assert_eq!(expansion(256, 4).depth_bias, DEPTH_BIAS);
}
