//! The amounts that a pass was requested to produce, and that it produced.

use pass::{Content, Figure, Interface, Member, OutputDesc, PassTypeError, Struct, UseContext};

const COUNTERS: Struct = Struct::new("crates/interfaces/counters/counters.wgsl", "Counters");

/// The interface `Counters`.
pub const INTERFACE: Interface = Interface::new(
    "Counters",
    "How much a pass was requested to produce, and how much it produced within its bounds.",
    &[Member::required("", Content::Struct(COUNTERS), "both numbers")],
)
.with_folder("crates/interfaces/counters")
.with_figures(&[
    Figure::new("requested", "how many were requested", ""),
    Figure::new("produced", "how many were produced", ""),
]);

/// Describes an output of counters.
///
/// # Errors
/// Where counters.wgsl is refused.
pub fn output(cx: &UseContext<'_>, port: &str) -> Result<OutputDesc, PassTypeError> {
    Ok(OutputDesc::one(port, cx.buffer(COUNTERS, 1)?))
}
