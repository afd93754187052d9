//! What an adapter can do only so fast.

use super::super::table::Spread;
use serde_json::{Value, json};

/// A sort of work, each measured by a kernel that does little else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ceiling {
    Copy,
    Load,
    LoadNear,
    Store,
    StoreNear,
    LoadWordsInOrder,
    LoadWords,
    LoadWordsNear,
    LoadVectors,
    LoadVectorsNear,
    LoadTexels,
    StoreTexels,
    Atomics,
    AtomicsNear,
    AtomicsOfOne,
    Threads,
    Barriers,
    Multiplications,
    Dispatches,
    Fragments,
    FragmentsOfFour,
    Triangles,
    TrianglesOutOfView,
}

/// How a rate is shown.
#[derive(Clone, Copy)]
enum Unit {
    /// 10⁹ a second.
    Billions(&'static str),
    /// 10⁶ a second.
    Millions(&'static str),
    /// Microseconds for each.
    Each,
}

impl Ceiling {
    /// In JSON.
    pub(super) fn name(self) -> &'static str {
        self.texts().0
    }

    /// In tables.
    fn what(self) -> &'static str {
        self.texts().1
    }

    fn texts(self) -> (&'static str, &'static str, Unit) {
        const BYTES: Unit = Unit::Billions("GB/s");
        const LOADS: Unit = Unit::Millions("M/s");
        match self {
            Ceiling::Copy => ("copy", "copy of a buffer, read and written", BYTES),
            Ceiling::Load => ("load", "buffer load in order, 16 B each, beyond caches", BYTES),
            Ceiling::LoadNear => ("load-near", "buffer load in order, 16 B each, in 1 MiB", BYTES),
            Ceiling::Store => ("store", "buffer store in order, 16 B each, beyond caches", BYTES),
            Ceiling::StoreNear => ("store-near", "buffer store in order, 16 B each, in 1 MiB", BYTES),
            Ceiling::LoadWordsInOrder => ("load-words-in-order", "loads of 4 B in order in 1 MiB", LOADS),
            Ceiling::LoadWords => ("load-words", "loads of 4 B anywhere, beyond caches", LOADS),
            Ceiling::LoadWordsNear => ("load-words-near", "loads of 4 B anywhere in 1 MiB", LOADS),
            Ceiling::LoadVectors => ("load-vectors", "loads of 16 B anywhere, beyond caches", LOADS),
            Ceiling::LoadVectorsNear => ("load-vectors-near", "loads of 16 B anywhere in 1 MiB", LOADS),
            Ceiling::LoadTexels => ("load-texels", "texels loaded, r32float", Unit::Millions("Mtexel/s")),
            Ceiling::StoreTexels => ("store-texels", "texels stored, r32float", Unit::Millions("Mtexel/s")),
            Ceiling::Atomics => ("atomics", "atomic minima anywhere, beyond caches", LOADS),
            Ceiling::AtomicsNear => ("atomics-near", "atomic minima anywhere in 1 MiB", LOADS),
            Ceiling::AtomicsOfOne => ("atomics-of-one", "atomic minima of one word", LOADS),
            Ceiling::Threads => ("threads", "threads that do nothing, 64 a workgroup", LOADS),
            Ceiling::Barriers => ("barriers", "threads at a barrier, 256 a workgroup", LOADS),
            Ceiling::Multiplications => {
                ("multiplications", "multiplications with additions, f32", Unit::Billions("GFLOP/s"))
            }
            Ceiling::Dispatches => ("dispatches", "dispatches of one workgroup", Unit::Each),
            Ceiling::Fragments => ("fragments", "fragments, r32float", Unit::Millions("Mpx/s")),
            Ceiling::FragmentsOfFour => {
                ("fragments-of-four", "fragments, rgba16float", Unit::Millions("Mpx/s"))
            }
            Ceiling::TrianglesOutOfView => ("triangles-out-of-view", "the same out of view", LOADS),
            Ceiling::Triangles => {
                ("triangles", "triangles of a third of a pixel that cover no centre", LOADS)
            }
        }
    }
}

/// A ceiling with what was done in a second, in bytes, operations or pieces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured {
    pub(super) ceiling: Ceiling,
    pub(super) rate: Spread,
}

impl Measured {
    /// As a table has it: what, and how fast.
    pub(super) fn cells(&self) -> [String; 2] {
        let (rate, unit) = self.shown();
        [self.ceiling.what().to_owned(), rate.with_unit(unit)]
    }

    pub(super) fn to_json(self) -> Value {
        let (rate, unit) = self.shown();
        json!({
            "name": self.ceiling.name(),
            "what": self.ceiling.what(),
            "median": rate.median,
            "least": rate.least,
            "greatest": rate.greatest,
            "unit": unit,
        })
    }

    fn shown(self) -> (Spread, &'static str) {
        let Spread { median, least, greatest } = self.rate;
        let over =
            |unit: f64| Spread { median: median / unit, least: least / unit, greatest: greatest / unit };
        match self.ceiling.texts().2 {
            Unit::Billions(name) => (over(1e9), name),
            Unit::Millions(name) => (over(1e6), name),
            Unit::Each => (self.rate.under(1e6), "µs"),
        }
    }
}

/// All ceilings of an adapter.
pub(super) struct Ceilings(pub(super) Vec<Measured>);

impl Ceilings {
    /// The fastest of some, in a second; none where none of them was measured.
    pub(super) fn fastest(&self, of: &[Ceiling]) -> Option<f64> {
        let rates = self.0.iter().filter(|measured| of.contains(&measured.ceiling));
        rates.map(|measured| measured.rate.median).reduce(f64::max)
    }
}
