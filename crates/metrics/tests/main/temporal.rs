//! What changes from frame to frame.

use metrics::temporal::{
    ErrorSeries, FrameError, Pinhole, TRACKED_PIXELS, TemporalDifference, Tid, View, temporal_difference,
    tracked_pixels,
};
use metrics::{Image, ImageError};

const TOLERANCE: f64 = 0.01;

/// At (x, 0, 0), looking along −z, with a right angle from edge to edge.
fn camera_at(x: f64) -> Pinhole {
    Pinhole {
        position: [x, 0.0, 0.0],
        right: [1.0, 0.0, 0.0],
        up: [0.0, 1.0, 0.0],
        back: [0.0, 0.0, 1.0],
        half_extent: [1.0, 1.0],
    }
}

fn grey(width: usize, values: &[f32]) -> Image {
    let pixels = values.iter().map(|&value| [value, value, value, 1.0]).collect();
    Image::new(width, values.len() / width, pixels).unwrap()
}

#[track_caller]
fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-6, "{found} instead of {expected}");
}

#[test]
fn a_still_camera_sees_the_difference_of_the_frames() {
    let (first, second) = (grey(3, &[1.0, 2.0, 3.0]), grey(3, &[1.0, 5.0, -1.0]));
    // The last pixel sees nothing, and does not count.
    let depth = grey(3, &[2.0, 7.0, 0.0]);
    let view = |image| View { image, depth: &depth, camera: camera_at(0.3) };
    let same = temporal_difference(&view(&first), &view(&first), TOLERANCE).unwrap();
    assert_eq!(same, TemporalDifference { matched: 2, ..Default::default() });
    assert_eq!(same.rms(), Some(0.0));
    let found = temporal_difference(&view(&first), &view(&second), TOLERANCE).unwrap();
    close(found.sum_of_squares, 9.0);
    close(found.rms().unwrap(), 4.5_f64.sqrt());
}

#[test]
fn what_hides_and_what_leaves_by_hand() {
    // Across 8 pixels, a pixel is 2 m wide at 8 m and 1 m at 4 m. The camera goes 2 m to the right: the
    // wall at 8 m moves a pixel to the left, the pole at 4 m two.
    let mut depth = [[8.0; 8]; 2];
    depth[0][5] = 4.0;
    depth[1][3] = 4.0;
    let [before, after] = depth.map(|row| grey(8, &row));
    // Of the wall, pixel 0 leaves, and pixel 4 ends behind the pole. The pole brightens from 1 to 3, and
    // what pixel 7 sees, then in pixel 6, from 0 to 1.
    let first = grey(8, &[0.0, 0.5, 0.0, 0.0, 9.0, 1.0, 0.0, 0.0]);
    let second = grey(8, &[0.5, 0.0, 0.0, 3.0, 7.0, 0.0, 1.0, 7.0]);
    let view = |image, depth, x| View { image, depth, camera: camera_at(x) };
    let (previous, current) = (view(&first, &before, 0.0), view(&second, &after, 2.0));
    let found = temporal_difference(&previous, &current, TOLERANCE).unwrap();
    assert_eq!((found.matched, found.disoccluded, found.outside, found.non_finite), (6, 1, 1, 0));
    close(found.sum_of_squares, 5.0);
    // At any tolerance of 1 or more, the wall passes for the pole: (3 − 9)² comes in.
    let blind = temporal_difference(&previous, &current, 1.0).unwrap();
    assert_eq!((blind.matched, blind.disoccluded), (7, 0));
    close(blind.sum_of_squares, 41.0);
}

