//! The count is the age of the pass's own history buffer.

use interfaces::progress::Progress;
use pass_test::{Harness, ResetCause};

#[test]
fn frames_are_counted_from_the_last_reset() {
    for (frames, reset, expected) in [(1, None, 0), (4, None, 3), (4, Some(2), 1), (4, Some(3), 0)] {
        let harness = Harness::new(still_frames::PASS)
            .input("of", "ReflectiveShadowMap", &[], Vec::new())
            .feedback("past", "still")
            .frames(frames);
        let harness = match reset {
            Some(frame) => harness.event(frame, ResetCause::Scene),
            None => harness,
        };
        let Some(outputs) = harness.run() else { return };
        let found: Vec<Progress> = outputs.read("still");
        assert_eq!(found[0].step, expected, "{frames} frames, reset before {reset:?}");
    }
}
