#![doc = include_str!("../README.md")]

use gpu_algorithms::segmented_scan;
use interfaces::virtual_lights;
use pass::{OutputDesc, Outputs, PassTypeError, ReadSettings, RecordContext, Recording, Settings, reflected};

pass::from_wgsl!(outputs, record);

/// Whether candidates are chosen by sums of the lights' flux.
fn is_by_power(settings: &Settings, has_tree: bool) -> Result<bool, PassTypeError> {
    let descends = has_tree && settings.bool("descend")?;
    Ok(!descends && settings.text("proposal")? == "power")
}

fn outputs(cx: &Outputs<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
    let mut outputs = cx.declared()?;
    if is_by_power(cx.settings, cx.input("tree").is_some())? {
        outputs.push(OutputDesc::scratch_u32("power_sums", cx.fact("lights", virtual_lights::COUNT)?.max(1)));
    }
    Ok(outputs)
}

fn record(cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
    let mut recording = Recording::default();
    if is_by_power(cx.settings, cx.connected("tree"))? {
        recording = recording.then(segmented_scan(&cx.file("cumulate.wgsl"), 1, 1));
    }
    recording.steps.extend(reflected::record(cx)?.steps);
    Ok(recording)
}