#[test]
fn a_shift_by_whole_pixels_changes_nothing() {
    // At 8 m and 16 pixels a pixel is 1 m wide: the noise on the wall moves by three pixels.
    let noise = |metre: usize, y: usize| ((metre * 73 + y * 151) % 97) as f32;
    let depth = grey(16, &[8.0; 256]);
    let seen_from = |x0: usize| Image::from_fn(16, 16, |x, y| [noise(x + x0, y), 0.0, 0.0, 1.0]).unwrap();
    let (first, second) = (seen_from(0), seen_from(3));
    let previous = View { image: &first, depth: &depth, camera: camera_at(0.0) };
    let current = View { image: &second, depth: &depth, camera: camera_at(3.0) };
    let found = temporal_difference(&previous, &current, TOLERANCE).unwrap();
    assert_eq!(found, TemporalDifference { matched: 13 * 16, outside: 3 * 16, ..Default::default() });
}

#[test]
fn a_textured_floor_under_a_moving_camera_changes_by_half_a_pixel_at_most() {
    const SIDE: usize = 64;
    // 1.5 m above the floor y = 0, turned down by 45°, then moved and turned further.
    let camera = |x: f64, z: f64, down: f64| Pinhole {
        position: [x, 1.5, z],
        right: [1.0, 0.0, 0.0],
        up: [0.0, down.cos(), -down.sin()],
        back: [0.0, down.sin(), down.cos()],
        half_extent: [0.5, 0.5],
    };
    let see = |camera: Pinhole| {
        let point =
            |x: usize, y: usize, depth| camera.world(x as f64 + 0.5, y as f64 + 0.5, depth, (SIDE, SIDE));
        let depth = |x: usize, y: usize| 1.5 / (1.5 - point(x, y, 1.0)[1]);
        let value = |x: usize, y: usize| {
            let [x, _, z] = point(x, y, depth(x, y));
            2.0 + (3.0 * x).sin() + (3.0 * z).cos()
        };
        let picture = |value: &dyn Fn(usize, usize) -> f64| {
            Image::from_fn(SIDE, SIDE, |x, y| [value(x, y) as f32; 4]).unwrap()
        };
        (picture(&value), picture(&depth), camera)
    };
    let frames = [see(camera(0.0, 0.0, 0.8)), see(camera(0.11, -0.07, 0.83))];
    let [previous, current] =
        frames.each_ref().map(|(image, depth, camera)| View { image, depth, camera: *camera });
    // A pixel at depth d is d/64 wide; on the floor its height is stretched by at most 1/sin of the flattest
    // ray, some 3.5. The texture's slope is at most 3 in x and in z.
    let found = temporal_difference(&previous, &current, 0.05).unwrap();
    let farthest = frames[0].1.pixels().iter().map(|pixel| f64::from(pixel[0])).fold(0.0, f64::max);
    let half_a_pixel = 3.0 * 0.5 * farthest / SIDE as f64 * (1.0 + 3.5);
    let rms = found.rms().unwrap();
    assert!(rms > 0.0 && rms < half_a_pixel, "{rms} against {half_a_pixel}");
    assert_eq!(found.disoccluded, 0, "a plane hides nothing");
    assert!(found.matched > SIDE * SIDE * 8 / 10, "{found:?}");
    // Without reprojection the texture slides past the pixels.
    let still = View { camera: previous.camera, ..current };
    let sliding = temporal_difference(&previous, &still, 1.0).unwrap().rms().unwrap();
    assert!(rms < 0.3 * sliding, "{rms} against {sliding}");
}

#[test]
fn broken_pixels_and_wrong_sizes_are_told() {
    let (image, depth) = (grey(2, &[f32::NAN, 1.0]), grey(2, &[1.0, 1.0]));
    let view = View { image: &image, depth: &depth, camera: camera_at(0.0) };
    let found = temporal_difference(&view, &view, TOLERANCE).unwrap();
    assert_eq!((found.matched, found.non_finite), (1, 1));
    let nowhere = grey(2, &[f32::NAN, f32::INFINITY]);
    let lost = temporal_difference(&View { depth: &nowhere, ..view }, &view, TOLERANCE).unwrap();
    assert_eq!((lost, lost.rms()), (TemporalDifference::default(), None));
    let small = grey(1, &[1.0]);
    let error = temporal_difference(&View { depth: &small, ..view }, &view, TOLERANCE).unwrap_err();
    assert!(matches!(error, ImageError::SizesDiffer { what: "the previous depth", .. }), "{error}");
}

