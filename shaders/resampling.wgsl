// Resampling of virtual lights: the target by which they are chosen, and the choice. [Talbot et al. 2005; Bitterli et al. 2020]
//
// The target of a light is positive everywhere, even where the light gives nothing. So a light that was chosen for one pixel could
// have been chosen for any other, and lights of several pixels combine without bias by any weights that sum to 1.

#import "algorithms/scaled.wgsl"
#import "bounded-geometry.wgsl"
#import "color.wgsl"
#import "horizon.wgsl"
#import "reservoirs.wgsl"
#import "scene.wgsl"

/// The facts of Reservoirs that belong to the target.
struct Target {
    /// In radii of a disc of the light's area.
    bound: f32,
    /// In units of the geometry term at the scene's dense extent.
    least: f32,
}

/// A place that receives light.
struct Receiver {
    /// World space [m].
    at: vec3<f32>,
    /// For shading, unit.
    normal: vec3<f32>,
}

/// Returns the geometry term of a light at the scene's dense extent, which it faces [1/m²].
fn term_at_extent() -> f32 {
    let extent2 = scene_info.dense_extent * scene_info.dense_extent;
    return select(1.0 / (PI * extent2), 0.0, extent2 == 0.0);
}

/// Returns the target of a light at a receiver, but for the guess of its visibility: the luminance of the bounded irradiance
/// [W/m²], and the least that counts.
fn contribution(by: Target, light: VirtualLight, receiver: Receiver) -> f32 {
    if light.kind == INFINITELY_FAR {
        return weight_of(luminance(light.flux) * (max(-dot(receiver.normal, light.normal), 0.0) + by.least));
    }
    let offset = receiver.at - light.position;
    let least = by.bound * by.bound * light.area;
    var term = share_along(light, offset);
    if term > 0.0 {
        term *= bounded_geometry(offset, light.normal, receiver.normal, 1e-6 * scene_info.extent, least, 0.0).x;
    }
    return weight_of(luminance(light.flux) * (term + by.least * term_at_extent()));
}

/// Returns the share of a in the sum of a and b, which are not negative.
fn share_of(a: f32, b: f32) -> f32 {
    return a / max(a + b, 1e-37);
}

/// The choice of a light among candidates.
struct Resampling {
    reservoir: Reservoir,
    /// Its target.
    value: f32,
    /// Sum of the weights of all candidates.
    sum: f32,
}

/// Offers a candidate with a weight: it replaces the one chosen so far with the probability of its share in the sum of all weights.
/// `value` is its target, `number` random in [0, 1). [Bitterli et al. 2020, Alg. 2]
fn offer(choice: ptr<function, Resampling>, candidate: Reservoir, value: f32, weight: f32, number: f32) {
    let counted = weight_of(weight);
    (*choice).sum = weight_of((*choice).sum + counted);
    if counted > number * (*choice).sum {
        (*choice).reservoir = candidate;
        (*choice).value = value;
    }
}

/// Returns the reservoir of a choice among `count` lights.
fn chosen(choice: Resampling, count: f32) -> Reservoir {
    if choice.value <= 0.0 {
        return no_light(count);
    }
    var reservoir = choice.reservoir;
    reservoir.weight = weight_of(choice.sum / choice.value);
    reservoir.count = count;
    return reservoir;
}
