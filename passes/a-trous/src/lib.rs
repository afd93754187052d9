#![doc = include_str!("../README.md")]

use interfaces::irradiance::{INTERLEAVE_X, INTERLEAVE_Y};
use pass::{
    Compute, Extent, Format, OutputDesc, Outputs, PassTypeError, ReadSettings, RecordContext, Recording,
    ResourceDesc,
};

pass::from_wgsl!(outputs, record);

/// Returns the iterations after which each subset of an interleaving of this many sub-images along a side has the same
/// weight.
fn iterations_without_pattern(interleave: u32) -> u32 {
    interleave.max(2).next_power_of_two().ilog2()
}

fn outputs(cx: &Outputs<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
    let mut outputs = cx.declared()?;
    let picture = ResourceDesc::texture_2d(Format::Rgba32Float, Extent::like("view"));
    outputs.extend(["even", "odd"].map(|name| OutputDesc::scratch(name, picture.clone())));
    Ok(outputs)
}

fn record(cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
    let interleave = |fact| cx.fact("irradiance", fact).unwrap_or(1);
    let iterations = match cx.settings.u32("iterations")? {
        0 => iterations_without_pattern(interleave(INTERLEAVE_X).max(interleave(INTERLEAVE_Y))),
        given => given,
    };
    let scratch = |i: u32| if i.is_multiple_of(2) { "even" } else { "odd" };
    let shader = cx.file("a-trous.wgsl");
    let steps = (0..iterations).map(|i| {
        let from = if i == 0 { "irradiance" } else { scratch(i - 1) };
        let to = if i + 1 == iterations { "filtered" } else { scratch(i) };
        Compute::per_texel(shader.clone(), "smooth_once", cx.size("view"))
            .value("stride", 1 << i)
            .value("last", u32::from(i + 1 == iterations))
            .bind("source", from)
            .bind("filtered", to)
    });
    Ok(Recording::of(steps))
}
