#![doc = include_str!("../README.md")]

use gpu_algorithms::{parts, reduce};
use pass::{
    Compute, OutputDesc, Outputs, PassTypeError, ReadSettings, RecordContext, Recording, Settings, Struct,
    Threads,
};

pass::from_wgsl!(outputs, record);

const SCALED: Struct = Struct::new("shaders/algorithms/scaled.wgsl", "Scaled");

/// The most proposals whose importance is stored at once.
const STORED: u32 = 1 << 22;

/// Chains, proposals of each, and chains that are followed at once.
fn numbers(settings: &Settings) -> Result<(u32, u32, u32), PassTypeError> {
    let (count, steps) = (settings.u32("count")?, settings.u32("steps")?);
    Ok((count, steps, (STORED / steps).min(count)))
}

/// Whether weights are normalised by the mean over the proposals of all chains.
fn sums_all(settings: &Settings) -> Result<bool, PassTypeError> {
    Ok(settings.text("weights")? == "none")
}

fn outputs(cx: &Outputs<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
    let (count, steps, chains) = numbers(cx.settings)?;
    let mut outputs = cx.declared()?;
    outputs.push(OutputDesc::scratch_u32("proposed", chains * steps));
    if sums_all(cx.settings)? {
        outputs.push(reduce::scratch(&cx.use_cx, "sums", count * steps, cx.use_cx.size_of(SCALED)?)?);
        outputs.push(cx.scratch("sum", SCALED, 1)?);
    }
    Ok(outputs)
}

fn record(cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
    let (count, steps, chains_at_once) = numbers(cx.settings)?;
    let mut recording = Recording::default();
    if sums_all(cx.settings)? {
        let mean = cx.file("mean.wgsl");
        recording = Recording::of(reduce::steps(&cx.use_context(), &mean, count * steps, "sums")?);
    }
    let shader = cx.file("sample-metropolis.wgsl");
    for part in parts(count, chains_at_once) {
        let chains = part.end.min(count) - part.begin;
        for (entry, threads) in [("propose", chains * steps), ("sample", chains)] {
            let step = Compute::new(shader.clone(), entry, Threads::Row(threads));
            recording = recording.then(step.value("first", part.begin).value("chains", chains));
        }
    }
    Ok(recording)
}
