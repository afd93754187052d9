#![doc = include_str!("../README.md")]

use gpu_algorithms::reduce;
use pass::{Compute, OutputDesc, Outputs, PassTypeError, ReadSettings, RecordContext, Recording, Threads};

pass::from_wgsl!(outputs, record);

fn outputs(cx: &Outputs<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
    if cx.settings.text("place")? == "texel" && cx.input("rsm").is_none() {
        return Err(PassTypeError::input("rsm", "lights are at a texel each, and there are no texels")
            .help("link the reflective shadow map, or take `place: \"mean\"`"));
    }
    cx.declared()
}

fn record(cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
    let shader = cx.file("lights-from-clusters.wgsl");
    let lights = cx.fact("lights", interfaces::virtual_lights::COUNT)?;
    let make = Compute::new(shader.clone(), "make_lights", Threads::Row(lights));
    Ok(Recording::one(reduce::few(&shader)).then(make))
}
