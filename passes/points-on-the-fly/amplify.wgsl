// How many points each triangle is amplified into, from the triangles as they are in this frame (TCAS §5.2): weights,
// their sum, each triangle's share of it as a whole number, and the prefix sum of the shares. The points themselves are made
// by shaders/points-on-the-fly.wgsl.
//
// DEVIATION(no-tessellator): WebGPU has none; each thread finds its triangle by binary search.
// DEVIATION(maps-in-turn): the papers draw the map of a point at random.
// DEVIATION(one-map-a-point): ACRSM splats a point into several.

/// Weights are the points of a tessellator (ACRSM Eq. 5.3-5.4); else areas.
#option TESSELLATION false

#import "amplification.wgsl"
#import "dispatch.wgsl"
#import "prefix-sum.wgsl"
#import "random.wgsl"
#import "scene.wgsl"
#import "surface-sample.wgsl"
#import "triangle-samples.wgsl"
#import "triangle.wgsl"

struct Settings {
    /// Workgroups that hold all triangles, RUN a thread.
    groups: u32,
    /// Binary logarithm of the entries of the guide.
    guide_bits: u32,
    min_factor: u32,
    max_factor: u32,
    seed: u32,
}

/// What a workgroup of triangles comes to, or all of them.
struct Part {
    /// Sum of the weights.
    weight: f32,
    /// The least and the greatest area [m²] of triangles that have one, and edge [m] of those. Least above greatest: none has.
    areas: vec2<f32>,
    edges: vec2<f32>,
}

/// Of no triangle.
const NOTHING: Part = Part(0.0, vec2(3.0e38, 0.0), vec2(3.0e38, 0.0));
/// All that is shared out: half of what a u32 holds, so that rounding cannot carry the sum beyond it.
const WHOLE: u32 = 0x80000000u;

/// Triangles of a thread, one after the other.
const RUN: u32 = 8u;

var<uniform> settings: Settings;
/// [groups + 1] The last is that of all.
var<storage, read_write> parts: array<Part>;
/// [groups] Sum of the shares of a workgroup, and then of all before it.
var<storage, read_write> blocks: array<u32>;
var<storage, read_write> points: Amplification;

fn interval_start(triangle: u32) -> u32 {
    return points.starts[triangle];
}

struct Measured {
    /// [m²]
    area: f32,
    /// [m]
    edges: vec3<f32>,
}

/// Zeros beyond the last triangle.
fn measured(index: u32) -> Measured {
    if index >= scene_info.triangles {
        return Measured();
    }
    let triangle = triangle_of_scene(index);
    let across = triangle.b - triangle.a;
    let edges = vec3(length(triangle.a), length(triangle.b), length(across));
    return Measured(normal_and_area(triangle.a, triangle.b).w, edges);
}

/// Where between two bounds, smoothed; 1 where they are one: what is as large as the largest is large.
fn level(bounds: vec2<f32>, value: f32) -> u32 {
    var smoothed = 1.0;
    if bounds.y > bounds.x {
        let x = clamp((value - bounds.x) / (bounds.y - bounds.x), 0.0, 1.0);
        smoothed = x * x * (3.0 - 2.0 * x);
    }
    return max(u32(ceil(smoothed * f32(settings.max_factor))), settings.min_factor);
}

/// Vertices of a triangle at these levels of its edges and inside, each a point in OpenGL's point mode with equal
/// spacing: those along the edges, and rings of two segments fewer each, down to a triangle or a point.
fn tessellated_points(edges: vec3<u32>, inside: u32) -> u32 {
    let around = edges.x + edges.y + edges.z;
    if inside == 1u && around == 3u {
        return 3u;
    }
    let levels = max(inside, 2u);
    let rings = levels / 2u;
    if levels % 2u == 1u {
        return around + 3u * rings * rings;
    }
    return around + 1u + 3u * rings * (rings - 1u);
}

fn weight_of_triangle(triangle: Measured) -> f32 {
#if TESSELLATION
    if triangle.area == 0.0 {
        return 0.0;
    }
    let whole = parts[settings.groups];
    let edges = vec3(
        level(whole.edges, triangle.edges.x),
        level(whole.edges, triangle.edges.y),
        level(whole.edges, triangle.edges.z),
    );
    return f32(tessellated_points(edges, level(whole.areas, triangle.area)));
#else
    return triangle.area;
#endif
}

/// First of the triangles of a thread.
fn first_of_run(group: u32, thread: u32) -> u32 {
    return (group * SCAN_SIZE + thread) * RUN;
}

fn both(a: Part, b: Part) -> Part {
#if TESSELLATION
    let areas = vec2(min(a.areas.x, b.areas.x), max(a.areas.y, b.areas.y));
    return Part(a.weight + b.weight, areas, vec2(min(a.edges.x, b.edges.x), max(a.edges.y, b.edges.y)));
#else
    return Part(a.weight + b.weight, a.areas, a.edges);
#endif
}

/// The parts of a workgroup's threads as one.
fn united(thread: u32, part: Part) -> Part {
    var sum = part;
    sum.weight = prefix_sum(thread, part.weight).y;
#if TESSELLATION
    sum.areas = vec2(-workgroup_max(thread, -part.areas.x), workgroup_max(thread, part.areas.y));
    sum.edges = vec2(-workgroup_max(thread, -part.edges.x), workgroup_max(thread, part.edges.y));
#endif
    return sum;
}

