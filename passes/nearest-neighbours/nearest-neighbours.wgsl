// Estimates how densely points lie on surfaces, by the distance to the k-th nearest neighbour. [SMC-IR §3.2.4, Eq. 7-8]
//
// This file has the search; summary.wgsl and tree.wgsl prepare it. All that leaves the search is the k least distances, so it
// does not matter in which order neighbours are found.

#input points: SurfacePoints // The points that have a density.
#input among: SurfacePoints optional // The points whose density it is, and which are neighbours. Without it, the points
    // themselves.
#output density: Density(count: points.count) // Estimate at each point; 0 where that is empty.

#option TREE false internal // whether there is a tree over the points, which is searched; else all are compared
#option SELF false internal // whether neighbours are among the points themselves
#option VECTORS 1 one_of [1, 2, 4, 8] internal // four distances each: k and more
#option SIDES false // Whether only neighbours whose normals are within 90° of the point's own count. Otherwise the two sides of a
    // thin wall are neighbours, and lights on either side are as weak as if they were on one.
#option OWNERS false // Whether the nearest neighbour of each point is an output too: its owner.
#if OWNERS
#output owners: Owners(count: points.count) // The neighbour that is nearest to each point.
#endif

#import "algorithms/summary.wgsl"
#import "color.wgsl"
#import "dispatch.wgsl"
#import "neighbourhood.wgsl"
#import "owners.wgsl"

struct Settings {
    points_count: u32,
    among_count: u32,
    /// The index of this dispatch among several, each of which compares its share of neighbours.
    part: u32,
    parts: u32,
    /// Leaves of the tree, a power of two.
    leaves: u32,
    /// The number k of the neighbour whose distance is measured. Higher: the estimate has less variance, but is blurred. 0: max(1, ⌊√I / 32⌋)
    /// of I points, with which it is consistent (SMC-IR Eq. 8), up to 32. [default: 0, min: 0, max: 32]
    k: u32,
    /// The search for neighbours, whose result is the same. pairs: all pairs are compared. tree: down a tree over the points.
    /// auto: the faster of both for the numbers of points. [default: "auto", one_of: ["auto", "pairs", "tree"]]
    structure: u32,
}

var<uniform> settings: Settings;
var<storage, read> points: SurfacePoints;
var<storage, read> among: SurfacePoints;
var<storage, read> summary: Summary;
/// The least squared distances of dispatches before: VECTORS for each point.
var<storage, read_write> distances: array<vec4<f32>>;
var<storage, read_write> density: array<f32>;
#if OWNERS
var<storage, read_write> owners: array<u32>;
#endif
#if TREE
var<storage, read> nodes: array<Neighbourhood>;
/// Position [units] as bits, and index, leaf after leaf.
var<storage, read> arranged: array<vec4<u32>>;
/// The points along the curve too: neighbouring threads search in the same nodes.
var<storage, read> turns: array<u32>;
#if !SELF
/// Where the points of the tree are along the curve, in rising order.
var<storage, read> keys: array<u32>;
/// The same of the points, in the order of their turns, without the bits that are left out.
var<storage, read> keys_of_points: array<u32>;
#endif
#endif

const GROUP: u32 = 256u;
/// The squared distance of no neighbour [units²].
const NOT_FOUND: f32 = 3.0e38;
/// Points whose squared distance is less are in the same place [units²]: single precision distinguishes positions to 1e-7 of
/// the extent, unless they are near the origin.
const SAME_PLACE: f32 = 1e-20;
#if SIDES
/// Cosine of the greatest angle between normals of one side: less than 90° by more than roundings.
const SAME_SIDE: f32 = 1e-5;
#endif

struct Query {
    index: u32,
    position: vec3<f32>,
    normal: vec3<f32>,
}

/// The k least squared distances so far [units²], in rising order, behind numbers below 0 that fill the rest.
var<private> nearest: array<vec4<f32>, VECTORS>;

#if OWNERS
/// The nearest neighbour so far, of equals the first; also one in the same place.
var<private> owner: u32;
/// Its squared distance [units²].
var<private> owner_squared: f32;
#endif

/// Returns the number of the farthest neighbour that counts: from whole numbers alone, so that no adapter rounds the root.
fn neighbours() -> u32 {
    if settings.k != 0u {
        return min(settings.k, 4u * VECTORS);
    }
    var k = 1u;
    while k < 4u * VECTORS && 1024u * (k + 1u) * (k + 1u) <= summary.count {
        k++;
    }
    return k;
}

