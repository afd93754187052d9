//! The CPU reference: the same lookup in `f64`.

/// Returns the visible share of a light through a square map of `tile` × `tile` distances \[m\]: `position`
/// \[px\] is the position of the receiver in the map, and `nearest` \[m\] its distance minus the depth bias.
pub(crate) fn filtered(map: &[f64], tile: u32, position: [f64; 2], nearest: f64, taps: u32) -> f64 {
    let start = position.map(|x| x - 0.5 * f64::from(taps));
    let corner = start.map(f64::floor);
    let last = f64::from(tile - 1);
    // Along an axis, the share of each texel that is inside a window that is cut at its edges.
    let weight = |axis: usize, i: u32| match i {
        0 => 1.0 - (start[axis] - corner[axis]),
        i if i == taps => start[axis] - corner[axis],
        _ => 1.0,
    };
    let mut sum = 0.0;
    for y in 0..=taps {
        for x in 0..=taps {
            let [column, row] =
                [(0, x), (1, y)].map(|(axis, i)| (corner[axis] + f64::from(i)).clamp(0.0, last));
            let stored = map[row as usize * tile as usize + column as usize];
            if nearest <= stored {
                sum += weight(0, x) * weight(1, y);
            }
        }
    }
    sum / f64::from(taps * taps)
}
