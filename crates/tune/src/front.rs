//! The points that no other one beats in both.

/// Returns the indices of points of which no other one has less of one and no more of the other, from the least time on.
///
/// A point is (time, error); one that is not finite is left out. Of equal ones the first is kept.
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> =
        (0..points.len()).filter(|i| points[*i].0.is_finite() && points[*i].1.is_finite()).collect();
    order.sort_by(|a, b| {
        let (a, b) = (points[*a], points[*b]);
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    let mut least = f64::INFINITY;
    order.retain(|i| {
        let is_less = points[*i].1 < least;
        least = least.min(points[*i].1);
        is_less
    });
    order
}
