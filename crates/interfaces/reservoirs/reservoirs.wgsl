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
    /// The light's place among those of the frame in which it was chosen.
    index: u32,
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

/// Returns the pixel of a reservoir of a view of `width` pixels a row; where there is no such reservoir, a pixel below the last row.
fn pixel_of_reservoir(index: u32, per_pixel: u32, width: u32) -> vec2<u32> {
    let pixel = index / per_pixel;
    return vec2(pixel % width, pixel / width);
}

/// Returns the index of a reservoir of a pixel, of which each has `per_pixel`.
fn reservoir_of_pixel(pixel: vec2<u32>, slot: u32, per_pixel: u32, width: u32) -> u32 {
    return (pixel.y * width + pixel.x) * per_pixel + slot;
}
