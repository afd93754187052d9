// Path tracing with next-event estimation, accumulated until there are enough samples. [SMC-IR §5.4]
//
// This is the reference that other pipelines are compared with. A path starts at a point of a pixel, and at each surface adds what the lights of the scene contribute there. Light
// that was reflected once is direct; after k more reflections it belongs to the k-th bounce. Surfaces that emit are lights
// too: each surface samples a point of one, and paths may meet them. So is the environment: each surface samples a direction
// of it, and paths may leave the scene.
//
// Means over all samples, one texel per pixel; the number of samples is in the buffer `samples_progress`:
//   samples_image: direct + indirect + emitted radiance [W/(m² sr)]; alpha: the luminance of half the samples, for the estimate
//   samples_direct: radiance reflected once; alpha: share of the samples that hit a surface
//   samples_indirect: radiance of bounces 1 to `bounces`
//   samples_irradiance: indirect irradiance at the surface seen [W/m²]; alpha: luminance of what the clamp removed

#input past: PathSamples optional // The samples so far: `prev` of the output `samples`. Without it each frame begins again.
#output image: Radiance(size: frame) // All light.
#output direct: Radiance(size: frame) // Light that was reflected once.
#output indirect: Radiance(size: frame) // Light of bounces 1 to `bounces`.
#output irradiance: Irradiance(size: frame) // Indirect irradiance where the camera sees a surface.
#output samples: PathSamples(size: frame) // Means over all samples so far.

#option EMISSIVE false // whether any surface emits
#option GLOSSY false // whether anything reflects other than diffusely
#option PAST false // whether there are samples of earlier frames

#import "camera.wgsl"
#import "color.wgsl"
#import "environment-light.wgsl"
#import "path-samples.wgsl"
#import "progress.wgsl"
#import "reflected-light.wgsl"
#import "scatter.wgsl"
#import "sobol.wgsl"
#if EMISSIVE
#import "emitted-light.wgsl"
#endif

struct Settings {
    samples_size: vec2<u32>,
    seed: u32,
    /// Most reflections between the surface that a light illuminates and the one that the camera sees; 0 is direct light
    /// alone. Time grows with it. [default: 3, min: 0, max: 63]
    bounces: u32,
    /// Number N of samples per pixel after which rendering stops. Error falls as N^-½ or better. [default: 1024, min: 1, max:
    /// 16777216]
    samples: u32,
    /// Samples per pixel in one frame, or fewer if they would take more than 128 rays. More: the picture is complete after
    /// fewer frames, each of which takes longer. [default: 4, min: 1, max: 64]
    samples_per_frame: u32,
    /// Estimated relMSE of the whole picture at which rendering stops before all samples are taken; 0 takes all samples.
    /// [default: 0.0, min: 0.0, max: 1000000.0]
    error: f32,
    /// Length of a path's first indirect segment below which its geometry term is bounded, as a fraction of the scene's
    /// dense extent; 0 is no bound. With the same value as the `clamp` of `gather`, the picture is what virtual lights with that
    /// clamp converge to. [default: 0.0, min: 0.0, max: 1.0]
    clamp: f32,
    /// The value of a pixel. box: the mean over its square. centre: what its centre sees, as in a G-buffer. [default:
    /// "box", one_of: ["box", "centre"]]
    filter_: u32,
    /// Points in a pixel along either side, with the filter `centre`: a grid, as of the supersampling of a G-buffer. [default: 1,
    /// min: 1, max: 16]
    supersampling: u32,
    /// 1 if direct and emitted light are needed.
    direct: u32,
}

var<uniform> settings: Settings;
#if PAST
var past_image: texture_2d<f32>;
var past_direct: texture_2d<f32>;
var past_indirect: texture_2d<f32>;
var past_irradiance: texture_2d<f32>;
var<storage, read> past_progress: Progress;
var<storage, read> past_halves: Halves;
#endif
var samples_image: texture_storage_2d<rgba32float, write>;
var samples_direct: texture_storage_2d<rgba32float, write>;
var samples_indirect: texture_storage_2d<rgba32float, write>;
var samples_irradiance: texture_storage_2d<rgba32float, write>;

