//! The density of points on surfaces.

use pass::{Content, Fact, Interface, Member, OutputDesc, ResourceDesc};

/// The number of points that have a density.
pub const COUNT: Fact<u32> = Fact::required("count", "the number of points that have a density");

/// The interface `Density`.
pub const INTERFACE: Interface = Interface::new(
    "Density",
    "The probability density of each of a number of points, with respect to the area of surfaces.",
    &[Member::required("", Content::Array("f32"), "density of each point [1/m²]; 0 where there is no point")],
)
.with_facts(&[COUNT.decl()]);

/// Describes an output of the densities of `count` points.
pub fn output(port: &str, count: u32) -> OutputDesc {
    // A buffer has at least one element.
    OutputDesc::one(port, ResourceDesc::buffer(4 * u64::from(count.max(1)))).fact(COUNT, count)
}
