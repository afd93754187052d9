#![doc = include_str!("../README.md")]

use gpu_algorithms::scan;
use pass::{Compute, OutputDesc, Outputs, PassTypeError, ReadSettings, RecordContext, Recording, Threads};

pass::from_wgsl!(outputs, record);

fn outputs(cx: &Outputs<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
    let mut outputs = cx.declared()?;
    let (width, height) = cx.input("view").and_then(|view| view.size()).unwrap_or((1, 1));
    outputs.extend(scan::scratch(&cx.use_cx, "places", width * height)?);
    Ok(outputs)
}

fn record(cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
    let samples = cx.settings.u32("samples")?;
    let ((width, height), items) = (cx.size("view"), samples * cx.layers("rsm"));
    let shader = cx.file("reflective-gather.wgsl");
    let step = |entry, threads| Compute::new(shader.clone(), entry, threads);
    let grid = |(width, height)| Threads::Grid([width, height, 1]);
    // The members of `settings` that say which samples a dispatch takes are there for all of them.
    let whole = |step: Compute| step.split(0, 1);
    let again = Threads::Indirect { buffer: "groups".into(), offset: 0 };
    let compact = scan::steps(&cx.use_context(), &shader, width * height, "places")?;
    Ok(Recording::default()
        .then_all(whole(step("scatter", Threads::Row(samples))))
        .then_all(step("gather_coarsely", grid(cx.size("coarse"))).split(items, 1))
        .then_all(whole(step("interpolate", grid((width, height))).bind("gathered", "coarse")))
        .then_all(compact.into_iter().flat_map(whole))
        .then_all(step("gather_again", again).split(items, 1)))
}
