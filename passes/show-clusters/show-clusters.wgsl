// Shows the cells of clusters of a reflective shadow map on the surfaces in view.
//
// Each cluster has a color, darker where the light that the cell belongs to does not shine, and a dot at the texel at its
// centre.

#input map: ClusterMap // The cluster of each texel.
#input clusters: Clusters // The clusters, averaged: where their centres are.
#input rsm: ReflectiveShadowMap // The map that was clustered; its positions are the shadow maps.
#input view: GBuffer // The surfaces to show them on.
#output display: Display(size: like(view) / view.supersampling) // The cells in colors.

#import "camera.wgsl"
#import "clustering.wgsl"
#import "light-map.wgsl"
#import "random.wgsl"
#import "slope.wgsl"

struct Settings {
    view_size: vec2<u32>,
    view_supersampling: u32,
    display_size: vec2<u32>,
    /// Radius of the dot at the centre of a cell; 0 draws none. [default: 3.0, min: 0.0, max: 100.0, unit: "px"]
    dot: f32,
}

var<uniform> settings: Settings;
var view_depth: texture_2d<f32>;
var view_normal: texture_2d<f32>;
var map: texture_2d_array<u32>;
var<storage, read> clusters: Clusters;
var rsm_position: texture_2d_array<f32>;
var display: texture_storage_2d<rgba8unorm, write>;

/// The color of surfaces that no map reaches, and of those that belong to no cluster.
const OUTSIDE: vec3<f32> = vec3(0.1);
const UNMAPPED: vec3<f32> = vec3(0.4);
const DOT: vec3<f32> = vec3(0.0);

/// Share of its brightness that a color has in shadow.
const IN_SHADOW: f32 = 0.35;

/// The distance behind the surface in the map at which a surface still counts as lit, in sides of a texel, times 1 + its slope: a texel covers
/// half of its side around its centre.
const BIAS: f32 = 1.0;

/// Bound on the slope, as of what stands on edge.
const STEEPEST: f32 = 8.0;

/// The texel in which a map sees a point.
struct Place {
    layer: u32,
    texel: vec2<u32>,
    /// Whether the map reaches the point, and whether nothing lies between.
    is_inside: bool,
    is_lit: bool,
}

/// Looks a point up in a layer.
fn place_in(index: u32, at: vec3<f32>, normal: vec3<f32>) -> Place {
    let layer = scene_light_layers[index];
    let axes = mat3x3(layer.world_from_layer[0].xyz, layer.world_from_layer[1].xyz, layer.world_from_layer[2].xyz);
    let receiver = (at - layer.world_from_layer[3].xyz) * axes;
    let distance = -receiver.z;
    let perspective = layer.kind != LIGHT_DIRECTIONAL;
    if perspective && distance <= 0.0 {
        return Place(index, vec2(0u), false, false);
    }
    let size = vec2<f32>(textureDimensions(rsm_position));
    let half_extent = layer.half_extent * select(1.0, distance, perspective);
    let uv = (receiver.xy / half_extent * vec2(0.5, -0.5) + 0.5) * size;
    if any(uv < vec2(0.0)) || any(uv >= size) {
        return Place(index, vec2(0u), false, false);
    }
    let texel = vec2<u32>(uv);
    let side = 2.0 * max(half_extent.x / size.x, half_extent.y / size.y);
    let n = normal * axes;
    let to_light = select(vec3(0.0, 0.0, 1.0), -normalize(receiver), perspective);
    let slope = slope_against(n, to_light, 1.0 / STEEPEST);
    let seen = textureLoad(rsm_position, texel, index, 0).w;
    let is_open = seen == 0.0 || seen >= distance - BIAS * side * (1.0 + slope);
    return Place(index, texel, true, dot(n, to_light) > 0.0 && is_open);
}

/// The place of a point in the map of the first light that shines on it; where none does, of the first that reaches it.
fn place_of(at: vec3<f32>, normal: vec3<f32>) -> Place {
    var best = Place(0u, vec2(0u), false, false);
    for (var i = 0u; i < scene_lights.count; i++) {
        let place = place_in(layer_that_sees(scene_lights.lights[i], at), at, normal);
        if place.is_lit {
            return place;
        }
        if place.is_inside && !best.is_inside {
            best = place;
        }
    }
    return best;
}

/// The color of a cluster. Hues step by the golden ratio, so that those of near indices are far apart; brightness and
/// saturation distinguish others.
fn color_of(index: u32) -> vec3<f32> {
    let hue = unit_float(index * 2654435769u) * 6.0;
    let bits = hash(index);
    let value = 0.6 + 0.2 * f32(bits % 3u);
    let saturation = 0.5 + 0.4 * f32((bits >> 8u) % 2u);
    let ramp = abs((vec3(hue) + vec3(0.0, 4.0, 2.0)) % 6.0 - 3.0) - 1.0;
    return value * (1.0 - saturation + saturation * clamp(ramp, vec3(0.0), vec3(1.0)));
}

/// Whether a pixel that sees `at` is in the dot of a cluster.
fn is_in_dot(index: u32, at: vec3<f32>, depth: f32) -> bool {
    if index >= arrayLength(&clusters.clusters) {
        return false;
    }
    let texel = clusters.clusters[index].texel;
    if texel == NO_TEXEL {
        return false;
    }
    let size = textureDimensions(rsm_position);
    let place = vec2(texel % size.x, texel / size.x % size.y);
    let centre = textureLoad(rsm_position, place, texel / (size.x * size.y), 0).xyz;
    let pixel = 2.0 * camera.half_extent.y * depth / f32(settings.display_size.y);
    return distance(at, centre) < settings.dot * pixel;
}

/// The color of what a sample of the view sees.
fn color_at(sample: vec2<u32>) -> vec3<f32> {
    let depth = textureLoad(view_depth, sample, 0).x;
    if depth <= 0.0 {
        return vec3(0.0);
    }
    let at = camera.position + pixel_ray(vec2<f32>(sample), settings.view_size) * depth;
    let place = place_of(at, direction_of(textureLoad(view_normal, sample, 0).xyz));
    if !place.is_inside {
        return OUTSIDE;
    }
    let index = textureLoad(map, place.texel, place.layer, 0).x;
    var color = UNMAPPED;
    if index != NO_CLUSTER {
        color = select(color_of(index), DOT, is_in_dot(index, at, depth));
    }
    return color * select(IN_SHADOW, 1.0, place.is_lit);
}

@compute @workgroup_size(8, 8)
fn show(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= settings.display_size) {
        return;
    }
    let side = settings.view_supersampling;
    var color = vec3(0.0);
    for (var i = 0u; i < side * side; i++) {
        color += color_at(id.xy * side + vec2(i % side, i / side));
    }
    textureStore(display, id.xy, vec4(color / f32(side * side), 1.0));
}
