//! The probabilities with which points are chosen, by definition and in double precision.

/// Returns the probability of each point in systematic sampling: its weight over a threshold, at most 1, where the threshold
/// makes them add up to `count`. All are 1 where no more than that have a weight.
pub(crate) fn systematic(weights: &[f64], count: usize) -> Vec<f64> {
    let mut sorted: Vec<f64> = weights.iter().copied().filter(|weight| *weight > 0.0).collect();
    sorted.sort_by(|a, b| b.total_cmp(a));
    if sorted.len() <= count {
        return weights.iter().map(|weight| f64::from(u8::from(*weight > 0.0))).collect();
    }
    // From the least on, so that small weights count beside great ones.
    let mut rest = 0.0;
    let mut below: Vec<f64> = sorted
        .iter()
        .rev()
        .map(|weight| {
            rest += weight;
            rest
        })
        .collect();
    below.reverse();
    // The greatest are certain, until those that are left suffice for the rest of the count.
    let certain =
        (0..count).find(|cut| sorted[*cut] * (count - cut) as f64 <= below[*cut]).unwrap_or(count - 1);
    let threshold = below[certain] / (count - certain) as f64;
    weights.iter().map(|weight| (weight / threshold).min(1.0)).collect()
}

/// Returns the probability of each of many points if they are drawn one after the other, each in proportion to the weights that
/// are left, until there are `count`: 1 - exp(-w t) with one time t for all.
pub(crate) fn successive(weights: &[f64], count: f64) -> Vec<f64> {
    let at = |time: f64| weights.iter().map(move |weight| -(-weight * time).exp_m1());
    let (mut low, mut high) = (-80.0f64, 80.0f64);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if at(middle.exp()).sum::<f64>() < count { low = middle } else { high = middle }
    }
    at(low.exp()).collect()
}
