//! Hemispherical depth maps that go on filling over frames.

use pass::{Content, Interface, Member};

/// The interface `FillingMaps`.
pub const INTERFACE: Interface = Interface::new(
    "FillingMaps",
    "Hemispherical depth maps that go on filling over frames, one a virtual light.",
    &[Member::required(
        "",
        Content::Array("u32"),
        "texels as in the interface DepthAtlas, in an order of their own: distance, and how sure it is",
    )],
)
.with_folder("crates/interfaces/filling_maps");
