//! `sum-importance` and `sample-inverse-transform` in double precision, which needs no scaling by powers of two.

use gpu_algorithms::reference::segmented_scan;

/// The sums of TCAS §4.2: along rows, along the last column, over maps.
#[derive(Clone, Debug)]
pub(crate) struct Cdf {
    /// Width and height of a map.
    pub(crate) size: (u32, u32),
    /// `[layers][height][width]`
    pub(crate) rows: Vec<f64>,
    /// `[layers][height]`
    pub(crate) columns: Vec<f64>,
    /// `[layers]`
    pub(crate) layers: Vec<f64>,
}

/// A texel with the probability of sampling it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Texel {
    /// Layer of the importance map.
    pub(crate) layer: u32,
    /// Row.
    pub(crate) row: u32,
    /// Column.
    pub(crate) column: u32,
    /// Product of the three stages.
    pub(crate) probability: f64,
}

/// One stage of the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Choice {
    /// Index of the entry.
    pub(crate) index: u32,
    /// Width of its interval over the total.
    pub(crate) probability: f64,
    /// Position of the number in the interval, in [0, 1).
    pub(crate) rest: f64,
}

/// Returns the value that counts as a weight: NaN and negative values become 0, infinity the greatest number.
pub(crate) fn weight_of(x: f32) -> f64 {
    if x > 0.0 { f64::from(x.min(f32::MAX)) } else { 0.0 }
}

impl Cdf {
    /// Creates it from an importance map `[layers][height][width]`.
    pub(crate) fn new(importance: &[f32], size: (u32, u32)) -> Cdf {
        let weights: Vec<f64> = importance.iter().map(|&f| weight_of(f)).collect();
        let (rows, totals) = segmented_scan(&weights, size.0 as usize);
        let (columns, totals) = segmented_scan(&totals, size.1 as usize);
        let (layers, _) = segmented_scan(&totals, totals.len());
        Cdf { size, rows, columns, layers }
    }

    /// Returns the texel that these numbers select with 2 or 3 `dimensions`; `None` if the importance is 0
    /// everywhere.
    pub(crate) fn draw(&self, numbers: [f64; 3], dimensions: u32) -> Option<Texel> {
        if self.layers.last().is_none_or(|total| *total == 0.0) {
            return None;
        }
        let (width, height) = (self.size.0 as usize, self.size.1 as usize);
        let layer = choose(&self.layers, numbers[0]);
        let (for_row, for_column) =
            if dimensions == 2 { (layer.rest, numbers[1]) } else { (numbers[1], numbers[2]) };
        let first = layer.index as usize * height;
        let row = choose(&self.columns[first..first + height], for_row);
        let first = (first + row.index as usize) * width;
        let column = choose(&self.rows[first..first + width], for_column);
        Some(Texel {
            layer: layer.index,
            row: row.index,
            column: column.index,
            probability: layer.probability * row.probability * column.probability,
        })
    }
}

/// Returns the first entry whose sum exceeds number · total; total must not be 0.
pub(crate) fn choose(sums: &[f64], number: f64) -> Choice {
    let total = sums[sums.len() - 1];
    let sought = (number * total).min(total.next_down());
    let index = sums.partition_point(|sum| *sum <= sought);
    let before = if index > 0 { sums[index - 1] } else { 0.0 };
    let width = sums[index] - before;
    Choice {
        index: index as u32,
        probability: (width / total).max(1.0 / 16_777_216.0),
        rest: ((sought - before) / width).clamp(0.0, 1.0_f64.next_down()),
    }
}
