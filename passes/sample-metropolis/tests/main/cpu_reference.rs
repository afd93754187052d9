//! `sample-metropolis.wgsl` and `proposal.wgsl` in double precision, which needs no scaling by powers of two.

/// The normalization of the importance f in a light's weight w / f (TCAS Eq. 3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Weights {
    /// The mean of f over the proposals of the chain, the first sample included.
    LocalMean,
    /// f of the first sample.
    Single,
    /// The mean of f over the proposals of all chains.
    None,
    /// As [`Weights::LocalMean`], of a chain that is a [reservoir](Chain::reservoir).
    Reservoir,
}

/// A chain of Algorithm 1. Its states are texels, by any number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Chain {
    /// The current sample.
    pub(crate) texel: u32,
    /// f of the current sample.
    pub(crate) importance: f64,
    /// f of the first sample.
    pub(crate) first: f64,
    /// Sum of f over the first sample and all proposals.
    pub(crate) sum: f64,
    /// Samples so far M.
    pub(crate) steps: u32,
    /// Whether one of the samples is chosen in proportion to f, instead of by Metropolis-Hastings.
    pub(crate) reservoir: bool,
}

/// Returns the value that counts as an importance: NaN and negative values become 0, infinity the greatest
/// number.
pub(crate) fn importance_of(x: f32) -> f64 {
    if x > 0.0 { f64::from(x.min(f32::MAX)) } else { 0.0 }
}

impl Chain {
    /// Creates a chain of one sample.
    pub(crate) fn new(texel: u32, importance: f64) -> Chain {
        Chain { texel, importance, first: importance, sum: importance, steps: 1, reservoir: false }
    }

    /// Creates a reservoir of one sample (Talbot, Cline & Egbert 2005, resampled importance sampling).
    pub(crate) fn reservoir(texel: u32, importance: f64) -> Chain {
        Chain { reservoir: true, ..Chain::new(texel, importance) }
    }

    /// Returns the probability of accepting a proposal of this importance.
    pub(crate) fn acceptance(&self, importance: f64) -> f64 {
        let against = if self.reservoir { self.sum + importance } else { self.importance };
        if importance == 0.0 { 0.0 } else { (importance / against).min(1.0) }
    }

    /// Takes a step; `number` in [0, 1) decides.
    pub(crate) fn propose(&mut self, texel: u32, importance: f64, number: f64) {
        if self.acceptance(importance) >= 1.0 - number {
            (self.texel, self.importance) = (texel, importance);
        }
        self.sum += importance;
        self.steps += 1;
    }

    /// Returns w / f, given the mean of f over the proposals of all chains. A light's flux is flux · texels /
    /// N times it.
    pub(crate) fn ratio(&self, weights: Weights, mean: f64) -> f64 {
        let w = match weights {
            Weights::LocalMean | Weights::Reservoir => self.sum / f64::from(self.steps),
            Weights::Single => self.first,
            Weights::None => mean,
        };
        if self.importance == 0.0 { 0.0 } else { (w / self.importance).min(16_777_216.0) }
    }
}

/// Returns the element of Halton's sequence that is proposed to a chain at a step; `shuffled` returns the chain's place in
/// that step's shuffle.
pub(crate) fn element(chain: u32, step: u32, count: u32, shuffled: impl Fn(u32) -> u32) -> u32 {
    let place = if step > 0 { shuffled(chain) } else { chain };
    step * count + place + 1
}
