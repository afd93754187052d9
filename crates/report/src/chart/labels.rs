//! Places labels so that they do not overlap.

/// A rectangle: left, top, right, bottom [px].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rect {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Rect {
    /// Creates a rectangle around a centre.
    pub(super) fn around((x, y): (f64, f64), width: f64, height: f64) -> Rect {
        Rect {
            left: x - width / 2.0,
            top: y - height / 2.0,
            right: x + width / 2.0,
            bottom: y + height / 2.0,
        }
    }

    fn meets(&self, other: &Rect) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    fn lies_in(&self, other: &Rect) -> bool {
        self.left >= other.left
            && self.right <= other.right
            && self.top >= other.top
            && self.bottom <= other.bottom
    }
}

/// Returns which of the labels along an axis are shown: from the first one on, each that keeps a gap from the
/// one before. `labels` are centre and width [px], sorted by centre.
pub(super) fn thinned(labels: &[(f64, f64)], gap: f64) -> Vec<bool> {
    let mut free = f64::NEG_INFINITY;
    let fits = |&(centre, width): &(f64, f64)| {
        let fits = centre - width / 2.0 >= free;
        if fits {
            free = centre + width / 2.0 + gap;
        }
        fits
    };
    labels.iter().map(fits).collect()
}

/// A label to be placed beside a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    pub(super) point: (f64, f64),
    pub(super) width: f64,
    pub(super) height: f64,
}

/// Returns small areas that cover a line.
pub(super) fn along((x, y): (f64, f64), (to_x, to_y): (f64, f64)) -> Vec<Rect> {
    const STEP: f64 = 3.0;
    let steps = ((to_x - x).hypot(to_y - y) / STEP).ceil().max(1.0);
    let at = |i: u32| {
        let share = f64::from(i) / steps;
        Rect::around((x + share * (to_x - x), y + share * (to_y - y)), STEP, STEP)
    };
    if x == to_x && y == to_y { Vec::new() } else { (0..=steps as u32).map(at).collect() }
}

/// Returns the centre of each label beside its point: above right, below left, above left, below right, above, below, right
/// or left, whichever is the first that is inside `area` and free; `None` if none is. `taken` are areas that labels must not
/// cover; those of `crossed` they cover only where there is no other place.
pub(super) fn beside(
    labels: &[Wanted],
    area: Rect,
    taken: &[Rect],
    crossed: &[Rect],
) -> Vec<Option<(f64, f64)>> {
    const REACH: f64 = 8.0;
    let mut taken = taken.to_vec();
    let place = |&Wanted { point: (x, y), width, height }: &Wanted| {
        let (dx, dy) = (REACH + width / 2.0, REACH + height / 2.0);
        let candidates = [
            (x + dx - 2.0, y - dy + 4.0),
            (x - dx + 2.0, y + dy - 4.0),
            (x - dx + 2.0, y - dy + 4.0),
            (x + dx - 2.0, y + dy - 4.0),
            (x, y - dy),
            (x, y + dy),
            (x + dx, y),
            (x - dx, y),
        ];
        let place = |&centre: &(f64, f64)| Rect::around(centre, width, height);
        let is_free = |centre: &(f64, f64)| {
            let place = place(centre);
            place.lies_in(&area) && !taken.iter().any(|other| other.meets(&place))
        };
        let is_clear = |centre: &(f64, f64)| !crossed.iter().any(|other| other.meets(&place(centre)));
        let free = candidates.into_iter().filter(is_free);
        let free = free.clone().find(is_clear).or_else(|| free.clone().next());
        taken.extend(free.map(|centre| Rect::around(centre, width, height)));
        free
    };
    labels.iter().map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_label_that_would_touch_the_one_before_is_left_out() {
        assert_eq!(thinned(&[(0.0, 10.0), (8.0, 10.0), (16.0, 10.0)], 2.0), [true, false, true]);
        assert_eq!(thinned(&[(0.0, 10.0), (12.0, 10.0)], 2.0), [true, true]);
    }

    #[test]
    fn labels_of_near_points_take_turns_and_then_give_up() {
        let area = Rect { left: 0.0, top: 0.0, right: 100.0, bottom: 100.0 };
        let label = Wanted { point: (50.0, 50.0), width: 20.0, height: 10.0 };
        let placed = beside(&[label; 12], area, &[], &[]);
        let boxes: Vec<Rect> =
            placed.iter().flatten().map(|&centre| Rect::around(centre, 20.0, 10.0)).collect();
        // At the four corners; the other places would touch one of them.
        assert_eq!(boxes.len(), 4, "{placed:?}");
        for (index, place) in boxes.iter().enumerate() {
            assert!(place.lies_in(&area));
            assert!(boxes[..index].iter().all(|other| !other.meets(place)), "{boxes:?}");
        }
    }

    #[test]
    fn a_label_leaves_lines_free_where_it_can() {
        let area = Rect { left: 0.0, top: 0.0, right: 100.0, bottom: 100.0 };
        let label = Wanted { point: (50.0, 50.0), width: 20.0, height: 10.0 };
        let up = along((50.0, 50.0), (90.0, 30.0));
        let [beside_it] = beside(&[label], area, &[], &up)[..] else { panic!("one label") };
        assert!(beside_it.is_some_and(|(x, _)| x < 50.0), "{beside_it:?}");
        let all = [Rect { left: 0.0, top: 0.0, right: 100.0, bottom: 100.0 }];
        let [across] = beside(&[label], area, &[], &all)[..] else { panic!("one label") };
        assert!(across.is_some(), "there is no other place");
        assert_eq!(beside(&[label], area, &all, &[]), [None]);
    }

    #[test]
    fn a_label_stays_in_the_area() {
        let area = Rect { left: 0.0, top: 0.0, right: 100.0, bottom: 100.0 };
        let label = Wanted { point: (99.0, 1.0), width: 20.0, height: 10.0 };
        let [corner] = beside(&[label], area, &[], &[])[..] else { panic!("one label") };
        let (x, y) = corner.expect("room to the left");
        assert!(x < 99.0 && y > 1.0, "{x} {y}");
    }
}
