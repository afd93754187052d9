//! The mean over frames: where it goes on from, of how many frames it is, and what changes of light do to it.

use interfaces::progress::Progress;
use pass::{Format, ResourceDesc};
use pass_test::{Harness, buffer, member};
use temporal_accumulation::PASS;

const INPUT: (&str, &str) = ("irradiance", "Irradiance");
const OUTPUT: &str = "accumulated";

const SIDE: usize = 8;

/// The mean of the frames before: linear over the picture.
fn ramp(x: f32, y: f32) -> [f32; 4] {
    [1.0 + 0.25 * x, 3.0 - 0.125 * y, 2.0 + 0.5 * x + 0.25 * y, 1.0]
}

fn texture<T: bytemuck::NoUninit>(
    name: &str,
    format: Format,
    of: impl Fn(usize, usize) -> T,
) -> (&str, ResourceDesc, Vec<u8>) {
    let texels: Vec<T> = (0..SIDE * SIDE).map(|i| of(i % SIDE, i / SIDE)).collect();
    member(name, ResourceDesc::texture_2d(format, (SIDE as u32, SIDE as u32)), &texels)
}

/// A frame of `now` after a mean of `before` frames.
#[derive(Clone, Copy)]
struct Case {
    now: [f32; 4],
    before: f32,
    /// From where a pixel is to where it was \[px\].
    motion: [f32; 2],
    texels: u32,
    still: u32,
}

impl Case {
    /// Returns the mean and the number of its frames, row by row.
    fn run(self, set: &[(&str, u32)]) -> Option<(Vec<[f32; 4]>, Vec<f32>)> {
        let Case { now, before, motion, texels, still } = self;
        let place = |x: usize, y: usize| [x as f32 + 0.5 + motion[0], y as f32 + 0.5 + motion[1]];
        let still = Progress { step: still, ..Progress::default() };
        let mut harness = Harness::new(PASS)
            .frame(SIDE as u32, SIDE as u32)
            .input(INPUT.0, INPUT.1, &[], vec![texture("", Format::Rgba32Float, |_, _| now)])
            .input(
                "reprojection",
                "Reprojection",
                &[],
                vec![
                    texture("place", Format::Rg32Float, place),
                    texture("texels", Format::R32Uint, |_, _| texels),
                ],
            )
            .input("still", "Progress", &[], vec![("", buffer(16), bytemuck::bytes_of(&still).to_vec())])
            .past(
                "past",
                "FrameMean",
                1,
                vec![
                    texture("value", Format::Rgba32Float, |x, y| ramp(x as f32, y as f32)),
                    texture("frames", Format::R32Float, |_, _| before),
                ],
            );
        for (name, value) in set {
            harness = harness.set(name, *value);
        }
        let outputs = harness.run()?;
        let mean = outputs.read("mean.value");
        assert_eq!(mean, outputs.read::<[f32; 4]>(OUTPUT));
        Some((mean, outputs.read("mean.frames")))
    }
}

fn assert_near(found: [f32; 4], expected: [f32; 4]) {
    let near = std::iter::zip(found, expected).all(|(a, b)| (a - b).abs() < 1e-5);
    assert!(near, "{found:?} and {expected:?}");
}

/// What `frames` frames have, of which the last is `now` and the others have the mean `before`.
fn mean_of(before: [f32; 4], now: [f32; 4], frames: f32) -> [f32; 4] {
    std::array::from_fn(|c| (before[c] * (frames - 1.0) + now[c]) / frames)
}

const MOVED: Case =
    Case { now: [2.0, 2.0, 6.0, 1.0], before: 5.0, motion: [0.3, -0.4], texels: 15, still: 9 };

/// A cubic interpolation keeps what is linear, and so does one of four texels, at the edge of the picture.
#[test]
fn the_mean_goes_on_from_where_the_surface_was() {
    let Some((mean, frames)) = MOVED.run(&[]) else { return };
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
        let Some((mean, _)) = (Case { texels, ..MOVED }).run(&[]) else { return };
        assert_near(mean[3 * SIDE + 3], mean_of(ramp(3.0 + x, 3.0 + y), MOVED.now, 6.0));
    }
    let Some((mean, frames)) = (Case { texels: 0, ..MOVED }).run(&[]) else { return };
    assert!(mean.iter().all(|mean| *mean == MOVED.now), "what has come into view begins anew");
    assert!(frames.iter().all(|frames| *frames == 1.0));
}

#[test]
fn the_mean_is_of_as_many_frames_as_may_be() {
    let Some((mean, frames)) = (Case { motion: [0.0; 2], ..MOVED }).run(&[("frames", 3)]) else { return };
    assert!(frames.iter().all(|frames| *frames == 3.0));
    assert_near(mean[2 * SIDE + 5], mean_of(ramp(5.0, 2.0), MOVED.now, 3.0));
}

/// The frame is the same everywhere: a mean that is drawn to it is the same.
#[test]
fn a_change_of_light_is_seen_at_once() {
    let Some((mean, frames)) = (Case { still: 0, motion: [0.0; 2], ..MOVED }).run(&[]) else { return };
    mean.iter().for_each(|mean| assert_near(*mean, MOVED.now));
    assert!(frames.iter().all(|frames| *frames == 2.0));
}
