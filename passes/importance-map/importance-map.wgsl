// The importance of each texel of a reflective shadow map as a virtual light: what it contributes to samples of the view
// without regard to visibility (TCAS Eq. 1-2), or its flux (ISM §4). With blocks, the response of the view to one texel of
// each, from which shaders/importance-by-blocks.wgsl computes the importance of all.

/// What is stored: importance by contribution to the view, of each texel; the response of the view to a texel of each
/// block; or importance by flux, of each texel.
#option STORED contribution one_of [contribution, response, flux]

#import "algorithms/scaled.wgsl"
#import "color.wgsl"
#if STORED != flux
#import "scene.wgsl"
#import "view-sample.wgsl"

struct Settings {
    view_samples: u32,
    min_distance: f32,
    defensive: f32,
    stride: u32,
}

const TILE: u32 = 64u;

var<uniform> settings: Settings;
var<storage, read> samples: array<ViewSample>;
var<workgroup> tile: array<ViewSample, TILE>;
var rsm_position: texture_2d_array<f32>;
var rsm_normal: texture_2d_array<f32>;
#endif
var rsm_flux: texture_2d_array<f32>;
#if STORED == response
var importance_response: texture_storage_2d_array<rgba32float, write>;
#else
var importance_map: texture_storage_2d_array<r32float, write>;
#endif

/// What a texel reflects [W]; 0 outside the map.
fn flux_at(texel: vec2<u32>, layer: u32) -> vec3<f32> {
    // Outside the map, the load returns some texel or zero.
    let flux = textureLoad(rsm_flux, texel, layer, 0).rgb;
    return select(vec3(0.0), flux, all(texel < textureDimensions(rsm_flux)));
}

#if STORED == response
/// The texel that stands for a block: the one in the middle, or the brightest where that reflects nothing.
fn texel_of_block(block: vec2<u32>, layer: u32) -> vec2<u32> {
    let first = block * settings.stride;
    var found = first + settings.stride / 2u;
    var brightest = luminance(flux_at(found, layer));
    if brightest > 0.0 {
        return found;
    }
    for (var y = 0u; y < settings.stride; y++) {
        for (var x = 0u; x < settings.stride; x++) {
            let bright = luminance(flux_at(first + vec2(x, y), layer));
            if bright > brightest {
                found = first + vec2(x, y);
                brightest = bright;
            }
        }
    }
    return found;
}
#endif

@compute @workgroup_size(16, 16)
fn measure(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
#if STORED == response
    let texel = texel_of_block(id.xy, id.z);
#else
    let texel = id.xy;
#endif
    let flux = flux_at(texel, id.z);
#if STORED != flux
    let reflects = luminance(flux) > 0.0;
    let position = to_extents(textureLoad(rsm_position, texel, id.z, 0).xyz);
    let normal = textureLoad(rsm_normal, texel, id.z, 0).xyz;
    var response = vec3(0.0);
    for (var first = 0u; first < settings.view_samples; first += TILE) {
        workgroupBarrier();
        if thread < TILE && first + thread < settings.view_samples {
            tile[thread] = samples[first + thread];
        }
        workgroupBarrier();
        let end = min(TILE, settings.view_samples - first);
        if reflects {
            for (var k = 0u; k < end; k++) {
                response += tile[k].response * sample_geometry(position, normal, tile[k], settings.min_distance);
            }
        }
    }
    response /= f32(settings.view_samples);
#endif
#if STORED == response
    if all(id.xy < textureDimensions(importance_response)) {
        textureStore(importance_response, id.xy, id.z, vec4(response, 0.0));
    }
#else
    if all(id.xy < textureDimensions(importance_map)) {
#if STORED == contribution
        let value = importance_of(flux, response, settings.defensive);
#else
        let value = weight_of(luminance(flux));
#endif
        textureStore(importance_map, id.xy, id.z, vec4(value));
    }
#endif
}
