// Splats points of the scene into hemispherical depth maps, one a virtual light: imperfect shadow maps before
// their holes are filled. [ISM §3.2]
//
// depth: [count × tile × tile] u32, map after map and in each row by row, the bits of the distance [m]. Distances are not negative, so their
// bits are in the order of their values and an integer minimum keeps the nearest.

#option KERNEL box one_of [box, surfel] // the paper's one distance a splat, or that of the point's tangent plane

#import "dispatch.wgsl"
#import "paraboloid.wgsl"
#import "points.wgsl"
#import "scene.wgsl"
#import "virtual-lights.wgsl"

struct Settings {
    points_count: u32,
    points_per_map: u32,
    depth_count: u32,
    depth_tile: u32,
    max_splat: f32,
    splat_scale: f32,
}

var<uniform> settings: Settings;
var<storage, read> points: array<Point>;
var<storage, read> lights: VirtualLights;
var<storage, read_write> depth: array<atomic<u32>>;
/// The same buffer, as whole vectors.
var<storage, read_write> cleared: array<vec4<u32>>;

/// Four texels a thread: nothing fell, +∞.
@compute @workgroup_size(64)
fn clear(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = row_index(group, groups, local, 64u);
    if index < arrayLength(&cleared) {
        cleared[index] = vec4(0x7f800000u);
    }
}

/// One thread a splat. Neighbouring threads work on one map, and map i takes the points from i·n on, modulo
/// their count: a fixed and even subset.
@compute @workgroup_size(64)
fn splat(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local_index: u32,
) {
    let index = row_index(group, groups, local_index, 64u);
    let map = index / settings.points_per_map;
    if map >= min(settings.depth_count, lights.count) {
        return;
    }
    let point = points[index % settings.points_count];
    let frame = frame_from_normal(lights.lights[map].normal);
    let offset = point.position - lights.lights[map].position;
    let local = offset * frame;
    if !above_horizon(local, scene_info.extent) {
        return;
    }

    // All points stand for the same area: what the scene has, shared out among the points of one map.
    let area = scene_info.area / f32(settings.points_per_map);
    let distance = length(local);
    let facing = abs(dot(point.normal, offset)) / distance;
    let centre = paraboloid_from_direction(local / distance);
    let tile = settings.depth_tile;
    let texel = paraboloid_density(centre) * texel_area(tile);
    let side = clamp(settings.splat_scale * sqrt(area * facing / texel) / distance, 1.0, settings.max_splat);

    // Texels whose centres are in the square: at least one, as a side is at least 1.
    let position = tile_position(centre, tile);
    let low = vec2<u32>(max(ceil(position - 0.5 * side - 0.5), vec2(0.0)));
    let high = vec2<u32>(min(ceil(position + 0.5 * side - 0.5), vec2(f32(tile))));
    let size = high - low;
    let first = (map * tile + low.y) * tile + low.x;
#if KERNEL == surfel
    let normal = point.normal * frame;
    let height = dot(normal, local);
    let reach = sqrt(area) * settings.splat_scale;
#endif
    // One loop, not two: neighbouring threads with splats of different sizes wait less for each other.
    var at = vec2(0u);
    for (var i = 0u; i < size.x * size.y; i++) {
#if KERNEL == surfel
        // Where the texel's ray meets the tangent plane, held within the splat's own reach for rays that graze it.
        let along = dot(normal, direction_from_paraboloid(texel_centre(low + at, tile)));
        let hit = select(distance, height / along, along * height > 0.0);
        let stored = clamp(hit, max(distance - reach, 0.0), distance + reach);
#else
        let stored = distance;
#endif
        atomicMin(&depth[first + at.y * tile + at.x], bitcast<u32>(stored));
        at.x++;
        if at.x == size.x {
            at = vec2(0u, at.y + 1u);
        }
    }
}
