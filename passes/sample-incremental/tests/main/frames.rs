//! Lights that a frame keeps of the one before, and those that it may replace.

use super::{Frame, Sampling, lamp_at, light, point_at, room};
use glam::DVec3;
use interfaces::surface_points::SurfacePoint;
use scene::LightKind;

/// A still scene comes to rest: then every light keeps every bit.
#[test]
fn a_still_scene_comes_to_rest() {
    let spot = LightKind::Spot { inner: 0.4, outer: 0.7 };
    let scene = room(
        [0.5; 3],
        vec![point_at([0.3, 0.2, 0.1], [1.0; 3]), light(spot, [-0.2, 0.1, 0.0], [0.2, 0.1, 1.0], [9.0; 3])],
    );
    let sampling = Sampling::of(200, 8);
    let Some(rest) = sampling.at_rest(&scene, 60) else { return };
    let mut points = rest.points.clone();
    for _ in 0..2 {
        let frame = sampling.frame(&scene, Some(&points)).expect("the adapter is still there");
        assert_eq!(frame.points, points);
        assert_eq!(frame.lights, rest.lights);
        points = frame.points;
    }
    assert_evenly_spread(&rest, 0..200);
}

/// No light that is nearest to another of its source would be a tenth farther from all others anywhere else.
fn assert_evenly_spread(frame: &Frame, slots: std::ops::Range<usize>) {
    let ends = slots.clone().map(|slot| frame.shares[slot]);
    let mut ranges: Vec<_> =
        ends.map(|[source, first, end, ..]| (source, first as usize, end as usize)).collect();
    ranges.dedup();
    // The most crowded light of all sources, by distance over the mean distance of its source.
    let crowd = |slot: usize, at: DVec3, first: usize, end: usize| {
        let others = (first..end).filter(|other| *other != slot);
        others.map(|other| frame.place(other).distance(at)).fold(f64::INFINITY, f64::min)
    };
    let density = |slot: usize| f64::from(f32::from_bits(frame.shares[slot][4])).sqrt();
    let all = ranges.iter().flat_map(|(_, first, end)| (*first..*end).map(|slot| (slot, *first, *end)));
    let least = all
        .map(|(slot, first, end)| {
            (crowd(slot, frame.place(slot), first, end) * density(slot), slot, first, end)
        })
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let (least, slot, first, end) = least.expect("there are lights");
    let per_slot = frame.probes.len() / frame.sites.len();
    let hole = frame.probes[first * per_slot..end * per_slot]
        .iter()
        .map(|probe| crowd(slot, DVec3::from([0, 1, 2].map(|k| f64::from(probe[k]))), first, end))
        .fold(0.0, f64::max);
    let hole = hole * density(slot);
    assert!(hole <= 1.1 * least * 1.001, "slot {slot}: {least} from its neighbour, and {hole} elsewhere");
    assert!(hole > 0.0 && least > 0.5, "{least}");
}

/// The first frame places all lights, with a history buffer that is empty as without one.
#[test]
fn the_first_frame_places_all_lights() {
    let (scene, sampling) = (lamp_at([0.3, 0.2, 0.1]), Sampling::of(100, 4));
    let Some(frame) = sampling.frame(&scene, None) else { return };
    assert_eq!((frame.header.marked, frame.header.iteration, frame.waiting()), (100, 0, 0));
    assert!(frame.points.iter().all(|point| point.mark == 1 && !point.is_none()));
    let fed = sampling.harness(&scene).feedback("past", "points");
    let outputs = fed.run().expect("the adapter is still there");
    assert_eq!(outputs.surface_points("points"), (frame.header, frame.points.clone()));
    assert_eq!(outputs.lights("lights"), frame.lights);
    // The second frame goes on from it.
    let second = sampling.harness(&scene).feedback("past", "points").frames(2).run();
    let (header, points) = second.expect("the adapter is still there").surface_points("points");
    let next = sampling.frame(&scene, Some(&frame.points)).expect("the adapter is still there");
    assert_eq!((header.iteration, header.marked), (1, next.header.marked));
    let places = |points: &[SurfacePoint]| points.iter().map(|point| point.position).collect::<Vec<_>>();
    assert_eq!(places(&points), places(&next.points));
}

/// Every run of a seed is the same, and another seed has other lights.
#[test]
fn seeds_repeat_and_differ() {
    let (scene, sampling) = (lamp_at([0.3, 0.2, 0.1]), Sampling::of(64, 4));
    let positions = |seed: u32| {
        let (_, points) = sampling.harness(&scene).seed(seed).run()?.surface_points("points");
        Some(points)
    };
    let Some(first) = positions(1) else { return };
    assert_eq!(positions(1).as_ref(), Some(&first));
    let other = positions(2).expect("the adapter is still there");
    assert!(std::iter::zip(&first, &other).all(|(a, b)| a.position != b.position && a.seed != b.seed));
}

/// A frame after which the budget is used up has placed as many lights as it may, and no other light has moved.
#[test]
fn a_frame_places_no_more_lights_than_it_may() {
    let (before, after) = (lamp_at([-0.5, 0.2, 0.0]), lamp_at([0.5, 0.2, 0.3]));
    for moved in [1, 8, 100, 256] {
        let sampling = Sampling::of(100, moved);
        let Some(mut frame) = sampling.frame(&before, None) else { return };
        for _ in 0..3 {
            let next = sampling.frame(&after, Some(&frame.points)).expect("the adapter is still there");
            let changed = next.changed(&frame.points);
            assert!(changed.len() <= moved as usize, "{} of {moved}", changed.len());
            assert_eq!(
                next.header.marked as usize,
                next.points.iter().filter(|point| point.mark == 1).count()
            );
            assert!(changed.iter().all(|slot| next.points[*slot].mark == 1));
            assert!(next.header.marked <= moved && (moved > 8 || next.header.marked == moved));
            frame = next;
        }
    }
}
