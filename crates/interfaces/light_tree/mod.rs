//! Trees over virtual lights, in which a light is found by its share of the light at a point.

use pass::{Content, Fact, Figure, Interface, Member, Struct};

/// The number of leaves.
pub const LEAVES: Fact<u32> = Fact::required("leaves", "leaves of the tree, a power of two");

const TREE: Struct = Struct::new("crates/interfaces/light_tree/light-nodes.wgsl", "LightTree");

/// The interface `LightTree`.
pub const INTERFACE: Interface = Interface::new(
    "LightTree",
    "A tree over virtual lights, in which a light is found by its share of the light at a point.",
    &[Member::required(
        "",
        Content::Struct(TREE),
        "how many lights there are, and bounds of those below each node",
    )],
)
.with_facts(&[LEAVES.decl()])
.with_folder("crates/interfaces/light_tree")
.with_figures(&[Figure::new("count", "lights that are not dark", "")]);

wgsl_structs::wgsl! {
    "light_tree/light-nodes.wgsl" {
        pub const NO_LIGHT;
        pub struct LightNode;
        pub struct LightTree as LightTreeHeader;
    }
}

/// Returns the number of leaves of a tree over at most this many lights.
pub fn leaves(lights: u32) -> u32 {
    lights.max(1).next_power_of_two()
}

/// Returns the bytes of a buffer with a tree of these nodes, of which the second half are the leaves.
pub fn to_bytes(header: &LightTreeHeader, nodes: &[LightNode]) -> Vec<u8> {
    let header = LightTreeHeader { leaves: nodes.len() as u32 / 2, ..*header };
    [bytemuck::bytes_of(&header), bytemuck::cast_slice(nodes)].concat()
}

/// Returns the header and the nodes in the bytes of a buffer; `None` where there are too few bytes for its leaves.
pub fn from_bytes(bytes: &[u8]) -> Option<(LightTreeHeader, Vec<LightNode>)> {
    crate::with_rows(bytes, |header: &LightTreeHeader| header.leaves.saturating_mul(2))
}
