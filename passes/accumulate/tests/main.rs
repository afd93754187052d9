//! The mean over frames, and when it is done.

use interfaces::progress::Progress;
use pass::{Format, ResourceDesc};
use pass_test::{Harness, Outputs, member};

const PIXELS: [[f32; 4]; 3] = [[1.0, 2.0, 3.0, 1.0], [0.0; 4], [1e30, 4.0, 0.5, 1.0]];

/// Runs the pass with the same picture in each of `count` frames.
fn after(count: u32, frames: u32, past: bool) -> Option<Outputs> {
    let picture = ResourceDesc::texture_2d(Format::Rgba32Float, (3, 1));
    let harness = Harness::new(accumulate::PASS).set("frames", frames).frames(count).input(
        "radiance",
        "Radiance",
        &[],
        vec![member("", picture, &PIXELS)],
    );
    let harness = if past { harness.feedback("past", "mean") } else { harness };
    harness.run()
}

fn progress(outputs: &Outputs) -> Progress {
    let found: Vec<Progress> = outputs.read("mean.progress");
    found[0]
}

#[test]
fn the_mean_is_taken_until_there_are_enough_frames() {
    for (count, taken, done) in [(1, 1, 0), (2, 2, 0), (4, 4, 1), (9, 4, 1)] {
        let Some(outputs) = after(count, 4, true) else { return };
        assert_eq!(progress(&outputs), Progress { step: taken, steps: 4, error: 0.0, done });
        for output in ["mean.radiance", "image"] {
            let mean: Vec<[f32; 4]> = outputs.read(output);
            assert_eq!(mean, PIXELS, "the mean of {count} equal pictures is each of them");
        }
    }
}

#[test]
fn without_a_past_each_frame_begins_again() {
    let Some(outputs) = after(3, 4, false) else { return };
    assert_eq!(progress(&outputs).step, 1);
    assert_eq!(outputs.read::<[f32; 4]>("image"), PIXELS);
}
