// Microfacet reflection, as glTF's metallic-roughness model has it.

#import "color.wgsl"

/// Microfacet reflection [1/sr]: GGX with the height-correlated Smith term (Heitz 2014) and Schlick's Fresnel.
/// All directions leave the surface, unit.
fn ggx(normal: vec3<f32>, to_light: vec3<f32>, to_camera: vec3<f32>, f0: vec3<f32>, roughness: f32) -> vec3<f32> {
    let nl = dot(normal, to_light);
    // Seen on edge, a surface would reflect without bound.
    let nv = max(dot(normal, to_camera), 1e-3);
    // A mirror shows a light without extent nowhere, or without bound: it is kept this rough.
    let a = max(roughness * roughness, 1e-3);
    let a2 = a * a;
    let half_way = normalize(to_light + to_camera);
    let nh = clamp(dot(normal, half_way), 0.0, 1.0);
    // 1 − nh² by the cross product, which does not cancel near the peak.
    let sine = cross(normal, half_way);
    let spread = a2 * nh * nh + dot(sine, sine);
    let distribution = a2 / (PI * spread * spread);
    let shadowing = 0.5 / (nl * sqrt(a2 + (1.0 - a2) * nv * nv) + nv * sqrt(a2 + (1.0 - a2) * nl * nl));
    let fresnel = f0 + (1.0 - f0) * pow(1.0 - clamp(dot(to_light, half_way), 0.0, 1.0), 5.0);
    return distribution * shadowing * fresnel;
}
