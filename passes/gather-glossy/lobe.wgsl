// Specular lobes: how much a surface reflects from one direction into another, and how far a light's size widens that.

#import "color.wgsl"
#import "ggx.wgsl"

/// How surfaces reflect: values of the setting `model`.
const GGX: u32 = 0u;
const PHONG: u32 = 1u;

/// Width² of a cosine lobe of the exponent N, the greatest 1. The peak of a Phong lobe is 1 / (π width²).
fn width2_of(exponent: f32) -> f32 {
    return 2.0 / (max(exponent, 0.0) + 2.0);
}

/// The exponent of a cosine lobe of this width².
fn exponent_of(width2: f32) -> f32 {
    return max(2.0 / min(width2, 1.0) - 2.0, 0.0);
}

/// cosᴺ, which is 1 for N = 0.
fn cosine_power(cosine: f32, exponent: f32) -> f32 {
    return select(pow(max(cosine, 1e-10), exponent), 1.0, exponent == 0.0);
}

/// Phong's lobe of reflectance 1 [1/sr]. All directions leave the surface, unit.
fn phong(normal: vec3<f32>, from_: vec3<f32>, to: vec3<f32>, exponent: f32) -> f32 {
    let mirrored = 2.0 * dot(normal, from_) * normal - from_;
    return (exponent + 2.0) / (2.0 * PI) * cosine_power(clamp(dot(mirrored, to), 0.0, 1.0), exponent);
}

/// Blinn's lobe of reflectance 1 [1/sr], likewise: ∫ cosᴺ(θ/2) cosθ dω = 8π (2^(−N/2) + N) / ((N + 2) (N + 4)).
fn blinn(normal: vec3<f32>, from_: vec3<f32>, to: vec3<f32>, exponent: f32) -> f32 {
    let scale = (exponent + 2.0) * (exponent + 4.0) / (8.0 * PI * (exp2(-0.5 * exponent) + exponent));
    let half_way = from_ + to;
    let cosine = dot(normal, half_way) / max(length(half_way), 1e-10);
    return scale * cosine_power(clamp(cosine, 0.0, 1.0), exponent);
}

/// A model of reflection, and how rough surfaces are by it.
struct LobeModel {
    /// GGX, PHONG, or Blinn's model.
    kind: u32,
    /// N of Phong's and Blinn's models; microfacets have the roughness of their surface.
    exponent: f32,
}

/// A specular lobe [1/sr]: GGX of a roughness, or a cosine lobe. `spread` is the angular radius² [rad²] of a light
/// that is no point: a mirror shows a disc of that radius with its mean radiance. Wider lobes reflect as much.
fn specular_lobe(
    model: LobeModel, normal: vec3<f32>, from_: vec3<f32>, to: vec3<f32>, f0: vec3<f32>, roughness: f32, spread: f32,
) -> vec3<f32> {
    if dot(normal, from_) <= 0.0 || dot(normal, to) <= 0.0 {
        return vec3(0.0);
    }
    if model.kind == GGX {
        // Half vectors spread by half the angle of what they reflect. Lobes of microfacets are no wider than of roughness 1.
        let alpha2 = min(roughness * roughness * roughness * roughness + 0.25 * spread, 1.0);
        return ggx(normal, from_, to, f0, sqrt(sqrt(alpha2)));
    }
    let width2 = width2_of(model.exponent);
    if model.kind == PHONG {
        return f0 * phong(normal, from_, to, exponent_of(width2 + spread));
    }
    return f0 * blinn(normal, from_, to, exponent_of(width2 + 0.25 * spread));
}
