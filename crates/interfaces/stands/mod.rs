//! Where virtual lights stood when their shadow maps were rendered.

use pass::{Content, Fact, Interface, Member, OutputDesc, PassTypeError, Struct, UseContext};

/// The number of maps.
pub const COUNT: Fact<u32> = Fact::required("count", "the number of maps");

const STANDS: Struct = Struct::new("crates/interfaces/stands/stands.wgsl", "Stands");

/// The interface `Stands`.
pub const INTERFACE: Interface = Interface::new(
    "Stands",
    "Where virtual lights stood when their shadow maps were rendered.",
    &[Member::required("", Content::Struct(STANDS), "position and normal of the light of each map")],
)
.with_facts(&[COUNT.decl()])
.with_folder("crates/interfaces/stands");

wgsl_structs::wgsl! {
    "stands/stands.wgsl" {
        pub struct Stand;
    }
}

/// Describes an output for `count` maps.
///
/// # Errors
/// Where stands.wgsl is refused.
pub fn output(cx: &UseContext<'_>, port: &str, count: u32) -> Result<OutputDesc, PassTypeError> {
    // A buffer has at least one element.
    Ok(OutputDesc::one(port, cx.buffer(STANDS, u64::from(count.max(1)))?).fact(COUNT, count))
}