/// The contribution of a path.
struct Sample {
    direct: vec3<f32>,
    indirect: vec3<f32>,
    emitted: vec3<f32>,
    /// Indirect irradiance at the surface seen [W/m²].
    irradiance: vec3<f32>,
    /// Luminance of the irradiance that the clamp removed [W/m²].
    removed: f32,
    seen: f32,
}

// Random sequences of two numbers each; two of them for every surface of a path, and one more where surfaces emit.
const PIXEL: u32 = 0u;
const DIRECTION: u32 = 1u;
const LOBE: u32 = 2u;
const EMITTER: u32 = 0x656du;
const ENVIRONMENT: u32 = EMITTER + 64u;

/// The value of `filter` for the mean over a pixel's square.
const BOX: u32 = 0u;

@compute @workgroup_size(8, 8)
fn trace_paths(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= settings.samples_size) {
        return;
    }
    var image = vec3(0.0);
    var half = 0.0;
    var direct = vec4(0.0);
    var indirect = vec4(0.0);
    var irradiance = vec4(0.0);
    var before: Progress;
#if PAST
    before = past_progress;
#endif
    let count = steps_of_frame(before, settings.samples_per_frame, settings.samples);
    let pixel_seed = hash2(settings.seed, id.y * settings.samples_size.x + id.x);
    for (var s = 0u; s < count; s++) {
        let sample = path(id.xy, before.step + s, pixel_seed);
        image += sample.direct + sample.indirect + sample.emitted;
        direct += vec4(sample.direct, sample.seen);
        indirect += vec4(sample.indirect, 0.0);
        irradiance += vec4(sample.irradiance, sample.removed);
    }
    let samples = f32(max(count, 1u));
    image /= samples;
    direct /= samples;
    indirect /= samples;
    irradiance /= samples;
#if PAST
    // The mean moves by what the frame differs from it. A sum of equal samples, as of direct light at the centre of a pixel,
    // would round all of them to the same side.
    let past = textureLoad(past_image, id.xy, 0);
    half = select(past.a, luminance(past.rgb), past_halves.samples == before.step);
    let share = f32(count) / f32(max(before.step + count, 1u));
    image = moved(vec4(past.rgb, 0.0), vec4(image, 0.0), share).rgb;
    direct = moved(textureLoad(past_direct, id.xy, 0), direct, share);
    indirect = moved(textureLoad(past_indirect, id.xy, 0), indirect, share);
    irradiance = moved(textureLoad(past_irradiance, id.xy, 0), irradiance, share);
#endif
    textureStore(samples_image, id.xy, vec4(image, half));
    textureStore(samples_direct, id.xy, direct);
    textureStore(samples_indirect, id.xy, indirect);
    textureStore(samples_irradiance, id.xy, irradiance);
}

/// The mean of all samples, of which those of this frame are a share.
fn moved(past: vec4<f32>, frame: vec4<f32>, share: f32) -> vec4<f32> {
    return past + (frame - past) * share;
}

