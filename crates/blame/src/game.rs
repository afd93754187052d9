//! Shapley values: the mean over all orders of what each player adds when its turn comes. [Shapley 1953]

use metrics::statistics::Summary;

/// A set of players: bit i is that of player i.
pub type Subset = u32;

/// Orders that are drawn where there are too many subsets; half of them are the reverse of another.
const ORDERS: usize = 16;

/// A game of some players: which subsets need a value, and the shares that follow from these.
#[derive(Clone, Debug)]
pub struct Game {
    players: usize,
    /// The orders that were drawn; `None` where all subsets are looked at.
    orders: Option<Vec<Vec<usize>>>,
}

impl Game {
    /// Creates the game of up to 31 players. Of more than `exact` players, shares are means over orders that are drawn by the
    /// seed, each with its reverse (antithetic: Mitchell et al. 2022).
    pub fn new(players: usize, exact: usize, seed: u64) -> Game {
        let orders = (players > exact).then(|| {
            let mut random = fastrand::Rng::with_seed(seed);
            let mut orders = Vec::with_capacity(ORDERS);
            while orders.len() < ORDERS {
                let mut order: Vec<usize> = (0..players).collect();
                random.shuffle(&mut order);
                orders.push(order.clone());
                order.reverse();
                orders.push(order);
            }
            orders
        });
        Game { players, orders }
    }

    /// Returns the subsets that need a value, each once: first the empty one, last that of all players.
    pub fn subsets(&self) -> Vec<Subset> {
        let Some(orders) = &self.orders else { return (0..1 << self.players).collect() };
        let mut subsets: Vec<Subset> = orders.iter().flat_map(|order| prefixes(order)).collect();
        subsets.sort_unstable();
        subsets.dedup();
        subsets
    }

    /// Whether shares are means over orders that were drawn.
    pub fn is_sampled(&self) -> bool {
        self.orders.is_some()
    }

    /// Returns the share of each player in what the value falls by from no player to all of them.
    pub fn shares(&self, value: &dyn Fn(Subset) -> f64) -> Vec<f64> {
        let Some(orders) = &self.orders else { return self.exact_shares(value) };
        let mut shares = vec![0.0; self.players];
        for order in orders {
            for (share, part) in shares.iter_mut().zip(falls(order, value)) {
                *share += part / orders.len() as f64;
            }
        }
        shares
    }

    /// Returns half the widths of the 95 % intervals of the shares that come from drawing orders; 0 where none were drawn.
    pub fn halves(&self, value: &dyn Fn(Subset) -> f64) -> Vec<f64> {
        let Some(orders) = &self.orders else { return vec![0.0; self.players] };
        // An order and its reverse are not independent, but their mean is of others.
        let pairs: Vec<Vec<f64>> = orders
            .chunks(2)
            .map(|pair| {
                let parts = pair.iter().map(|order| falls(order, value));
                let sum = parts.reduce(|a, b| a.iter().zip(&b).map(|(a, b)| a + b).collect());
                sum.unwrap_or_default().into_iter().map(|sum| sum / pair.len() as f64).collect()
            })
            .collect();
        let of_player = |player: usize| pairs.iter().map(|pair| pair[player]).collect::<Vec<f64>>();
        let half = |player| Summary::of(&of_player(player)).map_or(0.0, |summary| summary.half_width_95);
        (0..self.players).map(half).collect()
    }

    fn exact_shares(&self, value: &dyn Fn(Subset) -> f64) -> Vec<f64> {
        let values: Vec<f64> = (0..1 << self.players).map(value).collect();
        // Of the orders of n players, |S|! (n − |S| − 1)! / n! have exactly the players S before a given one.
        let n = self.players;
        let weight = |before: usize| {
            let choose = (0..before).fold(1.0, |all, i| all * (n - 1 - i) as f64 / (i + 1) as f64);
            1.0 / (n as f64 * choose)
        };
        let share = |player: usize| {
            let without = (0..values.len()).filter(|subset| subset & (1 << player) == 0);
            without
                .map(|subset| {
                    weight(subset.count_ones() as usize) * (values[subset] - values[subset | 1 << player])
                })
                .sum()
        };
        (0..n).map(share).collect()
    }
}

/// The subsets that an order goes through, from none to all.
fn prefixes(order: &[usize]) -> impl Iterator<Item = Subset> + '_ {
    (0..=order.len()).map(|length| order[..length].iter().fold(0, |subset, player| subset | 1 << player))
}

/// What the value falls by at each player's turn in an order, by player.
fn falls(order: &[usize], value: &dyn Fn(Subset) -> f64) -> Vec<f64> {
    let values: Vec<f64> = prefixes(order).map(value).collect();
    let mut falls = vec![0.0; order.len()];
    for (turn, player) in order.iter().enumerate() {
        falls[*player] = values[turn] - values[turn + 1];
    }
    falls
}
