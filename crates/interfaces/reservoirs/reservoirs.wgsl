// The interface Reservoirs: virtual lights chosen for pixels by resampled importance sampling. [Talbot et al. 2005; Bitterli et al.
// 2020]
//
// A light is chosen in proportion to a target p̂, which may be any function that is positive where the light could give anything: the
// luminance of what it would give without occluders, times a guess of its visibility. The sum over all lights of any f is estimated
// by f · weight, without bias.

#import "virtual-lights.wgsl"

/// A light that was chosen from many for a pixel.
struct Reservoir {
    /// The light as it was when it was chosen: it may be one of an earlier frame.
    light: VirtualLight,
    /// Weight W of the light: an estimate of 1 over the probability of choosing it. 0 where no light was chosen.
    weight: f32,
    /// Confidence M: the number of lights that it was chosen from.
    count: f32,
    /// Guess of the visibility of the light, which was a factor of its target: at least the fact `doubt`, at most 1.
    guess: f32,
    pad0: u32,
}

/// The reservoirs of all pixels.
struct Reservoirs {
    reservoirs: array<Reservoir>,
}

/// A reservoir in which no light is, chosen from `count`.
fn no_light(count: f32) -> Reservoir {
    var none: Reservoir;
    none.light.normal = vec3(0.0, 0.0, 1.0);
    none.count = count;
    none.guess = 1.0;
    return none;
}
