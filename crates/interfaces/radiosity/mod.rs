//! Radiosity of points on surfaces.

use pass::{Content, Fact, Interface, Member, OutputDesc, PassTypeError, Struct, UseContext};

/// The number of points that have a radiosity.
pub const COUNT: Fact<u32> = Fact::required("count", "the number of points that have a radiosity");

const RADIOSITIES: Struct =
    Struct::new("crates/interfaces/radiosity/point-radiosity.wgsl", "PointRadiosities");

/// The interface `Radiosity`.
pub const INTERFACE: Interface = Interface::new(
    "Radiosity",
    "The light that leaves the surface at each of a number of points.",
    &[Member::required(
        "",
        Content::Struct(RADIOSITIES),
        "radiosity of each point, and what it follows from",
    )],
)
.with_facts(&[COUNT.decl()])
.with_folder("crates/interfaces/radiosity");

wgsl_structs::wgsl! {
    "radiosity/point-radiosity.wgsl" {
        pub struct PointRadiosity;
    }
}

/// Describes an output of the radiosities of `count` points.
///
/// # Errors
/// Where point-radiosity.wgsl is refused.
pub fn output(cx: &UseContext<'_>, port: &str, count: u32) -> Result<OutputDesc, PassTypeError> {
    // A buffer has at least one element.
    Ok(OutputDesc::one(port, cx.buffer(RADIOSITIES, u64::from(count.max(1)))?).fact(COUNT, count))
}
