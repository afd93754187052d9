// Makes virtual lights of points on surfaces, by their radiosity and density. [SMC-IR Eq. 6]
//
// Each stands for the part of the surfaces that its density leaves it.

#input points: SurfacePoints // The positions of the lights.
#input radiosity: Radiosity // The radiosity there.
#input density: Density // The density of the points.
#output lights: VirtualLights(count: points.count) // A light for each point; dark where there is none.

#import "algorithms/scaled.wgsl"
#import "dispatch.wgsl"
#import "point-radiosity.wgsl"
#import "surface-points.wgsl"
#import "virtual-lights.wgsl"

struct Settings {
    points_count: u32,
}

var<uniform> settings: Settings;
var<storage, read> points: SurfacePoints;
var<storage, read> radiosity: PointRadiosities;
var<storage, read> density: array<f32>;
/// Points that become lights. [scratch]
var<storage, read_write> present: u32;
var<storage, read_write> lights: VirtualLights;

/// Whether a light comes of a point.
fn is_light(index: u32) -> bool {
    return points.points[index].triangle != NO_TRIANGLE && density[index] > 0.0;
}

/// Counts the points that become lights, in one workgroup. [threads: 1]
@compute @workgroup_size(GROUP_SIZE)
fn count_points(@builtin(local_invocation_index) thread: u32) {
    var here = 0u;
    for (var i = thread; i < settings.points_count; i += GROUP_SIZE) {
        here += select(0u, 1u, is_light(i));
    }
    let all = prefix_sum_u32(thread, here).y;
    if thread == 0u {
        present = all;
    }
}

@compute @workgroup_size(64)
fn make_lights(row: Row) {
    let index = index_in(row, 64u);
    if index >= settings.points_count {
        return;
    }
    let point = points.points[index];
    var light: VirtualLight;
    light.texel = point.triangle;
    // A light that is dark has a place all the same, where its map may be rendered.
    light.normal = vec3(0.0, 0.0, 1.0);
    if is_light(index) {
        light.position = point.position;
        light.normal = point.normal;
        // DEVIATION(area): points in the paper.
        light.area = weight_of(1.0 / (f32(present) * density[index]));
        let flux = radiosity.radiosities[index].radiosity * light.area;
        light.flux = weights_of(flux);
    }
    lights.lights[index] = light;
    if index == 0u {
        lights.count = settings.points_count;
    }
}
