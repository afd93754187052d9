//! Growth of a measure over an axis: the exponent p of a power law, measure ∝ axisᵖ.

/// The fewest values of an axis through which a line is fitted.
pub(crate) const FEWEST_VALUES: usize = 3;

/// Exponents with which a measure grows over an axis.
///
/// A fixed cost c makes c + a xᵖ of a power law. Its local exponent, p a xᵖ / (c + a xᵖ), rises from 0 to p along
/// the axis, so a fit over all values says less of p than one over the upper values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Exponents {
    /// Over the upper half of the axis.
    pub(crate) upper: f64,
    /// Over the whole axis.
    pub(crate) whole: f64,
}

impl Exponents {
    /// Fits exponents to pairs of a place on the axis and a measure; pairs at one place are averaged. `None` for
    /// fewer than three places, and if a place or a measure is not above 0.
    pub(crate) fn of(mut points: Vec<(f64, f64)>) -> Option<Exponents> {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let logarithms: Vec<(f64, f64)> = points
            .chunk_by(|a, b| a.0 == b.0)
            .map(|alike| {
                let mean = alike.iter().map(|(_, value)| value).sum::<f64>() / alike.len() as f64;
                (alike[0].0.ln(), mean.ln())
            })
            .collect();
        let usable = logarithms.iter().all(|(x, y)| x.is_finite() && y.is_finite());
        let most_below = logarithms.len().checked_sub(FEWEST_VALUES).filter(|_| usable)?;
        let middle = 0.5 * (logarithms[0].0 + logarithms[logarithms.len() - 1].0);
        let below = logarithms.iter().filter(|(x, _)| *x < middle).count().min(most_below);
        Some(Exponents { upper: slope(&logarithms[below..]), whole: slope(&logarithms) })
    }
}

/// Returns the slope of the straight line with the least squares of distances in y.
fn slope(points: &[(f64, f64)]) -> f64 {
    let x = points.iter().map(|point| point.0).sum::<f64>() / points.len() as f64;
    let along: f64 = points.iter().map(|point| (point.0 - x).powi(2)).sum();
    // From the first y, which changes no slope and makes that of equal values exactly 0.
    let across: f64 = points.iter().map(|point| (point.0 - x) * (point.1 - points[0].1)).sum();
    across / along
}

#[cfg(test)]
mod tests {
    use super::Exponents;

    /// Exponents over 2⁶ to 2¹³ of `measure`.
    fn over_lights(mut measure: impl FnMut(f64) -> f64) -> Exponents {
        let lights = (6..=13).map(|power| f64::from(1 << power));
        Exponents::of(lights.map(|lights| (lights, measure(lights))).collect()).unwrap()
    }

    #[track_caller]
    fn close(found: f64, expected: f64, within: f64) {
        assert!((found - expected).abs() < within, "{found} instead of {expected}");
    }

    #[test]
    fn a_power_law_has_one_exponent() {
        for p in [-0.5, 0.0, 0.1, 1.0, 2.0] {
            let found = over_lights(|lights| 3.0 * lights.powf(p));
            close(found.upper, p, 1e-12);
            close(found.whole, p, 1e-12);
        }
    }

    #[test]
    fn a_fixed_cost_flattens_the_lower_half() {
        // The cost of 512 lights comes on top: exponents 1/9 at 64 and 16/17 at 8192. The mean of the upper half,
        // 2/3, 4/5, 8/9 and 16/17, is 0.82.
        let found = over_lights(|lights| 512.0 + lights);
        close(found.upper, 0.82, 0.02);
        assert!(found.whole < 0.6, "{found:?}");
        // The upper half shows little of a fixed cost below the least measure.
        close(over_lights(|lights| 32.0 + lights).upper, 1.0, 0.02);
        // Faster growth is found in spite of it.
        assert!(over_lights(|lights| 512.0 + lights.powf(1.5)).upper > 1.3);
    }

    #[test]
    fn noise_spreads_exponents_about_the_true_one() {
        let mut state = 1_u64;
        // Uniform noise of ±10 %, a deviation of 5.8 %.
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            1.0 + 0.2 * ((state >> 33) as f64 / (1_u64 << 31) as f64 - 0.5)
        };
        let found: Vec<Exponents> =
            (0..1000).map(|_| over_lights(|lights| lights.sqrt() * noise())).collect();
        let mean = |of: fn(&Exponents) -> f64| found.iter().map(of).sum::<f64>() / 1000.0;
        // Deviations of 0.058 / (ln 2 √5) = 0.037 and 0.058 / (ln 2 √42) = 0.013, a thirtieth of it for the means.
        close(mean(|exponents| exponents.upper), 0.5, 0.005);
        close(mean(|exponents| exponents.whole), 0.5, 0.002);
        let spread = (found.iter().map(|found| (found.upper - 0.5).powi(2)).sum::<f64>() / 1000.0).sqrt();
        close(spread, 0.037, 0.003);
    }

    #[test]
    fn three_places_are_needed() {
        assert_eq!(Exponents::of(vec![(1.0, 1.0), (2.0, 2.0), (2.0, 3.0)]), None, "two places");
        assert_eq!(Exponents::of(vec![(1.0, 1.0), (2.0, 2.0), (4.0, 0.0)]), None, "nothing grows from 0");
        assert_eq!(Exponents::of(vec![(0.0, 1.0), (2.0, 2.0), (4.0, 4.0)]), None);
        // Two at one place are averaged; the order does not matter, and three places have no lower half.
        let found = Exponents::of(vec![(4.0, 16.0), (1.0, 0.5), (2.0, 4.0), (1.0, 1.5)]).unwrap();
        close(found.upper, 2.0, 1e-12);
        assert_eq!(found.upper, found.whole);
    }
}
