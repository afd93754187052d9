//! The cluster of each texel of a reflective shadow map.

use pass::{Content, Fact, Format, Interface, Member};

/// The number of clusters.
pub const COUNT: Fact<u32> = Fact::required("count", "the number of clusters");

/// The side of the window of texels around a cluster that it may take.
pub const WINDOW: Fact<u32> = Fact::optional(
    "window",
    "side of the square of texels around a cluster, in which all of its texels are; 0, or left out: the layer",
);

/// The value of an empty texel, and of one that no cluster reaches.
pub const NONE: u32 = u32::MAX;

/// The interface `ClusterMap`.
pub const INTERFACE: Interface = Interface::new(
    "ClusterMap",
    "The cluster of each texel of a reflective shadow map.",
    &[Member::required(
        "",
        Content::TextureArray(Format::R32Uint),
        "as the reflective shadow map: index of the cluster; 2³² - 1 where the texel is unlit or in the window of \
         none",
    )],
)
.with_facts(&[COUNT.decl(), WINDOW.decl()]);
