#![doc = include_str!("../README.md")]

use gpu_algorithms::reduce;
use pass::{
    Compute, OutputDesc, Outputs, PassTypeError, ReadSettings, RecordContext, Recording, Settings, Struct,
    Threads,
};

pass::from_wgsl!(outputs, record);

/// The emptiest place.
const HOLE: Struct = Struct::new("passes/sample-incremental/slots.wgsl", "Hole");

/// Scratch of the reduction that finds the emptiest place.
const HOLES: &str = "holes";

fn outputs(cx: &Outputs<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
    let mut outputs = cx.declared()?;
    let (_, probes) = slots_and_probes(cx.settings)?;
    outputs.push(reduce::scratch(&cx.use_cx, HOLES, probes, cx.use_cx.size_of(HOLE)?)?);
    Ok(outputs)
}

fn record(cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
    let (slots, probes) = slots_and_probes(cx.settings)?;
    let step = |file: &str, entry, threads| Compute::new(cx.file(file), entry, Threads::Row(threads));
    let use_cx = cx.use_context();
    let together = use_cx.constant("passes/sample-incremental/cells.wgsl", "TOGETHER")?;
    let relax = reduce::steps(&use_cx, &cx.file("relax.wgsl"), probes, HOLES)?;
    let mut recording = Recording::one(step("sample-incremental.wgsl", "verify", slots))
        .then(step("cells.wgsl", "assign", probes.div_ceil(together)))
        .then(step("cells.wgsl", "separate", slots))
        .then(step("choose.wgsl", "begin", 1));
    for _ in 0..cx.settings.u32("moved")?.min(slots) {
        recording = recording.then_all(relax.clone()).then(step("choose.wgsl", "choose", 1));
    }
    Ok(recording.then(step("count.wgsl", "count", probes)).then(step(
        "sample-incremental.wgsl",
        "emit",
        slots,
    )))
}

/// Returns the number of lights, and of the directions by which their cells are counted.
fn slots_and_probes(settings: &Settings) -> Result<(u32, u32), PassTypeError> {
    let slots = settings.u32("count")?;
    Ok((slots, slots * settings.u32("probes")?))
}
