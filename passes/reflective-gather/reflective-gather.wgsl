// Gathers the light of a reflective shadow map around the projection of each pixel into it, without shadows: at few pixels, then at
// those that cannot be interpolated between them. [Dachsbacher & Stamminger 2005, §3-§4; ACRSM §3.2.2]
//
// All pixels share one pattern of samples: rays from the projection to the edge of the map, with the samples uniform along each ray.
// So their density falls with the distance, and a sample stands for more of the map the farther away it is.
//
// irradiance: rgba32float [W/m²]; in alpha the luminance of what the bound removed [W/m²].

#input view: GBuffer // The pixels at which light is gathered.
#input rsm: ReflectiveShadowMap // The light that surfaces reflect, one layer for each map of a light.
#output irradiance: Irradiance // Diffuse irradiance, without shadows.
#output interpolated: Counters // The number of pixels, and of those that did not have to be gathered again.

#option WEIGHTS density one_of [density, squared] // The weight of a sample. density: the part of the map that it stands for, so that
    // the expected sum is that over all texels within the radius. squared: the square of its distance, as the paper has it, which
    // takes far texels for more than they are; samples beyond the edges of the map are lost.

#import "bounded-geometry.wgsl"
#import "algorithms/compact.wgsl"
#import "counters.wgsl"
#import "horizon.wgsl"
#import "lights.wgsl"
#import "octahedron.wgsl"
#import "scene.wgsl"
#import "sobol.wgsl"
#import "surface-around.wgsl"

struct Settings {
    view_size: vec2<u32>,
    /// Samples in each layer of the map. More: less error, and more time. The paper takes 400. [default: 400, min: 1, max: 16384]
    samples: u32,
    /// The farthest that a sample lies from the projection of the pixel, in sides of the map. Larger: light from farther away, but
    /// more error near the pixel. With 1.5, all of the map is within reach. [default: 1.5, min: 0.0, max: 1.5]
    radius: f32,
    /// Distance between the pixels at which light is gathered first. Larger: less time, but less detail where surfaces are flat. 1
    /// gathers at all of them. [default: 4, min: 1, max: 64, unit: "px"]
    divisor: u32,
    /// The least number of the four pixels around that must be alike for a pixel to be interpolated between those that are. More:
    /// less error at edges, but more pixels to gather again. [default: 3, min: 1, max: 4]
    neighbors: u32,
    /// Greatest distance of a pixel that is alike from the plane of the one that is interpolated, as a fraction of its depth. Larger:
    /// light that leaks across steps. Smaller: more pixels to gather again. [default: 0.02, min: 0.0]
    plane: f32,
    /// Least cosine between the normals of pixels that are alike. Smaller: light that leaks across creases. Larger: more pixels to
    /// gather again. [default: 0.9, min: -1.0, max: 1.0]
    cosine: f32,
    /// Distance below which the geometry term of a sample is bounded, in radii of a disc of the area for which it stands; at most a
    /// fifth of the scene's dense extent. 0 is no such bound. Larger: smaller bright spots, but more light lost near corners. [default: 1.0, min: 0.0, max: 100.0]
    area_bound: f32,
    seed: u32,
    /// The samples of all layers, one layer after the other, that this dispatch takes: `begin` to `end`.
    begin: u32,
    end: u32,
    /// 1 for the dispatch that takes the last samples.
    last: u32,
}

var<uniform> settings: Settings;
var rsm_position: texture_2d_array<f32>;
var rsm_normal: texture_2d_array<f32>;
var rsm_flux: texture_2d_array<f32>;
var irradiance: texture_storage_2d<rgba32float, write>;
var<storage, read_write> interpolated: Counters;

/// A sample relative to the projection of a pixel.
struct Offset {
    /// Unit.
    direction: vec2<f32>,
    /// As a fraction of the way along that direction.
    distance: f32,
}

/// The pattern. [scratch, count: settings.samples]
var<storage, read_write> pattern: array<Offset>;
/// Irradiance at every `divisor`-th pixel of every `divisor`-th row, and at the last ones.
/// [scratch, size: ((view.width + settings.divisor - 2) / settings.divisor + 1,
///     (view.height + settings.divisor - 2) / settings.divisor + 1)]
var coarse: texture_storage_2d<rgba32float, write>;
/// [reads: coarse]
var gathered: texture_2d<f32>;
/// 1 for each pixel that must be gathered again, else 0. [scratch, count: view.width * view.height]
var<storage, read_write> rejected: array<u32>;
/// Those pixels, one behind the other: workgroups are full, however the pixels are scattered. [scratch, count: view.width *
/// view.height]
var<storage, read_write> pixels: array<u32>;
/// Workgroups that gather at them. [scratch]
var<storage, read_write> groups: array<u32, 3>;
/// Sums of the dispatches before. [scratch, count: view.width * view.height * min(parts - 1, 1)]
var<storage, read_write> sums: array<vec4<f32>>;

