//! Indirect irradiance at the pixels of a G-buffer.

use pass::{Content, Fact, Format, Interface, Member};

/// The sub-images along a row, of an irradiance that is interleaved.
pub const INTERLEAVE_X: Fact<u32> =
    Fact::optional("interleave_x", "sub-images along a row; 1 where it is left out");
/// The sub-images along a column, of an irradiance that is interleaved.
pub const INTERLEAVE_Y: Fact<u32> =
    Fact::optional("interleave_y", "sub-images along a column; 1 where it is left out");
/// The distance of the near field, of which virtual lights give a part.
pub const CLAMP: Fact<f32> = Fact::optional(
    "clamp",
    "distance b below which lights give only d² / b² of what they would, as a fraction of the scene's dense extent; 0 where it \
     is left out",
);
/// The distance below which a virtual light gives no more.
pub const AREA_BOUND: Fact<f32> = Fact::optional(
    "area_bound",
    "distance below which a light gives no more, in radii of a disc of the area that it stands for, at most a fifth of the \
     scene's dense extent; 0 where it is left out",
);

/// The interface `Irradiance`.
pub const INTERFACE: Interface = Interface::new(
    "Irradiance",
    "Indirect irradiance at the pixels of a G-buffer.",
    &[Member::required(
        "",
        Content::Texture(Format::Rgba32Float),
        "[W/m²]; in alpha the luminance of what clamping removed [W/m²]",
    )],
)
.with_facts(&[INTERLEAVE_X.decl(), INTERLEAVE_Y.decl(), CLAMP.decl(), AREA_BOUND.decl()])
.with_outputs(&["irradiance"]);
