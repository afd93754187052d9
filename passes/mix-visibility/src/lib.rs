#![doc = include_str!("../README.md")]

use pass::{OutputDesc, Outputs, PassTypeError};

pass::from_wgsl!(outputs);

fn outputs(cx: &Outputs<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
    let declared = cx.declared()?;
    let with_exact =
        |output: OutputDesc| output.handed("exact", "exact", "atlas").handed("exact_places", "places", "");
    Ok(declared.into_iter().map(with_exact).collect())
}
