//! Checks whether the measurements of a study agree with the claims of its paper.

use crate::description::{Claim, Pick, Pins, Relation, TRIANGLES, place_of};
use crate::growth::Exponents;
use crate::interval::Interval;
use crate::record::{Cell, Outcome, Results};
use crate::report::is_time;
use serde::Serialize;
use std::collections::BTreeMap;

/// The verdict of the measurements on a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// It holds, beyond the 95 % interval over the seeds.
    Holds,
    /// It does not hold, beyond that interval.
    Fails,
    /// The interval has both.
    Undecided,
}

/// The result of a claim for one scene, or for all whose triangles it is over.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding<'a> {
    /// The claim.
    pub claim: &'a Claim,
    /// The scenes, in the order of the study.
    pub scenes: Vec<&'a str>,
    /// The adapter whose cells it is about; `None` where it is about all.
    pub adapter: Option<&'a str>,
    /// Means over the seeds, with their intervals: of the measure over the cells of each pick, in the order of
    /// [`Relation::picks`]; for a growth, of the exponent in the upper half of the axis, and of that over
    /// the whole axis. `None` if no cell has the measure.
    pub means: Vec<Option<Interval>>,
    /// The verdict; `None` without measurements.
    pub verdict: Option<Verdict>,
}

impl Finding<'_> {
    /// Returns the ratio of the two means; `None` for other relations, and if the denominator is not above 0.
    pub fn ratio(&self) -> Option<f64> {
        match (&self.claim.relation, self.means.as_slice()) {
            (Relation::Ratio { .. }, [Some(of), Some(to)]) if to.mean > 0.0 => Some(of.mean / to.mean),
            _ => None,
        }
    }

    /// Returns why the claim does not hold or is not decided, as the study states it; `None` where it holds, and where the
    /// study states no reason.
    pub fn reason(&self) -> Option<&str> {
        let open = matches!(self.verdict, Some(Verdict::Fails | Verdict::Undecided));
        Some(self.claim.because.as_str()).filter(|reason| open && !reason.is_empty())
    }
}

