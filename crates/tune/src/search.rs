//! Best-first search and successive halving.

use metrics::statistics::{Summary, median};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// How much worse a point is for each time that it takes twice as long as it may, or errs twice as much: more than the factor by
/// which the other one could fall, so that the search comes back.
const BEYOND: f64 = 4.0;

/// An axis of the grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// The number of its values, at least 1.
    pub values: usize,
    /// The value from which the search begins.
    pub start: usize,
    /// Whether values lie in an order: then a step leads to a neighbour, otherwise to any other.
    pub ordered: bool,
}

/// A point of the grid: the index of a value on each axis.
pub type Point = Vec<usize>;

/// The result of one seed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Relative squared error.
    pub error: f64,
    /// Time of a frame \[ms\].
    pub ms: f64,
}

/// What is looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// The least error in this time of a frame \[ms\].
    Ms(f64),
    /// The least time for this error.
    Error(f64),
}

/// How much is tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The most points that are tried.
    pub points: usize,
    /// The points that are tried with more seeds; half of them in each round.
    pub kept: usize,
    /// Seeds by which the last ones are judged.
    pub judges: u32,
}

/// Measures points.
pub trait Evaluate {
    /// The error that ends the search.
    type Error;

    /// Returns the result of a point with a seed; `None` where the point is none that can be.
    ///
    /// # Errors
    /// What ends the search.
    fn evaluate(&mut self, point: &Point, seed: u32) -> Result<Option<Measured>, Self::Error>;
}

/// A point that was tried.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Candidate {
    /// The point.
    pub point: Point,
    /// The results of the seeds by which it was chosen.
    pub chosen_by: Vec<Measured>,
    /// The results of other seeds; empty where it was not judged.
    pub judged_by: Vec<Measured>,
    /// Whether the points beside it were tried.
    #[serde(skip)]
    is_done: bool,
}

/// The result of a search.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// All points that can be, the best first.
    pub tried: Vec<Candidate>,
    /// The index of the winner: of those that were judged and meet the target, the best; `None` where none does.
    pub winner: Option<usize>,
    /// How often a point was measured with a seed.
    pub runs: usize,
}

impl Candidate {
    /// The error of the first seed.
    fn bits(&self) -> u64 {
        self.chosen_by[0].error.to_bits()
    }

    fn samples(&self) -> &[Measured] {
        if self.judged_by.is_empty() { &self.chosen_by } else { &self.judged_by }
    }

    /// Returns the number of seeds that count: those that judged it, or else those that it was chosen by.
    pub fn seeds(&self) -> usize {
        self.samples().len()
    }

    /// Returns the mean error over the seeds that count, with half of its 95 % interval.
    pub fn error(&self) -> (f64, Option<f64>) {
        let errors: Vec<f64> = self.samples().iter().map(|sample| sample.error).collect();
        let mean = errors.iter().sum::<f64>() / errors.len().max(1) as f64;
        (mean, Summary::of(&errors).map(|summary| summary.half_width_95))
    }

    /// Returns the median time over the seeds that count \[ms\].
    pub fn ms(&self) -> f64 {
        let mut times: Vec<f64> = self.samples().iter().map(|sample| sample.ms).collect();
        median(&mut times).unwrap_or(f64::INFINITY)
    }

    /// Returns whether it meets a target.
    pub fn meets(&self, target: Target) -> bool {
        match target {
            Target::Ms(most) => self.ms() <= most,
            Target::Error(most) => self.error().0 <= most,
        }
    }

    /// What is to be as little as possible: the logarithm of the one, and what the other is beyond the target.
    fn cost(&self, target: Target) -> f64 {
        let (error, ms) = (self.error().0, self.ms());
        let (own, most, least) = match target {
            Target::Ms(most) => (ms, most, error),
            Target::Error(most) => (error, most, ms),
        };
        let cost = least.ln() + BEYOND * (own / most).ln().max(0.0);
        if cost.is_nan() { f64::INFINITY } else { cost }
    }
}

