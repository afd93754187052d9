//! The mean over frames: where it goes on from, of how many frames it is, and what changes of light do to it.

use pass_test::frame_mean::{self, Followed, MOVED, Means, assert_near, mean_of, ramp};

const SIDE: usize = frame_mean::SIDE as usize;

/// Returns the mean, the number of its frames and their variance, row by row.
fn run(case: Followed, set: &[(&str, u32)]) -> Option<Means> {
    case.run(temporal_accumulation::PASS, ("irradiance", "Irradiance"), "accumulated", set)
}

/// A cubic interpolation keeps what is linear, and so does one of four texels, at the edge of the picture.
#[test]
fn the_mean_goes_on_from_where_the_surface_was() {
    let Some((mean, frames, _)) = run(MOVED, &[]) else { return };
    for y in 1..SIDE {
        for x in 0..SIDE - 1 {
            let before = ramp(x as f32 + 0.3, y as f32 - 0.4);
            assert_near(mean[y * SIDE + x], mean_of(before, MOVED.now, 6.0));
        }
    }
    let inside = |i: &usize| i % SIDE < SIDE - 1 && *i >= SIDE;
    assert!((0..SIDE * SIDE).filter(inside).all(|i| (frames[i] - 6.0).abs() < 1e-5), "{frames:?}");
}

#[test]
fn texels_of_other_surfaces_do_not_count() {
    // The place lies between the pixel and the one to the right, above both: bit 2 is the pixel, bit 1 the one right above.
    for (texels, [x, y]) in [(1, [0.0, -1.0]), (2, [1.0, -1.0]), (4, [0.0, 0.0]), (8, [1.0, 0.0])] {
        let Some((mean, ..)) = run(Followed { texels, ..MOVED }, &[]) else { return };
        assert_near(mean[3 * SIDE + 3], mean_of(ramp(3.0 + x, 3.0 + y), MOVED.now, 6.0));
    }
    let Some((mean, frames, _)) = run(Followed { texels: 0, ..MOVED }, &[]) else { return };
    assert!(mean.iter().all(|mean| *mean == MOVED.now), "what has come into view begins anew");
    assert!(frames.iter().all(|frames| *frames == 1.0));
}

#[test]
fn the_mean_is_of_as_many_frames_as_may_be() {
    let Some((mean, frames, _)) = run(Followed { motion: [0.0; 2], ..MOVED }, &[("frames", 3)]) else {
        return;
    };
    assert!(frames.iter().all(|frames| *frames == 3.0));
    assert_near(mean[2 * SIDE + 5], mean_of(ramp(5.0, 2.0), MOVED.now, 3.0));
}

/// The frame is the same everywhere: a mean that is drawn to it is the same.
#[test]
fn a_change_of_light_is_seen_at_once() {
    let Some((mean, frames, _)) = run(Followed { still: 0, motion: [0.0; 2], ..MOVED }, &[]) else { return };
    mean.iter().for_each(|mean| assert_near(*mean, MOVED.now));
    assert!(frames.iter().all(|frames| *frames == 2.0));
}

/// Of five equal frames and a sixth that is away from them, the variance is 5/36 of the square of that.
#[test]
fn the_variance_is_that_of_the_frames() {
    let Some((_, _, variance)) = run(Followed { motion: [0.0; 2], ..MOVED }, &[]) else { return };
    for (i, variance) in variance.iter().enumerate() {
        let before = ramp((i % SIDE) as f32, (i / SIDE) as f32);
        let away: f32 = [0.2126, 0.7152, 0.0722]
            .iter()
            .enumerate()
            .map(|(c, part)| part * (MOVED.now[c] - before[c]))
            .sum();
        assert!((variance - 5.0 / 36.0 * away * away).abs() < 1e-5, "{i}: {variance} for {away}");
    }
}