#[test]
fn a_walk_is_judged_over_all_its_pixels() {
    let mut tid = Tid::default();
    assert_eq!(tid.value(), None);
    tid.add(&TemporalDifference { sum_of_squares: 4.0, matched: 1, ..Default::default() });
    assert_eq!(tid.value(), Some(2.0));
    tid.add(&TemporalDifference { sum_of_squares: 0.0, matched: 3, ..Default::default() });
    assert_eq!(tid.value(), Some(1.0), "not the mean of the two frames");
}

#[test]
fn errors_over_time_by_hand() {
    // After L / (1 + L): 1/2 3/4 against 0 1/2, so E is 1/2, then 1/4; the other pixel is right, then 1/2 off.
    let mut series = ErrorSeries::default();
    assert_eq!((series.average_error(), series.average_change(0.5)), (None, None), "no frame");
    assert_eq!(series.add([(1.0, 0.0), (1.0, 1.0)]), FrameError { error: 0.25, change: None });
    assert_eq!((series.average_error(), series.average_change(0.5)), (Some(0.25), None), "one frame");
    assert_eq!(series.add([(3.0, 1.0), (0.0, 1.0)]), FrameError { error: 0.375, change: Some(0.375) });
    close(series.average_error().unwrap(), (0.5 + 0.0 + 0.25 + 0.5) / 4.0);
    close(series.average_change(0.5).unwrap(), (0.25 / 0.5 + 0.5 / 0.5) / 2.0);
    assert_eq!(series.average_change(0.0), None, "no time passes");
    // A constant error does not flicker, and what is negative is 0.
    let of = |frames: &[&[(f64, f64)]]| {
        let mut series = ErrorSeries::default();
        for frame in frames {
            series.add(frame.iter().copied());
        }
        (series.average_error(), series.average_change(0.1))
    };
    assert_eq!(of(&[&[(1.0, -1.0)], &[(1.0, 0.0)]]), (Some(0.5), Some(0.0)));

    assert_eq!(of(&[&[(1.0, 1.0), (0.0, 0.0)], &[(1.0, 1.0)]]), (Some(0.0), None), "a pixel is missing");
    assert_eq!(of(&[&[], &[]]), (None, None), "no pixels");
    for broken in [f64::NAN, f64::INFINITY] {
        assert_eq!(of(&[&[(broken, 0.0)], &[(0.0, 0.0)]]), (None, None));
        assert_eq!(of(&[&[(0.0, 0.0)], &[(0.0, broken)]]), (None, None));
    }
}

#[test]
fn tracked_pixels_are_spread_over_what_is_seen() {
    // Twice as wide as high: eight pixels, one in each eighth.
    let all = grey(64, &[1.0; 64 * 32]);
    let mut eighths: Vec<_> =
        tracked_pixels(&all, TRACKED_PIXELS).into_iter().map(|(x, y)| (x / 16, y / 16)).collect();
    eighths.sort_unstable();
    eighths.dedup();
    assert_eq!(eighths.len(), 8, "{eighths:?}");

    // Where the left half sees nothing, none is tracked; NaN is nothing, too.
    let half: Vec<f32> = (0..16).map(|pixel| [0.0, f32::NAN, 1.0, 1.0][pixel % 4]).collect();
    let tracked = tracked_pixels(&grey(4, &half), 2);
    assert!(tracked.iter().all(|&(x, _)| x >= 2), "{tracked:?}");
    assert_eq!(tracked.iter().map(|&(_, y)| y / 2).collect::<Vec<_>>(), [1, 0], "one in each quarter");

    assert_eq!(tracked_pixels(&grey(2, &[0.0, 1.0]), 8), [(1, 0)], "no more than are seen");
    assert_eq!(tracked_pixels(&grey(2, &[0.0, 0.0]), 8), []);
    assert_eq!(tracked_pixels(&all, 0), []);
}
