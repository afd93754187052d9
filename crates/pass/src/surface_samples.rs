//! What a consumer of the interface `Points` owes its module: see shaders/surface-sample.wgsl.

use crate::{Compute, RecordContext, Value};

/// Samples of the port `points` for a number of maps.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceSamples {
    count: u32,
    maps: u32,
    per_map: u32,
    block: u32,
}

impl SurfaceSamples {
    /// So many samples for each of so many maps, and no more than there are. The product is at most 2³⁰.
    pub fn new(cx: &RecordContext<'_>, maps: u32, per_map: u32) -> SurfaceSamples {
        let count = cx.fact("points", "count");
        // Maps that take turns, a power of two: not many more than there are.
        let block = cx.fact("points", "block").clamp(1, maps.next_power_of_two());
        SurfaceSamples { count, maps, per_map: per_map.min(count), block }
    }

    /// Indices of samples that there are to ask for: of all maps, filled up to whole blocks.
    pub fn threads(&self) -> u32 {
        self.maps.next_multiple_of(self.block) * self.per_map
    }

    /// A dispatch with the members of `settings` that the module reads.
    pub fn fill(&self, dispatch: Compute) -> Compute {
        // Between two samples, in units of 2⁻³² of 2⁻³¹ of the surface.
        let step = (1_u64 << 63) / u64::from(self.maps * self.per_map).max(1);
        let values = [
            ("points_count", self.count),
            ("points_maps", self.maps),
            ("points_per_map", self.per_map),
            ("points_block_bits", self.block.ilog2()),
            ("points_step_whole", (step >> 32) as u32),
            ("points_step_fraction", step as u32),
        ];
        values.into_iter().fold(dispatch, |dispatch, (name, value)| dispatch.value(name, Value::U32(value)))
    }
}
