//! The CPU reference in `f64`, for one map: the names of the WGSL, with levels as whole images.

/// An image of distances \[m\], infinite in holes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Level {
    /// Texels a side.
    pub(crate) side: usize,
    /// Row by row.
    pub(crate) depth: Vec<f64>,
}

impl Level {
    /// Returns the value at a texel; a hole outside the image.
    pub(crate) fn at(&self, x: isize, y: isize) -> f64 {
        let inside = |v: isize| usize::try_from(v).ok().filter(|v| *v < self.side);
        match (inside(x), inside(y)) {
            (Some(x), Some(y)) => self.depth[y * self.side + x],
            _ => f64::INFINITY,
        }
    }

    fn new(side: usize, value: impl Fn(isize, isize) -> f64) -> Level {
        let depth = (0..side * side).map(|i| value((i % side) as isize, (i / side) as isize)).collect();
        Level { side, depth }
    }
}

/// Least and greatest of the values that are not holes; `None` if all are.
fn span(values: &[f64]) -> Option<(f64, f64)> {
    let valid = values.iter().filter(|value| value.is_finite());
    valid.fold(None, |span: Option<(f64, f64)>, value| {
        let (least, greatest) = span.unwrap_or((*value, *value));
        Some((least.min(*value), greatest.max(*value)))
    })
}

/// Returns the mean of those of four that are not holes, if they are within `threshold` of each other;
/// otherwise a hole.
pub(crate) fn pulled(values: [f64; 4], threshold: f64) -> f64 {
    match span(&values) {
        Some((nearest, farthest)) if farthest - nearest <= threshold => {
            let valid: Vec<f64> = values.into_iter().filter(|value| value.is_finite()).collect();
            valid.iter().sum::<f64>() / valid.len() as f64
        }
        _ => f64::INFINITY,
    }
}

/// Returns the median of those of four that are not holes: of an even number the mean of the middle two, if they are
/// within `threshold` of each other; otherwise a hole.
pub(crate) fn pulled_median(values: [f64; 4], threshold: f64) -> f64 {
    let mut valid: Vec<f64> = values.into_iter().filter(|value| value.is_finite()).collect();
    valid.sort_by(f64::total_cmp);
    if valid.is_empty() {
        return f64::INFINITY;
    }
    let (low, high) = (valid[(valid.len() - 1) / 2], valid[valid.len() / 2]);
    if high - low <= threshold { 0.5 * (low + high) } else { f64::INFINITY }
}

/// Returns the value of a texel, given the pushed level above it.
pub(crate) fn pushed(own: f64, x: isize, y: isize, coarse: &Level, threshold: f64) -> f64 {
    let side = (x % 2 * 2 - 1, y % 2 * 2 - 1);
    let values =
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| coarse.at(x / 2 + i * side.0, y / 2 + j * side.1));
    let reference = match (values[0], span(&values[1..])) {
        (parent, _) if parent.is_finite() => parent,
        (_, Some((nearest, farthest))) if farthest - nearest <= 2.0 * threshold => nearest,
        _ => return own,
    };
    let close = values
        .iter()
        .zip([9.0, 3.0, 3.0, 1.0])
        .filter(|(value, _)| (*value - reference).abs() <= 2.0 * threshold);
    let (sum, weights) =
        close.fold((0.0, 0.0), |(sum, weights), (value, weight)| (sum + value * weight, weights + weight));
    let value = sum / weights;
    if (own - value).abs() > threshold { value } else { own }
}

/// Fills a map by means: thresholds in metres at level 0.
pub(crate) fn pull_push(map: &Level, levels: u32, pull_threshold: f64, push_threshold: f64) -> Level {
    pull_push_by(pulled, map, levels, pull_threshold, push_threshold)
}

/// Fills a map, where `pulled` combines four texels within a threshold of each other.
pub(crate) fn pull_push_by(
    pulled: fn([f64; 4], f64) -> f64,
    map: &Level,
    levels: u32,
    pull_threshold: f64,
    push_threshold: f64,
) -> Level {
    let mut pyramid = vec![map.clone()];
    for l in 0..levels {
        let finer = &pyramid[l as usize];
        let threshold = pull_threshold * f64::from(1 << l);
        let coarse = Level::new(finer.side.div_ceil(2), |x, y| {
            pulled([(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| finer.at(2 * x + i, 2 * y + j)), threshold)
        });
        pyramid.push(coarse);
    }
    for l in (0..levels as usize).rev() {
        let threshold = push_threshold * f64::from(1 << l);
        let (finer, coarse) = (&pyramid[l], &pyramid[l + 1]);
        pyramid[l] = Level::new(finer.side, |x, y| pushed(finer.at(x, y), x, y, coarse, threshold));
    }
    pyramid.swap_remove(0)
}
