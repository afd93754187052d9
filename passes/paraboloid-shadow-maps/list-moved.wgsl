// Lists the maps whose lights stand elsewhere than when they were rendered, in one workgroup, layer by layer.
// [SMC-IR §4, Laine et al. 2007]

#import "algorithms/workgroup.wgsl"
#import "dispatch.wgsl"
#import "kept.wgsl"
#import "stands.wgsl"

struct Settings {
    lights_count: u32,
    /// Maps of a layer.
    maps_of_layer: u32,
    /// Vertices of all triangles of the scene.
    vertices: u32,
    /// Workgroups that trace the rays of a map.
    groups_of_map: u32,
}

var<uniform> settings: Settings;
var<storage, read> lights: VirtualLights;
var<storage, read> rendered: Stands;
var<storage, read_write> stands: Stands;
/// The maps to render, by index.
var<storage, read_write> moved: array<u32>;
/// [layer] Where the maps of a layer begin in the list.
var<storage, read_write> begins: array<u32>;
var<storage, read_write> draws: array<LayerDraws>;
/// The workgroups that trace a ray for each texel, in three dimensions, and the number of maps that they trace.
var<storage, read_write> groups: vec4<u32>;

@compute @workgroup_size(GROUP_SIZE)
fn list(@builtin(local_invocation_index) thread: u32) {
    var before = 0u;
    for (var layer = 0u; layer < arrayLength(&begins); layer++) {
        let first = layer * settings.maps_of_layer;
        let end = min(first + settings.maps_of_layer, settings.lights_count);
        let begin = before;
        for (var block = first; block < end; block += GROUP_SIZE) {
            let index = block + thread;
            var has_moved = false;
            if index < end {
                var light: VirtualLight;
                if index < lights.count {
                    light = lights.lights[index];
                }
                let stand = stand_of(light);
                has_moved = !is_same_stand(stand, rendered.stands[index]);
                stands.stands[index] = stand;
            }
            let ranks = prefix_sum_u32(thread, select(0u, 1u, has_moved));
            if has_moved {
                moved[before + ranks.x - 1u] = index;
            }
            before += ranks.y;
        }
        if thread == 0u {
            begins[layer] = begin;
            let instances = before - begin;
            draws[layer] = LayerDraws(vec4(6u, instances, 0u, 0u), vec4(settings.vertices, instances, 0u, 0u));
        }
    }
    if thread == 0u {
        groups = vec4(folded(before * settings.groups_of_map), 1u, before);
    }
}
