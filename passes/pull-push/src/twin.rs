//! The algorithm in plain f64 on one map: same names as the WGSL, levels as whole images.

/// An image of distances [m], infinite in holes.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Texels a side.
    pub side: usize,
    /// Row by row.
    pub depth: Vec<f64>,
}

impl Level {
    /// The value at a texel; a hole outside the image.
    pub fn at(&self, x: isize, y: isize) -> f64 {
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

/// The mean of those of four that are within `threshold` of the nearest.
pub fn pulled(values: [f64; 4], threshold: f64) -> f64 {
    let nearest = values.into_iter().fold(f64::INFINITY, f64::min);
    if nearest == f64::INFINITY {
        return nearest;
    }
    let close: Vec<f64> = values.into_iter().filter(|value| value - nearest <= threshold).collect();
    close.iter().sum::<f64>() / close.len() as f64
}

/// The value of a texel, given the pushed level above it.
pub fn pushed(own: f64, x: isize, y: isize, coarse: &Level, threshold: f64) -> f64 {
    let parent = (x / 2, y / 2);
    let side = (x % 2 * 2 - 1, y % 2 * 2 - 1);
    let values = [(0, 0, 9.0), (1, 0, 3.0), (0, 1, 3.0), (1, 1, 1.0)]
        .map(|(i, j, weight)| (coarse.at(parent.0 + i * side.0, parent.1 + j * side.1), weight));
    let mut reference = values[0].0;
    if reference == f64::INFINITY {
        reference = values[1..].iter().fold(f64::INFINITY, |nearest, (value, _)| nearest.min(*value));
    }
    if reference == f64::INFINITY {
        return own;
    }
    let close = values.iter().filter(|(value, _)| (value - reference).abs() <= 2.0 * threshold);
    let (sum, weights) =
        close.fold((0.0, 0.0), |(sum, weights), (value, weight)| (sum + value * weight, weights + weight));
    let pushed = sum / weights;
    if (own - pushed).abs() > threshold { pushed } else { own }
}

/// A map filled: thresholds in metres at level 0.
pub fn pull_push(map: &Level, levels: u32, pull_threshold: f64, push_threshold: f64) -> Level {
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
