//! Passes that add a frame to a mean which follows what pixels show: one frame of one value, after a mean that is a ramp.

use crate::view::picture;
use crate::{Harness, buffer};
use interfaces::progress::Progress;
use pass::{Format, Pass};

/// The side of the picture \[px\].
pub const SIDE: u32 = 8;

/// A frame of `now` after a mean of `before` frames, which is [`ramp`].
#[derive(Clone, Copy, Debug)]
pub struct Followed {
    /// The value of each pixel of the frame.
    pub now: [f32; 4],
    /// The number of frames before.
    pub before: f32,
    /// From where a pixel is to where what it shows was \[px\].
    pub motion: [f32; 2],
    /// The member `texels` of the port `reprojection`.
    pub texels: u32,
    /// Frames since lights or geometry have moved.
    pub still: u32,
}

/// A mean of five frames, in which the picture was 0.3 px to the right and 0.4 px above; the light has not changed.
pub const MOVED: Followed =
    Followed { now: [2.0, 2.0, 6.0, 1.0], before: 5.0, motion: [0.3, -0.4], texels: 15, still: 9 };

/// The mean, the number of its frames and the variance of their luminance, row by row.
pub type Means = (Vec<[f32; 4]>, Vec<f32>, Vec<f32>);

impl Followed {
    /// Returns what a pass makes of the frame at its input `name`, of the interface `interface`; `None` where there is no adapter.
    ///
    /// # Panics
    /// Where its output `shown` is another picture than the mean.
    pub fn run(
        self,
        pass: &dyn Pass,
        (name, interface): (&str, &str),
        shown: &str,
        set: &[(&str, u32)],
    ) -> Option<Means> {
        let Followed { now, before, motion, texels, still } = self;
        let size = (SIDE, SIDE);
        let place = |x: u32, y: u32| [x as f32 + 0.5 + motion[0], y as f32 + 0.5 + motion[1]];
        let still = Progress { step: still, ..Progress::default() };
        let reprojection = vec![
            picture("place", Format::Rg32Float, size, place),
            picture("texels", Format::R32Uint, size, |_, _| texels),
        ];
        let past = vec![
            picture("value", Format::Rgba32Float, size, |x, y| ramp(x as f32, y as f32)),
            picture("frames", Format::Rg32Float, size, |_, _| [before, 0.0]),
        ];
        let mut harness = Harness::new(pass)
            .frame(SIDE, SIDE)
            .input(name, interface, &[], vec![picture("", Format::Rgba32Float, size, |_, _| now)])
            .input("reprojection", "Reprojection", &[], reprojection)
            .input("still", "Progress", &[], vec![("", buffer(16), bytemuck::bytes_of(&still).to_vec())])
            .past("past", "FrameMean", 1, past);
        for (name, value) in set {
            harness = harness.set(name, *value);
        }
        let outputs = harness.run()?;
        let mean = outputs.read("mean.value");
        assert_eq!(mean, outputs.read::<[f32; 4]>(shown));
        let (frames, variance) = outputs.read::<[f32; 2]>("mean.frames").into_iter().map(Into::into).unzip();
        Some((mean, frames, variance))
    }
}

/// The mean of the frames before: linear over the picture.
pub fn ramp(x: f32, y: f32) -> [f32; 4] {
    [1.0 + 0.25 * x, 3.0 - 0.125 * y, 2.0 + 0.5 * x + 0.25 * y, 1.0]
}

/// What `frames` frames have, of which the last is `now` and the others have the mean `before`.
pub fn mean_of(before: [f32; 4], now: [f32; 4], frames: f32) -> [f32; 4] {
    std::array::from_fn(|c| (before[c] * (frames - 1.0) + now[c]) / frames)
}

/// Asserts that two values differ by rounding alone.
///
/// # Panics
/// Where they do not.
pub fn assert_near(found: [f32; 4], expected: [f32; 4]) {
    let near = std::iter::zip(found, expected).all(|(a, b)| (a - b).abs() < 1e-5);
    assert!(near, "{found:?} and {expected:?}");
}
