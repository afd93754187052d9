/// Returns the number of frames from a jump of the light until `series` has converged to its new value.
///
/// `series` has one value per frame, such as the mean luminance of the picture, and `jump` is the first frame
/// under the new light. The old value is that of the frame before; the new value is the mean of the last
/// quarter (rounded up) of the frames from `jump` on. The lag is the smallest n such that all frames from
/// `jump + n` on differ from the new value by at most `share` of |new − old|; it is 0 if the frame of the
/// jump does so already.
///
/// Returns `None` if there is no such n: `jump` has no frame before it or is past the end, a value is NaN or
/// infinite, the value did not change, or the last frame still differs by more. There must be enough frames
/// for the last quarter to have converged, and noise must be well below `share` of the change.
pub fn lag(series: &[f64], jump: usize, share: f64) -> Option<usize> {
    let old = *series.get(jump.checked_sub(1)?)?;
    let after = series.get(jump..).filter(|after| !after.is_empty())?;
    let tail = &after[after.len() - after.len().div_ceil(4)..];
    let settled = tail.iter().sum::<f64>() / tail.len() as f64;
    let way = (settled - old).abs();
    if !(way > 0.0 && way.is_finite() && after.iter().all(|value| value.is_finite())) {
        return None;
    }
    let lag = after.iter().rposition(|value| (value - settled).abs() > share * way).map_or(0, |n| n + 1);
    (lag < after.len()).then_some(lag)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        // The old value is 0; of the 12 frames after the jump, the last three give the new value 8. A tenth
        // of the change is 0.8: 7.5 is within, and what comes before it is not.
        let series = [9.0, 0.0, 4.0, 6.0, 7.0, 7.5, 7.75, 8.0, 8.0, 8.0, 8.0, 8.0, 8.0, 8.0];
        assert_eq!(lag(&series, 2, 0.1), Some(3));
        assert_eq!(lag(&series, 2, 0.5), Some(0));
        // A value that arrives and leaves again has not converged.
        let mut leaves = series;
        leaves[8] = 5.0;
        assert_eq!(lag(&leaves, 2, 0.1), Some(7));
        // The same for falling values.
        assert_eq!(lag(&series.map(|value| 10.0 - value), 2, 0.1), Some(3));
    }

    #[test]
    fn nothing_to_tell() {
        let series = [0.0, 1.0, 1.0];
        assert_eq!(lag(&series, 1, 0.1), Some(0));
        assert_eq!(lag(&series, 0, 0.1), None, "no frame before");
        assert_eq!(lag(&series, 3, 0.1), None, "past the end");
        assert_eq!(lag(&series, 9, 0.1), None, "far past the end");
        assert_eq!(lag(&[1.0; 5], 2, 0.1), None, "no change");
        assert_eq!(lag(&[0.0, f64::NAN, 1.0, 1.0, 1.0, 1.0], 1, 0.1), None, "broken");
        // The last two of eight alternate around their mean 2 by 1, which is more than a tenth of 2.
        assert_eq!(lag(&[0.0, 1.0, 3.0, 1.0, 3.0, 1.0, 3.0, 1.0, 3.0], 1, 0.1), None, "never stays");
    }
}
