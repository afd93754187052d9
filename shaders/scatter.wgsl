// Directions in which a surface scatters light, sampled for paths.

#option GLOSSY false // whether anything reflects other than diffusely

#import "hemisphere.wgsl"
#import "reflectance.wgsl"
#import "sobol.wgsl"
#import "tangent-frame.wgsl"

struct Scattered {
    direction: vec3<f32>,
    /// Reflectance · cosine / density.
    weight: vec3<f32>,
    /// Cosine / (π · density): 1 where directions are sampled by the cosine alone.
    cosine_share: f32,
    /// [1/sr]
    density: f32,
}

/// Samples a direction from which a surface may have received the light that it reflects.
fn scatter(vertex: PathVertex, leaving: vec3<f32>, index: u32, direction_seed: u32, lobe_seed: u32) -> Scattered {
    let square = sobol2_of(index, direction_seed);
    let tangents = frame_from_normal(vertex.normal);
    var local = by_cosine(square);
#if GLOSSY
    let toward = leaving * tangents;
    let share = specular_share(vertex.surface);
    if sobol2_of(index, lobe_seed).x < share {
        local = reflect(-toward, visible_normal(toward, lobe_alpha(vertex.surface), square));
    }
    let direction = tangents * local;
    if local.z <= 0.0 || dot(vertex.geometric, direction) <= 0.0 {
        return Scattered(vec3(0.0), vec3(0.0), 0.0, 0.0);
    }
    let density = lobes_density(vertex.surface, share, toward, local);
    let weight = reflectance(vertex, direction, leaving) * local.z / density;
    return Scattered(direction, weight, local.z / (PI * density), density);
#else
    let direction = tangents * local;
    let arrives = select(0.0, 1.0, dot(vertex.geometric, direction) > 0.0);
    return Scattered(direction, arrives * vertex.surface.albedo, arrives, local.z / PI);
#endif
}

/// Density [1/sr] with which `scatter` samples a direction. Unit; 0 below the surface.
fn scatter_density(vertex: PathVertex, leaving: vec3<f32>, direction: vec3<f32>) -> f32 {
    let cosine = dot(vertex.normal, direction);
    if cosine <= 0.0 {
        return 0.0;
    }
#if GLOSSY
    let tangents = frame_from_normal(vertex.normal);
    return lobes_density(vertex.surface, specular_share(vertex.surface), leaving * tangents, direction * tangents);
#else
    return cosine / PI;
#endif
}

#if GLOSSY
/// The share of directions that are sampled by the specular lobe: each surface samples both lobes in proportion to their
/// reflectance at normal incidence.
fn specular_share(at: Surface) -> f32 {
    let diffuse = luminance(at.albedo);
    let specular = luminance(at.specular);
    return select(0.0, specular / (diffuse + specular), specular > 0.0);
}

/// Returns the width α of the specular lobe of a surface: its roughness squared.
fn lobe_alpha(at: Surface) -> f32 {
    return max(at.roughness * at.roughness, 1e-3);
}

/// Density [1/sr] of a direction by both lobes. Local frame, unit.
fn lobes_density(at: Surface, share: f32, toward: vec3<f32>, local: vec3<f32>) -> f32 {
    return (1.0 - share) * local.z / PI + share * visible_normal_density(toward, local, lobe_alpha(at));
}

/// A microfacet normal of GGX, among those that are visible from a direction (Dupuy & Benyoub 2023). Local frame, unit.
fn visible_normal(toward: vec3<f32>, alpha: f32, square: vec2<f32>) -> vec3<f32> {
    let stretched = normalize(vec3(toward.xy * alpha, max(toward.z, 1e-3)));
    let angle = 2.0 * PI * square.x;
    // 1 - z, which keeps its digits near the normal.
    let cap = square.y * (1.0 + stretched.z);
    let radius = sqrt(max(cap * (2.0 - cap), 0.0));
    let half_way = vec3(radius * cos(angle), radius * sin(angle), 1.0 - cap) + stretched;
    return normalize(vec3(half_way.xy * alpha, half_way.z));
}

/// Density [1/sr] of the direction that such a normal reflects to: D G₁ / (4 cosθ) (Heitz 2018).
fn visible_normal_density(toward: vec3<f32>, to_light: vec3<f32>, alpha: f32) -> f32 {
    let half_way = normalize(toward + to_light);
    let a2 = alpha * alpha;
    let spread = a2 * half_way.z * half_way.z + dot(half_way.xy, half_way.xy);
    let cosine = max(toward.z, 1e-3);
    // G₁ / cosθ = 2 / (cosθ + √(α² + (1 − α²) cos²θ))
    return a2 / (PI * spread * spread) * 0.5 / (cosine + sqrt(a2 + (1.0 - a2) * cosine * cosine));
}
#endif
