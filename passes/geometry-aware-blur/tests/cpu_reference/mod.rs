//! The CPU reference of the window, in `f64`, with the names of geometry-aware-blur.wgsl.

/// Returns the weight of an offset along one side of a window of this many pixels.
pub(crate) fn window_weight(offset: i32, window: u32) -> f64 {
    if window.is_multiple_of(2) && offset.unsigned_abs() * 2 == window { 0.5 } else { 1.0 }
}

/// Returns a coordinate moved back into the image by one period; still outside if the image is narrower.
pub(crate) fn inside(at: i32, size: u32, period: u32) -> i32 {
    at + if at < 0 { period as i32 } else { 0 } - if at >= size as i32 { period as i32 } else { 0 }
}

/// Returns the pixels along one side of the window around `at`, with their weights.
pub(crate) fn window(at: u32, size: u32, window: u32) -> Vec<(u32, f64)> {
    let reach = window as i32 / 2;
    (-reach..=reach)
        .filter_map(|offset| {
            let other = inside(at as i32 + offset, size, window);
            let other = u32::try_from(other).ok().filter(|other| *other < size)?;
            Some((other, window_weight(offset, window)))
        })
        .collect()
}
