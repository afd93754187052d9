// The domain of a source: the directions into which it sends light, or of a directional light the places across it. Areas are
// kept: a point light has the unit sphere, a spot its cap of that, a directional light the rectangle of its map, of which the
// longer side is 2. Distances are those of the vectors.

#import "hemisphere.wgsl"
#import "light-power.wgsl"
#import "surface.wgsl"
#import "tangent-frame.wgsl"

/// A ray along which a source sends light.
struct Beam {
    origin: vec3<f32>,
    /// Unit.
    direction: vec3<f32>,
}

/// Metres that count as 1 in the domain of a directional light.
fn unit_across(light: Light) -> f32 {
    let half_extent = scene_light_layers[light.first_layer].half_extent;
    return max(half_extent.x, half_extent.y);
}

/// The area of the domain.
fn domain_area(light: Light) -> f32 {
    if light.kind == LIGHT_DIRECTIONAL {
        let side = unit_across(light);
        return measure_of(light) / side / side;
    }
    return measure_of(light);
}

/// The place of a point of the unit square.
fn place_of(light: Light, square: vec2<f32>) -> vec3<f32> {
    if light.kind == LIGHT_DIRECTIONAL {
        let half_extent = scene_light_layers[light.first_layer].half_extent;
        return vec3((2.0 * square - 1.0) * (half_extent / unit_across(light)), 0.0);
    }
    return frame_from_normal(light.direction) * direction_about_z(square.x * light.cap_sampled, square.y);
}

/// The place from which light comes to a point in world space.
fn place_towards(light: Light, position: vec3<f32>) -> vec3<f32> {
    if light.kind == LIGHT_DIRECTIONAL {
        let layer = scene_light_layers[light.first_layer];
        let way = position - layer.world_from_layer[3].xyz;
        let across = vec2(dot(layer.world_from_layer[0].xyz, way), dot(layer.world_from_layer[1].xyz, way));
        return vec3(across / unit_across(light), 0.0);
    }
    return unit(position - light.position);
}

/// Whether a place is in the domain, up to the rounding of a light at its border that was placed there. False for what is no
/// number.
fn is_in_domain(light: Light, place: vec3<f32>) -> bool {
    if light.kind == LIGHT_DIRECTIONAL {
        let sides = scene_light_layers[light.first_layer].half_extent / unit_across(light);
        return all(abs(place.xy) <= sides * 1.0001);
    }
    let slack = 1e-6 + 1e-4 * light.cap_sampled;
    return dot(place, place) > 0.5 && cap_of(light, place) <= light.cap_sampled + slack;
}

/// The ray of a place.
fn beam_of(light: Light, place: vec3<f32>) -> Beam {
    if light.kind == LIGHT_DIRECTIONAL {
        let layer = scene_light_layers[light.first_layer];
        let across = place.xy * unit_across(light);
        return Beam((layer.world_from_layer * vec4(across, 0.0, 1.0)).xyz, light.direction);
    }
    return Beam(light.position, place);
}

/// The share of its intensity that a source gives along the ray of a place.
fn shine_at(light: Light, place: vec3<f32>) -> f32 {
    var even = light;
    even.intensity = vec3(1.0);
    return light_intensity(even, place).x;
}
