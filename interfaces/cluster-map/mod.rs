//! Which cluster a texel of a reflective shadow map belongs to.

use pass::{Content, Fact, Format, Interface, Member};

/// The number of clusters.
pub const COUNT: Fact<u32> = Fact::required("count", "the number of clusters");

/// The side of the window of texels around a cluster that it may take.
pub const WINDOW: Fact<u32> = Fact::optional(
    "window",
    "side of the square of texels around a cluster, in which all of its texels are; 0, or left out: the layer",
);

/// What an empty texel holds, and one that no cluster reaches.
pub const NONE: u32 = u32::MAX;

/// The interface `ClusterMap`.
pub const INTERFACE: Interface = Interface::new(
    "ClusterMap",
    "Which cluster each texel of a reflective shadow map belongs to.",
    &[Member::required(
        "",
        Content::Texture(Format::R32Uint),
        "array, as the reflective shadow map: index of the cluster; 2³² - 1 where the texel is unlit or in the window of \
         none",
    )],
)
.with_facts(&[COUNT.decl(), WINDOW.decl()]);
