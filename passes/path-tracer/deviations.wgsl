// Sums of squared deviations of samples from their own mean, one by one and of two sets together. The mean of squares less the
// square of the mean has no digits where samples differ little. [Welford 1962; Chan, Golub, LeVeque 1983]

/// Samples of a number.
struct Deviations {
    count: f32,
    mean: f32,
    /// Sum of the squares of what they are away from their mean.
    squares: f32,
}

fn with_sample(a: Deviations, x: f32) -> Deviations {
    let count = a.count + 1.0;
    let difference = x - a.mean;
    let mean = a.mean + difference / count;
    return Deviations(count, mean, a.squares + difference * (x - mean));
}

fn of_both(a: Deviations, b: Deviations) -> Deviations {
    let count = a.count + b.count;
    if count == 0.0 {
        return a;
    }
    let difference = b.mean - a.mean;
    let share = b.count / count;
    return Deviations(count, a.mean + difference * share, a.squares + b.squares + difference * difference * a.count * share);
}
