//! The surfaces that pixels show, for comparison with those of the next frame.

use pass::{Content, Format, Interface, Member};

/// The interface `SeenSurfaces`.
pub const INTERFACE: Interface = Interface::new(
    "SeenSurfaces",
    "The surfaces that pixels show, for comparison with those of the next frame.",
    &[
        Member::required(
            "position",
            Content::Texture(Format::Rgba32Float),
            "in world space [m]; in alpha the distance along the viewing axis [m], 0 where nothing is seen",
        ),
        Member::required(
            "normal",
            Content::Texture(Format::Rgba16Float),
            "normal of the plane in world space, unit",
        ),
    ],
);
