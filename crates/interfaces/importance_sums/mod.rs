//! Cumulative sums of importance, in which texels are found by the inverse transform method.

use pass::{Content, Format, Interface, Member};

/// The interface `ImportanceSums`.
pub const INTERFACE: Interface = Interface::new(
    "ImportanceSums",
    "Cumulative sums of the importance of the texels of a reflective shadow map (TCAS §4.2), each stage in a unit of its own.",
    &[
        Member::required(
            "rows",
            Content::TextureArray(Format::R32Float),
            "of each texel: the sum along its row up to it",
        ),
        Member::required(
            "totals",
            Content::Array("f32"),
            "`[layers][height]` of each row: the sum of the rows of its map up to it; then, `[layers]`, of each map: the sum of the maps \
             up to it",
        ),
    ],
);
