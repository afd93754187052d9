// The interface LightTree: a perfect binary tree over virtual lights, whose leaves are lights in the order of Morton's curve.
// [Lin & Yuksel 2020, §3]
//
// Node 1 is the root of all leaves, nodes 2i and 2i + 1 are the children of node i, and the leaves are the last half of the nodes:
// leaf k is node `leaves + k`. The first `count` leaves are lights, and the others are empty.

/// The light of a node that is no leaf, and of an empty leaf.
const NO_LIGHT: u32 = 0xffffffffu;

/// The lights below a node.
struct LightNode {
    /// Corner of the box around the positions of those on surfaces [m]; above `high` where there are none.
    low: vec3<f32>,
    /// Luminance of the flux of those on surfaces [W]; at most 1e37.
    flux: f32,
    /// Opposite corner [m].
    high: vec3<f32>,
    /// Luminance of the irradiance by those infinitely far [W/m²]; at most 1e37.
    far: f32,
    /// Axis of a cone in which all of their normals lie, unit. Of those infinitely far, the normal is the direction of travel.
    axis: vec3<f32>,
    /// Cosine of the angle between the axis and the edge of that cone; -1 for all directions.
    cosine: f32,
    /// The least area that one of those on surfaces stands for [m²].
    area: f32,
    /// Index of the light of a leaf; NO_LIGHT elsewhere.
    light: u32,
    pad0: u32,
    pad1: u32,
}

/// A tree of lights.
struct LightTree {
    /// Lights in the tree: all that are not dark.
    count: u32,
    /// Leaves, a power of two.
    leaves: u32,
    /// The lowest node that has all lights below it.
    root: u32,
    pad: u32,
    /// [2 leaves] The first has no meaning.
    nodes: array<LightNode>,
}

/// Returns a node without lights.
fn empty_node() -> LightNode {
    return LightNode(vec3(3.0e38), 0.0, vec3(-3.0e38), 0.0, vec3(0.0, 0.0, 1.0), 1.0, 3.0e38, NO_LIGHT, 0u, 0u);
}
