// Traces a ray for each texel of the maps.

#option PAST false // whether maps are kept, and only those that are listed are traced

#import "algorithms/morton.wgsl"
#import "dispatch.wgsl"
#import "light-projection.wgsl"
#import "ray-tracing.wgsl"

struct Settings {
    lights_count: u32,
    visibility_tile: u32,
    visibility_columns: u32,
    visibility_rows: u32,
    /// Workgroups that trace the rays of a map.
    groups_of_map: u32,
#if !PAST
    /// The first map of the dispatch, and the one after its last.
    first_map: u32,
    end_map: u32,
#endif
}

var<uniform> settings: Settings;
var<storage, read> lights: VirtualLights;
#if PAST
/// The maps to trace, by index.
var<storage, read> moved: array<u32>;
/// The workgroups of this dispatch, and in the last component the number of those maps.
var<storage, read> groups: vec4<u32>;
#endif
var visibility_atlas: texture_storage_2d_array<r32float, write>;

const GROUP: u32 = 64u;

/// The distance [m] to the first surface along the ray of a texel; NOTHING where there is none.
fn distance_of(index: u32, texel: vec2<u32>) -> f32 {
    if index >= min(settings.lights_count, lights.count) {
        return NOTHING;
    }
    let light = lights.lights[index];
    let ray = map_ray(light.kind, texel_centre(texel, settings.visibility_tile));
    let nearest = rise_above_horizon(ray);
    if all(light.flux == vec3(0.0)) || nearest < 0.0 {
        return NOTHING;
    }
    let frame = frame_from_normal(light.normal);
    let hit = trace(light.position + frame * ray.origin, frame * ray.direction, nearest, FAR);
    return select(hit.distance * ray.length, NOTHING, hit.triangle == NO_HIT);
}

/// One thread per texel; each map begins with a workgroup.
@compute @workgroup_size(GROUP)
fn trace_maps(row: Row) {
    let tile = settings.visibility_tile;
    let texels = tile * tile;
    let group = group_in(row);
    let number = group % settings.groups_of_map * GROUP + row.local;
    var map = group / settings.groups_of_map;
#if PAST
    if map >= groups.w || number >= texels {
        return;
    }
    map = moved[map];
#else
    map += settings.first_map;
    if map >= settings.end_map || number >= texels {
        return;
    }
#endif
    let texel = place_in_turn(number, tile);
    let origin = tile_origin(map, settings.visibility_columns, settings.visibility_rows, tile);
    textureStore(visibility_atlas, origin.xy + texel, origin.z, vec4(distance_of(map, texel)));
}