fn begin_search(query: Query, index: u32) {
    let unused = 4u * VECTORS - neighbours();
    for (var v = 0u; v < VECTORS; v++) {
        if settings.part > 0u {
            nearest[v] = distances[index * VECTORS + v];
        } else {
            nearest[v] = select(vec4(-1.0), vec4(NOT_FOUND), vec4(0u, 1u, 2u, 3u) + 4u * v >= vec4(unused));
        }
    }
#if OWNERS
    owner = select(NO_OWNER, owners[index], settings.part > 0u);
    owner_squared = NOT_FOUND;
    if owner != NO_OWNER {
        owner_squared = squared_distance(query, among.points[owner].position * units_per_metre());
    }
#endif
}

/// The greatest squared distance that a neighbour may have [units²].
fn reach() -> f32 {
    return nearest[VECTORS - 1u].w;
}

/// Puts a squared distance in its place.
fn insert(squared: f32) {
    var before = -1.0;
    for (var v = 0u; v < VECTORS; v++) {
        let old = nearest[v];
        nearest[v] = max(vec4(before, old.xyz), min(old, vec4(squared)));
        before = old.w;
    }
}

fn squared_distance(query: Query, position: vec3<f32>) -> f32 {
    let offset = position - query.position;
    return dot(offset, offset);
}

/// Whether a point may be a neighbour, but for its distance.
fn is_neighbour(query: Query, index: u32) -> bool {
#if SELF
    if index == query.index {
        return false;
    }
#endif
#if SIDES
    if dot(among.points[index].normal, query.normal) < SAME_SIDE {
        return false;
    }
#endif
    return true;
}

/// Takes a point into account that is not empty.
fn consider(query: Query, position: vec3<f32>, index: u32) {
    let squared = squared_distance(query, position);
    let is_near = squared < reach() && squared >= SAME_PLACE;
#if OWNERS
    let may_own = squared <= owner_squared;
#else
    let may_own = false;
#endif
    if !(is_near || may_own) || !is_neighbour(query, index) {
        return;
    }
#if OWNERS
    if may_own {
        owner = select(index, min(index, owner), squared == owner_squared);
        owner_squared = squared;
    }
#endif
    if is_near {
        insert(squared);
    }
}

/// p = k / (I π r²) [1/m²]. [Eq. 7]
fn density_of_found() -> f32 {
    var found = 0.0;
    var farthest = 0.0;
    for (var v = 0u; v < VECTORS; v++) {
        let counts = (nearest[v] >= vec4(0.0)) & (nearest[v] < vec4(NOT_FOUND));
        found += dot(select(vec4(0.0), vec4(1.0), counts), vec4(1.0));
        let squares = select(vec4(0.0), nearest[v], counts);
        farthest = max(farthest, max(max(squares.x, squares.y), max(squares.z, squares.w)));
    }
    if found == 0.0 {
        // It is alone: it may be anywhere in the scene.
        return 1.0 / max(scene_info.area, 1e-37);
    }
    let scale = units_per_metre();
    return min(found / (f32(summary.count) * PI * farthest) * scale * scale, 3.0e38);
}

/// Ends what one dispatch does for a point.
fn end_search(query: Query) {
    if query.index >= settings.points_count {
        return;
    }
    let there = query.index < points.header.count && points.points[query.index].triangle != NO_TRIANGLE;
#if OWNERS
    owners[query.index] = select(NO_OWNER, owner, there);
#endif
    if settings.part + 1u == settings.parts {
        density[query.index] = select(0.0, density_of_found(), there);
        return;
    }
    for (var v = 0u; v < VECTORS; v++) {
        distances[query.index * VECTORS + v] = nearest[v];
    }
}

/// The point for which a thread searches. Of those that are too many, the last.
fn query_of(index: u32) -> Query {
    let point = points.points[min(index, settings.points_count - 1u)];
    return Query(index, point.position * units_per_metre(), point.normal);
}

#if TREE
/// What rounding may take from a squared distance, as a factor.
const ROUNDED: f32 = 1.0 - 1e-6;

/// Whether a neighbour that counts may be in a node.
fn may_hold(query: Query, node: Neighbourhood, squared: f32) -> bool {
    if node.first == NO_POINT {
        return false;
    }
#if SIDES
    // The greatest cosine of any normal in the box.
    let low = query.normal * normal_at(low_normal(node.normals));
    let high = query.normal * normal_at(high_normal(node.normals));
    let cosines = max(low, high);
    if cosines.x + cosines.y + cosines.z < 0.5 * SAME_SIDE {
        return false;
    }
#endif
    let is_place = all(node.low == node.high);
#if OWNERS
    if squared <= owner_squared && !(is_place && squared == owner_squared && node.first >= owner) {
        return true;
    }
#endif
    let farthest = max(abs(node.low - query.position), abs(node.high - query.position));
    return squared < reach() && (!is_place || dot(farthest, farthest) >= SAME_PLACE);
}

