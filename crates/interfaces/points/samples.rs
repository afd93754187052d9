//! Requests of a consumer of the interface `Points` to its module: `struct SamplesWanted` of surface-sample.wgsl.

use super::{BLOCK, COUNT};
use pass::{Compute, PassTypeError, RecordContext, Value};
use std::ops::Range;

/// Samples of the port `points` for a number of maps.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceSamples {
    maps: u32,
    per_map: u32,
    block: u32,
}

impl SurfaceSamples {
    /// Requests a number of samples for each of a number of maps, and no more than there are. The product is at
    /// most 2³⁰.
    ///
    /// # Errors
    /// Where the producer of `points` lacks facts of its interface.
    pub fn new(cx: &RecordContext<'_>, maps: u32, per_map: u32) -> Result<SurfaceSamples, PassTypeError> {
        let count = cx.fact("points", COUNT)?;
        // Maps that take turns, a power of two: not many more than there are.
        let block = cx.fact("points", BLOCK).unwrap_or(1).clamp(1, maps.next_power_of_two());
        Ok(SurfaceSamples { maps, per_map: per_map.min(count), block })
    }

    /// Requests the samples of so many splats for each of a number of maps, each chosen from some candidates; returns them with
    /// the number of candidates. Splats are whole, within the budget of samples and within the points that there are.
    ///
    /// # Errors
    /// Where the producer of `points` lacks facts of its interface.
    pub fn of_splats(
        cx: &RecordContext<'_>,
        maps: u32,
        splats: u32,
        candidates: u32,
        budget: u32,
    ) -> Result<(SurfaceSamples, u32), PassTypeError> {
        let most = (budget / maps.max(1)).clamp(1, cx.fact("points", COUNT)?.max(1));
        let candidates = candidates.min(most);
        let per_map = splats.min(most / candidates) * candidates;
        Ok((SurfaceSamples::new(cx, maps, per_map)?, candidates))
    }

    /// Returns how many samples each map has.
    pub fn per_map(&self) -> u32 {
        self.per_map
    }

    /// Returns how many maps take turns: the samples of this many maps, from a multiple of it on, are next to each other.
    pub fn block(&self) -> u32 {
        self.block
    }

    /// Returns the indices of the samples of these maps, of which the first is a multiple of [`SurfaceSamples::block`].
    pub fn of_maps(&self, maps: &Range<u32>) -> Range<u32> {
        maps.start * self.per_map..maps.end.next_multiple_of(self.block) * self.per_map
    }

    /// Returns a dispatch with the values of a member of `settings` of the type SamplesWanted.
    pub fn fill(&self, dispatch: Compute, member: &str) -> Compute {
        // Between two samples, in units of 2⁻³² of 2⁻³¹ of the surface.
        let step = (1_u64 << 63) / u64::from(self.maps * self.per_map).max(1);
        let values = [
            ("maps", self.maps),
            ("per_map", self.per_map),
            ("block_bits", self.block.ilog2()),
            ("step_whole", (step >> 32) as u32),
            ("step_fraction", step as u32),
            ("turn", 0),
        ];
        values.into_iter().fold(dispatch, |dispatch, (name, value)| {
            dispatch.value(&format!("{member}.{name}"), Value::U32(value))
        })
    }
}
