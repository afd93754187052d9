//! Alg. 1 of SMC-IR, lines 9 to 16, by sorting.

/// A light of the frame before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Light {
    /// Radiosity over density.
    pub(crate) intensity: f32,
    /// Whether it reaches what is in view.
    pub(crate) is_valid: bool,
}

/// Returns which candidate comes to each slot; `None` where the slot stays as it is. `lights` and `candidates` have `None`
/// where there is no light, and no candidate. `moved` is M_max.
pub(crate) fn newcomers(
    lights: &[Option<Light>],
    candidates: &[Option<f32>],
    moved: usize,
    quantile: f64,
) -> Vec<Option<usize>> {
    let mut present: Vec<usize> = (0..lights.len()).filter(|slot| lights[*slot].is_some()).collect();
    let light = |slot: &usize| lights[*slot].expect("it is present");
    let mut found: Vec<usize> = (0..candidates.len()).filter(|index| candidates[*index].is_some()).collect();
    let candidate = |index: &usize| candidates[*index].expect("it is present");

    let mut intensities: Vec<f32> = present.iter().map(|slot| light(slot).intensity).collect();
    intensities.sort_by(f32::total_cmp);
    // A candidate is strong where at least that share of the lights is weaker.
    let most = (quantile * present.len() as f64).ceil() as usize;
    let strong = match intensities.get(most.max(1) - 1) {
        Some(threshold) => found.iter().filter(|index| candidate(index) > *threshold).count(),
        None => 0,
    };
    let invalid = present.iter().filter(|slot| !light(slot).is_valid).count();
    let empty = lights.len() - present.len();
    let removed = invalid.max(strong.min(moved)).min(moved).min(found.len().saturating_sub(empty));

    // Both sorts keep the order of what is equal.
    present.sort_by(|a, b| {
        let (a, b) = (light(a), light(b));
        a.is_valid.cmp(&b.is_valid).then(a.intensity.total_cmp(&b.intensity))
    });
    found.sort_by(|a, b| candidate(b).total_cmp(&candidate(a)));
    let gone = &present[..removed.min(present.len())];
    let mut chosen = found[..found.len().min(empty + gone.len())].to_vec();
    chosen.sort_unstable();
    let mut chosen = chosen.into_iter();
    let slot =
        |slot: usize| if lights[slot].is_none() || gone.contains(&slot) { chosen.next() } else { None };
    (0..lights.len()).map(slot).collect()
}
