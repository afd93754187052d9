//! Whether a virtual light is visible from a point.

mod atlas;

use crate::virtual_lights;
pub use atlas::AtlasLayout;
use pass::{Content, Fact, Format, Interface, Member};

/// The side of a map of an atlas.
pub const TILE: Fact<u32> = Fact::optional("tile", "side of a map of the atlas [px]");
/// The maps along a row of a layer of an atlas.
pub const COLUMNS: Fact<u32> = Fact::optional("columns", "maps along a row of a layer of the atlas");
/// The rows of maps in a layer of an atlas.
pub const ROWS: Fact<u32> = Fact::optional("rows", "rows of maps in a layer of the atlas");
/// The depth bias of a lookup.
pub const DEPTH_BIAS: Fact<f32> =
    Fact::optional("depth_bias", "bias of a lookup, in widths of a texel at the receiver");
/// The depth bias of a lookup that grows with the slope of the receiver's plane.
pub const SLOPE_BIAS: Fact<f32> = Fact::optional(
    "slope_bias",
    "bias of a lookup, in widths of a texel times the slope of the receiver's plane",
);

/// The interface `Visibility`.
pub const INTERFACE: Interface = Interface::new(
    "Visibility",
    "Whether a virtual light is seen from a point. Module: defines `fn visibility(index: u32, light: VirtualLight, at: \
     vec3<f32>, normal: vec3<f32>) -> f32`; with the option `DEFERS` also `visibility_at_once`, which is negative where a ray \
     decides and else the same.",
    &[
        Member::optional(
            "atlas",
            Content::TextureArray(Format::R32Float),
            "paraboloid maps of the distance [m], one tile a virtual light, row by row and layer by layer; a \
             large number where nothing is",
        ),
        Member::optional(
            "basis",
            Content::Array("u32"),
            "images of the atlas in several levels, prefiltered for a series of the depth test",
        ),
        Member::optional("owners", Content::Array("u32"), "where lights share maps, for each light: whose map is its own"),
        Member::optional(
            "sources",
            Content::Struct(virtual_lights::LIGHTS),
            "where lights share maps: the lights of the maps",
        ),
        Member::optional(
            "exact",
            Content::TextureArray(Format::R32Float),
            "where a few lights have maps of another kind: those, as in `atlas`",
        ),
        Member::optional(
            "exact_places",
            Content::Array("u32"),
            "where a few lights have maps of another kind, for each light: which of these is its own; 2^32 - 1 for none",
        ),
    ],
)
.with_facts(&[TILE.decl(), COLUMNS.decl(), ROWS.decl(), DEPTH_BIAS.decl(), SLOPE_BIAS.decl()])
.with_stand_in("shaders/visibility-none.wgsl");