fn path(pixel: vec2<u32>, index: u32, pixel_seed: u32) -> Sample {
    var sample: Sample;
    var within = sobol2_of(index, hash2(pixel_seed, PIXEL));
    if settings.filter_ != BOX {
        let side = f32(settings.supersampling);
        within = (floor(within * side) + 0.5) / side;
    }
    var origin = camera.position;
    var direction = view_ray(vec2<f32>(pixel) + within);
    // The ray has length 1 along the viewing axis, where the near plane is measured.
    var hit = trace(origin, direction, camera.near, FAR);
    if hit.triangle == NO_HIT {
        if settings.direct != 0u {
            sample.emitted = environment_radiance(direction);
        }
        return sample;
    }
    direction = normalize(direction);
    var vertex = path_vertex(hit, direction);
    sample.seen = 1.0;
#if EMISSIVE
    if settings.direct != 0u {
        sample.emitted = vertex.surface.emission;
    }
#endif
    // The share of light that arrives along the path and reaches the camera; the same without the first reflection, for
    // the irradiance; and the share of both that the clamp keeps.
    var throughput = vec3(1.0);
    var arriving = vec3(1.0);
    var kept = 1.0;
    for (var bounce = 0u; bounce <= settings.bounces; bounce++) {
        if bounce > 0u {
            collect(&sample, throughput, arriving, kept, reflected_light(vertex, -direction));
        } else if settings.direct != 0u {
            sample.direct += reflected_light(vertex, -direction);
        }
        if environment_is_sampled() {
            let place = sobol2_bits_of(index, hash2(pixel_seed, ENVIRONMENT + bounce));
            if bounce > 0u {
                collect(&sample, throughput, arriving, kept, reflected_environment(vertex, -direction, place));
            } else if settings.direct != 0u {
                sample.direct += reflected_environment(vertex, -direction, place);
            }
        }
#if EMISSIVE
        let place = sobol2_bits_of(index, hash2(pixel_seed, EMITTER + bounce));
        if bounce > 0u {
            collect(&sample, throughput, arriving, kept, reflected_emission(vertex, -direction, place));
        } else if settings.direct != 0u {
            sample.direct += reflected_emission(vertex, -direction, place);
        }
#else
        // One more segment would meet nothing that emits.
        if bounce == settings.bounces && !environment_is_sampled() {
            break;
        }
#endif
        let scattered = scatter(vertex, -direction, index, hash2(pixel_seed, 2u * bounce + DIRECTION),
            hash2(pixel_seed, 2u * bounce + LOBE));
        if !any(scattered.weight > vec3(0.0)) {
            break;
        }
        throughput *= scattered.weight;
        // With cosine-distributed directions, the mean of π times the arriving radiance is the irradiance.
        arriving = select(arriving * scattered.weight, vec3(PI * scattered.cosine_share), bounce == 0u);
        origin = offset_origin(vertex.position, vertex.geometric);
        hit = trace(origin, scattered.direction, 0.0, FAR);
        if hit.triangle == NO_HIT {
            let radiance = met_environment(scattered.direction, scattered.density);
            if bounce > 0u {
                collect(&sample, throughput, arriving, kept, radiance);
            } else if settings.direct != 0u {
                sample.direct += throughput * radiance;
            }
            break;
        }
        let from_point = vertex.position;
        direction = scattered.direction;
        vertex = path_vertex(hit, direction);
#if EMISSIVE
        if any(vertex.surface.emission > vec3(0.0)) {
            let share = met_share(hit.triangle, vertex, from_point, direction, scattered.density);
            let emission = share * vertex.surface.emission;
            if bounce > 0u {
                collect(&sample, throughput, arriving, kept, emission);
            } else if settings.direct != 0u {
                sample.direct += throughput * emission;
            }
        }
#endif
        if bounce == 0u && settings.clamp > 0.0 {
            // SMC-IR §5.4: the geometry term of the first segment is bounded like that of a virtual light; segments
            // that end on a light are not bounded.
            let offset = (vertex.position - from_point) / (settings.clamp * scene_info.dense_extent);
            kept = min(dot(offset, offset), 1.0);
        }
    }
    return sample;
}

/// Adds indirect radiance that leaves the last surface of a path.
fn collect(sample: ptr<function, Sample>, throughput: vec3<f32>, arriving: vec3<f32>, kept: f32, radiance: vec3<f32>) {
    (*sample).indirect += throughput * radiance * kept;
    (*sample).irradiance += arriving * radiance * kept;
    (*sample).removed += luminance(arriving * radiance) * (1.0 - kept);
}
