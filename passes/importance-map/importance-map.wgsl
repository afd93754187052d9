// Computes the importance of the texels of a reflective shadow map as virtual lights. [TCAS §4.1, Eq. 1-2; ISM §4; ACRSM §4.5]
//
// This file writes what is stored: what each texel contributes to samples of the view without regard to visibility; or its flux;
// or importance by reflectance, divided by its greatest value so that ACRSM Eq. 4.4 and 4.6 can add and compare it with other values
// of at most 1. view-samples.wgsl picks the samples; reflectance.wgsl and greatest.wgsl prepare importance by reflectance.

#option MEASURE contribution one_of [contribution, flux, reflectance] // The definition of importance. contribution: what the texel
    // contributes to samples of the view, without visibility (TCAS Eq. 1-2). flux: the luminance of the flux that it reflects,
    // independent of the camera (ISM §4). reflectance: how the surface reflects, and how it lies to samples of the view; at most
    // 1 (ACRSM Eq. 4.1-4.3).
#option EVALUATE texels one_of [texels, blocks, on-demand] // Where it is evaluated, for the measures contribution and reflectance.
    // texels: at each texel, and stored. blocks, for reflectance alone: what the texel reflects at each, but what depends on the
    // view at one texel of each block, which takes 1/stride² of the time. on-demand, for contribution alone: at the texels that
    // the sampler asks for: of 512² texels, 1,024 Metropolis-Hastings chains of 5 steps ask for 5,120; the inverse transform asks
    // for all, twice.

#option SPECULAR false // Whether the measure flux counts what texels reflect specularly, for lights with lobes; else a metal has no
    // lights. Where the scene is glossy.
#option RSM_SPECULAR false // whether the reflective shadow map has the member `specular`

#if MEASURE == reflectance
#input rsm: ReflectiveShadowMap with albedo // Each texel is a potential virtual light.
#else
#input rsm: ReflectiveShadowMap // Each texel is a potential virtual light.
#endif
#if MEASURE != flux
#input view: GBuffer // What the lights are to be important for.
#input points: SurfacePoints optional // Samples of the view, in place of `view_samples` of its pixels.
#endif
#if MEASURE == contribution && EVALUATE == on-demand
#output importance: Importance(
    view_samples: samples_count,
    min_distance: settings.min_distance,
    defensive: settings.defensive,
) module "importance-on-demand.wgsl" // f(v) of each texel.
#else
#output importance: Importance module "importance-stored.wgsl" // f(v) of each texel.
#endif

#import "algorithms/scaled.wgsl"
#import "color.wgsl"
#if MEASURE == flux && SPECULAR && RSM_SPECULAR
#import "beam.wgsl"
#endif
#if MEASURE == reflectance
#import "reflectance-values.wgsl"
#elif MEASURE == contribution
#import "scene.wgsl"
#import "squares.wgsl"
#import "view-sample.wgsl"
#endif

struct Settings {
    // DEVIATION(sample-count): a number, not a share of the pixels.
    /// Number P of samples of the view, for the measure contribution. Noise of the importance falls as P^-½; time rises with P ×
    /// texels that are evaluated. TCAS §2 names 0.1 % of the pixels. [default: 128, min: 1, max: 65536]
    view_samples: u32,
    /// Rays from each sample of the view to random texels, for the measure contribution, by which a contribution is measured
    /// relative to what the sample receives. Dark places then get more of the lights, and bright ones fewer. More: what a sample
    /// receives is less noisy; 64 are enough. 0: contributions are added up as they are (TCAS Eq. 1), and bright places decide.
    /// [default: 0, min: 0, max: 4096]
    rays_per_sample: u32,
    // DEVIATION(min-distance): the paper does not bound the distance.
    /// Lower bound on the distance between a texel and a sample of the view in the geometry term. Larger: fewer lights cluster
    /// where a sample happens to lie near a lit surface. Too large: corners, which nearby lights illuminate, get too few lights.
    /// [default: 0.01, min: 0.0001, max: 1.0, unit: "scene extents"]
    min_distance: f32,
    // DEVIATION(defensive): the paper adds nothing.
    /// Constant k in f = Φ (response + k), for the measure contribution: texels that no sample of the view saw are sampled too, in
    /// proportion to their flux. It does not depend on the view, so a change in one place changes no importance elsewhere. Larger:
    /// fewer bright outliers, but more lights out of sight. 0: as in the paper. [default: 0.002, min: 0.0, max: 1000.0, unit:
    /// "1/extents²"]
    defensive: f32,
    // DEVIATION(blocks): the texels of a block have one ρ_v.
    /// Side of a block, for `evaluate: blocks`. Larger: less time, but the importance follows edges less closely. [default: 4,
    /// min: 1, max: 64, unit: "texels"]
    stride: u32,
    /// Weight w_v of how the texel lies to samples of the view against how it reflects, for the measure reflectance. 0:
    /// independent of the camera. [default: 0.5, min: 0.0, max: 1.0]
    view_weight: f32,
}

