//! The limits of an adapter.

use super::super::table::Spread;
use serde_json::{Value, json};

/// The unit in which a rate is printed.
#[derive(Clone, Copy)]
enum Unit {
    /// 10⁹ a second.
    Billions(&'static str),
    /// 10⁶ a second.
    Millions(&'static str),
    /// Microseconds for each.
    Each(&'static str),
}

/// Defines the ceilings: name in JSON, name for readers, and unit.
macro_rules! ceilings {
    ($($name:ident $key:literal $label:literal $unit:ident($text:literal))*) => {
        /// A sort of work, measured by a kernel that does little else.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(super) enum Ceiling {
            $($name,)*
        }

        impl Ceiling {
            /// Returns its name in JSON, that in tables, and its unit.
            fn texts(self) -> (&'static str, &'static str, Unit) {
                match self {
                    $(Ceiling::$name => ($key, $label, Unit::$unit($text)),)*
                }
            }
        }
    };
}

ceilings! {
    Copy "copy" "copy of a buffer, read and written" Billions("GB/s")
    Load "load" "buffer load in order, 16 B each, beyond caches" Billions("GB/s")
    LoadNear "load-near" "buffer load in order, 16 B each, in 1 MiB" Billions("GB/s")
    Store "store" "buffer store in order, 16 B each, beyond caches" Billions("GB/s")
    StoreNear "store-near" "buffer store in order, 16 B each, in 1 MiB" Billions("GB/s")
    LoadWordsInOrder "load-words-in-order" "loads of 4 B in order in 1 MiB" Millions("M/s")
    LoadWords "load-words" "loads of 4 B anywhere, beyond caches" Millions("M/s")
    LoadWordsNear "load-words-near" "loads of 4 B anywhere in 1 MiB" Millions("M/s")
    LoadVectors "load-vectors" "loads of 16 B anywhere, beyond caches" Millions("M/s")
    LoadVectorsNear "load-vectors-near" "loads of 16 B anywhere in 1 MiB" Millions("M/s")
    LoadTexels "load-texels" "texels loaded, r32float" Millions("Mtexel/s")
    StoreTexels "store-texels" "texels stored, r32float" Millions("Mtexel/s")
    Atomics "atomics" "atomic minima anywhere, beyond caches" Millions("M/s")
    AtomicsNear "atomics-near" "atomic minima anywhere in 1 MiB" Millions("M/s")
    AtomicsOfOne "atomics-of-one" "atomic minima of one word" Millions("M/s")
    Threads "threads" "threads that do nothing, 64 a workgroup" Millions("M/s")
    Barriers "barriers" "threads at a barrier, 256 a workgroup" Millions("M/s")
    Multiplications "multiplications" "multiplications with additions, f32" Billions("GFLOP/s")
    Dispatches "dispatches" "dispatches of one workgroup" Each("µs")
    Fragments "fragments" "fragments, r32float" Millions("Mpx/s")
    FragmentsOfFour "fragments-of-four" "fragments, rgba16float" Millions("Mpx/s")
    Triangles "triangles" "triangles of a third of a pixel that cover no centre" Millions("M/s")
    TrianglesOutOfView "triangles-out-of-view" "the same out of view" Millions("M/s")
}

/// A ceiling with what was done in a second, in bytes, operations or pieces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured {
    pub(super) ceiling: Ceiling,
    pub(super) rate: Spread,
}

impl Measured {
    /// Returns the row of a table: the work and its rate.
    pub(super) fn cells(&self) -> [String; 2] {
        let (rate, unit) = self.shown();
        [self.ceiling.texts().1.to_owned(), rate.with_unit(unit)]
    }

    pub(super) fn to_json(self) -> Value {
        let (rate, unit) = self.shown();
        let (name, what, _) = self.ceiling.texts();
        json!({
            "name": name,
            "what": what,
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
            Unit::Each(name) => (self.rate.under(1e6), name),
        }
    }
}

/// All ceilings of an adapter.
pub(super) struct Ceilings(pub(super) Vec<Measured>);

impl Ceilings {
    /// Returns the greatest rate of some ceilings; `None` if none of them was measured.
    pub(super) fn fastest(&self, of: &[Ceiling]) -> Option<f64> {
        let rates = self.0.iter().filter(|measured| of.contains(&measured.ceiling));
        rates.map(|measured| measured.rate.median).reduce(f64::max)
    }
}
