#![doc = include_str!("../README.md")]

use gpu_algorithms::{reduce, scan};
use pass::{
    Compute, OutputDesc, Outputs, PassTypeError, ReadSettings, RecordContext, Recording, Settings, Struct,
    Threads, Value,
};

pass::from_wgsl!(outputs, record);

const BOUNDS: Struct = Struct::new("shaders/tessellation.wgsl", "Bounds");

/// Bytes of a weight, a f32.
const WEIGHT_BYTES: u64 = 4;

fn tessellates(settings: &Settings) -> Result<bool, PassTypeError> {
    Ok(settings.text("rule")? == "tessellation")
}

/// Returns the binary logarithm of the number of entries of the guide table, which is about the number of triangles.
fn guide_bits(triangles: u32) -> u32 {
    triangles.max(1).ilog2().min(20)
}

/// Returns the entries of the guide table, with the end of the last.
fn guide_entries(triangles: u32) -> u32 {
    (1 << guide_bits(triangles)) + 1
}

fn outputs(cx: &Outputs<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
    let triangles = cx.traits.values.get("triangles").and_then(Value::as_u32).unwrap_or(0);
    let starts = triangles.saturating_add(1).into();
    let values = [("interval_starts", starts), ("guide_entries", guide_entries(triangles).into())];
    let mut outputs = cx.declared_with(&values)?;
    outputs.push(reduce::scratch(&cx.use_cx, "weight_blocks", triangles, WEIGHT_BYTES)?);
    outputs.extend(scan::scratch(&cx.use_cx, "share_sums", triangles)?);
    if tessellates(cx.settings)? {
        let bytes = cx.use_cx.size_of(BOUNDS)?;
        outputs.push(cx.scratch("bounds", BOUNDS, 1)?);
        outputs.push(reduce::scratch(&cx.use_cx, "bounds_blocks", triangles, bytes)?);
    }
    Ok(outputs)
}

fn record(cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
    let (use_cx, triangles) = (cx.use_context(), cx.trait_u32("triangles"));
    let mut recording = Recording::default();
    if tessellates(cx.settings)? {
        let bounds = cx.shader("shaders/tessellation-bounds.wgsl", &[]);
        recording = Recording::of(reduce::steps(&use_cx, &bounds, triangles, "bounds_blocks")?);
    }
    let main = cx.file("points-on-the-fly.wgsl");
    let mut shares = scan::steps(&use_cx, &main, triangles, "share_sums")?;
    shares.push(Compute::new(main, "guide", Threads::Row(guide_entries(triangles))));
    let shares = shares.into_iter().map(|step| step.value("guide_bits", guide_bits(triangles)));
    let sum = reduce::steps(&use_cx, &cx.file("sum.wgsl"), triangles, "weight_blocks")?;
    Ok(recording.then_all(sum).then_all(shares))
}