var<uniform> settings: Settings;
#if MEASURE != contribution || EVALUATE != on-demand
var importance_map: texture_storage_2d_array<r32float, write>;
#endif

#if MEASURE == reflectance
var<storage, read> values: array<ReflectanceValues>;
var<storage, read> greatest: GreatestValues;

@compute @workgroup_size(16, 16)
fn normalise(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = textureDimensions(importance_map);
    if any(id.xy >= size) {
        return;
    }
    let value = values[(id.z * size.y + id.y) * size.x + id.x];
    let importance = importance_by_reflectance(value, greatest.reflected, settings.view_weight);
    textureStore(importance_map, id.xy, id.z, vec4(part_of(importance, greatest.importance)));
}
#elif MEASURE == flux || EVALUATE != on-demand
#if MEASURE == contribution
var<storage, read> samples: array<ViewSample>;
var<workgroup> tile: array<ViewSample, TILE>;
var rsm_position: texture_2d_array<f32>;
var rsm_normal: texture_2d_array<f32>;
#endif
var rsm_flux: texture_2d_array<f32>;
#if MEASURE == flux && SPECULAR && RSM_SPECULAR
var rsm_specular: texture_2d_array<f32>;
#endif

/// The flux that a texel reflects [W]; 0 outside the map.
fn flux_at(texel: vec2<u32>, layer: u32) -> vec3<f32> {
    // Outside the map, the load returns some texel or zero.
    let flux = textureLoad(rsm_flux, texel, layer, 0).rgb;
    return select(vec3(0.0), flux, all(texel < textureDimensions(rsm_flux)));
}

#if MEASURE == flux && SPECULAR && RSM_SPECULAR
/// The flux [W] that a texel reflects specularly at normal incidence.
fn specular_flux(texel: vec2<u32>, layer: u32) -> vec3<f32> {
    // Where the map is empty, so are both members.
    let specular = textureLoad(rsm_specular, texel, layer, 0).rgb;
    return specular * texel_beam(vec3(texel, layer), textureDimensions(rsm_flux)).flux;
}
#endif

#if MEASURE == contribution
/// A texel for which a thread measures what the view receives.
struct Measured {
    texel: vec2<u32>,
    flux: vec3<f32>,
    position: vec3<f32>,
    normal: vec3<f32>,
    response: vec3<f32>,
}

fn measured(texel: vec2<u32>, layer: u32) -> Measured {
    let position = to_extents(textureLoad(rsm_position, texel, layer, 0).xyz);
    let normal = textureLoad(rsm_normal, texel, layer, 0).xyz;
    return Measured(texel, flux_at(texel, layer), position, normal, vec3(0.0));
}

/// Measures a square of GROUP_SIDE * SPAN texels of a layer. [threads: (
///     (importance.width + SPAN - 1) / SPAN, (importance.height + SPAN - 1) / SPAN, rsm.layers)]
@compute @workgroup_size(GROUP_SIDE, GROUP_SIDE)
fn measure(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let corner = group.xy * SQUARE + local.xy;
    var places: array<Measured, SPAN * SPAN>;
    var reflects = false;
    for (var i = 0u; i < SPAN * SPAN; i++) {
        places[i] = measured(corner + place_in_square(i), group.z);
        reflects |= luminance(places[i].flux) > 0.0;
    }
    for (var first = 0u; first < settings.view_samples; first += TILE) {
        workgroupBarrier();
        if first + thread < settings.view_samples {
            tile[thread] = samples[first + thread];
        }
        workgroupBarrier();
        let end = select(0u, min(TILE, settings.view_samples - first), reflects);
        for (var k = 0u; k < end; k++) {
            let at = tile[k];
            for (var i = 0u; i < SPAN * SPAN; i++) {
                places[i].response += at.response * sample_geometry(places[i].position, places[i].normal, at, settings.min_distance);
            }
        }
    }
    for (var i = 0u; i < SPAN * SPAN; i++) {
        store(places[i], group.z);
    }
}

fn store(place: Measured, layer: u32) {
    let response = select(vec3(0.0), place.response / f32(settings.view_samples), luminance(place.flux) > 0.0);
    if all(place.texel < textureDimensions(importance_map)) {
        textureStore(importance_map, place.texel, layer, vec4(importance_of(place.flux, response, settings.defensive)));
    }
}
#else
@compute @workgroup_size(16, 16)
fn measure(@builtin(global_invocation_id) id: vec3<u32>) {
    let flux = flux_at(id.xy, id.z);
#if SPECULAR && RSM_SPECULAR
    let value = weight_of(luminance(flux + specular_flux(id.xy, id.z)));
#else
    let value = weight_of(luminance(flux));
#endif
    if all(id.xy < textureDimensions(importance_map)) {
        textureStore(importance_map, id.xy, id.z, vec4(value));
    }
}
#endif
#endif
