// Samples the scene's surfaces uniformly by area, in an order of which every run is stratified. [ISM §3.1]
//
// DEVIATION(sequence): the paper picks triangles and positions at random.

#output points: Points(count: settings.count) module "points-stored.wgsl" // Every run of 2^m that starts at a multiple of 2^m is
    // stratified by itself.
#exact points: pass points-on-the-fly // Points where each map needs them.

#import "dispatch.wgsl"
#import "mask.wgsl"
#import "points.wgsl"
#import "random.wgsl"
#import "scene.wgsl"
#import "sobol.wgsl"
#import "triangle-samples.wgsl"
#import "triangle.wgsl"

struct Settings {
    /// Number of points, which all maps share; 32 bytes each. More: fewer holes in the shadow maps, but more time and memory.
    /// More than 4,194,304 require an adapter that binds buffers of more than 128 MiB. [default: 262144, min: 1, max: 8388608]
    count: u32,
    seed: u32,
}

var<uniform> settings: Settings;
var<storage, read_write> points: array<Point>;

fn interval_start(triangle: u32) -> u32 {
    return scene_area_table[triangle];
}

@compute @workgroup_size(64)
fn place(row: Row) {
    let index = index_in(row, 64u);
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

    let bits = clamp(firstLeadingBit(scene_info.triangles), 1u, 20u);
    let entry = first >> (32u - bits);
    let triangle = triangle_at(first, scene_area_guide[entry], scene_area_guide[entry + 1u]);
    let start = scene_area_table[triangle];
    // At least 1, also for the table of a scene without area, where an interval may be empty.
    let width = max(scene_area_table[triangle + 1u] - start, 1u);
    let square = vec2(min(f32(first - start) / f32(width), 1.0), unit_float(second));

    // Rounded as it is stored; the position is computed from the rounded value, so that readers of the point get the
    // same position.
    let rounded = vec2<u32>(triangle_from_square(square) * 65535.0 + 0.5);
    let barycentric = vec2(min(rounded.x, 65535u), min(rounded.y, 65535u - min(rounded.x, 65535u)));
    let edges = triangle_of_scene(triangle);
    let at = vec2<f32>(barycentric) / 65535.0;
    let normal = normal_and_area(edges.a, edges.b).xyz;
    points[index] = Point(
        edges.corner + at.x * edges.a + at.y * edges.b,
        triangle,
        select(vec3(0.0), normal, triangle_exists(triangle, at)),
        barycentric.x | (barycentric.y << 16u),
    );
}
