// Computes the direct light of all lights, with filtered shadows from the reflective shadow map. [percentage-closer
// filtering: Reeves, Salesin & Cook 1987]
//
// Visibility is percentage-closer filtering (Reeves, Salesin & Cook 1987) with a receiver-plane depth bias: each tap is
// compared with the distance of the plane through the receiver in that texel (after Isidoro 2006). With `settle`, a ray decides where
// the taps differ, which is at the edges of shadows, or do so within the bias: edges are then as sharp as the view, whatever the side of the
// map.

#input view: GBuffer // The surfaces to light.
#input rsm: ReflectiveShadowMap // What the lights see; its positions are the shadow maps.
#output direct: Radiance // Direct light, reflected towards the camera.
#lights

#option VIEW_SPECULAR false // whether the G-buffer has the member `specular`
#option SETTLE false // Whether a ray decides where the taps of a window differ, or do so within the bias.

#import "camera.wgsl"
#import "color.wgsl"
#import "ggx.wgsl"
#import "incident-light.wgsl"
#import "light-map.wgsl"
#import "light-reach.wgsl"
#import "scene.wgsl"
#import "slope.wgsl"
#import "view-geometric.wgsl"

struct Settings {
    direct_size: vec2<u32>,
    /// Side of the window over which shadows are filtered: 5 makes 25 taps. Larger: softer edges; time grows with the
    /// square.
    /// [default: 5, one_of: [1, 3, 5, 7, 9], unit: "texels"]
    pcf: u32,
    /// Depth bias: how far behind the map a surface may lie and still be lit, times 1 + its slope. Larger: less shadow
    /// acne, but more light leaks at contacts. [default: 0.25, min: 0.0, max: 100.0, unit: "texels"]
    bias: f32,
}

var<uniform> settings: Settings;
var view_depth: texture_2d<f32>;
var view_normal: texture_2d<f32>;
var view_albedo: texture_2d<f32>;
#if VIEW_SPECULAR
var view_specular: texture_2d<f32>;
#endif
var rsm_position: texture_2d_array<f32>;
var direct: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn direct_light(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= settings.direct_size) {
        return;
    }
    let depth = textureLoad(view_depth, id.xy, 0).x;
    if depth == 0.0 {
        textureStore(direct, id.xy, vec4(0.0));
        return;
    }
    let at = position_from_depth(id.xy, settings.direct_size, depth);
    let normal = textureLoad(view_normal, id.xy, 0).xyz;
    let plane = plane_normal(id.xy, normal);
    let albedo = textureLoad(view_albedo, id.xy, 0).rgb;
    var radiance = vec3(0.0);
    for (var i = 0u; i < scene_lights.count; i++) {
        let light = scene_lights.lights[i];
        let incident = incident_light(light, at);
        let irradiance = incident.irradiance * dot(normal, -incident.direction);
        // A light that is behind the surface, too far off its axis or dark needs no shadow-map lookup.
        if !any(irradiance > vec3(0.0)) || dot(plane, incident.direction) >= 0.0 {
            continue;
        }
        var reflected = albedo / PI;
#if VIEW_SPECULAR
        let specular = textureLoad(view_specular, id.xy, 0);
        let towards_camera = -normalize(pixel_ray(vec2<f32>(id.xy), settings.direct_size));
        reflected += ggx(normal, -incident.direction, towards_camera, specular.rgb, specular.a);
#endif
        var lit = visibility(layer_that_sees(light, at), at, plane);
#if SETTLE
        if lit == UNDECIDED {
            lit = select(0.0, 1.0, light_reaches(light, offset_origin(at, plane), -incident.direction));
        }
#endif
        radiance += reflected * irradiance * lit;
    }
    textureStore(direct, id.xy, vec4(radiance, 1.0));
}

/// Bound on the slope of a plane from texel to texel, in sides of a texel: seen nearly edge-on, its slope would grow
/// without bound, and whatever lies in front of it would be taken for the plane itself.
const STEEPEST: f32 = 8.0;

#if SETTLE
/// What `visibility` returns where only a ray can tell.
const UNDECIDED: f32 = -1.0;

