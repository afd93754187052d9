// The points among which neighbours are searched, and the tree over them.
//
// Lengths are in a unit near the scene's extent, so that their squares stay in range for scenes of any scale. It is a power of
// two times a metre: positions in it are exact, and so are differences of neighbours.

#import "scene.wgsl"
#import "surface-points.wgsl"

/// Units in a metre.
fn units_per_metre() -> f32 {
    let exponent = i32(bitcast<u32>(scene_info.extent) >> 23u);
    let inverse = bitcast<f32>(u32(clamp(254 - exponent, 1, 253)) << 23u);
    return select(1.0, inverse, scene_info.extent > 0.0);
}

/// Points of a leaf. More: fewer nodes to visit and less memory, but more points are compared.
const LEAF: u32 = 8u;

/// What is in a node of a perfect binary tree over the points, sorted along Hilbert's curve. Node 1 is the root; nodes 2i and 2i +
/// 1 are the children of node i.
struct Neighbourhood {
    /// The box around all positions [units].
    low: vec3<f32>,
    /// The least index of a point; NO_POINT where there is none.
    first: u32,
    high: vec3<f32>,
    /// The box around all normals.
    normal_low: vec3<f32>,
    normal_high: vec3<f32>,
}

const NO_POINT: u32 = 0xffffffffu;
