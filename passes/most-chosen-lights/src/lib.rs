#![doc = include_str!("../README.md")]

use gpu_algorithms::select;
use interfaces::{reservoirs, virtual_lights};
use pass::{Compute, OutputDesc, Outputs, PassTypeError, RecordContext, Recording, Threads};

pass::from_wgsl!(outputs, record);

fn outputs(cx: &Outputs<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
    let mut outputs = cx.declared()?;
    outputs.push(OutputDesc::scratch_u32("times", cx.fact("lights", virtual_lights::COUNT)?));
    outputs.push(select::scratch(&cx.use_cx, "selection")?);
    Ok(outputs)
}

fn record(cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
    let shader = cx.file("most-chosen-lights.wgsl");
    let lights = cx.fact("lights", virtual_lights::COUNT)?;
    let (width, height) = cx.size("view");
    let chosen = width * height * cx.fact("reservoirs", reservoirs::PER_PIXEL)?;
    let step = |entry, threads| Compute::new(shader.clone(), entry, Threads::Row(threads));
    Ok(Recording::one(step("begin", lights.max(1)))
        .then(step("count", chosen))
        .then_all(select::steps(&cx.use_context(), &shader, lights, "selection")?)
        .then(step("take", 1)))
}
