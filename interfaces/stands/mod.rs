//! Where virtual lights stood when their shadow maps were rendered.

use bytemuck::{Pod, Zeroable};
use pass::{Content, Fact, Interface, Member, OutputDesc, PassTypeError, Struct, UseContext};

/// The number of maps.
pub const COUNT: Fact<u32> = Fact::required("count", "the number of maps");

const STANDS: Struct = Struct::new("interfaces/stands/stands.wgsl", "Stands");

/// The interface `Stands`.
pub const INTERFACE: Interface = Interface::new(
    "Stands",
    "Where virtual lights stood when their shadow maps were rendered.",
    &[Member::required("", Content::Struct(STANDS), "position and normal of the light of each map")],
)
.with_facts(&[COUNT.decl()])
.with_folder("interfaces/stands");

/// `struct Stand` of stands.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct Stand {
    /// Position in world space \[m\].
    pub position: [f32; 3],
    /// 1 where there is a map; 0 before.
    pub is_rendered: u32,
    /// Unit normal.
    pub normal: [f32; 3],
    /// Unused; zero.
    pub pad: u32,
}

/// Describes an output for `count` maps.
///
/// # Errors
/// Where stands.wgsl is refused.
pub fn output(cx: &UseContext<'_>, port: &str, count: u32) -> Result<OutputDesc, PassTypeError> {
    // A buffer has at least one element.
    Ok(OutputDesc::one(port, cx.buffer(STANDS, u64::from(count.max(1)))?).fact(COUNT, count))
}
