//! The cluster of each virtual light, or the nearest neighbour of each point.

use pass::{Content, Fact, Interface, Member, OutputDesc, ResourceDesc};

/// The number of those that have an owner.
pub const COUNT: Fact<u32> = Fact::required("count", "the most lights or points that have an owner");

/// The interface `Owners`.
pub const INTERFACE: Interface = Interface::new(
    "Owners",
    "Which of a few virtual lights or points, such as clusters, each of many belongs to.",
    &[Member::required(
        "",
        Content::Array("u32"),
        "for each light or point, the index of its owner; 2^32 - 1 for none",
    )],
)
.with_facts(&[COUNT.decl()])
.with_folder("crates/interfaces/owners");

/// Describes an output of the owners of at most `count` lights or points.
pub fn output(port: &str, count: u32) -> OutputDesc {
    // A buffer has at least one element.
    OutputDesc::one(port, ResourceDesc::buffer(4 * u64::from(count.max(1)))).fact(COUNT, count)
}
