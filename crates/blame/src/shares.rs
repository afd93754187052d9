//! The table of shares.

use crate::game::{Game, Subset};
use crate::player::{Player, frames};
use metrics::statistics::Summary;
use serde::{Deserialize, Serialize};

/// A change that is nothing but rounding, as a share of the whole.
const ROUNDING: f64 = 1e-6;

/// The share of the greatest change from which on a row owes as much.
const ALIKE: f64 = 0.99;

/// What pictures of a subset cost and how wrong they are: a value for each seed, whose mean is the estimate.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cell {
    /// Relative squared error of the mean of any number of seeds.
    pub bias_squared: Vec<f64>,
    /// Relative variance between seeds.
    pub variance: Vec<f64>,
    /// Mean of the picture over that of the reference.
    pub energy: Vec<f64>,
    /// GPU time of a frame \[ms\].
    pub ms: Vec<f64>,
}

impl Cell {
    /// Relative squared error: bias² and variance.
    fn error(&self) -> Vec<f64> {
        self.bias_squared.iter().zip(&self.variance).map(|(bias, variance)| bias + variance).collect()
    }

    fn by_seed(&self) -> Vec<[f64; 2]> {
        self.error().into_iter().zip(&self.energy).map(|(error, energy)| [error, *energy]).collect()
    }
}

/// A mean over seeds, with half the width of its 95 % interval.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The mean.
    pub mean: f64,
    /// Half the width; `None` where nothing is known of it.
    pub half: Option<f64>,
}

/// A row of the table.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// The approximation.
    pub name: String,
    /// What is exact in its place.
    pub exact: String,
    /// The passes that owe it.
    pub passes: Vec<String>,
    /// Its part of the relative squared error: bias² and variance.
    pub error: Estimate,
    /// Its part of bias².
    pub bias_squared: Estimate,
    /// Its part of the variance.
    pub variance: Estimate,
    /// Its part of energy, as a share of the reference's: below 0 where it takes energy away.
    pub energy: Estimate,
    /// GPU time that it saves in a frame \[ms\]; `None` where there is no timer.
    pub saves: Option<Estimate>,
    /// `error` and `energy` of each seed.
    pub by_seed: Vec<[f64; 2]>,
}

/// A part of what is left where all approximations are exact.
#[derive(Clone, Debug)]
pub struct Stage {
    /// Its name.
    pub name: String,
    /// How it is told from the others.
    pub doc: String,
    /// The passes that owe it.
    pub passes: Vec<String>,
    /// What is left before something else stands in its place, and after.
    pub cells: [Cell; 2],
}

/// Which passes owe what.
#[derive(Clone, Debug, Default)]
pub struct Owing {
    /// Those of each player.
    pub players: Vec<Vec<String>>,
    /// Those that are left where all approximations are exact, and nothing else can stand in their place.
    pub rest: Vec<String>,
}

/// The shares of all approximations.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shares {
    /// Those of approximations and of stages, the greatest part of the error first.
    pub rows: Vec<Row>,
    /// What is left then, and noise. Its time is that of a frame in which all are exact.
    pub rest: Row,
    /// The pipeline as it is, with the time of a frame: the sum of all but for time, which the rest has more of by what rows save.
    pub whole: Row,
    /// Whether shares are means over orders that were drawn, and not over all.
    pub sampled: bool,
}

/// Returns the shares. `cell` returns a subset as it was measured: the single frame changes nothing of that.
pub fn table(
    game: &Game,
    players: &[Player],
    owing: &Owing,
    stages: &[Stage],
    cell: &dyn Fn(Subset) -> Cell,
) -> Shares {
    let subsets = game.subsets();
    let cells: Vec<Cell> = subsets.iter().map(|subset| of_frames(cell(*subset), players, *subset)).collect();
    let place = |subset: Subset| subsets.binary_search(&subset).expect("the game has asked for it");
    let at = |subset: Subset| &cells[place(subset)];
    let all: Subset = (1 << players.len()) - 1;
    let by_seed = |values: &dyn Fn(&Cell) -> Vec<f64>| -> Vec<Vec<f64>> {
        let values: Vec<Vec<f64>> = cells.iter().map(values).collect();
        let of_seed = |seed: usize| game.shares(&|subset| values[place(subset)][seed]);
        (0..values[0].len()).map(of_seed).collect()
    };
    let shares = |values: &dyn Fn(&Cell) -> Vec<f64>| -> Vec<Estimate> {
        let by_seed = by_seed(values);
        let values: Vec<Vec<f64>> = cells.iter().map(values).collect();
        let of_orders = game.halves(&|subset| estimate(&values[place(subset)]).mean);
        (0..players.len())
            .map(|player| {
                let of_seeds: Vec<f64> = by_seed.iter().map(|shares| shares[player]).collect();
                estimate(&of_seeds).with(of_orders[player])
            })
            .collect()
    };
    let of_error = shares(&Cell::error);
    let seeds = [by_seed(&Cell::error), by_seed(&|cell| cell.energy.clone())];
    let of_bias = shares(&|cell| cell.bias_squared.clone());
    let of_variance = shares(&|cell| cell.variance.clone());
    let of_energy = shares(&|cell| cell.energy.clone());
    let timed = !at(0).ms.is_empty();
    let of_time = if timed { shares(&|cell| cell.ms.clone()) } else { Vec::new() };
    let mut rows: Vec<Row> = players
        .iter()
        .enumerate()
        .map(|(player, of)| Row {
            name: of.name.clone(),
            exact: of.doc.clone(),
            passes: owing.players[player].clone(),
            error: of_error[player],
            bias_squared: of_bias[player],
            variance: of_variance[player],
            energy: of_energy[player],
            saves: of_time.get(player).map(|share| Estimate { mean: -share.mean, ..*share }),
            by_seed: seeds[0].iter().zip(&seeds[1]).map(|(a, b)| [a[player], b[player]]).collect(),
        })
        .collect();
    rows.extend(stages.iter().map(Stage::row));
    rows.sort_by(|a, b| b.error.mean.total_cmp(&a.error.mean));
    let whole = |name: &str, cell: &Cell, passes: &[String]| {
        let energy = estimate(&cell.energy);
        Row {
            name: name.to_owned(),
            exact: String::new(),
            passes: passes.to_vec(),
            error: estimate(&cell.error()),
            bias_squared: estimate(&cell.bias_squared),
            variance: estimate(&cell.variance),
            energy: Estimate { mean: energy.mean - 1.0, ..energy },
            saves: timed.then(|| estimate(&cell.ms)),
            by_seed: cell.by_seed(),
        }
    };
    let left = stages.iter().fold(at(all).clone(), |left, stage| {
        let Cell { bias_squared, energy, .. } = stage.owed();
        Cell {
            bias_squared: difference(&left.bias_squared, &bias_squared),
            energy: difference(&left.energy, &energy),
            ..left
        }
    });
    Shares {
        rows,
        rest: whole("the rest", &left, &owing.rest),
        whole: whole("the picture", at(0), &[]),
        sampled: game.is_sampled(),
    }
}

