//! The light that is placed next, and its place, against brute force.

use super::{Frame, Sampling, WAITING, lamp_at, point_at, room};
use glam::{DVec3, Vec3};
use interfaces::surface_points::SurfacePoint;

fn probes(frame: &Frame) -> impl Iterator<Item = DVec3> + '_ {
    frame.probes.iter().map(|probe| DVec3::from([0, 1, 2].map(|k| f64::from(probe[k]))))
}

/// The distance to the nearest of some places.
fn crowd(at: DVec3, places: impl Iterator<Item = DVec3>) -> f64 {
    places.map(|place| place.distance(at)).fold(f64::INFINITY, f64::min)
}

/// Where all lights are lit, the one that is nearest to another goes where it is farthest from all others.
#[test]
fn the_most_crowded_light_goes_to_the_emptiest_place() {
    let mut moves = 0;
    for count in [2, 3, 5, 9, 40] {
        let sampling = Sampling::of(count, 1);
        let Some(start) = sampling.frame(&lamp_at([-0.8, 0.5, 0.7]), None) else { return };
        let position = Vec3::new(0.8, -0.6, 0.3);
        let frame = sampling.frame(&lamp_at(position.to_array()), Some(&start.points));
        let frame = frame.expect("the adapter is still there");
        let place = |point: &SurfacePoint| (Vec3::from(point.position) - position).normalize().as_dvec3();
        let before: Vec<DVec3> = start.points.iter().map(place).collect();
        let others =
            |slot: usize| before.iter().enumerate().filter(move |(i, _)| *i != slot).map(|(_, p)| *p);
        let distances: Vec<f64> = (0..before.len()).map(|slot| crowd(before[slot], others(slot))).collect();
        let least = distances.iter().copied().fold(f64::INFINITY, f64::min);
        // Of the two that are nearest to each other, the first.
        let slot = distances.iter().position(|distance| *distance < least + 1e-6).expect("there are lights");
        let best = probes(&frame).map(|probe| crowd(probe, others(slot))).fold(0.0, f64::max);
        if best < 1.1 * least {
            assert_eq!(frame.header.marked, 0);
            continue;
        }
        moves += 1;
        assert_eq!((frame.header.marked, frame.points[slot].mark), (1, 1), "{count} lights: {distances:?}");
        let found = crowd(frame.place(slot), others(slot));
        assert!((found - best).abs() < 1e-4, "{count} lights: {found} from all others, of {best}");
    }
    assert!(moves >= 4, "{moves}");
}

/// Slots that wait are filled one after the other, each at the place that is farthest from all lights that are there by then.
#[test]
fn slots_that_wait_are_filled_where_it_is_emptiest() {
    let (scene, sampling) = (lamp_at([0.3, 0.1, -0.2]), Sampling::of(30, 1));
    let Some(start) = sampling.frame(&scene, None) else { return };
    let mut points = start.points;
    for slot in [3, 11, 12, 25] {
        points[slot] = SurfacePoint::NONE;
    }
    for slot in [3, 11, 12, 25] {
        let frame = sampling.frame(&scene, Some(&points)).expect("the adapter is still there");
        let there = (0..30).filter(|i| *i != slot && frame.sites[*i][3] != WAITING).map(|i| frame.place(i));
        let there: Vec<DVec3> = there.collect();
        let best = probes(&frame).map(|probe| crowd(probe, there.iter().copied())).fold(0.0, f64::max);
        assert_eq!((frame.header.marked, frame.points[slot].mark), (1, 1));
        let found = crowd(frame.place(slot), there.iter().copied());
        assert!((found - best).abs() < 1e-5, "slot {slot}: {found} from all others, of {best}");
        points = frame.points;
    }
}

/// A source all of whose lights are there, however badly they lie, keeps nobody waiting.
#[test]
fn only_sources_with_a_slot_that_waits_are_filled() {
    let scene = room([0.5; 3], vec![point_at([0.3; 3], [1.0; 3]), point_at([-0.3; 3], [1.0; 3])]);
    let sampling = Sampling::of(64, 4);
    let Some(start) = sampling.frame(&scene, None) else { return };
    let mut points = start.points;
    // Half of the first source's are lost; all of the second's lie in one place.
    points[..16].fill(SurfacePoint::NONE);
    let one = points[32];
    points[32..].fill(one);
    let frame = sampling.frame(&scene, Some(&points)).expect("the adapter is still there");
    assert_eq!((frame.waiting(), frame.header.marked), (12, 4));
    assert!(frame.points[32..].iter().all(|point| point.mark == 0));
}