/// Areas as weights, and with TESSELLATION the bounds of areas and edges.
@compute @workgroup_size(256)
fn measure(
    @builtin(workgroup_id) id: vec3<u32>,
    @builtin(num_workgroups) ids: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let group = row_index(id, ids, 0u, 1u);
    let first = first_of_run(group, thread);
    var part = NOTHING;
    for (var i = 0u; i < RUN; i++) {
        let triangle = measured(first + i);
        if triangle.area > 0.0 {
            let edges = triangle.edges;
            let least = min(edges.x, min(edges.y, edges.z));
            let greatest = max(edges.x, max(edges.y, edges.z));
            part = both(part, Part(triangle.area, vec2(triangle.area), vec2(least, greatest)));
        }
    }
    part = united(thread, part);
    if thread == 0u && group < settings.groups {
        parts[group] = part;
    }
}

/// The weights of the rule, where those are not areas.
@compute @workgroup_size(256)
fn count(
    @builtin(workgroup_id) id: vec3<u32>,
    @builtin(num_workgroups) ids: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let group = row_index(id, ids, 0u, 1u);
    let first = first_of_run(group, thread);
    var weight = 0.0;
    for (var i = 0u; i < RUN; i++) {
        weight += weight_of_triangle(measured(first + i));
    }
    let sum = prefix_sum(thread, weight).y;
    if thread == 0u && group < settings.groups {
        parts[group].weight = sum;
    }
}

/// One workgroup: all parts as one.
@compute @workgroup_size(256)
fn sum_up(@builtin(local_invocation_index) thread: u32) {
    var sum = NOTHING;
    for (var i = thread; i < settings.groups; i += SCAN_SIZE) {
        sum = both(sum, parts[i]);
    }
    sum = united(thread, sum);
    if thread == 0u {
        parts[settings.groups] = sum;
    }
}

/// Each triangle's share of WHOLE, rounded at random so that the roundings of many do not add up; sums from the first of
/// the workgroup on.
@compute @workgroup_size(256)
fn share(
    @builtin(workgroup_id) id: vec3<u32>,
    @builtin(num_workgroups) ids: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let group = row_index(id, ids, 0u, 1u);
    let first = first_of_run(group, thread);
    var sums: array<u32, RUN>;
    var sum = 0u;
    for (var i = 0u; i < RUN; i++) {
        let weight = weight_of_triangle(measured(first + i));
        if weight > 0.0 {
            let share = weight / parts[settings.groups].weight * f32(WHOLE);
            sum += u32(share + unit_float(hash2(settings.seed, first + i)));
        }
        sums[i] = sum;
    }
    let before = prefix_sum_u32(thread, sum);
    for (var i = 0u; i < RUN; i++) {
        if first + i < scene_info.triangles {
            points.starts[first + i + 1u] = before.x - sum + sums[i];
        }
    }
    if thread == 0u && group < settings.groups {
        blocks[group] = before.y;
    }
}

/// One workgroup: what lies before each workgroup of triangles, and how many points are asked for.
@compute @workgroup_size(256)
fn offset(@builtin(local_invocation_index) thread: u32) {
    var before = 0u;
    for (var first = 0u; first < settings.groups; first += SCAN_SIZE) {
        let i = first + thread;
        var own = 0u;
        if i < settings.groups {
            own = blocks[i];
        }
        let sums = prefix_sum_u32(thread, own);
        if i < settings.groups {
            blocks[i] = before + sums.x - own;
        }
        before += sums.y;
    }
    if thread == 0u {
        points.starts[0] = 0u;
#if TESSELLATION
        // The conversion ends at the greatest number.
        points.asked = u32(parts[settings.groups].weight);
#else
        points.asked = ANY_NUMBER;
#endif
        points.guide_bits = settings.guide_bits;
        points.step = whole_over(max(points.asked, 1u));
    }
}

/// WHOLE over a number: whole part, and fraction in units of 2⁻³².
fn whole_over(divisor: u32) -> vec2<u32> {
    var rest = WHOLE % divisor;
    var fraction = 0u;
    for (var bit = 0u; bit < 32u; bit++) {
        // The bit that the doubled rest loses.
        let carry = rest >> 31u;
        rest <<= 1u;
        fraction <<= 1u;
        if carry == 1u || rest >= divisor {
            rest -= divisor;
            fraction |= 1u;
        }
    }
    return vec2(WHOLE / divisor, fraction);
}

/// Sums from the first triangle on. The last interval ends where all do.
@compute @workgroup_size(256)
fn place(
    @builtin(workgroup_id) id: vec3<u32>,
    @builtin(num_workgroups) ids: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let index = row_index(id, ids, thread, SCAN_SIZE);
    if index < scene_info.triangles {
        let end = min(points.starts[index + 1u] + blocks[index / (SCAN_SIZE * RUN)], WHOLE);
        points.starts[index + 1u] = select(end, WHOLE, index + 1u == scene_info.triangles);
    }
}

/// The guide: where searches begin and end.
@compute @workgroup_size(256)
fn guide(
    @builtin(workgroup_id) id: vec3<u32>,
    @builtin(num_workgroups) ids: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let index = row_index(id, ids, thread, SCAN_SIZE);
    let entries = 1u << settings.guide_bits;
    if index > entries || scene_info.triangles == 0u {
        return;
    }
    let last = scene_info.triangles - 1u;
    var triangle = last;
    if index < entries {
        triangle = triangle_at(index << (31u - settings.guide_bits), 0u, last);
    }
    points.starts[scene_info.triangles + 1u + index] = triangle;
}
