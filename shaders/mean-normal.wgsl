// The mean of normals that differ within a footprint, and of those among them that face a direction. [Toksvig 2005]

/// The deviation of slopes along any axis, for normals whose mean is of this length, in (0, 1], where slopes are small. [Toksvig 2005]
fn deviation_of(length: f32) -> f32 {
    return sqrt((1.0 - length) / length);
}

/// The share of a normal distribution that is below its mean and so many deviations, to 3e-4.
fn share_below(deviations: f32) -> f32 {
    let x = clamp(deviations, -8.0, 8.0);
    return 0.5 + 0.5 * tanh(0.7978846 * (x + 0.044715 * x * x * x));
}

/// The sum of the normals that face a unit direction, over the number of all; `mean` is the mean of all. Their slopes are taken as
/// normally distributed, with the variance that the length of the mean says: unit vectors that differ more have a shorter one.
fn mean_facing(mean: vec3<f32>, to: vec3<f32>) -> vec3<f32> {
    let size = clamp(length(mean), 1e-3, 1.0);
    let middle = mean / size;
    let cosine = dot(middle, to);
    let across = to - cosine * middle;
    let sine = length(across);
    let small = deviation_of(size);
    // So light from all sides has an error of at most 0.4 % up to deviations of 1; by `small` it would lack 2 % at 0.6.
    let deviation = small + 0.4 * small * small * small;
    // Normals that differ by less than rounding all face it or none do.
    if deviation * sine < 1e-3 {
        return select(vec3(0.0), mean, cosine > 0.0);
    }
    // Those face it whose slope away from it is below this many deviations.
    let most = cosine / (deviation * sine);
    let facing = share_below(most);
    let density = 0.3989423 * exp(-0.5 * most * most);
    return size * (facing * middle + deviation * density / sine * across);
}
