#![doc = include_str!("../README.md")]

use pass::{Compute, Pass, PassTypeError, RecordContext, Recording, reflected};

/// The pass type `composite`.
pub const PASS: &dyn Pass = &Composite;

struct Composite;

impl Pass for Composite {
    fn kind(&self) -> &'static str {
        "composite"
    }

    /// Adds the step for a screen, in a file of its own: with the curves as options, one file would have too many variants.
    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let recording = reflected::record(cx)?;
        if !cx.connected("display") {
            return Ok(recording);
        }
        let show = Compute::per_texel(cx.file("display.wgsl"), "show", cx.size("view"));
        Ok(recording.then(show.bind("radiance", "image")))
    }
}
