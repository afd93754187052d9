#![doc = include_str!("../README.md")]

use gpu_algorithms::segmented_scan;
use pass::{OutputDesc, Outputs, PassTypeError, RecordContext, Recording, ResourceDesc};

pass::from_wgsl!(outputs, record);

fn outputs(cx: &Outputs<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
    let mut outputs = cx.declared()?;
    let layers = cx.input("rsm").and_then(|rsm| rsm.member("flux")?.texture()).map_or(1, |flux| flux.layers);
    let totals = |name, segments| OutputDesc::scratch(name, ResourceDesc::buffer(8 * u64::from(segments)));
    outputs.extend([totals("map_totals", layers), totals("total", 1)]);
    Ok(outputs)
}

fn record(cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
    let ((_, height), layers) = (cx.size("sums"), cx.layers("sums"));
    let rows = segmented_scan(&cx.file("sum-importance.wgsl"), height, layers);
    let sum = |[parts, totals]: [&str; 2], [first, length, segments]: [u32; 3]| {
        let scan = segmented_scan(&cx.file("totals.wgsl"), segments, 1).value("segment_length", length);
        scan.value("first", first).bind("parts", parts).bind("totals", totals)
    };
    let columns = sum(["row_totals", "map_totals"], [0, height, layers]);
    let maps = sum(["map_totals", "total"], [height * layers, layers, 1]);
    Ok(Recording::of([rows, columns, maps]))
}
