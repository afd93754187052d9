//! Radiosity of points on surfaces.

use pass::{Content, Fact, Interface, Member, OutputDesc, ResourceDesc};

/// The number of points that have a radiosity.
pub const COUNT: Fact<u32> = Fact::required("count", "the number of points that have a radiosity");

/// The interface `Radiosity`.
pub const INTERFACE: Interface = Interface::new(
    "Radiosity",
    "The light that leaves the surface at each of a number of points.",
    &[Member::required(
        "",
        Content::Buffer,
        "vec4f a point: radiosity [W/m²], and its luminance; 0 where there is no point",
    )],
)
.with_facts(&[COUNT.decl()]);

/// Describes an output of the radiosities of `count` points.
pub fn output(port: &str, count: u32) -> OutputDesc {
    // A buffer has at least one element.
    OutputDesc::one(port, ResourceDesc::buffer(16 * u64::from(count.max(1)))).fact(COUNT, count)
}
