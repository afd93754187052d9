// Angles to the axis of a spot as 1 - cos: of directions within a cone, and the falloff between its two angles.

#import "lights.wgsl"
#import "inputs/directions.wgsl"

struct Given {
    axis: vec3<f32>,
    leaving: vec3<f32>,
    cap_outer: f32,
    cap_inner: f32,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    let axis = unit_direction(u.xy);
    let cap = 2.0 * sin(0.5 * magnitude) * sin(0.5 * magnitude);
    let leaving = direction_beside(axis, magnitude * sqrt(0.1 + 0.8 * u.z), u.w);
    return Given(axis, leaving, cap, 0.05 * cap);
}

/// [magnitude: 1e-6 to 1.5, half angle of the cone [rad]]
fn probe(given: Given) -> vec4<f32> {
    var light: Light;
    light.kind = LIGHT_SPOT;
    light.direction = given.axis;
    light.cap_outer = given.cap_outer;
    light.cap_inner = given.cap_inner;
    light.intensity = vec3(1.0);
    return vec4(cap_of(light, given.leaving), light_intensity(light, given.leaving));
}
