#![doc = include_str!("../README.md")]

use gpu_algorithms::reduce;
use interfaces::importance::VIEW_SAMPLE;
use interfaces::surface_points;
use pass::{
    Compute, OutputDesc, Outputs, PassTypeError, ReadSettings, RecordContext, Recording, Settings, Step,
    Struct, Threads, Usage, reflected,
};

pass::from_wgsl!(outputs, record);

const VALUES: Struct = Struct::new("passes/importance-map/reflectance-values.wgsl", "ReflectanceValues");
const GREATEST: Struct = Struct::new("passes/importance-map/reflectance-values.wgsl", "GreatestValues");

/// Returns the measure, and where it is evaluated.
fn choices(settings: &Settings) -> Result<(&str, &str), PassTypeError> {
    let refused = |message: &str, help| Err(PassTypeError::setting("evaluate", message).help(help));
    match (settings.text("measure")?, settings.text("evaluate")?) {
        ("contribution", "blocks") => refused(
            "importance by contribution is evaluated at texels: blocks are for `reflectance`",
            "take `texels` or `on-demand`",
        ),
        ("reflectance", "on-demand") => refused(
            "importance by reflectance is divided by its greatest value, so all texels are evaluated",
            "take `blocks` or `texels`",
        ),
        choices => Ok(choices),
    }
}

/// Returns the side of the blocks of which one texel is compared with the view \[texels\].
fn block_side(settings: &Settings) -> Result<u32, PassTypeError> {
    if settings.text("evaluate")? == "blocks" { settings.u32("stride") } else { Ok(1) }
}

/// Returns whether contributions count relative to what a sample of the view receives.
fn is_relative(settings: &Settings) -> Result<bool, PassTypeError> {
    Ok(settings.text("measure")? == "contribution" && settings.u32("rays_per_sample")? > 0)
}

fn outputs(cx: &Outputs<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
    let (measure, evaluate) = choices(cx.settings)?;
    let count = match cx.input("points") {
        Some(_) => cx.fact("points", surface_points::COUNT)?,
        None => cx.settings.u32("view_samples")?,
    };
    let values = [("samples_count", count.into())];
    let mut outputs = cx.declared_with(&values)?;
    let samples = cx.use_cx.buffer(VIEW_SAMPLE, u64::from(count))?;
    let received = is_relative(cx.settings)?.then(|| OutputDesc::scratch_u32("received", count));
    let mut hand = |members: &[&str]| {
        let port = outputs.remove(0);
        outputs.push(members.iter().fold(port, |port, member| port.handed(member, "rsm", member)));
    };
    match (measure, evaluate) {
        ("flux", _) => return Ok(outputs),
        ("contribution", "on-demand") => {
            hand(&["position", "normal", "flux"]);
            outputs[0].members.push(("samples".into(), samples, Usage::Overwrites));
            outputs.extend(received);
            return Ok(outputs);
        }
        _ => {}
    }
    outputs.push(OutputDesc::scratch("samples", samples));
    outputs.extend(received);
    if measure == "reflectance" {
        let side = block_side(cx.settings)?;
        let flux = cx.input("rsm").and_then(|rsm| rsm.member("flux")?.texture());
        let ((width, height), layers) = flux.map_or(((1, 1), 1), |flux| (flux.size, flux.layers));
        let texels = width * height * layers;
        outputs.extend([
            OutputDesc::scratch_u32("block_seen", width.div_ceil(side) * height.div_ceil(side) * layers),
            cx.scratch("values", VALUES, texels)?,
            cx.scratch("greatest", GREATEST, 1)?,
            reduce::scratch(&cx.use_cx, "blocks", texels, size_of::<f32>() as u64)?,
        ]);
    }
    Ok(outputs)
}

fn record(cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
    let (measure, evaluate) = choices(cx.settings)?;
    let count = if cx.connected("points") {
        cx.fact("points", surface_points::COUNT)?
    } else {
        cx.settings.u32("view_samples")?
    };
    let mut recording = Recording::default();
    if measure != "flux" {
        let pick = Compute::new(cx.file("view-samples.wgsl"), "pick", Threads::Row(count));
        let is_output = (measure, evaluate) == ("contribution", "on-demand");
        let bound = |step: Compute| if is_output { step.bind("samples", "importance.samples") } else { step };
        recording = recording.then(bound(pick));
        if is_relative(cx.settings)? {
            let weigh = |entry, threads| bound(Compute::new(cx.file("weigh-samples.wgsl"), entry, threads));
            let group = cx.use_context().constant("passes/importance-map/weigh-samples.wgsl", "RAYS")?;
            let receive = weigh("receive", Threads::Row(count.saturating_mul(group)));
            recording = recording.then(receive).then(weigh("weigh", Threads::Row(1)));
        }
    }
    if measure == "reflectance" {
        recording = recording.then_all(reflectance(cx)?);
    }
    recording.steps.extend(reflected::record(cx)?.steps);
    for step in &mut recording.steps {
        if let Step::Compute(step) = step {
            step.values.push(("view_samples".into(), count.into()));
        }
    }
    Ok(recording)
}

/// Returns the steps that find what each texel reflects and how it is seen, and the greatest values of all.
fn reflectance(cx: &RecordContext<'_>) -> Result<Vec<Compute>, PassTypeError> {
    let side = block_side(cx.settings)?;
    let ((width, height), layers) = (cx.size("importance"), cx.layers("importance"));
    let step = |entry, [width, height]: [u32; 2]| {
        let threads = Threads::Grid([width, height, layers]);
        Compute::new(cx.file("reflectance.wgsl"), entry, threads).value("block_side", side)
    };
    // Blocks per thread along each side of a square.
    let span = cx.use_context().constant("shaders/squares.wgsl", "SPAN")?;
    let blocks = [width, height].map(|length| length.div_ceil(side).div_ceil(span));
    let mut steps = vec![step("compare_with_view", blocks), step("reflectance", [width, height])];
    let texels = width * height * layers;
    for of in ["reflected", "importance"] {
        let shader = cx.file("greatest.wgsl").define("OF", of);
        let of_all = reduce::steps(&cx.use_context(), &shader, texels, "blocks")?;
        steps.extend(of_all.into_iter().map(|step| step.value("texels", texels)));
    }
    Ok(steps)
}
