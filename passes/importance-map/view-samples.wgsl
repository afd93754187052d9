// Picks the samples of the view over which TCAS Eq. 1 estimates the importance of a virtual light: the same pixels in every
// frame, stratified, or points that another pass gives.

#option MEASURE contribution one_of [contribution, flux, reflectance] // flux has no samples of the view
#option POINTS false // whether the samples are given

#import "color.wgsl"
#import "dispatch.wgsl"
#import "scene.wgsl"
#import "view-sample.wgsl"
#if POINTS
#import "surface-points.wgsl"
#else
#import "camera.wgsl"
#import "random.wgsl"
#endif

struct Settings {
    view_samples: u32,
    seed: u32,
}

var<uniform> settings: Settings;
#if POINTS
var<storage, read> points: SurfacePoints;
#else
var view_depth: texture_2d<f32>;
var view_normal: texture_2d<f32>;
var view_albedo: texture_2d<f32>;
#endif
var<storage, read_write> samples: array<ViewSample>;

#if MEASURE != flux
#if POINTS
/// The sample at a point; nothing where that is empty.
fn sample_of(index: u32) -> ViewSample {
    if index >= points.header.count || points.points[index].triangle == NO_TRIANGLE {
        return ViewSample();
    }
    let point = points.points[index];
    return ViewSample(to_extents(point.position), point.normal, LUMINANCE * albedo_of(point) / PI);
}
#else
/// The sample at a pixel; nothing where that sees no surface.
fn sample_of(index: u32) -> ViewSample {
    let size = textureDimensions(view_depth);
    let pixel = min(vec2<u32>(halton3(index + 1u, settings.seed).xy * vec2<f32>(size)), size - 1u);
    let depth = textureLoad(view_depth, pixel, 0).r;
    if depth <= 0.0 {
        return ViewSample();
    }
    let position = camera.position + pixel_ray(vec2<f32>(pixel), size) * depth;
    // DEVIATION(diffuse): the BRDF without its glossy part.
    let albedo = textureLoad(view_albedo, pixel, 0).rgb;
    return ViewSample(to_extents(position), textureLoad(view_normal, pixel, 0).xyz, LUMINANCE * albedo / PI);
}
#endif

@compute @workgroup_size(64)
fn pick(row: Row) {
    let index = index_in(row, 64u);
    if index < settings.view_samples {
        samples[index] = sample_of(index);
    }
}
#endif