impl Results {
    /// Returns the result of each claim for each scene that it is about, in the order of the study; where it is
    /// over the triangles of scenes, for all of them at once. Means are over all finished cells that have the
    /// measure, first those of each seed, then over the seeds. Where several adapters ran the cells, a claim about times has
    /// a result for each.
    pub fn findings(&self) -> Vec<Finding<'_>> {
        let mut findings = Vec::new();
        let adapters = self.adapters();
        for claim in &self.study.claims {
            let scenes = self.study.scenes.iter().map(|scene| scene.name.as_str());
            let about: Vec<&str> = scenes
                .filter(|name| claim.scenes.is_empty() || claim.scenes.iter().any(|s| s.value == *name))
                .collect();
            let about: Vec<Vec<&str>> = match &claim.relation {
                Relation::Growth { over, .. } if over.value == TRIANGLES => {
                    if about.is_empty() {
                        Vec::new()
                    } else {
                        vec![about]
                    }
                }
                _ => about.into_iter().map(|scene| vec![scene]).collect(),
            };
            let is_of_one = is_time(&claim.measure.value) || self.study.budget_of_time;
            let adapters = if adapters.len() > 1 && is_of_one {
                adapters.iter().copied().map(Some).collect()
            } else {
                vec![None]
            };
            for scenes in about {
                for adapter in &adapters {
                    findings.push(self.finding(claim, scenes.clone(), *adapter));
                }
            }
        }
        findings
    }

    fn finding<'a>(
        &'a self,
        claim: &'a Claim,
        scenes: Vec<&'a str>,
        adapter: Option<&'a str>,
    ) -> Finding<'a> {
        let about = (scenes.as_slice(), adapter);
        let seeds = match &claim.relation {
            Relation::Growth { of, over, .. } => self.exponents(claim, of, &over.value, about),
            relation => relation.picks().into_iter().map(|pick| self.seeds(claim, pick, about)).collect(),
        };
        let mean = |seeds: &Seeds| Interval::of(&seeds.values().copied().collect::<Vec<f64>>());
        // An exponent is no error.
        let is_growth = matches!(claim.relation, Relation::Growth { .. });
        let noise = scenes.iter().filter_map(|scene| self.study.noise(scene, &claim.measure.value));
        let floor = noise.reduce(f64::max).filter(|_| !is_growth);
        Finding {
            claim,
            scenes,
            adapter,
            means: seeds.iter().map(mean).collect(),
            verdict: verdict(&claim.relation, &seeds, floor),
        }
    }

    /// Returns the finished cells of a pick that have the measure, with its value.
    fn values<'a>(
        &'a self,
        claim: &'a Claim,
        pick: &'a Pick,
        (scenes, adapter): (&'a [&str], Option<&'a str>),
    ) -> impl Iterator<Item = (&'a Cell, f64)> {
        let cells = self.cells.iter().filter(move |cell| {
            cell.outcome == Outcome::Done
                && scenes.contains(&cell.scene.as_str())
                && adapter.is_none_or(|adapter| cell.node.adapter == adapter)
                && cell.pipeline == pick.pipeline.value
                && lies_at(cell, &claim.at)
                && lies_at(cell, &pick.at)
        });
        cells.filter_map(|cell| Some((cell, cell.measure(&claim.measure.value)?)))
    }

    fn seeds(&self, claim: &Claim, pick: &Pick, about: (&[&str], Option<&str>)) -> Seeds {
        let mut values: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
        for (cell, value) in self.values(claim, pick, about) {
            values.entry(cell.seed).or_default().push(value);
        }
        values
            .into_iter()
            .map(|(seed, values)| (seed, values.iter().sum::<f64>() / values.len() as f64))
            .collect()
    }

    /// Returns the exponents of a growth: in the upper half of the axis, and over all of it.
    fn exponents(&self, claim: &Claim, of: &Pick, over: &str, about: (&[&str], Option<&str>)) -> Vec<Seeds> {
        let mut points: BTreeMap<u32, Vec<(f64, f64)>> = BTreeMap::new();
        for (cell, value) in self.values(claim, of, about) {
            if let Some(place) = self.place(cell, over) {
                points.entry(cell.seed).or_default().push((place, value));
            }
        }
        let found: Vec<(u32, Exponents)> =
            points.into_iter().filter_map(|(seed, points)| Some((seed, Exponents::of(points)?))).collect();
        let seeds = |exponent: fn(&Exponents) -> f64| {
            found.iter().map(|(seed, exponents)| (*seed, exponent(exponents))).collect()
        };
        vec![seeds(|exponents| exponents.upper), seeds(|exponents| exponents.whole)]
    }

    /// Returns where a cell lies on an axis of numbers.
    fn place(&self, cell: &Cell, over: &str) -> Option<f64> {
        if over == TRIANGLES {
            let scene = self.study.scenes.iter().find(|scene| scene.name == cell.scene)?;
            return Some(scene.triangles as f64);
        }
        place_of(cell.axes.get(over)?)
    }
}

/// The mean of a measure over the cells of each seed, or its exponent.
pub(crate) type Seeds = BTreeMap<u32, f64>;

/// Returns whether one mean is less than another, seed by seed and beyond the 95 % interval: the test of an order. Errors that
/// are both below `floor`, that of the reference itself, are alike.
pub(crate) fn is_less(less: &Seeds, more: &Seeds, floor: Option<f64>) -> bool {
    margin_above(less, more, floor, |less, more| more - less)
        .is_some_and(|margin| above_zero(&margin, true) == Verdict::Holds)
}

/// Returns the mean over seeds; `None` without any.
pub(crate) fn mean(seeds: &Seeds) -> Option<f64> {
    (!seeds.is_empty()).then(|| seeds.values().sum::<f64>() / seeds.len() as f64)
}

