//! Radiance towards the camera.

use pass::{Content, Format, Interface, Member};

/// The interface `Radiance`.
pub const INTERFACE: Interface = Interface::new(
    "Radiance",
    "Radiance towards the camera.",
    &[Member::required(
        "",
        Content::Texture(Format::Rgba32Float),
        "[W/(m² sr)]; alpha 1 where something is seen",
    )],
)
.with_outputs(&["image", "direct", "indirect"]);
