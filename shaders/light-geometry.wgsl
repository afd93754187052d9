// The geometry term of a virtual light, bounded near the light, for passes that sum the light of virtual lights.

#option GEOMETRY bounded one_of [bounded, point-to-disc, disc] // What a light near a receiver gives. bounded: no more than at the
    // bound, so what is nearer is lost. disc: what a disc of the light's area gives, for lights that stand for an area of known
    // shape. point-to-disc: the same where it is straight ahead, Φ cosθ cosθ' / (π d² + A), and less elsewhere (ACRSM Eq. 3.9).

#import "color.wgsl"
#if GEOMETRY == disc
#import "disc-irradiance.wgsl"
#else
#import "bounded-geometry.wgsl"
#endif
#import "horizon.wgsl"
#import "scene.wgsl"
#import "virtual-lights.wgsl"

/// Geometry term of a light without its visibility [1/m²], cosθ cosθ' / (π d²), or the cosine alone where the light is infinitely
/// far: what remains after the bounds, and what they remove. Of a light nearer than b, which is `clamp` as a fraction of the scene's
/// dense extent, the share d² / b² remains; `area_bound` is the distance, in radii of a disc of the light's area, below which a light
/// gives no more, where GEOMETRY is bounded: it is at most `most_bound`.
fn light_geometry(
    light: VirtualLight,
    at: vec3<f32>,
    normal: vec3<f32>,
    clamp: f32,
    area_bound: f32,
) -> vec2<f32> {
    if light.kind == INFINITELY_FAR {
        return vec2(max(-dot(normal, light.normal), 0.0), 0.0);
    }
    let offset = at - light.position;
    let along = share_along(light, offset);
    if along == 0.0 {
        return vec2(0.0);
    }
    // Below the rounding of positions, neither the distance nor the light's direction is meaningful.
    let rounding = 1e-6 * scene_info.extent;
#if GEOMETRY == disc
    let terms = vec2(disc_irradiance(offset, light.normal, normal, max(light.area / PI, rounding * rounding)), 0.0);
#elif GEOMETRY == bounded
    let terms = bounded_geometry(offset, light.normal, normal, rounding, area_of_bound(area_bound, light.area), 0.0);
#else
    let terms = bounded_geometry(offset, light.normal, normal, rounding, 0.0, light.area);
#endif
    let near = clamp * scene_info.dense_extent;
    let distance2 = max(dot(offset, offset), rounding * rounding);
    let share = min(distance2 / max(near * near, 1e-37), 1.0);
    return along * vec2(terms.x * share, terms.y + terms.x * (1.0 - share));
}

/// Whether a light is before a plane through a receiver: no light arrives from behind it, even where a bent normal faces the light.
fn is_before(light: VirtualLight, at: vec3<f32>, plane: vec3<f32>) -> bool {
    let to_light = select(light.position - at, -light.normal, light.kind == INFINITELY_FAR);
    return dot(plane, to_light) > 0.0;
}

/// Irradiance of a light [W/m²], and the luminance of what the bound removed. `terms` are those of `light_geometry`, times the
/// visibility.
fn light_sum(flux: vec3<f32>, terms: vec2<f32>) -> vec4<f32> {
    return vec4(flux * terms.x, luminance(flux) * terms.y);
}
