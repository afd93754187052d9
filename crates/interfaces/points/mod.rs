//! Samples of the scene's surfaces.

mod samples;

use pass::{Content, Fact, Interface, Member};
pub use samples::SurfaceSamples;

/// The greatest number of different samples.
pub const COUNT: Fact<u32> = Fact::required("count", "the most different samples there are");

/// The number of maps that take samples in turn.
pub const BLOCK: Fact<u32> =
    Fact::optional("block", "how many maps take turns, a power of two; 1 where it is left out");

/// The interface `Points`.
pub const INTERFACE: Interface = Interface::new(
    "Points",
    "Samples of the scene's surfaces, of which each map takes an equal share. Module: defines `fn surface_sample(wanted: \
     SamplesWanted, index: u32) -> SurfaceSample` and `fn samples_requested() -> u32` (surface-sample.wgsl).",
    &[Member::required("", Content::Buffer, "what the module reads")],
)
.with_facts(&[COUNT.decl(), BLOCK.decl()])
.with_folder("crates/interfaces/points")
.with_stand_in("shaders/points-stored.wgsl");

wgsl_structs::wgsl! {
    "points/surface-sample.wgsl" {
        pub struct SurfaceSample;
    }
}
