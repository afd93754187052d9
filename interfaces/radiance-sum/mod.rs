//! Radiance summed over frames.

use crate::progress::PROGRESS;
use pass::{Content, Format, Interface, Member};

/// The interface `RadianceSum`.
pub const INTERFACE: Interface = Interface::new(
    "RadianceSum",
    "Radiance summed over frames: what the next frame goes on from.",
    &[
        Member::required(
            "radiance",
            Content::Texture(Format::Rgba32Float),
            "the sum [W/(m² sr)]; of alpha too",
        ),
        Member::required("progress", Content::Struct(PROGRESS), "frames so far, and whether more are wanted"),
    ],
);
