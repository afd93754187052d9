//! Means of a progressive picture.

use crate::progress::PROGRESS;
use pass::{Content, Format, Interface, Member, Struct};

const HALVES: Struct = Struct::new("crates/interfaces/path_samples/path-samples.wgsl", "Halves");

/// The interface `PathSamples`.
pub const INTERFACE: Interface = Interface::new(
    "PathSamples",
    "Means of a progressive picture: what the next frame goes on from.",
    &[
        Member::required(
            "image",
            Content::Texture(Format::Rgba32Float),
            "all light [W/(m² sr)]; in alpha its luminance when samples had last doubled before this frame",
        ),
        Member::required(
            "direct",
            Content::Texture(Format::Rgba32Float),
            "light reflected once [W/(m² sr)]; in alpha the share of the samples that saw something",
        ),
        Member::required(
            "indirect",
            Content::Texture(Format::Rgba32Float),
            "light reflected more than once [W/(m² sr)]",
        ),
        Member::required(
            "irradiance",
            Content::Texture(Format::Rgba32Float),
            "indirect irradiance [W/m²]; in alpha the luminance of what clamping removed",
        ),
        Member::required(
            "progress",
            Content::Struct(PROGRESS),
            "samples so far, and whether more are wanted",
        ),
        Member::required(
            "halves",
            Content::Struct(HALVES),
            "the last time when samples were twice as many as before, and the error then",
        ),
    ],
)
.with_folder("crates/interfaces/path_samples");