/// Decides a claim by what it says must be above 0: the difference of two means, seed by seed, since the same seed gives
/// pipelines the same random numbers. Errors that are both below `floor`, that of the reference itself, decide nothing.
fn verdict(relation: &Relation, seeds: &[Seeds], floor: Option<f64>) -> Option<Verdict> {
    let margin = |a: &Seeds, b: &Seeds, f: &dyn Fn(f64, f64) -> f64| margin_above(a, b, floor, f);
    let margins: Option<Vec<Interval>> = match (relation, seeds) {
        (Relation::Order(_), seeds) => {
            seeds.windows(2).map(|pair| margin(&pair[0], &pair[1], &|less, more| more - less)).collect()
        }
        (Relation::Ratio { at_least, at_most, .. }, [of, to]) => {
            margin(of, to, &|_, to| to).filter(|to| to.mean > 0.0)?;
            let least = at_least.map(|least| margin(of, to, &|of, to| of - least * to));
            let most = at_most.map(|most| margin(of, to, &|of, to| most * to - of));
            least.into_iter().chain(most).collect()
        }
        // Of a growth, the exponent in the upper half of its axis.
        (
            Relation::Bound { at_least, at_most, .. } | Relation::Growth { at_least, at_most, .. },
            [found, ..],
        ) => {
            let least = at_least.map(|least| margin(found, found, &|found, _| found - least));
            let most = at_most.map(|most| margin(found, found, &|found, _| most - found));
            least.into_iter().chain(most).collect()
        }
        _ => None,
    };
    // An order is strict, a bound is not.
    let strict = matches!(relation, Relation::Order(_));
    let verdicts: Vec<Verdict> = margins?.iter().map(|margin| above_zero(margin, strict)).collect();
    Some(if verdicts.contains(&Verdict::Fails) {
        Verdict::Fails
    } else if verdicts.contains(&Verdict::Undecided) {
        Verdict::Undecided
    } else {
        Verdict::Holds
    })
}

/// The same as [`margin`], of which nothing is known where both means are below `floor`.
fn margin_above(a: &Seeds, b: &Seeds, floor: Option<f64>, f: impl Fn(f64, f64) -> f64) -> Option<Interval> {
    let found = margin(a, b, f)?;
    let is_below = |seeds: &Seeds| mean(seeds).zip(floor).is_some_and(|(mean, floor)| mean < floor);
    let alike = Interval { half: Some(f64::INFINITY), ..found };
    Some(if is_below(a) && is_below(b) { alike } else { found })
}

/// The mean of `f` over the seeds that both have, with its interval; without one, if they have none in common.
fn margin(a: &Seeds, b: &Seeds, f: impl Fn(f64, f64) -> f64) -> Option<Interval> {
    let common: Vec<f64> = a.iter().filter_map(|(seed, a)| Some(f(*a, *b.get(seed)?))).collect();
    match Interval::of(&common) {
        Some(interval) => Some(interval),
        None => Interval::of(&[f(mean(a)?, mean(b)?)]),
    }
}

fn above_zero(margin: &Interval, strict: bool) -> Verdict {
    let half = margin.half.unwrap_or(0.0);
    // One seed, or seeds that agree, have no interval.
    let holds = if strict || half > 0.0 { margin.mean > half } else { margin.mean >= 0.0 };
    let fails = if half > 0.0 { margin.mean < -half } else { !holds };
    match (holds, fails) {
        (true, _) => Verdict::Holds,
        (false, true) => Verdict::Fails,
        (false, false) => Verdict::Undecided,
    }
}

/// Returns whether a cell has these values; an axis that its pipeline does not have matches any value.
fn lies_at(cell: &Cell, at: &Pins) -> bool {
    at.iter().all(|(axis, value)| cell.axes.get(&axis.value).is_none_or(|own| *own == value.value))
}

#[cfg(test)]
mod tests {
    use super::{Seeds, Verdict, verdict};
    use crate::description::{Pick, Relation};

