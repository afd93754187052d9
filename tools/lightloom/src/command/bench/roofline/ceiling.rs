//! The limits of an adapter.

use super::super::table::{Row, Spread};

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

/// Defines the ceilings: name and unit.
macro_rules! ceilings {
    ($($name:ident $label:literal $unit:ident($text:literal))*) => {
        /// A sort of work, measured by a kernel that does little else.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(super) enum Ceiling {
            $($name,)*
        }

        impl Ceiling {
            /// Returns its name and its unit.
            fn texts(self) -> (&'static str, Unit) {
                match self {
                    $(Ceiling::$name => ($label, Unit::$unit($text)),)*
                }
            }
        }
    };
}

ceilings! {
    Copy "copy of a buffer, read and written" Billions("GB/s")
    Load "buffer load in order, 16 B each, beyond caches" Billions("GB/s")
    LoadNear "buffer load in order, 16 B each, in 1 MiB" Billions("GB/s")
    Store "buffer store in order, 16 B each, beyond caches" Billions("GB/s")
    StoreNear "buffer store in order, 16 B each, in 1 MiB" Billions("GB/s")
    LoadWordsInOrder "loads of 4 B in order in 1 MiB" Millions("M/s")
    LoadWords "loads of 4 B anywhere, beyond caches" Millions("M/s")
    LoadWordsNear "loads of 4 B anywhere in 1 MiB" Millions("M/s")
    LoadVectors "loads of 16 B anywhere, beyond caches" Millions("M/s")
    LoadVectorsNear "loads of 16 B anywhere in 1 MiB" Millions("M/s")
    LoadTexels "texels loaded, r32float" Millions("Mtexel/s")
    StoreTexels "texels stored, r32float" Millions("Mtexel/s")
    Atomics "atomic minima anywhere, beyond caches" Millions("M/s")
    AtomicsNear "atomic minima anywhere in 1 MiB" Millions("M/s")
    AtomicsOfOne "atomic minima of one word" Millions("M/s")
    Threads "threads that do nothing, 64 a workgroup" Millions("M/s")
    Barriers "threads at a barrier, 256 a workgroup" Millions("M/s")
    Multiplications "multiplications with additions, f32" Billions("GFLOP/s")
    Dispatches "dispatches of one workgroup" Each("µs")
    Fragments "fragments, r32float" Millions("Mpx/s")
    FragmentsOfFour "fragments, rgba16float" Millions("Mpx/s")
    Triangles "triangles of a third of a pixel that cover no centre" Millions("M/s")
    TrianglesOutOfView "the same out of view" Millions("M/s")
}

/// A ceiling with what was done in a second, in bytes, operations or pieces.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured {
    pub(super) ceiling: Ceiling,
    pub(super) rate: Spread,
}

impl Measured {
    /// Returns the row of the table.
    pub(super) fn row(&self) -> Row {
        let Spread { median, least, greatest } = self.rate;
        let over =
            |unit: f64| Spread { median: median / unit, least: least / unit, greatest: greatest / unit };
        let (what, unit) = self.ceiling.texts();
        match unit {
            Unit::Billions(unit) => Row::new(what, over(1e9), unit),
            Unit::Millions(unit) => Row::new(what, over(1e6), unit),
            Unit::Each(unit) => Row::new(what, self.rate.under(1e6), unit),
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