/// Searches a grid. The same evaluations lead to the same outcome.
///
/// # Errors
/// As [`Evaluate::evaluate`].
pub fn search<E: Evaluate>(
    axes: &[Axis],
    target: Target,
    options: &Options,
    evaluate: &mut E,
) -> Result<Outcome, E::Error> {
    let mut state = State { tried: Vec::new(), seen: BTreeSet::new(), runs: 0, evaluate };
    state.visit(axes.iter().map(|axis| axis.start).collect())?;
    let regime = |candidate: &Candidate| -> Point {
        let unordered = axes.iter().zip(&candidate.point).filter(|(axis, _)| !axis.ordered);
        unordered.map(|(_, value)| *value).collect()
    };
    // The point that is gone on from, by its error: the same bits are the same picture, whatever the point is called.
    let mut from: BTreeMap<u64, Point> = BTreeMap::new();
    let mut of_regime: BTreeMap<Point, usize> = BTreeMap::new();
    // Axes that make no difference with a combination of alternatives.
    let mut idle: BTreeSet<(Point, usize)> = BTreeSet::new();
    let mut turn = 0;
    while state.seen.len() < options.points {
        let is_open = |candidate: &Candidate| {
            !candidate.is_done && from.get(&candidate.bits()).is_none_or(|point| *point == candidate.point)
        };
        // In turns the best of all, and the best of the combination of alternatives that was looked at least: what is best with one
        // of them may be far from what is best with another.
        let least = state.tried.iter().filter(|candidate| is_open(candidate)).map(regime);
        let least = least.min_by_key(|regime| of_regime.get(regime).copied().unwrap_or_default());
        let is_looked_for = |candidate: &Candidate| turn % 2 == 0 || Some(regime(candidate)) == least;
        let best = state.best(target, |candidate| is_open(candidate) && is_looked_for(candidate));
        let Some(index) = best else { break };
        let best = &state.tried[index];
        from.entry(best.bits()).or_insert_with(|| best.point.clone());
        let own = regime(best);
        let (steps, pairs) = neighbours(axes, &best.point, &|axis| !idle.contains(&(own.clone(), axis)));
        let is_better = |candidate: &Candidate| {
            steps.contains(&candidate.point) && candidate.cost(target) < best.cost(target)
        };
        // Pairs are many: they are tried where no single step is better.
        let is_least = !state.tried.iter().any(is_better);
        let fresh = |points: &[Point]| points.iter().find(|point| !state.seen.contains(*point)).cloned();
        match fresh(&steps).or_else(|| fresh(&pairs).filter(|_| is_least)) {
            Some(point) => {
                let (bits, before) = (best.bits(), best.point.clone());
                let is_same = state.visit(point.clone())?.is_some_and(|visited| visited.bits() == bits);
                let mut changed = (0..axes.len()).filter(|axis| before[*axis] != point[*axis]);
                if let (true, Some(axis), None) = (is_same, changed.next(), changed.next()) {
                    idle.insert((own.clone(), axis));
                }
                *of_regime.entry(own).or_default() += 1;
                turn += 1;
            }
            None => state.tried[index].is_done = true,
        }
    }
    let mut seeds = 1;
    let mut kept = state.ranked(target);
    kept.truncate(options.kept);
    while kept.len() > 2 {
        for index in &kept {
            state.again(*index, seeds + 1..=2 * seeds)?;
        }
        seeds *= 2;
        let cost = |index: &usize| state.tried[*index].cost(target);
        kept.sort_by(|a, b| cost(a).total_cmp(&cost(b)));
        kept.truncate(kept.len().div_ceil(2));
    }
    // Beside the last ones, one that keeps the target for sure is judged, as the winner may lie a little beyond it.
    let safe = state.ranked(target).into_iter().find(|index| {
        let candidate = &state.tried[*index];
        !kept.contains(index) && candidate.meets(target.tightened())
    });
    kept.extend(safe);
    for index in kept {
        for judge in 0..options.judges {
            let point = state.tried[index].point.clone();
            let found = state.measure(&point, judge_seed(judge))?;
            state.tried[index].judged_by.extend(found);
        }
    }
    Ok(Outcome::new(state.tried, target, state.runs))
}

/// Measures all points of a grid by the seeds that would judge them.
///
/// # Errors
/// As [`Evaluate::evaluate`].
pub fn full<E: Evaluate>(
    axes: &[Axis],
    target: Target,
    judges: u32,
    evaluate: &mut E,
) -> Result<Outcome, E::Error> {
    let mut state = State { tried: Vec::new(), seen: BTreeSet::new(), runs: 0, evaluate };
    let mut points: Vec<Point> = vec![Vec::new()];
    for axis in axes {
        let with =
            |point: &Point| (0..axis.values).map(|value| [&point[..], &[value]].concat()).collect::<Vec<_>>();
        points = points.iter().flat_map(with).collect();
    }
    for point in points {
        let mut judged_by = Vec::new();
        for judge in 0..judges {
            judged_by.extend(state.measure(&point, judge_seed(judge))?);
        }
        if let Some(first) = judged_by.first() {
            let chosen_by = vec![*first];
            state.tried.push(Candidate { point, chosen_by, judged_by, is_done: true });
        }
    }
    Ok(Outcome::new(state.tried, target, state.runs))
}

