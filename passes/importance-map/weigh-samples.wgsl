// Weighs the samples of the view by what they receive, so that what a light contributes to a dark place counts as much as the same
// share of the light of a bright one. What a sample receives is estimated by rays to random texels.

#option MEASURE contribution one_of [contribution, flux, reflectance] // contribution alone has weights

#import "algorithms/scaled.wgsl"
#import "color.wgsl"
#import "dispatch.wgsl"
#import "random.wgsl"
#import "ray-tracing.wgsl"
#import "scene.wgsl"
#import "view-sample.wgsl"

struct Settings {
    view_samples: u32,
    rays_per_sample: u32,
    min_distance: f32,
    seed: u32,
}

/// Threads of a workgroup, which shares the rays of a sample.
const RAYS: u32 = 64u;
/// What a sample counts to receive at least, in means of all: one that rays to its lights miss does not count for all others.
const LEAST: f32 = 0.2;

var<uniform> settings: Settings;
var rsm_position: texture_2d_array<f32>;
var rsm_normal: texture_2d_array<f32>;
var rsm_flux: texture_2d_array<f32>;
var<storage, read_write> samples: array<ViewSample>;
/// What each sample receives of the light of the texels, over their flux [1/extents²].
var<storage, read_write> received: array<f32>;

/// What texels reflect towards a sample, and all that they reflect [W].
struct LightSum {
    seen: Scaled,
    all: Scaled,
}

var<workgroup> lights: array<LightSum, RAYS>;

fn add_light(a: LightSum, b: LightSum) -> LightSum {
    return LightSum(add_scaled(a.seen, b.seen), add_scaled(a.all, b.all));
}

fn is_empty(sample: ViewSample) -> bool {
    return all(sample.response == vec3(0.0));
}

/// The light of a random texel.
fn light_of(sample: ViewSample, index: u32, ray: u32) -> LightSum {
    let numbers = halton3(ray + 1u, hash2(settings.seed, index));
    let size = vec3(textureDimensions(rsm_flux), textureNumLayers(rsm_flux));
    let texel = min(vec3<u32>(numbers * vec3<f32>(size)), size - 1u);
    let flux = textureLoad(rsm_flux, texel.xy, texel.z, 0).rgb;
    let all = scaled_weight(luminance(flux));
    let position = textureLoad(rsm_position, texel.xy, texel.z, 0).xyz;
    let normal = textureLoad(rsm_normal, texel.xy, texel.z, 0).xyz;
    let geometry = sample_geometry(to_extents(position), normal, sample, settings.min_distance);
    let light = weight_of(dot(flux, sample.response)) * geometry;
    if light == 0.0 {
        return LightSum(Scaled(0.0, 0), all);
    }
    let origin = offset_origin(scene_info.bounds_min + sample.position * scene_info.extent, sample.normal);
    let way = offset_origin(position, normal) - origin;
    if occluded(origin, way, 0.0, 1.0) {
        return LightSum(Scaled(0.0, 0), all);
    }
    return LightSum(scaled_weight(light), all);
}

#if MEASURE == contribution
/// One workgroup for each sample.
@compute @workgroup_size(RAYS)
fn receive(row: Row) {
    let index = group_in(row);
    var light = LightSum(Scaled(0.0, 0), Scaled(0.0, 0));
    if index < settings.view_samples && !is_empty(samples[index]) {
        for (var ray = row.local; ray < settings.rays_per_sample; ray += RAYS) {
            light = add_light(light, light_of(samples[index], index, ray));
        }
    }
    lights[row.local] = light;
    workgroupBarrier();
    if row.local == 0u && index < settings.view_samples {
        for (var thread = 1u; thread < RAYS; thread++) {
            light = add_light(light, lights[thread]);
        }
        let unit = max(magnitude(light.seen), magnitude(light.all));
        received[index] = select(0.0, in_units(light.seen, unit) / in_units(light.all, unit), light.all.value > 0.0);
    }
}

/// One workgroup for all samples.
@compute @workgroup_size(GROUP_SIZE)
fn weigh(@builtin(local_invocation_index) thread: u32) {
    var sum = vec2(0.0);
    for (var i = thread; i < settings.view_samples; i += GROUP_SIZE) {
        if !is_empty(samples[i]) {
            sum += vec2(received[i], 1.0);
        }
    }
    let mean = prefix_sum(thread, sum.x).y / max(prefix_sum(thread, sum.y).y, 1.0);
    if !(mean > 0.0) {
        return;
    }
    for (var i = thread; i < settings.view_samples; i += GROUP_SIZE) {
        samples[i].response *= mean / (received[i] + LEAST * mean);
    }
}
#endif
