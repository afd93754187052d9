#![doc = include_str!("../README.md")]

use pass::{Compute, PassTypeError, RecordContext, Recording, reflected};

pass::from_wgsl!(record);

/// Adds the step for a screen, in a file of its own: with the curves as options, one file would have too many variants.
fn record(cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
    let recording = reflected::record(cx)?;
    if !cx.connected("display") {
        return Ok(recording);
    }
    let show = Compute::per_texel(cx.file("display.wgsl"), "show", cx.size("image"));
    Ok(recording.then(show.bind("radiance", "image")))
}