/// The part of the bias within which a map believes that a tap sees the receiver's own surface.
const OWN_SURFACE: f32 = 0.2;
#endif

/// The share of a layer's light that reaches a point [m] of a plane with the unit `normal`.
fn visibility(index: u32, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    let layer = scene_light_layers[index];
    let axes = mat3x3(layer.world_from_layer[0].xyz, layer.world_from_layer[1].xyz, layer.world_from_layer[2].xyz);
    let receiver = (at - layer.world_from_layer[3].xyz) * axes;
    let n = normal * axes;
    let distance = -receiver.z;
    let perspective = layer.kind != LIGHT_DIRECTIONAL;
    if perspective && distance <= 0.0 {
        return 0.0;
    }
    let size = vec2<f32>(textureDimensions(rsm_position));
    // Half the map's width and height, and the longer side of a texel, at the receiver [m].
    let half_extent = layer.half_extent * select(1.0, distance, perspective);
    let texel = 2.0 * max(half_extent.x / size.x, half_extent.y / size.y);
    let to_light = select(vec3(0.0, 0.0, 1.0), -normalize(receiver), perspective);
    let slope = min(slope_against(n, to_light, 1.0 / STEEPEST), STEEPEST);
    let bias = settings.bias * texel * (1.0 + slope);

    // DEVIATION(window): taps are at texel centres; the window of `pcf` texels cuts the outermost, which count in part.
    // So each of the pcf² taps is bilinear, and the visible share changes continuously.
    let centre = (receiver.xy / half_extent * vec2(0.5, -0.5) + 0.5) * size - 0.5;
    let first = floor(centre) - f32(settings.pcf / 2u);
    let part = centre - floor(centre);
    let reach = STEEPEST * texel * f32(settings.pcf / 2u + 1u);
    var lit = 0.0;
    var weights = 0.0;
#if SETTLE
    var surely_lit = 0.0;
#endif
    for (var y = 0u; y <= settings.pcf; y++) {
        let weight_y = select(1.0, 1.0 - part.y, y == 0u) * select(1.0, part.y, y == settings.pcf);
        for (var x = 0u; x <= settings.pcf; x++) {
            let weight_x = select(1.0, 1.0 - part.x, x == 0u) * select(1.0, part.x, x == settings.pcf);
            let tap = clamp(first + vec2(f32(x), f32(y)), vec2(0.0), size - 1.0);
            let plane = ((tap + 0.5) / size * 2.0 - 1.0) * vec2(1.0, -1.0) * layer.half_extent;
            // DEVIATION(bias): compared with the receiver's plane minus a depth bias that is the same for all taps.
            let expected = clamp(plane_distance(receiver, n, plane, perspective), distance - reach, distance + reach);
            let seen = textureLoad(rsm_position, vec2<u32>(tap), index, 0).w;
            // An empty texel, past the outline of the scene, tells nothing of surfaces, whether they are lit.
            let weight = select(0.0, weight_x * weight_y, seen != 0.0);
            lit += select(0.0, weight, seen >= expected - bias);
            weights += weight;
#if SETTLE
            surely_lit += select(0.0, weight, seen >= expected - OWN_SURFACE * bias);
#endif
        }
    }
#if SETTLE
    if lit > 0.0 && surely_lit < weights {
        return UNDECIDED;
    }
#endif
    // Where the map is empty all around, nothing occludes.
    return select(1.0, lit / weights, weights > 0.0);
}

/// Distance along the layer's axis [m] at which the ray through `tap`, a point of the image plane, meets the plane
/// through `receiver` with the normal `n`. All are in the layer's space. A plane seen from behind or edge-on has the
/// distance of the receiver.
fn plane_distance(receiver: vec3<f32>, n: vec3<f32>, tap: vec2<f32>, perspective: bool) -> f32 {
    if perspective {
        let facing = dot(n, vec3(tap, -1.0));
        return select(-receiver.z, dot(n, receiver) / facing, facing < 0.0);
    }
    return select(-receiver.z, dot(n.xy, tap - receiver.xy) / n.z - receiver.z, n.z > 0.0);
}
