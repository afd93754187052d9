//! Soft lookups: the CPU reference against closed forms and rays, and the GPU against the CPU reference.

mod cpu_reference;

use cpu_reference::{Map, poisson_disc};
use glam::{DVec2, DVec3, dvec2};
use interfaces::virtual_lights::VirtualLight;
use pass::{Module, OutputDesc, ResourceDesc, Value};
use pass_test::visibility::{
    Plane, Receiver, atlas, errors_behind_edges, lookups, map_of, penumbrae, receivers_around, segment,
};
use std::f64::consts::{PI, TAU};

const MODULE: &str = "passes/percentage-closer-soft-shadows/lookup.wgsl";
const NOTHING: f64 = 3.0e38;
/// The depth bias of all lookups.
const DEPTH_BIAS: f64 = 0.02;

/// The settings of the lookups.
#[derive(Clone, Copy, Debug)]
struct Lookups {
    module: &'static str,
    search: u32,
    taps: u32,
    nearest: f32,
}

/// Returns how visible its light is from each receiver; `maps` are the layers of the atlas, one map each. `None` where
/// there is no adapter.
fn answers(
    by: Lookups,
    tile: u32,
    maps: &[f32],
    lights: &[VirtualLight],
    receivers: &[Receiver],
) -> Option<Vec<f32>> {
    let facts = [("tile", tile), ("columns", 1), ("rows", 1), ("search", by.search), ("taps", by.taps)];
    let outputs = lookups(lights, receivers)
        .input("visibility", "Visibility", &facts, vec![atlas(tile, maps)])
        .fact("depth_bias", DEPTH_BIAS as f32)
        .fact("slope_bias", 0.0)
        .fact("nearest", by.nearest)
        .module(by.module)
        .run()?;
    Some(outputs.read("answers"))
}

fn map(distances: &[f64], tile: u32) -> Map<'_> {
    Map { distances, tile, depth_bias: DEPTH_BIAS, search: 16, taps: 16, nearest: 0.25 }
}

#[test]
fn the_kernel_is_a_poisson_disc() {
    let kernel = poisson_disc();
    assert_eq!((kernel.len(), kernel[0]), (32, DVec2::ZERO));
    assert!(kernel.iter().all(|point| point.length() <= 1.0));
    // The best packings of these numbers of points in a disc have 0.55 and 0.38.
    for (count, least) in [(16, 0.36), (32, 0.235)] {
        let some = &kernel[..count];
        let pairs = some.iter().enumerate().flat_map(|(i, a)| some[..i].iter().map(move |b| a.distance(*b)));
        let nearest = pairs.fold(f64::INFINITY, f64::min);
        assert!(nearest >= least, "{nearest} between the nearest of {count}");
    }
}

#[test]
fn a_line_through_the_kernel_has_the_part_of_the_disc_beside_it() {
    for (count, most) in [(16, 0.11), (32, 0.08)] {
        let kernel = &poisson_disc()[..count];
        for (i, j) in (0..32).flat_map(|i| (0..41).map(move |j| (i, j))) {
            let (sin, cos) = (TAU * f64::from(i) / 32.0).sin_cos();
            let distance = f64::from(j) / 20.0 - 1.0;
            let beside = kernel.iter().filter(|point| point.dot(dvec2(cos, sin)) < distance).count();
            let (got, wanted) = (beside as f64 / count as f64, segment(distance));
            assert!((got - wanted).abs() < most, "{got} of {count} for {wanted}, direction {i}, {distance}");
        }
    }
}

/// Where visibility rises from a tenth to nine tenths, in the penumbra of an edge.
#[test]
fn penumbrae_are_as_wide_as_similar_triangles_say() {
    let area = PI * 0.3 * 0.3;
    let found = penumbrae(0.3, 8, 1.5, |distances| {
        Box::new(move |at| map(&distances, 512).visibility(area, at, DVec3::NEG_Z))
    });
    for penumbra in &found {
        assert_eq!(penumbra.ends, (0.0, 0.0), "dark and lit ends: {penumbra:?}");
        assert!((penumbra.width / penumbra.wanted - 1.0).abs() < 0.12, "{penumbra:?}");
    }
    assert!(found.is_sorted_by(|a, b| a.width > b.width), "nearer to the receiver is sharper: {found:?}");
}

#[test]
fn a_disc_is_as_visible_as_rays_say() {
    let (mean, worst) = errors_behind_edges(|distances, radius| {
        Box::new(move |at| map(&distances, 512).visibility(PI * radius * radius, at, DVec3::NEG_Z))
    });
    // 16 taps are 17 shades, and their edges fall between those of the disc.
    assert!(mean < 0.04 && worst < 0.2, "off by {mean} on average, {worst} at most");
}

/// Planes that the light stands over or that are its neighbours, seen by lights that are larger than they are high.
#[test]
fn planes_do_not_shadow_themselves() {
    for (tile, degrees) in [(32, 0.0), (32, 30.0), (32, 55.0), (128, 55.0), (128, 75.0), (128, 90.0)] {
        let plane = Plane::tilted(degrees, 1.0);
        let distances = map_of(tile, |direction| plane.along(direction));
        for radius in [0.0, 0.2, 1.0, 3.0] {
            let area = PI * radius * radius;
            let seen = plane.seen(4000, |at, normal| map(&distances, tile).visibility(area, at, normal));
            assert!(seen.iter().all(|seen| *seen == 1.0), "{tile}², {degrees}°, radius {radius}: {seen:?}");
            assert!(seen.len() > 200, "{} receivers", seen.len());
        }
    }
}

