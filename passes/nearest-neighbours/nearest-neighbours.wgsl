// Estimates how densely points lie on surfaces, by the distance to the k-th nearest neighbour. [SMC-IR §3.2.4, Eq. 7-8]
//
// This file has the search; summary.wgsl and cells.wgsl prepare it. All that leaves the search is the k least distances, so it
// does not matter in which order neighbours are found.

#input points: SurfacePoints // The points that have a density.
#input among: SurfacePoints optional // The points whose density it is, and which are neighbours. Without it, the points
    // themselves.
#output density: Density(count: points.count) // Estimate at each point; 0 where that is empty.

#option GRID false internal // whether points are sorted into cells, of which the nearest are searched; else all are compared
#option SELF false internal // whether neighbours are among the points themselves
#option VECTORS 1 one_of [1, 2, 4, 8] internal // four distances each: k and more
#option SIDES false // Whether only neighbours whose normals are within 90° of the point's own count. Otherwise the two sides of a
    // thin wall are neighbours, and lights on either side are as weak as if they were on one.
#option OWNERS false // Whether the nearest neighbour of each point is an output too: its owner.
#if OWNERS
#output owners: Owners(count: points.count) // The neighbour that is nearest to each point.
#endif

#import "color.wgsl"
#import "dispatch.wgsl"
#import "neighbourhood.wgsl"

struct Settings {
    points_count: u32,
    among_count: u32,
    /// The index of this dispatch among several. Each takes its share of neighbours from everywhere, so that none searches far and
    /// wide for want of any.
    part: u32,
    parts: u32,
    /// The most cells in a direction.
    resolution: u32,
    /// The number k of the neighbour whose distance is measured. Higher: the estimate has less variance, but is blurred. 0: max(1, ⌊√I / 32⌋)
    /// of I points, with which it is consistent (SMC-IR Eq. 8), up to 32. [default: 0, min: 0, max: 32]
    k: u32,
    /// The search for neighbours, whose result is the same. pairs: all pairs are compared. grid: points are sorted into cells.
    /// auto: the faster of both for the numbers of points. [default: "auto", one_of: ["auto", "pairs", "grid"]]
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
#if GRID
/// Where in `arranged` the points of each cell begin.
var<storage, read> starts: array<u32>;
var<storage, read> arranged: array<vec4<u32>>;
#endif

const GROUP: u32 = 256u;
/// The squared distance of no neighbour [units²].
const NOT_FOUND: f32 = 3.0e38;
/// Points whose squared distance is less are in the same place [units²]: single precision distinguishes positions to 1e-7 of
/// the extent, unless they are near the origin.
const SAME_PLACE: f32 = 1e-20;

struct Query {
    index: u32,
    position: vec3<f32>,
    normal: vec3<f32>,
}

/// The k least squared distances so far [units²], in rising order, behind numbers below 0 that fill the rest.
var<private> nearest: array<vec4<f32>, VECTORS>;

#if OWNERS
const NO_OWNER: u32 = 0xffffffffu;
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
    if dot(among.points[index].normal, query.normal) <= 0.0 {
        return false;
    }
#endif
    return true;
}

/// Takes a point into account that is not empty.
fn consider(query: Query, position: vec3<f32>, index: u32) {
    let squared = squared_distance(query, position);
#if OWNERS
    if squared <= owner_squared && is_neighbour(query, index) {
        owner = select(index, min(index, owner), squared == owner_squared);
        owner_squared = squared;
    }
#endif
    if squared < reach() && squared >= SAME_PLACE && is_neighbour(query, index) {
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

#if GRID
/// Takes the points of neighbouring cells of a row into account.
fn search_row(query: Query, first: u32, last: u32) {
    let end = starts[last + 1u];
    // The first place of this part.
    let begin = starts[first] + (settings.part + settings.parts - starts[first] % settings.parts) % settings.parts;
    for (var place = begin; place < end; place += settings.parts) {
        let other = arranged[place];
        consider(query, bitcast<vec3<f32>>(other.xyz), other.w);
    }
}

/// Searches boxes of cells, each around the one before, until what is outside is farther than the k-th neighbour.
fn search_cells(query: Query) {
    let cells = cells_around(summary, settings.resolution);
    let home = cell_at(cells, query.position);
    var radius = 0u;
    var inner_low = home;
    var inner_high = home;
    loop {
        let low = home - min(home, vec3(radius));
        let high = min(home + radius, cells.last);
        for (var z = low.z; z <= high.z; z++) {
            for (var y = low.y; y <= high.y; y++) {
                let row = cell_index(cells, vec3(0u, y, z));
                let yz = vec2(y, z);
                // The middle of these rows is the box before.
                if radius > 0u && all(yz >= inner_low.yz) && all(yz <= inner_high.yz) {
                    if low.x < inner_low.x {
                        search_row(query, row + low.x, row + inner_low.x - 1u);
                    }
                    if high.x > inner_high.x {
                        search_row(query, row + inner_high.x + 1u, row + high.x);
                    }
                } else {
                    search_row(query, row + low.x, row + high.x);
                }
            }
        }
        // How far all cells outside are: less the rounding of cells' sides. There are none beyond the first and the last.
        let below = query.position - cells.low - vec3<f32>(low) * cells.width;
        let above = cells.low - query.position + vec3<f32>(high + 1u) * cells.width;
        let free = min(select(below, vec3(1e18), low == vec3(0u)), select(above, vec3(1e18), high == cells.last));
        let sure = max(min(free.x, min(free.y, free.z)) - 1e-3 * cells.width, 0.0);
        if sure * sure >= reach() || (all(low == vec3(0u)) && all(high == cells.last)) {
            break;
        }
        inner_low = low;
        inner_high = high;
        // As far as is sure to be enough, or twice as far where there are too few neighbours yet.
        var more = radius;
        if reach() < NOT_FOUND {
            more = u32(min((sqrt(reach()) - sure) * cells.per_unit, f32(settings.resolution)));
        }
        radius = min(radius + more + 1u, settings.resolution);
    }
}

@compute @workgroup_size(GROUP)
fn search(row: Row) {
    let index = index_in(row, GROUP);
    if index >= settings.points_count {
        return;
    }
    let query = query_of(index);
    begin_search(query, index);
    if points.points[index].triangle != NO_TRIANGLE && summary.count > 0u {
        search_cells(query);
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
