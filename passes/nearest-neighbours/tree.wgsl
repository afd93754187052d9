// Builds a tree over the points among which neighbours are searched.

#import "algorithms/hilbert.wgsl"
#import "dispatch.wgsl"
#import "neighbourhood.wgsl"

struct Settings {
    /// Points that are placed, or nodes of the level that is built, a power of two: the first of them is the node of this number.
    count: u32,
    /// Low bits of keys that are left out.
    left_out: u32,
}

var<uniform> settings: Settings;
/// The points that are placed, or are in the tree.
var<storage, read> among: SurfacePoints;
var<storage, read> summary: Summary;
/// Where each point is along the curve; then, the same in rising order.
var<storage, read_write> keys: array<u32>;
/// Indices of points in the order of their keys.
var<storage, read> order: array<u32>;
/// Position [units] as bits, and index, in that order.
var<storage, read_write> arranged: array<vec4<u32>>;
var<storage, read_write> nodes: array<Neighbourhood>;

const GROUP: u32 = 64u;

/// Computes the key of each point, as if those outside the box were at its side. Empty points come last.
@compute @workgroup_size(GROUP)
fn place(row: Row) {
    let index = index_in(row, GROUP);
    if index >= settings.count {
        return;
    }
    let point = among.points[index];
    let there = index < among.header.count && point.triangle != NO_TRIANGLE;
    keys[index] = select(0xffffffffu, hilbert_of(point.position * units_per_metre(), summary), there) >> settings.left_out;
}

fn empty_node() -> Neighbourhood {
    return Neighbourhood(vec3(1e18), NO_POINT, vec3(-1e18), packed_normals(vec3(31u), vec3(0u)));
}

fn node_around(a: Neighbourhood, b: Neighbourhood) -> Neighbourhood {
    return Neighbourhood(
        min(a.low, b.low),
        min(a.first, b.first),
        max(a.high, b.high),
        packed_normals(
            min(low_normal(a.normals), low_normal(b.normals)),
            max(high_normal(a.normals), high_normal(b.normals)),
        ),
    );
}

/// Makes the leaves, and puts the positions of their points next to each other.
@compute @workgroup_size(GROUP)
fn make_leaves(row: Row) {
    let leaf = index_in(row, GROUP);
    if leaf >= settings.count {
        return;
    }
    var node = empty_node();
    for (var place = leaf * LEAF; place < min((leaf + 1u) * LEAF, summary.count); place++) {
        let index = order[place];
        let point = among.points[index];
        let position = point.position * units_per_metre();
        arranged[place] = vec4(bitcast<vec3<u32>>(position), index);
        let steps = (point.normal + 1.0) * NORMAL_STEPS;
        let normals = packed_normals(vec3<u32>(floor(steps)), vec3<u32>(ceil(steps)));
        node = node_around(node, Neighbourhood(position, index, position, normals));
    }
    nodes[settings.count + leaf] = node;
}

/// Makes the nodes of a level from those of the level below.
@compute @workgroup_size(GROUP)
fn make_level(row: Row) {
    let index = index_in(row, GROUP);
    if index < settings.count {
        let node = settings.count + index;
        nodes[node] = node_around(nodes[2u * node], nodes[2u * node + 1u]);
    }
}
