// Microfacet reflection near its peak, by roughness.

#import "inputs/reflection.wgsl"
#import "inputs/directions.wgsl"

fn given(magnitude: f32, u: vec4<f32>) -> Given {
    let normal = unit_direction(u.xy);
    // A half vector within about three widths of the peak.
    let half_way = direction_beside(normal, 3.0 * u.z * magnitude * magnitude, u.w);
    let to_light = direction_beside(normal, 1.4 * fract(u.z * 64.0), fract(u.w * 64.0));
    return Given(normal, to_light, 2.0 * dot(half_way, to_light) * half_way - to_light, magnitude);
}

/// [magnitude: 0.01 to 1, roughness]
fn probe(given: Given) -> vec4<f32> {
    return reflection(given);
}
