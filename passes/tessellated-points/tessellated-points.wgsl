// Places points on a lattice of each triangle, whose steps follow its edges and area, and stores them. [ACRSM Alg. 5.2]
//
// DEVIATION(rounding): rows end as in exact arithmetic.
// DEVIATION(maps-in-turn): samples go to maps in turn, not points.
//
// This file counts the points of each triangle, sums the counts, and places the points. What maps read is in
// shaders/points-tessellated.wgsl.

#output points: Points(
    count: settings.capacity when scene.triangles > 0,
    count: 0,
    block: BLOCK,
) module "shaders/points-tessellated.wgsl" // The points, in the order of their triangles.

#import "algorithms/scan.wgsl"
#import "lattice-points.wgsl"
#import "lattice.wgsl"
#import "mask.wgsl"
#import "random.wgsl"
#import "samples-in-turn.wgsl"

struct Settings {
    /// The most points that are stored, 32 bytes each. If the triangles have more, they all lose the same share. More than
    /// 4,194,304 require an adapter that binds buffers of more than 128 MiB. [default: 1048576, min: 1, max: 8388608]
    capacity: u32,
    /// Least tessellation level of edges and inside. Larger: more points on small triangles, and so on all. [default: 5, min: 1,
    /// max: 64]
    min_factor: u32,
    /// Greatest tessellation level of edges and inside. The number of points on large triangles rises with its square.
    /// [default: 64, min: 1, max: 64]
    max_factor: u32,
    /// How many maps take each point: s_f (ACRSM §5.3.2). Below 1, that share of the points is taken. [default: 1.0, min: 0.0,
    /// max: 64.0]
    splat_factor: f32,
}

/// The most maps whose samples neighbouring threads take in turn. A power of two.
const BLOCK: u32 = 32u;

var<uniform> settings: Settings;
var<storage, read> bounds: Bounds;
/// [scratch, count: starts] Points of the triangles before each, and of all.
var<storage, read_write> starts: array<u32>;
/// [count: settings.capacity]
var<storage, read_write> points: LatticePoints;

fn lattice_of(triangle: Measured) -> Lattice {
    return first_of_lattice(tessellation_levels(bounds, triangle, vec2(settings.min_factor, settings.max_factor)));
}

fn scan_length() -> u32 {
    return scene_info.triangles;
}

/// The number of points of a triangle.
fn scan_element(index: u32) -> u32 {
    let triangle = measured(index);
    if !(triangle.area > 0.0) {
        return 0u;
    }
    var count = 0u;
    for (var lattice = lattice_of(triangle); lattice.row < lattice.rows; lattice = next_of_lattice(lattice)) {
        count++;
    }
    return count;
}

fn scan_store(index: u32, before: u32, sum: u32) {
    starts[index + 1u] = sum;
}

fn scan_total(sum: u32) {
    starts[0] = 0u;
    points.stored = min(sum, settings.capacity);
    // The conversion saturates at the greatest u32.
    points.requested = u32(f32(sum) * settings.splat_factor);
    points.step = quotient(0x80000000u, max(points.requested, 1u));
}

/// Places the points of a triangle. If not all points fit, one is stored where the number of its slot rises.
@compute @workgroup_size(64)
fn place(row: Row) {
    let index = index_in(row, 64u);
    if index >= scene_info.triangles {
        return;
    }
    let first = starts[index];
    let end = starts[index + 1u];
    if first == end {
        return;
    }
    let all = starts[scene_info.triangles];
    let edges = triangle_of_scene(index);
    let shape = normal_and_area(edges.a, edges.b);
    let area = shape.w / f32(end - first) * f32(all) / f32(points.stored);
    let shrinks = all > settings.capacity;
    var share = 0u;
    if shrinks {
        // Rounded up, so that the last slot is filled.
        share = quotient(settings.capacity, all).y + 1u;
    }
    var lattice = lattice_of(measured(index));
    for (var number = first; number < end; number++) {
        var slot = number;
        var stores = true;
        if shrinks {
            slot = multiply_high(number, share);
            stores = slot < settings.capacity && slot != multiply_high(number + 1u, share);
        }
        if stores {
            let at = lattice.at.yz;
            let exists = triangle_exists(index, at);
            points.points[slot] = LatticePoint(
                edges.corner + at.x * edges.a + at.y * edges.b,
                index,
                shape.xyz,
                select(0.0, area, exists),
            );
        }
        lattice = next_of_lattice(lattice);
    }
}