impl Stage {
    /// What it owes: bias and energy alone, since what stands in its place has another noise.
    fn owed(&self) -> Cell {
        let [before, after] = &self.cells;
        Cell {
            bias_squared: difference(&before.bias_squared, &after.bias_squared),
            variance: vec![0.0; before.variance.len()],
            energy: difference(&before.energy, &after.energy),
            ms: Vec::new(),
        }
    }

    fn row(&self) -> Row {
        let owed = self.owed();
        Row {
            name: self.name.clone(),
            exact: self.doc.clone(),
            passes: self.passes.clone(),
            error: estimate(&owed.error()),
            bias_squared: estimate(&owed.bias_squared),
            variance: Estimate::default(),
            energy: estimate(&owed.energy),
            saves: None,
            by_seed: owed.by_seed(),
        }
    }
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// The mean of as many frames has as much less variance, and takes as much longer.
fn of_frames(cell: Cell, players: &[Player], subset: Subset) -> Cell {
    let frames = frames(players, subset);
    Cell {
        variance: cell.variance.iter().map(|variance| variance / frames).collect(),
        ms: cell.ms.iter().map(|ms| ms * frames).collect(),
        ..cell
    }
}

fn estimate(values: &[f64]) -> Estimate {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    Estimate { mean, half: Summary::of(values).map(|summary| summary.half_width_95) }
}

impl Estimate {
    /// The same with an independent error.
    fn with(self, half: f64) -> Estimate {
        Estimate { half: self.half.map(|own| own.hypot(half)), ..self }
    }

    /// Whether the interval is without 0.
    pub fn is_decided(&self) -> bool {
        self.half.is_some_and(|half| self.mean.abs() > half)
    }
}

/// What a row owes of the change from an earlier picture to this one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Change {
    /// The row.
    pub name: String,
    /// The passes that owe it.
    pub passes: Vec<String>,
    /// The change of its part of the error.
    pub error: Estimate,
    /// The change of its part of energy.
    pub energy: Estimate,
    /// Both together, as shares of the whole: by this rows are compared.
    pub size: f64,
}

/// Returns those of the rows, in the order of [`Shares::changes`], that owe most of the change: one, or several that owe as much,
/// such as a filter and the pattern that it removes, neither of which has an effect without the other.
pub fn blamed(changes: &[Change]) -> &[Change] {
    let most = changes.first().map_or(0.0, |change| change.size);
    let count = changes.iter().take_while(|change| change.size > ALIKE * most).count();
    &changes[..count]
}

impl Shares {
    /// Returns the rows whose part of error or energy has changed since an earlier picture of as many seeds, seed by seed, as far as
    /// intervals decide it; first the one that owes most of the change. Empty where nothing has changed.
    pub fn changes(&self, before: &Shares) -> Vec<Change> {
        let all =
            |shares: &Shares| -> Vec<Row> { shares.rows.iter().chain([&shares.rest]).cloned().collect() };
        let before_rows = all(before);
        let mut changes: Vec<Change> = all(self)
            .into_iter()
            .filter_map(|row| {
                let known = before_rows.iter().find(|known| known.name == row.name)?;
                let of = |what: usize| -> Estimate {
                    let seeds = row.by_seed.iter().zip(&known.by_seed);
                    estimate(&seeds.map(|(now, then)| now[what] - then[what]).collect::<Vec<f64>>())
                };
                let (error, energy) = (of(0), of(1));
                let size = error.mean.abs() / before.whole.error.mean + energy.mean.abs();
                let is_changed = (error.is_decided() || energy.is_decided()) && size > ROUNDING;
                is_changed.then_some(Change { name: row.name, passes: row.passes, error, energy, size })
            })
            .collect();
        changes.sort_by(|a, b| b.size.total_cmp(&a.size));
        changes
    }
}