/// Two maps in which every texel is a blocker at 0.9 m or is open, by a hash of its place.
fn rough_maps(tile: u32) -> Vec<f32> {
    let stored = |i: u32| if i.wrapping_mul(0x9e37_79b9) >> 31 == 0 { NOTHING as f32 } else { 0.9 };
    (0..2 * tile * tile).map(stored).collect()
}

fn light(area: f32) -> VirtualLight {
    VirtualLight { normal: [0.0, 0.0, 1.0], flux: [1.0; 3], area, ..VirtualLight::default() }
}

#[test]
fn the_gpu_agrees_with_the_cpu_reference() {
    const TILE: u32 = 16;
    let maps = rough_maps(TILE);
    let wide: Vec<f64> = maps.iter().map(|distance| f64::from(*distance)).collect();
    let receivers = receivers_around(600, 2);
    for (area, search, taps, nearest) in [(0.05, 16, 16, 0.25), (0.8, 16, 16, 0.25), (2.0, 7, 32, 0.5)] {
        let lookups = Lookups { module: MODULE, search, taps, nearest };
        let Some(got) = answers(lookups, TILE, &maps, &[light(area); 2], &receivers) else { return };
        let (mut differ, mut between) = (0, 0);
        for (receiver, got) in receivers.iter().zip(got) {
            let distances = &wide[receiver.light as usize * 256..][..256];
            let map = Map {
                search: search as usize,
                taps: taps as usize,
                nearest: f64::from(nearest),
                ..map(distances, TILE)
            };
            let wanted = map.visibility(f64::from(area), receiver.position.into(), receiver.normal.into());
            differ += usize::from((f64::from(got) - wanted).abs() > 1e-5);
            between += usize::from(wanted > 0.0 && wanted < 1.0);
        }
        // A tap may fall on the other side of a texel's edge in single precision.
        assert!(differ <= 6, "{differ} of 600 differ, area {area}");
        assert!(between > 300, "{between} receivers are in penumbrae, area {area}");
    }
}

#[test]
fn a_point_light_is_looked_up_once_to_the_bit() {
    let (maps, receivers) = (rough_maps(16), receivers_around(600, 2));
    let with = |module| {
        let lookups = Lookups { module, search: 16, taps: 16, nearest: 0.25 };
        answers(lookups, 16, &maps, &[light(0.0); 2], &receivers)
    };
    let (Some(soft), Some(hard)) = (with(MODULE), with("shaders/visibility-atlas.wgsl")) else { return };
    assert!(soft.iter().zip(&hard).all(|(soft, hard)| soft.to_bits() == hard.to_bits()));
    let lit = hard.iter().filter(|seen| **seen > 0.0).count();
    assert!((200..400).contains(&lit), "{lit} of 600 are lit");
}

#[test]
fn no_tap_leaves_its_own_map() {
    // Of three maps, the middle one is open, and those beside it are closed; and the other way round.
    let receivers: Vec<Receiver> =
        receivers_around(600, 1).into_iter().map(|receiver| Receiver { light: 1, ..receiver }).collect();
    for open in [true, false] {
        let stored = |layer| if (layer == 1) == open { NOTHING as f32 } else { 0.01 };
        let maps: Vec<f32> = (0..3 * 64).map(|i| stored(i / 64)).collect();
        let lookups = Lookups { module: MODULE, search: 32, taps: 32, nearest: 0.1 };
        let Some(got) = answers(lookups, 8, &maps, &[light(30.0); 3], &receivers) else { return };
        assert!(got.iter().all(|seen| *seen == if open { 1.0 } else { 0.0 }), "{got:?}");
    }
}

#[test]
fn behind_the_light_nothing_is_seen_and_a_blocker_at_the_light_is_no_nan() {
    let maps = vec![0.0_f32; 64];
    let at = |z: f64| Receiver { position: [0.3, 0.1, z], normal: [0.0, 0.0, -1.0], light: 0 };
    let lookups = Lookups { module: MODULE, search: 16, taps: 16, nearest: 0.25 };
    let Some(got) = answers(lookups, 8, &maps, &[light(0.5)], &[at(-1.0), at(0.0), at(1e-3), at(2.0)]) else {
        return;
    };
    assert_eq!(got, [0.0; 4]);
}

#[test]
fn it_softens_maps_and_nothing_else() {
    let outputs = |members: &[&str], module: Option<Module>| {
        let desc = ResourceDesc::texture_2d(pass::Format::R32Float, (8, 8));
        let facts = [
            ("tile", 8.into()),
            ("columns", 1.into()),
            ("rows", 1.into()),
            ("depth_bias", 0.5.into()),
            ("slope_bias", 0.5.into()),
        ];
        let settings = [("search", 16.into()), ("taps", 9.into()), ("nearest", 0.25.into())];
        let maps = pass_test::maps(members, &desc, &facts, module);
        pass_test::outputs_of(percentage_closer_soft_shadows::PASS, &settings, &[maps], &[])
    };
    let made = outputs(&["atlas"], None).expect("an atlas with its facts");
    assert!(made[0].members.is_empty() && made[0].handed.len() == 1, "the atlas is handed on");
    let module = |made: &[OutputDesc]| made[0].facts.module().expect("it has a module").clone();
    assert_eq!(module(&made).facts.get("iterations"), Some(&Value::U32(16 + 9)));
    assert_eq!(module(&made).facts.get("taps"), Some(&Value::U32(9)));
    assert_eq!(module(&made).options.get("SHARED"), None);
    let shared = Module::new("shaders/visibility-atlas.wgsl").option("SHARED", Value::Bool(true));
    let shared = outputs(&["atlas", "owners", "sources"], Some(shared)).expect("maps that lights share");
    assert_eq!(module(&shared).options.get("SHARED"), Some(&Value::Bool(true)));
    assert_eq!(outputs(&[], None).expect_err("rays have no maps").input.as_deref(), Some("maps"));
}