/// Threads of a workgroup that gathers at a row of pixels: a multiple of every adapter's subgroup.
const GROUP: u32 = 64u;

/// Makes the pattern. [threads: settings.samples]
@compute @workgroup_size(GROUP)
fn scatter(row: Row) {
    let i = index_in(row, GROUP);
    if i >= settings.samples {
        return;
    }
    let square = sobol2_of(i, settings.seed);
    let angle = 2.0 * PI * square.y;
    pattern[i] = Offset(vec2(cos(angle), sin(angle)), square.x);
}

/// The projection of a point [m] into a layer of the map: columns and rows as fractions of its sides. What lies beyond the edges of
/// the map is drawn to the edge, and what lies behind the light is mirrored to its front first, so that the projection is in the
/// map and continuous.
fn projection(layer: u32, at: vec3<f32>) -> vec2<f32> {
    let clip = scene_light_layers[layer].clip_from_world * vec4(at, 1.0);
    let farthest = max(abs(clip.w), max(abs(clip.x), abs(clip.y)));
    // At the light itself there is no direction.
    return select(vec2(0.0), clip.xy / farthest, farthest > 0.0) * vec2(0.5, -0.5) + 0.5;
}

/// A sample in a layer of the map.
struct Placed {
    /// Columns and rows as fractions of its sides.
    at: vec2<f32>,
    /// The part of the map for which it stands, times the number of samples.
    part: f32,
}

/// Places a sample around a projection.
fn placed(offset: Offset, centre: vec2<f32>) -> Placed {
#if WEIGHTS == density
    // DEVIATION(edges): a ray ends at the edge of the map, so that no sample is lost.
    let to_edges = select(centre, 1.0 - centre, offset.direction > vec2(0.0)) / max(abs(offset.direction), vec2(1e-6));
    let reach = min(min(to_edges.x, to_edges.y), settings.radius);
    // DEVIATION(weights): one over the density of the samples, in place of the squared distance.
    let part = 2.0 * PI * offset.distance * reach * reach;
#else
    let reach = settings.radius;
    // The mean of the squared distance is 1/3, so that the parts sum to the disc of that radius.
    let part = 3.0 * PI * offset.distance * offset.distance * reach * reach;
#endif
    return Placed(centre + offset.distance * reach * offset.direction, part);
}

/// A point that receives light.
struct Receiver {
    /// [m]
    at: vec3<f32>,
    normal: vec3<f32>,
    /// The normal of its plane.
    plane: vec3<f32>,
}

/// The irradiance of a receiver by a texel and all those for which it stands, `weight` texels [W/m²]; in alpha the luminance of
/// what the bound removed.
fn received(receiver: Receiver, texel: vec2<u32>, layer: u32, weight: f32) -> vec4<f32> {
    let position = textureLoad(rsm_position, texel, layer, 0);
    let normals = textureLoad(rsm_normal, texel, layer, 0);
    if position.w == 0.0 || dot(normals.xyz, normals.xyz) == 0.0 {
        return vec4(0.0);
    }
    let offset = receiver.at - position.xyz;
    // No light arrives from behind the plane, even where a bent normal faces it.
    if dot(receiver.plane, offset) >= 0.0 {
        return vec4(0.0);
    }
    let flux = textureLoad(rsm_flux, texel, layer, 0);
    // DEVIATION(bound): the paper has none.
    let least = area_of_bound(settings.area_bound, flux.a * max(weight, 1.0));
    let normal = normalize(normals.xyz);
    var stands_for = weight;
    if normals.w != 0.0 {
        let bent = direction_from_half_float(normals.w);
        // The map has the flux that leaves above the horizon of the bent normal.
        stands_for = select(0.0, weight / max(share_above(normal, bent), 1e-3), dot(bent, offset) >= 0.0);
    }
    let terms = stands_for * bounded_geometry(offset, normal, receiver.normal, 1e-6 * scene_info.extent, least, 0.0);
    return vec4(flux.rgb * terms.x, luminance(flux.rgb) * terms.y);
}

/// The light at a pixel by those samples of all layers that this dispatch takes [W/m²].
fn gather_at(pixel: vec2<u32>) -> vec4<f32> {
    let depth = textureLoad(view_depth, pixel, 0).x;
    if depth <= 0.0 {
        return vec4(0.0);
    }
    let at = camera.position + pixel_ray(vec2<f32>(pixel), settings.view_size) * depth;
    let normal = normalize(textureLoad(view_normal, pixel, 0).xyz);
    let receiver = Receiver(at, normal, plane_normal(pixel, normal));
    let size = textureDimensions(rsm_flux);
    let texels_per_sample = f32(size.x) * f32(size.y) / f32(settings.samples);
    let layers = min(textureNumLayers(rsm_flux), arrayLength(&scene_light_layers));
    let end = min(settings.end, layers * settings.samples);
    var sum = vec4(0.0);
    var next = settings.begin;
    while next < end {
        let layer = next / settings.samples;
        let centre = projection(layer, at);
        let end_of_layer = min((layer + 1u) * settings.samples, end);
        for (; next < end_of_layer; next++) {
            let sample = placed(pattern[next % settings.samples], centre);
            let place = vec2<i32>(floor(sample.at * vec2<f32>(size)));
#if WEIGHTS == squared
            if any(place < vec2(0)) || any(place >= vec2<i32>(size)) {
                continue;
            }
#endif
            // A place on the edge itself can round to beyond it.
            let texel = vec2<u32>(clamp(place, vec2(0), vec2<i32>(size) - 1));
            sum += received(receiver, texel, layer, texels_per_sample * sample.part);
        }
    }
    return sum;
}

