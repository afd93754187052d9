//! Hemispherical depth maps after splatting, with holes.

use pass::{Content, Fact, Interface, Member, WINDOW_ALIGNMENT};
use std::ops::Range;

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
        Content::Array("u32"),
        "[count × tile × tile], map after map: the bits of the distance [m]; those of +∞ where nothing fell",
    )],
)
.with_facts(&[TILE.decl(), COUNT.decl(), DEPTH_BIAS.decl(), SLOPE_BIAS.decl()]);

/// A run of the maps, and the bytes of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Window {
    /// The maps.
    pub maps: Range<u32>,
    /// Their bytes in the buffer of all maps; the first is a multiple of [`WINDOW_ALIGNMENT`].
    pub bytes: Range<u64>,
}

/// Splits `count` maps with sides of `tile` \[px\] into runs of at most `most` bytes, which a step can bind: an adapter
/// binds less of a buffer than it may hold. Each but the last has a multiple of `block` maps, a power of two; where `most`
/// is less than the fewest of them that begin at an aligned byte, that number is taken.
pub fn windows(count: u32, tile: u32, block: u32, most: u64) -> Vec<Window> {
    let map = u64::from(tile).pow(2) * 4;
    // This number of maps of any size ends at an aligned byte.
    let fewest = u64::from(block).max(WINDOW_ALIGNMENT / 4);
    let of_window = (most / map.max(1) / fewest).max(1) * fewest;
    let window = |first: u64| {
        let end = (first + of_window).min(u64::from(count));
        // Buffers of the graph end at a multiple of 16 bytes, so that they are whole vectors.
        Window { maps: first as u32..end as u32, bytes: first * map..(end * map).next_multiple_of(16) }
    };
    (0..u64::from(count)).step_by(of_window as usize).map(window).collect()
}
