//! A picture for a screen.

use pass::{Content, Format, Interface, Member};

/// The interface `Display`.
pub const INTERFACE: Interface = Interface::new(
    "Display",
    "A picture for a screen.",
    &[Member::required("", Content::Texture(Format::Rgba8Unorm), "tone-mapped and encoded as sRGB")],
)
.with_outputs(&["display"]);
