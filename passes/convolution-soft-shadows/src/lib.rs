#![doc = include_str!("../README.md")]

use interfaces::visibility::{COLUMNS, ROWS, TILE};
use pass::{
    Compute, LARGEST_WINDOW, OutputContext, OutputDesc, Pass, PassTypeError, ReadSettings, RecordContext,
    Recording, Settings, Threads, UseContext, reflected,
};

/// The pass type `convolution-soft-shadows`.
pub const PASS: &dyn Pass = &ConvolutionSoftShadows;

struct ConvolutionSoftShadows;

/// The most workgroups along a dimension: WebGPU's default.
const MAX_GROUPS: u32 = 65_535;

/// Where the basis images of all maps are in their buffer: see basis.wgsl.
#[derive(Clone, Copy)]
struct Basis {
    tile: u32,
    maps: u32,
    order: u32,
    levels: u32,
}

impl Basis {
    fn new(maps: u32, tile: u32, settings: &Settings) -> Result<Basis, PassTypeError> {
        // From the level with one texel on, nothing is left to halve.
        let levels = settings.u32("levels")?.min(tile.next_power_of_two().ilog2());
        Ok(Basis { tile, maps, order: settings.u32("order")?, levels })
    }

    /// Side of a level \[px\].
    fn side(self, level: u32) -> u32 {
        self.tile.div_ceil(1 << level)
    }

    /// Words of a map.
    fn stride(self) -> u64 {
        let texels: u64 = (1..=self.levels).map(|level| u64::from(self.side(level)).pow(2)).sum();
        1 + texels * u64::from(2 * self.order + 1)
    }

    fn bytes(self) -> u64 {
        u64::from(self.maps) * self.stride() * 4
    }

    /// Whether a buffer that every adapter binds holds it, and a dispatch has a workgroup for each map.
    fn fits(self) -> bool {
        self.bytes() <= LARGEST_WINDOW && self.maps <= MAX_GROUPS
    }

    /// Refuses what does not fit.
    fn check(self) -> Result<(), PassTypeError> {
        let (maps, tile) = (self.maps, self.tile);
        if self.fits() {
            return Ok(());
        }
        let most = (LARGEST_WINDOW / (self.stride() * 4)).min(u64::from(MAX_GROUPS));
        let mut advice = format!("take at most {most} maps");
        if let Some(tile) =
            (0..13).rev().map(|log| 1 << log).find(|tile| Basis { tile: *tile, ..self }.fits())
        {
            advice += &format!(", maps of {tile}²");
        }
        if let Some(order) = (1..self.order).rev().find(|order| Basis { order: *order, ..self }.fits()) {
            advice += &format!(", or `order: {order}`");
        }
        Err(PassTypeError::input(
            "maps",
            format!(
                "the basis images of {maps} maps of {tile}² by {} orders take {} MiB, of which every adapter binds {}",
                self.order,
                self.bytes().div_ceil(1 << 20),
                LARGEST_WINDOW >> 20
            ),
        )
        .help(advice))
    }
}

impl Pass for ConvolutionSoftShadows {
    fn kind(&self) -> &'static str {
        "convolution-soft-shadows"
    }

    fn files(&self) -> pass::Files {
        pass::files!()
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let main = self.main_shader(&cx.use_)?;
        let Some(atlas) = cx.input("maps").and_then(|maps| maps.member("atlas")?.texture()) else {
            // The directive refuses what has no atlas.
            return reflected::outputs(use_cx, &main, cx);
        };
        let maps = cx.fact("maps", COLUMNS)? * cx.fact("maps", ROWS)? * atlas.layers;
        let basis = Basis::new(maps, cx.fact("maps", TILE)?, cx.settings)?;
        basis.check()?;
        let values = [("map_levels", basis.levels.into()), ("map_words", (basis.stride() as u32).into())];
        reflected::outputs_with(use_cx, &main, cx, &values)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let maps = cx.fact("maps", COLUMNS)? * cx.fact("maps", ROWS)? * cx.layers("maps");
        let basis = Basis::new(maps, cx.fact("maps", TILE)?, cx.settings)?;
        let step = |entry: &str, level: u32, threads: [u32; 3]| {
            let shader = cx.file("convolution-soft-shadows.wgsl");
            Compute::new(shader, entry, Threads::Grid(threads)).value("level", level)
        };
        let levels = (1..=basis.levels).map(|level| {
            let side = basis.side(level);
            step(if level == 1 { "transform" } else { "halve" }, level, [side, side, maps])
        });
        // The 64 threads of a workgroup share a map.
        Ok(Recording::one(step("measure", 0, [64, 1, maps])).then_all(levels))
    }
}
