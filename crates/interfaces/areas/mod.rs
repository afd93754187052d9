//! The parts of surfaces that points stand for.

use pass::{Content, Fact, Interface, Member, OutputDesc, PassTypeError, Struct, UseContext};

/// The number of points that have an area.
pub const COUNT: Fact<u32> = Fact::required("count", "the number of points that have an area");

const AREAS: Struct = Struct::new("crates/interfaces/areas/areas.wgsl", "PointAreas");

/// The interface `Areas`.
pub const INTERFACE: Interface = Interface::new(
    "Areas",
    "The part of the surfaces that each of a number of points stands for, averaged from frame to frame.",
    &[Member::required(
        "",
        Content::Struct(AREAS),
        "area of each point, and how many frames it is the mean of",
    )],
)
.with_facts(&[COUNT.decl()])
.with_folder("crates/interfaces/areas");

wgsl_structs::wgsl! {
    "areas/areas.wgsl" {
        pub struct PointArea;
    }
}

/// Describes an output of the areas of `count` points.
///
/// # Errors
/// Where areas.wgsl is refused.
pub fn output(cx: &UseContext<'_>, port: &str, count: u32) -> Result<OutputDesc, PassTypeError> {
    // A buffer has at least one element.
    Ok(OutputDesc::one(port, cx.buffer(AREAS, u64::from(count.max(1)))?).fact(COUNT, count))
}
