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
const LEAF: u32 = 16u;

/// Low bits that keys lack of points for which neighbours are searched. With half of the bits, threads are near enough to each other, and
/// sorting takes half the time.
const LEFT_OUT: u32 = 16u;

/// What is in a node of a perfect binary tree over the points, sorted along Hilbert's curve. Node 1 is the root; nodes 2i and 2i +
/// 1 are the children of node i.
struct Neighbourhood {
    /// The box around all positions [units].
    low: vec3<f32>,
    /// The least index of a point; NO_POINT where there is none.
    first: u32,
    high: vec3<f32>,
    /// The box around all normals, as `packed_normals`.
    normals: u32,
}

/// Steps of a component of a normal in one of its directions.
const NORMAL_STEPS: f32 = 15.0;

/// Packs a box of normals, whose components are numbers of steps from -NORMAL_STEPS, into five bits each.
fn packed_normals(low: vec3<u32>, high: vec3<u32>) -> u32 {
    let places = vec3(1u, 1u << 5u, 1u << 10u);
    return dot(low, places) | (dot(high, places) << 15u);
}

/// The least components in a packed box, in steps.
fn low_normal(normals: u32) -> vec3<u32> {
    return vec3(normals, normals >> 5u, normals >> 10u) & vec3(31u);
}

/// The greatest.
fn high_normal(normals: u32) -> vec3<u32> {
    return low_normal(normals >> 15u);
}

/// What so many steps of each component are.
fn normal_at(steps: vec3<u32>) -> vec3<f32> {
    return vec3<f32>(steps) / NORMAL_STEPS - 1.0;
}

const NO_POINT: u32 = 0xffffffffu;
