#![doc = include_str!("../README.md")]

use gpu_algorithms::{reduce, scan};
use pass::{Compute, OutputDesc, Outputs, PassTypeError, RecordContext, Recording, Struct, Threads, Value};

pass::from_wgsl!(outputs, record);

const BOUNDS: Struct = Struct::new("shaders/tessellation.wgsl", "Bounds");

fn outputs(cx: &Outputs<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
    let triangles = cx.traits.values.get("triangles").and_then(Value::as_u32).unwrap_or(0);
    let mut outputs = cx.declared_with(&[("starts", triangles.saturating_add(1).into())])?;
    outputs.extend(scan::scratch(&cx.use_cx, "count_sums", triangles)?);
    outputs.push(reduce::scratch(&cx.use_cx, "bounds_blocks", triangles, cx.use_cx.size_of(BOUNDS)?)?);
    outputs.push(cx.scratch("bounds", BOUNDS, 1)?);
    Ok(outputs)
}

fn record(cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
    let (use_cx, triangles) = (cx.use_context(), cx.trait_u32("triangles"));
    let bounds = cx.shader("shaders/tessellation-bounds.wgsl", &[]);
    let main = cx.file("tessellated-points.wgsl");
    Ok(Recording::of(reduce::steps(&use_cx, &bounds, triangles, "bounds_blocks")?)
        .then_all(scan::steps(&use_cx, &main, triangles, "count_sums")?)
        .then(Compute::new(main, "place", Threads::Row(triangles))))
}
