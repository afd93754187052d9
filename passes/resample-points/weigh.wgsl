// The weight of each surface point: its radiosity over its density, as far as these are given. [SMC-IR §3.2.1]

#option DENSITY false // whether points have a density
#option RADIOSITY false // whether points have a radiosity
#option BY_AREA true // whether weights are divided by the density
#option TELL false // whether points are counted

#import "color.wgsl"
#import "dispatch.wgsl"
#import "point-radiosity.wgsl"
#import "surface-points.wgsl"
#import "weights.wgsl"

struct Settings {
    points_count: u32,
}

var<uniform> settings: Settings;
var<storage, read> points: SurfacePoints;
#if DENSITY && BY_AREA
var<storage, read> density: array<f32>;
#endif
#if RADIOSITY
var<storage, read> radiosity: PointRadiosities;
#endif
var<storage, read_write> weights: array<Scaled>;
#if TELL
/// How many points there are.
var<storage, read_write> present: atomic<u32>;
#endif

fn weight(index: u32) -> Scaled {
    if index >= points.header.count || points.points[index].triangle == NO_TRIANGLE {
        return Scaled(0.0, 0);
    }
    var weight = Scaled(1.0, 0);
#if RADIOSITY
    weight = scaled_weight(luminance(radiosity.radiosities[index].radiosity));
#endif
#if DENSITY && BY_AREA
    weight = quotient(weight, scaled_weight(density[index]));
#endif
    return weight;
}

@compute @workgroup_size(64)
fn weigh(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = row_index(group, groups, local, 64u);
    if index >= settings.points_count {
        return;
    }
    weights[index] = weight(index);
#if TELL
    if index < points.header.count && points.points[index].triangle != NO_TRIANGLE {
        atomicAdd(&present, 1u);
    }
#endif
}
