// Builds a tree over virtual lights, in which a light is found by its share of the light at a point. [Lin & Yuksel 2020, §3]
//
// Lights are sorted along Morton's curve, and each node of a perfect binary tree over that order bounds the lights of its two
// children, level by level. Dark lights, and those beyond the count, are in no node.

#input lights: VirtualLights // The lights.
#output tree: LightTree(leaves: leaves, count: 2 * leaves) // The tree, with a leaf for each light that is not dark.

#import "dispatch.wgsl"
#import "lit-lights.wgsl"

struct Settings {
    lights_count: u32,
    tree_leaves: u32,
    /// The first node of the level that is built, and as many as it has: a power of two.
    level: u32,
}

var<uniform> settings: Settings;
var<storage, read> lights: VirtualLights;
var<storage, read> summary: Summary;
/// Where each light is along the curve; then, the same in rising order. [scratch, count: lights.count]
var<storage, read_write> keys: array<u32>;
/// The lights in the order of their keys.
var<storage, read> order: array<u32>;
var<storage, read_write> tree: LightTree;

/// The key of dark lights, after all others.
const DARK: u32 = 0xffffffffu;
/// Bit of the keys of lights infinitely far, which come after those on surfaces.
const FAR_AWAY: u32 = 0x40000000u;

const GROUP: u32 = 64u;

/// Moves the low ten bits of each component two bits apart, and interleaves them.
fn morton3(cell: vec3<u32>) -> u32 {
    var bits = cell;
    bits = (bits | (bits << vec3(16u))) & vec3(0x030000ffu);
    bits = (bits | (bits << vec3(8u))) & vec3(0x0300f00fu);
    bits = (bits | (bits << vec3(4u))) & vec3(0x030c30c3u);
    bits = (bits | (bits << vec3(2u))) & vec3(0x09249249u);
    return bits.x | (bits.y << 1u) | (bits.z << 2u);
}

/// Returns where a light is along the curve.
fn key_of(light: VirtualLight) -> u32 {
    if !is_lit(light) {
        return DARK;
    }
    if light.kind == INFINITELY_FAR {
        return FAR_AWAY | morton3(vec3<u32>(clamp(light.normal * 0.5 + 0.5, vec3(0.0), vec3(1.0)) * 1023.0));
    }
    // Cells are cubes; lights that are all in one place are in one of them.
    let size = summary.high - summary.low;
    let longest = max(max(size.x, max(size.y, size.z)), 1e-30);
    return morton3(vec3<u32>(clamp((light.position - summary.low) / longest, vec3(0.0), vec3(1.0)) * 1023.0));
}

/// Computes the key of each light. [threads: lights.count]
@compute @workgroup_size(GROUP)
fn place(row: Row) {
    let index = index_in(row, GROUP);
    if index < min(lights.count, settings.lights_count) {
        keys[index] = key_of(lights.lights[index]);
    }
}

/// Makes the leaves. [threads: tree.leaves]
@compute @workgroup_size(GROUP)
fn make_leaves(row: Row) {
    let leaf = index_in(row, GROUP);
    if leaf >= settings.tree_leaves {
        return;
    }
    let count = summary.count;
    // DEVIATION(padding): leaves without a light are empty, not copies of lights with the flux 0.
    var node = empty_node();
    if leaf < count {
        let index = order[leaf];
        let light = lights.lights[index];
        let flux = brightness(light);
        node.axis = light.normal;
        node.light = index;
        if light.kind == INFINITELY_FAR {
            node.far = flux;
        } else {
            node.flux = flux;
            node.low = light.position;
            node.high = light.position;
            node.area = max(light.area, 0.0);
        }
    }
    tree.nodes[settings.tree_leaves + leaf] = node;
    if leaf == 0u {
        // The least power of two that is not below the count is the number of leaves below the root.
        let bits = select(0u, 32u - countLeadingZeros(count - 1u), count > 1u);
        tree.count = count;
        tree.leaves = settings.tree_leaves;
        tree.root = settings.tree_leaves >> bits;
        tree.pad = 0u;
        tree.nodes[0] = empty_node();
    }
}

/// A cone of directions: unit axis, and cosine of the angle to its edge in w.
alias Cone = vec4<f32>;

/// What rounding may take from the cosine of a cone.
const ROUNDING: f32 = 1e-6;

/// Cosine of the angle between an axis and the far edge of a cone; -1 where that is beyond the opposite direction.
fn far_edge(axis: vec3<f32>, cone: Cone) -> f32 {
    let cosine = clamp(dot(axis, cone.xyz), -1.0, 1.0);
    let sine = length(cross(axis, cone.xyz));
    let cone_sine = sqrt(max(1.0 - cone.w * cone.w, 0.0));
    if cone.w <= -1.0 || sine * cone.w + cosine * cone_sine < 0.0 {
        return -1.0;
    }
    return cosine * cone.w - sine * cone_sine;
}

// DEVIATION(cones): virtual lights shine on one side, so nodes bound their normals too.
/// Returns a cone around both. Whatever its axis is, its edge is beyond all directions of both: roundings make it wider, but never
/// too narrow. [Conty Estevez & Kulla 2018, §4.1]
fn cone_around(a: Cone, b: Cone) -> Cone {
    if far_edge(a.xyz, b) >= a.w {
        return a;
    }
    if far_edge(b.xyz, a) >= b.w {
        return b;
    }
    let between = atan2(length(cross(a.xyz, b.xyz)), dot(a.xyz, b.xyz));
    let angle_a = atan2(sqrt(max(1.0 - a.w * a.w, 0.0)), a.w);
    let angle_b = atan2(sqrt(max(1.0 - b.w * b.w, 0.0)), b.w);
    let turn = 0.5 * (between + angle_b - angle_a);
    let across = b.xyz - dot(a.xyz, b.xyz) * a.xyz;
    let square = dot(across, across);
    // Between opposite directions there is no middle.
    if square < 1e-12 {
        return Cone(a.xyz, max(min(a.w, far_edge(a.xyz, b)) - ROUNDING, -1.0));
    }
    let axis = normalize(cos(turn) * a.xyz + sin(turn) * inverseSqrt(square) * across);
    return Cone(axis, max(min(far_edge(axis, a), far_edge(axis, b)) - ROUNDING, -1.0));
}

/// Returns the bounds of the lights of both nodes.
fn node_around(a: LightNode, b: LightNode) -> LightNode {
    // Empty leaves come last.
    if b.flux + b.far == 0.0 {
        return LightNode(a.low, a.flux, a.high, a.far, a.axis, a.cosine, a.area, NO_LIGHT, 0u, 0u);
    }
    let cone = cone_around(Cone(a.axis, a.cosine), Cone(b.axis, b.cosine));
    return LightNode(
        min(a.low, b.low),
        min(a.flux + b.flux, GREATEST),
        max(a.high, b.high),
        min(a.far + b.far, GREATEST),
        cone.xyz,
        cone.w,
        min(a.area, b.area),
        NO_LIGHT,
        0u,
        0u,
    );
}

/// Makes the nodes of a level from those of the level below.
@compute @workgroup_size(GROUP)
fn make_level(row: Row) {
    let index = index_in(row, GROUP);
    if index < settings.level {
        let node = settings.level + index;
        tree.nodes[node] = node_around(tree.nodes[2u * node], tree.nodes[2u * node + 1u]);
    }
}
