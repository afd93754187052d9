#![doc = include_str!("../README.md")]

use gpu_algorithms::segmented_scan;
use pass::{OutputDesc, Outputs, PassTypeError, RecordContext, Recording, ResourceDesc, reflected};

pass::from_wgsl!(outputs, record);

fn outputs(cx: &Outputs<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
    let mut outputs = cx.declared()?;
    let flux = cx.input("rsm").and_then(|rsm| rsm.member("flux")?.texture());
    let (rows, layers) = flux.map_or((1, 1), |flux| (flux.size.1 * flux.layers, flux.layers));
    let totals = |name, segments| OutputDesc::scratch(name, ResourceDesc::buffer(8 * u64::from(segments)));
    outputs.extend([
        totals("row_totals", rows),
        OutputDesc::scratch_u32("column_cdf", rows),
        totals("layer_totals", layers),
        OutputDesc::scratch_u32("layer_cdf", layers),
        totals("total", 1),
    ]);
    Ok(outputs)
}

fn record(cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
    let ((_, height), layers) = (cx.size("row_cdf"), cx.layers("row_cdf"));
    let cumulate = |rows| cx.file("cumulate.wgsl").define("ROWS", rows);
    let rows = segmented_scan(&cumulate(true), height, layers).bind("totals", "row_totals");
    let run = |[parts, cdf, totals]: [&str; 3], length: u32, segments| {
        let scan = segmented_scan(&cumulate(false), segments, 1).value("segment_length", length);
        scan.bind("parts", parts).bind("cdf", cdf).bind("totals", totals)
    };
    let columns = run(["row_totals", "column_cdf", "layer_totals"], height, layers);
    let maps = run(["layer_totals", "layer_cdf", "total"], layers, 1);
    let mut recording = Recording::of([rows, columns, maps]);
    recording.steps.extend(reflected::record(cx)?.steps);
    Ok(recording)
}