/// The sum of this dispatch with those of the dispatches before, at a pixel that has this index.
fn continued(index: u32, own: vec4<f32>) -> vec4<f32> {
    var sum = own;
    if settings.begin > 0u {
        sum += sums[index];
    }
    if settings.last == 0u {
        sums[index] = sum;
    }
    // Of a light of 1e30 W, the sum would be infinite, and infinities cannot be interpolated.
    return min(sum, vec4(1e37));
}

/// The pixel of the view at which a texel of `coarse` is gathered.
fn pixel_of(texel: vec2<u32>) -> vec2<u32> {
    return min(texel * settings.divisor, settings.view_size - 1u);
}

/// Gathers at few pixels. [threads: texels(coarse), items: settings.samples * rsm.layers]
@compute @workgroup_size(8, 8)
fn gather_coarsely(@builtin(global_invocation_id) id: vec3<u32>) {
    let size = (settings.view_size + settings.divisor - 2u) / settings.divisor + 1u;
    if any(id.xy >= size) {
        return;
    }
    let sum = continued(id.y * size.x + id.x, gather_at(pixel_of(id.xy)));
    if settings.last == 1u {
        textureStore(coarse, id.xy, sum);
    }
}

/// Interpolates between these where enough of them are alike, and marks the other pixels.
@compute @workgroup_size(8, 8)
fn interpolate(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= settings.view_size) {
        return;
    }
    let index = id.y * settings.view_size.x + id.x;
    rejected[index] = 0u;
    let depth = textureLoad(view_depth, id.xy, 0).x;
    if depth <= 0.0 {
        textureStore(irradiance, id.xy, vec4(0.0));
        return;
    }
    let after = (id.xy + settings.divisor - 1u) / settings.divisor;
    if all(pixel_of(after) == id.xy) {
        textureStore(irradiance, id.xy, textureLoad(gathered, after, 0));
        return;
    }
    let normal = textureLoad(view_normal, id.xy, 0).xyz;
    let around = surface_around(id.xy, settings.view_size, depth, normal);
    let before = id.xy / settings.divisor;
    let low = pixel_of(before);
    // Where a pixel is in a row of `coarse`, both neighbours along a column are the same.
    let share = vec2<f32>(id.xy - low) / vec2<f32>(max(pixel_of(after) - low, vec2(1u)));
    var sum = vec4(0.0);
    var weights = 0.0;
    var alike = 0u;
    for (var corner = 0u; corner < 4u; corner++) {
        let is_after = vec2(corner % 2u == 1u, corner / 2u == 1u);
        let texel = select(before, after, is_after);
        let other = pixel_of(texel);
        if !is_same_surface(around, vec2<i32>(other), settings.plane, settings.cosine) {
            continue;
        }
        let shares = select(1.0 - share, share, is_after);
        sum += shares.x * shares.y * textureLoad(gathered, texel, 0);
        weights += shares.x * shares.y;
        alike += 1u;
    }
    if alike < settings.neighbors || weights <= 0.0 {
        rejected[index] = 1u;
        return;
    }
    textureStore(irradiance, id.xy, sum / weights);
}

fn scan_length() -> u32 {
    return settings.view_size.x * settings.view_size.y;
}

fn compact_keeps(i: u32) -> bool {
    return rejected[i] == 1u;
}

fn compact_move(i: u32, place: u32) {
    pixels[place] = i;
}

fn compact_count(count: u32) {
    interpolated = Counters(scan_length(), scan_length() - count);
    let of_pixels = folded((count + GROUP - 1u) / GROUP);
    groups = array(of_pixels.x, of_pixels.y, 1u);
}

/// Gathers at the pixels that were marked. [items: settings.samples * rsm.layers]
@compute @workgroup_size(GROUP)
fn gather_again(row: Row) {
    let i = index_in(row, GROUP);
    if i >= interpolated.requested - interpolated.produced {
        return;
    }
    let pixel = vec2(pixels[i] % settings.view_size.x, pixels[i] / settings.view_size.x);
    let sum = continued(i, gather_at(pixel));
    if settings.last == 1u {
        textureStore(irradiance, pixel, sum);
    }
}
