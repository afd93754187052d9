//! Virtual lights chosen for each pixel by resampling.

use pass::{Content, Fact, Interface, Member, Struct};

/// The number of reservoirs of a pixel.
pub const PER_PIXEL: Fact<u32> = Fact::required("per_pixel", "the number of reservoirs of a pixel");
/// The bound of the geometry term in the target.
pub const BOUND: Fact<f32> = Fact::required(
    "bound",
    "in the target, the distance below which the geometry term of a light grows no more, in radii of a disc of its area",
);
/// The least geometry term in the target.
pub const LEAST: Fact<f32> = Fact::required(
    "least",
    "in the target, what is added to the geometry term of each light, in units of that at the scene's dense extent",
);
/// The least visibility in the target.
pub const DOUBT: Fact<f32> =
    Fact::required("doubt", "in the target, the visibility of a light that seems to be hidden");

/// The interface `Reservoirs`.
pub const INTERFACE: Interface = Interface::new(
    "Reservoirs",
    "For each pixel, one or a few virtual lights, chosen from many nearly in proportion to what they give there.",
    &[Member::required(
        "",
        Content::Struct(Struct::new("crates/interfaces/reservoirs/reservoirs.wgsl", "Reservoirs")),
        "row by row, those of a pixel next to each other",
    )],
)
.with_facts(&[PER_PIXEL.decl(), BOUND.decl(), LEAST.decl(), DOUBT.decl()])
.with_folder("crates/interfaces/reservoirs");

wgsl_structs::wgsl! {
    "virtual_lights/virtual-lights.wgsl" {
        use crate::virtual_lights::VirtualLight;
    }
    "reservoirs/reservoirs.wgsl" {
        pub struct Reservoir;
    }
}
