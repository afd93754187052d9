//! A mean over frames, at each pixel of as many as it has been seen in.

use pass::{Content, Format, Interface, Member};

/// The interface `FrameMean`.
pub const INTERFACE: Interface = Interface::new(
    "FrameMean",
    "A mean over frames along the motion of what pixels show: what the next frame goes on from.",
    &[
        Member::required(
            "value",
            Content::Texture(Format::Rgba32Float),
            "the mean, in the unit of what it is the mean of",
        ),
        Member::required(
            "frames",
            Content::Texture(Format::Rg32Float),
            "the number of frames that it is the mean of, and the variance of their luminance [unit²]",
        ),
    ],
);
