//! Hemispherical depth maps after splatting, with holes.

use pass::{Content, Fact, Interface, Member};

/// The side of a map.
pub const TILE: Fact<u32> = Fact::required("tile", "side of a map [px]");
/// The number of maps.
pub const COUNT: Fact<u32> = Fact::required("count", "the number of maps");
/// The depth bias that lookups of the maps need.
pub const DEPTH_BIAS: Fact<f32> =
    Fact::required("depth_bias", "bias of a lookup, in widths of a texel at the receiver");
/// The depth bias that lookups need in addition where the receiver's plane is not perpendicular to the way.
pub const SLOPE_BIAS: Fact<f32> = Fact::required(
    "slope_bias",
    "bias of a lookup, in widths of a texel times the slope of the receiver's plane",
);

/// The interface `DepthAtlas`.
pub const INTERFACE: Interface = Interface::new(
    "DepthAtlas",
    "Hemispherical depth maps as splatted, one a virtual light.",
    &[Member::required(
        "",
        Content::Buffer,
        "[count × tile × tile] u32, map after map: the bits of the distance [m]; those of +∞ where nothing fell",
    )],
)
.with_facts(&[TILE.decl(), COUNT.decl(), DEPTH_BIAS.decl(), SLOPE_BIAS.decl()]);
