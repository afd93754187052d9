//! Radiance averaged over frames.

use crate::progress::PROGRESS;
use pass::{Content, Format, Interface, Member};

/// The interface `RadianceMean`.
pub const INTERFACE: Interface = Interface::new(
    "RadianceMean",
    "Radiance averaged over frames: what the next frame goes on from.",
    &[
        Member::required(
            "radiance",
            Content::Texture(Format::Rgba32Float),
            "the mean [W/(m² sr)]; of alpha too",
        ),
        Member::required("progress", Content::Struct(PROGRESS), "frames so far, and whether more are wanted"),
    ],
);
