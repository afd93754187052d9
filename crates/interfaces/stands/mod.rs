//! Where virtual lights stood when their shadow maps were rendered.

use pass::{Content, Fact, Interface, Member, Struct};

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
