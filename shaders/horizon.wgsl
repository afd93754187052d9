// The horizon of a virtual light under a normal map: light leaves a surface only to where both its own normal and the bent one face.

#import "virtual-lights.wgsl"

/// The kind of a light on a surface whose unit normal is bent to another one, or is the same.
fn kind_on_surface(normal: vec3<f32>, bent: vec3<f32>) -> u32 {
    return select(ON_SURFACE, pack4x8snorm(vec4(bent, 0.0)), any(bent != normal));
}

/// The bent normal of a light under a normal map, of about unit length.
fn normal_of_map(light: VirtualLight) -> vec3<f32> {
    return unpack4x8snorm(light.kind).xyz;
}

/// Whether a light on a surface sends anything along a way of any length.
fn is_above_horizon(light: VirtualLight, way: vec3<f32>) -> bool {
    return light.kind == ON_SURFACE || dot(normal_of_map(light), way) >= 0.0;
}

/// The share of the light of a Lambertian surface that leaves above the horizon of a bent unit normal: (1 + cosα) / 2.
fn share_above(normal: vec3<f32>, bent: vec3<f32>) -> f32 {
    return 0.5 + 0.5 * dot(normal, bent);
}

/// The share of the flux of a light that leaves above its horizon.
fn share_above_horizon(light: VirtualLight) -> f32 {
    if light.kind == ON_SURFACE || light.kind == INFINITELY_FAR {
        return 1.0;
    }
    return share_above(light.normal, normalize(normal_of_map(light)));
}
