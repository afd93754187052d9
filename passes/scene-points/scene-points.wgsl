// Samples of the scene's surfaces, evenly by area (ISM §3.1): one thread a point.
//
// The unit square is laid over the surface, area for area: the first number picks the triangle, and where it
// fell in the triangle's interval it is, with the second, the place there. So two numbers do, and the evenness
// of their sequence in the square is evenness on the surface.
//
// DEVIATION(sequence): the paper picks triangles and places at random.

#import "dispatch.wgsl"
#import "points.wgsl"
#import "random.wgsl"
#import "scene.wgsl"
#import "sobol.wgsl"

struct Settings {
    count: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var<storage, read_write> points: array<Point>;

/// The triangle whose interval of the table holds the number. Those without area have no interval.
fn triangle_at(number: u32) -> u32 {
    var low = 0u;
    var high = scene_info.triangles - 1u;
    while low < high {
        let middle = (low + high + 1u) / 2u;
        if scene_area_table[middle] <= number {
            low = middle;
        } else {
            high = middle - 1u;
        }
    }
    return low;
}

/// Barycentric coordinates of the second and third vertex from the unit square: keeps areas, and neighbours near
/// each other (Heitz 2019).
fn triangle_from_square(square: vec2<f32>) -> vec2<f32> {
    if square.y > square.x {
        return vec2(0.5 * square.x, square.y - 0.5 * square.x);
    }
    return vec2(square.x - 0.5 * square.y, 0.5 * square.y);
}

/// Unit normal of the triangle with these edges; zero where it has no area. The edges are scaled first: the
/// squares of their product leave the range of f32 in scenes of 1e-3 or 1e6 m.
fn geometric_normal(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    let longest = max(abs(a), abs(b));
    let scale = max(longest.x, max(longest.y, longest.z));
    if scale == 0.0 {
        return vec3(0.0);
    }
    let across = cross(a / scale, b / scale);
    let length = length(across);
    return select(vec3(0.0), across / length, length > 0.0);
}

@compute @workgroup_size(64)
fn place(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = row_index(group, groups, local, 64u);
    if index >= settings.count {
        return;
    }
    if scene_info.triangles == 0u {
        points[index] = Point();
        return;
    }
    let sobol = sobol2(index);
    // The table ends at 2^32 - 1, which is in no interval.
    let first = min(scramble(sobol.x, hash2(settings.seed, 0u)), 0xfffffffeu);
    let second = scramble(sobol.y, hash2(settings.seed, 1u));

    let triangle = triangle_at(first);
    let start = scene_area_table[triangle];
    // At least 1, also for the table of a scene without area, where an interval may be empty.
    let width = max(scene_area_table[triangle + 1u] - start, 1u);
    let square = vec2(min(f32(first - start) / f32(width), 1.0), unit_float(second));

    // Rounded as they are stored, and the position made from that: who reads the point finds the same place.
    let rounded = vec2<u32>(triangle_from_square(square) * 65535.0 + 0.5);
    let barycentric = vec2(min(rounded.x, 65535u), min(rounded.y, 65535u - min(rounded.x, 65535u)));
    let corner = scene_vertices[scene_indices[3u * triangle]].position;
    let a = scene_vertices[scene_indices[3u * triangle + 1u]].position - corner;
    let b = scene_vertices[scene_indices[3u * triangle + 2u]].position - corner;
    let at = vec2<f32>(barycentric) / 65535.0;
    points[index] = Point(
        corner + at.x * a + at.y * b,
        triangle,
        geometric_normal(a, b),
        barycentric.x | (barycentric.y << 16u),
    );
}