/// The least squared distance that a point of a node may have [units²]; a negative number where none of them counts.
fn distance_to(query: Query, index: u32) -> f32 {
    let node = nodes[index];
    let outside = max(max(node.low - query.position, query.position - node.high), vec3(0.0));
    // Points of a node that is all in one place are as far as that.
    let squared = dot(outside, outside) * select(ROUNDED, 1.0, all(node.low == node.high));
    return select(-1.0, squared, may_hold(query, node, squared));
}

/// Takes the points of a leaf into account.
fn search_leaf(query: Query, leaf: u32) {
    for (var place = leaf * LEAF; place < min((leaf + 1u) * LEAF, summary.count); place++) {
        let other = arranged[place];
        consider(query, bitcast<vec3<f32>>(other.xyz), other.w);
    }
}

/// The leaf where a point is along the curve, or would be.
fn leaf_of(turn: u32) -> u32 {
#if SELF
    return min(turn, max(summary.count, 1u) - 1u) / LEAF;
#else
    let key = keys_of_points[turn];
    // The last that begins at the key or before it.
    var leaf = 0u;
    for (var step = settings.leaves / 2u; step > 0u; step /= 2u) {
        let first = (leaf + step) * LEAF;
        if first < summary.count && keys[first] >> LEFT_OUT <= key {
            leaf += step;
        }
    }
    return leaf;
#endif
}

/// Searches the leaf where the point is along the curve, and from there the rest of the tree: most of it is farther than what that leaf
/// holds. Of two children the nearer comes first, and the other where it may still hold a neighbour. Of equals the first comes
/// first, so of points in one place that with the least index.
fn search_tree(query: Query, leaf: u32) {
    var node = settings.leaves + leaf;
    // A bit for each level above the node, the lowest for the last: whether the sibling of the node on the way there is still to
    // be searched.
    var rest = settings.leaves - 1u;
    var is_down = distance_to(query, node) >= 0.0;
    while is_down || rest != 0u {
        // All threads go down before any compares points, and up before any goes down again: what the threads of a warp do is the
        // same for longer.
        while is_down && node < settings.leaves {
            let left = distance_to(query, 2u * node);
            let right = distance_to(query, 2u * node + 1u);
            let is_right = left < 0.0 || (right >= 0.0 && right < left);
            is_down = max(left, right) >= 0.0;
            node = 2u * node + select(0u, 1u, is_right);
            rest = 2u * rest + select(0u, 1u, min(left, right) >= 0.0);
        }
        if is_down {
            search_leaf(query, node - settings.leaves);
        }
        is_down = false;
        while !is_down && rest != 0u {
            let levels = countTrailingZeros(rest);
            node = (node >> levels) ^ 1u;
            rest = (rest >> levels) ^ 1u;
            is_down = distance_to(query, node) >= 0.0;
        }
    }
}

@compute @workgroup_size(GROUP)
fn search(row: Row) {
    let turn = index_in(row, GROUP);
    if turn >= settings.points_count {
        return;
    }
    // Points that are not there have no turn: there may be fewer than there is room for.
    let there = turn < points.header.count;
    let index = select(turn, turns[turn], there);
    let query = query_of(index);
    begin_search(query, index);
    if there && points.points[index].triangle != NO_TRIANGLE {
        search_tree(query, leaf_of(turn));
    }
    end_search(query);
}
#else
/// Position [units], and 1 where there is a point.
var<workgroup> staged: array<vec4<f32>, GROUP>;

/// Returns point `index`, or none where that is too great.
fn staged_point(index: u32, end: u32) -> vec4<f32> {
    if index >= end || among.points[index].triangle == NO_TRIANGLE {
        return vec4(0.0);
    }
    return vec4(among.points[index].position * units_per_metre(), 1.0);
}

@compute @workgroup_size(GROUP)
fn search(row: Row) {
    let index = index_in(row, GROUP);
    let query = query_of(index);
    begin_search(query, min(index, settings.points_count - 1u));
    let end = min(settings.among_count, among.header.count);
    for (var first = settings.part * GROUP; first < end; first += settings.parts * GROUP) {
        staged[row.local] = staged_point(first + row.local, end);
        workgroupBarrier();
        for (var c = 0u; c < min(GROUP, end - first); c++) {
            let other = staged[c];
            if other.w > 0.0 {
                consider(query, other.xyz, first + c);
            }
        }
        workgroupBarrier();
    }
    end_search(query);
}
#endif