/// The seeds that judge: no choice is made by them.
fn judge_seed(judge: u32) -> u32 {
    u32::MAX - judge
}

impl Outcome {
    fn new(mut tried: Vec<Candidate>, target: Target, runs: usize) -> Outcome {
        tried.sort_by(|a, b| a.cost(target).total_cmp(&b.cost(target)));
        let is_winner = |candidate: &Candidate| !candidate.judged_by.is_empty() && candidate.meets(target);
        let winner = tried.iter().position(is_winner);
        Outcome { tried, winner, runs }
    }
}

impl Target {
    fn tightened(self) -> Target {
        match self {
            Target::Ms(most) => Target::Ms(most * 0.9),
            Target::Error(most) => Target::Error(most * 0.9),
        }
    }
}

/// What is known so far.
struct State<'e, E> {
    tried: Vec<Candidate>,
    /// All points that were tried, with those that cannot be.
    seen: BTreeSet<Point>,
    runs: usize,
    evaluate: &'e mut E,
}

impl<E: Evaluate> State<'_, E> {
    fn measure(&mut self, point: &Point, seed: u32) -> Result<Option<Measured>, E::Error> {
        self.runs += 1;
        self.evaluate.evaluate(point, seed)
    }

    /// Returns the point as it was measured; `None` where it is none that can be.
    fn visit(&mut self, point: Point) -> Result<Option<&Candidate>, E::Error> {
        self.seen.insert(point.clone());
        let found = self.measure(&point, 1)?;
        if let Some(measured) = found {
            self.tried.push(Candidate {
                point,
                chosen_by: vec![measured],
                judged_by: Vec::new(),
                is_done: false,
            });
        }
        Ok(self.tried.last().filter(|_| found.is_some()))
    }

    fn again(&mut self, index: usize, seeds: std::ops::RangeInclusive<u32>) -> Result<(), E::Error> {
        for seed in seeds {
            let point = self.tried[index].point.clone();
            let found = self.measure(&point, seed)?;
            self.tried[index].chosen_by.extend(found);
        }
        Ok(())
    }

    /// The indices of what was tried, the best first.
    fn ranked(&self, target: Target) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.tried.len()).collect();
        order.sort_by(|a, b| self.tried[*a].cost(target).total_cmp(&self.tried[*b].cost(target)));
        order
    }

    fn best(&self, target: Target, is: impl Fn(&Candidate) -> bool) -> Option<usize> {
        self.ranked(target).into_iter().find(|index| is(&self.tried[*index]))
    }
}

/// The points that are a step away along one axis, in the order of the axes; and those that are a step away along two: what the one
/// costs, the other may save.
fn neighbours(axes: &[Axis], point: &Point, matters: &dyn Fn(usize) -> bool) -> (Vec<Point>, Vec<Point>) {
    let (mut steps, mut pairs) = (Vec::new(), Vec::new());
    for (at, axis) in axes.iter().enumerate().filter(|(at, _)| matters(*at)) {
        let values = (0..axis.values)
            .filter(|value| if axis.ordered { value.abs_diff(point[at]) == 1 } else { *value != point[at] });
        for value in values {
            let mut other = point.clone();
            other[at] = value;
            steps.push(other);
        }
    }
    let steps_of =
        |at: usize| [point[at].checked_sub(1), Some(point[at] + 1).filter(|value| *value < axes[at].values)];
    let ordered: Vec<usize> = (0..axes.len()).filter(|at| axes[*at].ordered && matters(*at)).collect();
    for (i, first) in ordered.iter().enumerate() {
        for second in &ordered[i + 1..] {
            for (a, b) in steps_of(*first)
                .into_iter()
                .flatten()
                .flat_map(|a| steps_of(*second).into_iter().flatten().map(move |b| (a, b)))
            {
                let mut other = point.clone();
                (other[*first], other[*second]) = (a, b);
                pairs.push(other);
            }
        }
    }
    (steps, pairs)
}
