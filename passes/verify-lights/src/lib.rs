#![doc = include_str!("../README.md")]

use gpu_algorithms::scan;
use interfaces::surface_points;
use pass::{Compute, OutputDesc, Outputs, PassTypeError, ReadSettings, RecordContext, Recording, Threads};

pass::from_wgsl!(outputs, record);

/// Scratch of the scan that lists the lights that are unseen.
const PLACES: &str = "places";

fn outputs(cx: &Outputs<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
    let mut outputs = cx.declared()?;
    outputs.extend(scan::scratch(&cx.use_cx, PLACES, cx.fact("lights", surface_points::COUNT)?)?);
    Ok(outputs)
}

fn record(cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
    let lights = cx.fact("lights", surface_points::COUNT)?.max(1);
    let shader = cx.file("verify-lights.wgsl");
    let of_lights = |entry| Compute::new(shader.clone(), entry, Threads::Row(lights));
    let list = scan::steps(&cx.use_context(), &shader, lights, PLACES)?;
    let mut recording = Recording::one(of_lights("follow")).then_all(list.clone());
    let threads = Threads::Indirect { buffer: "round".into(), offset: 0 };
    let cast = Compute::new(shader.clone(), "cast_rays", threads).bind("dispatched", "round");
    for _ in 0..cx.settings.u32("rounds")? {
        recording = recording.then(cast.clone()).then(of_lights("settle")).then_all(list.clone());
    }
    Ok(recording.then(of_lights("finish")))
}
