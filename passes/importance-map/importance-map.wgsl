// The importance of each texel of a reflective shadow map as a virtual light: what it contributes to samples
// of the view without regard to visibility (TCAS Eq. 1-2), or its flux (ISM §4).

/// Importance by contribution to the view; otherwise by flux.
#option CONTRIBUTION true
/// Computes sums, for mixing with the flux.
#option SUMS true

#import "algorithms/scaled.wgsl"
#import "color.wgsl"
#if CONTRIBUTION
#import "scene.wgsl"
#import "view-sample.wgsl"

struct Settings {
    view_samples: u32,
    min_distance: f32,
}

const TILE: u32 = 64u;

var<uniform> settings: Settings;
var<storage, read> samples: array<ViewSample>;
var<workgroup> tile: array<ViewSample, TILE>;
var rsm_position: texture_2d_array<f32>;
var rsm_normal: texture_2d_array<f32>;
#endif
var rsm_flux: texture_2d_array<f32>;
var importance: texture_storage_2d_array<r32float, write>;
#if SUMS
#import "sums.wgsl"

/// [workgroups]
var<storage, read_write> partial_sums: array<Sums>;
#endif

/// Side of a workgroup.
const GROUP_SIDE: u32 = 16u;

@compute @workgroup_size(GROUP_SIDE, GROUP_SIDE)
fn measure(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let inside = all(id.xy < textureDimensions(rsm_flux));
    // Outside the map, the load returns some texel or zero, which is not used.
    let flux = textureLoad(rsm_flux, id.xy, id.z, 0).rgb;
    let reflected = select(0.0, weight_of(luminance(flux)), inside);
#if CONTRIBUTION
    let position = to_extents(textureLoad(rsm_position, id.xy, id.z, 0).xyz);
    let normal = textureLoad(rsm_normal, id.xy, id.z, 0).xyz;
    var response = vec3(0.0);
    for (var first = 0u; first < settings.view_samples; first += TILE) {
        workgroupBarrier();
        if thread < TILE && first + thread < settings.view_samples {
            tile[thread] = samples[first + thread];
        }
        workgroupBarrier();
        let end = min(TILE, settings.view_samples - first);
        if reflected > 0.0 {
            for (var k = 0u; k < end; k++) {
                response += tile[k].response * geometry(position, normal, tile[k]);
            }
        }
    }
    // The sum over samples is bounded; multiplied by the flux last, it overflows only where the result does.
    let value = select(0.0, weight_of(dot(flux, response / f32(settings.view_samples))), inside);
#else
    let value = reflected;
#endif
    if inside {
        textureStore(importance, id.xy, id.z, vec4(value));
    }
#if SUMS
    let contribution = workgroup_sum(thread, Scaled(value, 0));
    let all_flux = workgroup_sum(thread, Scaled(reflected, 0));
    if thread == 0u {
        partial_sums[(group.z * groups.y + group.y) * groups.x + group.x] = Sums(contribution, all_flux);
    }
#endif
}

#if CONTRIBUTION
/// The geometry term of Eq. 2 between a virtual light and a sample, cosθ cosθ' / (π d² + guard) [1/extents²].
fn geometry(position: vec3<f32>, normal: vec3<f32>, at: ViewSample) -> f32 {
    let way = at.position - position;
    // Single precision distinguishes positions to 1e-7 extents: below that, the sample is at the light, and the cosines
    // are 0 since the vector is.
    let squared = max(dot(way, way), 1e-20);
    let cosines = max(dot(normal, way), 0.0) * max(-dot(at.normal, way), 0.0) / squared;
    // DEVIATION(min-distance): a light at a sample would take all the importance, so its distance counts as at least
    // `min_distance`.
    return cosines / (PI * (squared + settings.min_distance * settings.min_distance));
}
#endif