    fn pick() -> Pick {
        Pick { pipeline: String::new().into(), at: Vec::new() }
    }

    fn order(less: &[f64], more: &[f64]) -> Option<Verdict> {
        let seeds = |values: &[f64]| -> Seeds { (1..).zip(values.iter().copied()).collect() };
        verdict(&Relation::Order(vec![pick(), pick()]), &[seeds(less), seeds(more)], None)
    }

    #[test]
    fn seeds_decide_an_order_or_do_not() {
        // Four differences of 1 ± 0.1: half a width of 0.13.
        assert_eq!(order(&[1.0, 5.0, 3.0, 2.0], &[2.0, 6.1, 3.9, 3.0]), Some(Verdict::Holds), "seed by seed");
        assert_eq!(order(&[2.0, 6.1, 3.9, 3.0], &[1.0, 5.0, 3.0, 2.0]), Some(Verdict::Fails));
        assert_eq!(order(&[1.0, 5.0, 3.0], &[3.0, 4.0, 3.5]), Some(Verdict::Undecided), "0.5 ± 3.7");
        // One seed, or seeds that agree, are taken at their word.
        assert_eq!(order(&[1.0], &[2.0]), Some(Verdict::Holds));
        assert_eq!(order(&[1.0], &[1.0]), Some(Verdict::Fails), "an order is strict");
        assert_eq!(order(&[1.0], &[]), None);
    }

    #[test]
    fn a_bound_is_of_the_numerator() {
        let ratio = |of: &[f64], most: f64| {
            let seeds = |values: &[f64]| -> Seeds { (1..).zip(values.iter().copied()).collect() };
            let relation = Relation::Ratio { of: pick(), to: pick(), at_least: None, at_most: Some(most) };
            verdict(&relation, &[seeds(of), seeds(&[4.0, 4.5, 3.5])], None)
        };
        assert_eq!(ratio(&[2.0, 2.25, 1.75], 0.5), Some(Verdict::Holds), "half of each");
        assert_eq!(ratio(&[2.0, 2.3, 1.7], 0.6), Some(Verdict::Holds));
        assert_eq!(ratio(&[2.0, 2.3, 1.7], 0.5), Some(Verdict::Undecided));
        assert_eq!(ratio(&[2.0, 2.3, 1.7], 0.4), Some(Verdict::Fails));
    }

    #[test]
    fn a_mean_is_within_its_bounds_beyond_the_interval() {
        let bound = |values: &[f64], least: f64, most: f64| {
            let seeds: Seeds = (1..).zip(values.iter().copied()).collect();
            let relation = Relation::Bound { of: pick(), at_least: Some(least), at_most: Some(most) };
            verdict(&relation, &[seeds], None)
        };
        // 4 ± 0.25.
        let values = [3.9, 4.0, 4.1];
        assert_eq!(bound(&values, 3.0, 5.0), Some(Verdict::Holds));
        assert_eq!(bound(&values, 3.0, 4.1), Some(Verdict::Undecided));
        assert_eq!(bound(&values, 4.5, 5.0), Some(Verdict::Fails));
        assert_eq!(bound(&[4.0], 4.0, 4.0), Some(Verdict::Holds), "a bound is not strict");
        assert_eq!(bound(&[], 3.0, 5.0), None);
    }

    #[test]
    fn errors_below_that_of_the_reference_decide_nothing() {
        let order = |less: f64, more: f64| {
            let seeds = |value: f64| Seeds::from([(1, value), (2, 1.01 * value)]);
            let relation = Relation::Order(vec![pick(), pick()]);
            verdict(&relation, &[seeds(less), seeds(more)], Some(0.03))
        };
        assert_eq!(order(0.01, 0.02), Some(Verdict::Undecided));
        assert_eq!(order(0.02, 0.01), Some(Verdict::Undecided));
        assert_eq!(order(0.01, 0.4), Some(Verdict::Holds), "one is above");
    }
}
