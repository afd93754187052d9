//! The parts of surfaces that points stand for.

use pass::{Content, Fact, Interface, Member, Struct};

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
