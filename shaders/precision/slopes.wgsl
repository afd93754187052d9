// The slope of a surface against a direction, by the angle between that and the surface's normal.

#import "inputs/directions.wgsl"
#import "slope.wgsl"

struct Given {
    normal: vec3<f32>,
    direction: vec3<f32>,
}

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    let normal = unit_direction(u.xy);
    return Given(normal, direction_beside(normal, magnitude, u.w));
}

/// [magnitude: 1e-5 to 1.5, angle [rad]]
fn probe(given: Given) -> vec4<f32> {
    return vec4(slope_against(given.normal, given.direction, 0.125), 0.0, 0.0, 0.0);
}
