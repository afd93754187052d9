// The horizon of a virtual light under a normal map: light leaves a surface only to where both its own normal and the bent one face. A
// light that stands for many bent normals has their mean and how far they scatter, as mean-normal.wgsl has it.

#import "mean-normal.wgsl"
#import "virtual-lights.wgsl"

/// The most that slopes of bent normals may scatter: of more, the mean has no direction.
const MOST_DEVIATION: f32 = 2.0;

/// Bent normals whose mean is longer than this differ from it by less than a byte says.
const ONE_NORMAL: f32 = 1.0 - 1e-4;

/// The kind of a light on a surface whose unit normal is bent to another one, or is the same.
fn kind_on_surface(normal: vec3<f32>, bent: vec3<f32>) -> u32 {
    return select(ON_SURFACE, pack4x8snorm(vec4(bent, 0.0)), any(bent != normal));
}

/// The kind of a light on a surface that is bent in many ways, by the mean of what normal maps add to its unit normals. What these
/// themselves differ by, where the surface is curved, has no part in it.
fn kind_of_bend(normal: vec3<f32>, bend: vec3<f32>) -> u32 {
    let mean = normal + bend;
    let size = min(length(mean), 1.0);
    // Normals that cancel each other have no mean.
    if dot(normal, mean) > ONE_NORMAL || size < 0.01 {
        return ON_SURFACE;
    }
    let deviation = select(min(deviation_of(size) / MOST_DEVIATION, 1.0), 0.0, size > ONE_NORMAL);
    return pack4x8snorm(vec4(normalize(mean), deviation));
}

/// The mean of the bent normals of a light on a surface.
fn mean_of_bent_normals(light: VirtualLight) -> vec3<f32> {
    if light.kind == ON_SURFACE {
        return light.normal;
    }
    let packed = unpack4x8snorm(light.kind);
    let deviation = packed.w * MOST_DEVIATION;
    return normalize(packed.xyz) / (1.0 + deviation * deviation);
}

/// The mean of what normal maps add to the normal of a light on a surface.
fn bend_of(light: VirtualLight) -> vec3<f32> {
    return mean_of_bent_normals(light) - light.normal;
}

/// The share of a light on a surface that goes along a way of any length: 1, or 0 below the horizon, and between them where its
/// bent normals differ.
fn share_along(light: VirtualLight, way: vec3<f32>) -> f32 {
    if light.kind == ON_SURFACE {
        return 1.0;
    }
    let packed = unpack4x8snorm(light.kind);
    let cosine = dot(packed.xyz, way);
    if packed.w <= 0.0 {
        return select(0.0, 1.0, cosine >= 0.0);
    }
    let across = length(way - cosine * packed.xyz);
    let small = packed.w * MOST_DEVIATION;
    // That of slopes of any size, to 1 % of the light up to slopes of 1.
    let deviation = small + 0.8 * small * small * small;
    return share_below(cosine / max(deviation * across, 1e-30));
}

/// The share of the light of a Lambertian surface that leaves above the horizon of a bent unit normal, (1 + cosα) / 2; or of many,
/// by their mean.
fn share_above(normal: vec3<f32>, bent: vec3<f32>) -> f32 {
    return 0.5 + 0.5 * dot(normal, bent);
}

/// The share of the flux of a light that leaves above its horizon.
fn share_above_horizon(light: VirtualLight) -> f32 {
    if light.kind == ON_SURFACE || light.kind == INFINITELY_FAR {
        return 1.0;
    }
    return share_above(light.normal, mean_of_bent_normals(light));
}
