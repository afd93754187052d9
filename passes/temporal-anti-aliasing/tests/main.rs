//! The mean of pictures: of how many frames it is, and to what it is drawn where anything moves.

use interfaces::reprojection::STANDS_STILL;
use pass_test::frame_mean::{self, Followed, MOVED, Means, assert_near, mean_of, ramp};

const SIDE: usize = frame_mean::SIDE as usize;

/// Returns the mean, the number of its frames and their variance, row by row.
fn run(case: Followed, set: &[(&str, u32)]) -> Option<Means> {
    case.run(temporal_anti_aliasing::PASS, ("radiance", "Radiance"), "image", set)
}

#[test]
fn where_nothing_moves_the_mean_is_of_all_frames() {
    let Some((mean, frames, _)) = run(Followed { motion: [0.0; 2], texels: 1 | STANDS_STILL, ..MOVED }, &[])
    else {
        return;
    };
    assert!(frames.iter().all(|frames| *frames == 6.0));
    for y in 0..SIDE {
        for x in 0..SIDE {
            assert_near(mean[y * SIDE + x], mean_of(ramp(x as f32, y as f32), MOVED.now, 6.0));
        }
    }
}

/// The frame is the same everywhere: a mean that is drawn to it is the same.
#[test]
fn where_anything_moves_the_mean_is_drawn_to_the_frame() {
    for case in [
        Followed { motion: [0.3, 0.0], texels: 1, ..MOVED },
        Followed { motion: [0.0; 2], still: 0, texels: 1 | STANDS_STILL, ..MOVED },
    ] {
        let Some((mean, frames, _)) = run(case, &[]) else { return };
        mean.iter().for_each(|mean| assert_near(*mean, MOVED.now));
        assert!(frames.iter().all(|frames| *frames == 4.0));
    }
}

#[test]
fn what_has_come_into_view_begins_anew() {
    let Some((mean, frames, _)) = run(Followed { texels: 0, ..MOVED }, &[]) else { return };
    assert!(mean.iter().all(|mean| *mean == MOVED.now) && frames.iter().all(|frames| *frames == 1.0));
}
