//! Soft shadows of area lights by basis images of shadow maps.

pub mod cpu_reference;

use interfaces::visibility::{
    self, ATTENUATION, COLUMNS, LEVELS, LOOP_ITERATIONS, NEAREST, OFFSET, ORDER, ROWS, SEARCH, STRIDE, TILE,
};
use pass::{
    Compute, Info, LARGEST_WINDOW, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext,
    Recording, ResourceDesc, SceneBindings, Setting, Settings, Threads, Usage, UseContext, Value,
};

/// The pass type `convolution-soft-shadows`.
pub const PASS: &dyn Pass = &ConvolutionSoftShadows { window: LARGEST_WINDOW };

/// Penumbrae of lights that have an area by prefiltered images, for shadow maps of any producer.
pub struct ConvolutionSoftShadows {
    /// The bytes of the basis images at most.
    pub window: u64,
}

const MODULE: &str = "passes/convolution-soft-shadows/convolution-soft-shadows.wgsl";
const SHADER: &str = "passes/convolution-soft-shadows/make-basis.wgsl";

/// The most workgroups along a dimension: WebGPU's default.
const MAX_GROUPS: u32 = 65_535;

pass::settings! {
    /// The settings of the pass type `convolution-soft-shadows`.
    pub struct ConvolutionSoftShadowsSettings {
        /// Orders M of the expansion. More: nearer blockers and receivers are told apart, but memory and time grow in
        /// proportion. Annen et al. 2007 have 4 to 16.
        order: u32 = 4, min: 1, max: 16;
        /// The most levels above the maps, up to the one that has a single texel. Fewer: less wide penumbrae, but hardly
        /// less memory; 0 looks up four texels of the maps alone.
        levels: u32 = 13, min: 0, max: 13;
        /// How much high orders are attenuated: a_k = exp(-attenuation ((2k - 1) / (2M))²). Smaller: the expansion rings, by
        /// 9 % at 0 and by 1 % at 1.5. Larger: its step is wider, so that light leaks in near blockers.
        attenuation: f32 = 1.5, min: 0.0, max: 4.0;
        /// How much nearer than the receiver it is compared, in depths of 1 / M. Smaller: surfaces shadow themselves. Larger:
        /// blockers near the receiver are found less.
        offset: f32 = 0.6, min: 0.0, max: 0.9;
        /// Searches for blockers, of which each narrows the region to the penumbra that the one before found. More: walls
        /// beside the receiver darken it less.
        search: u32 = 2, min: 1, max: 8;
        /// Least height of a blocker above the light's plane that is looked for, as a share of the receiver's. It bounds the
        /// region of the search and the penumbra, to (1 - n) / n of the light's radius. Smaller: wider penumbrae of
        /// blockers near the light; but more blockers are found that hide nothing.
        nearest: f32 = 0.5, min: 0.01, max: 1.0;
    }
}

/// Where the basis images of all maps are in their buffer: see basis.wgsl.
#[derive(Clone, Copy)]
struct Basis {
    tile: u32,
    maps: u32,
    order: u32,
    levels: u32,
}

impl Basis {
    fn new(maps: u32, tile: u32, settings: &ConvolutionSoftShadowsSettings) -> Basis {
        // From the level with one texel on, nothing is left to halve.
        let levels = settings.levels.min(tile.next_power_of_two().ilog2());
        Basis { tile, maps, order: settings.order, levels }
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

    /// Refuses what takes more than that many bytes, or more maps than a dispatch has.
    fn check(self, window: u64) -> Result<(), PassTypeError> {
        let (maps, tile) = (self.maps, self.tile);
        if self.bytes() <= window && maps <= MAX_GROUPS {
            return Ok(());
        }
        let fits = |other: Basis| other.bytes() <= window && maps <= MAX_GROUPS;
        let most = (window / (self.stride() * 4)).min(u64::from(MAX_GROUPS));
        let mut advice = format!("take at most {most} maps");
        if let Some(tile) = (0..13).rev().map(|log| 1 << log).find(|tile| fits(Basis { tile: *tile, ..self }))
        {
            advice += &format!(", maps of {tile}²");
        }
        if let Some(order) = (1..self.order).rev().find(|order| fits(Basis { order: *order, ..self })) {
            advice += &format!(", or `order: {order}`");
        }
        Err(PassTypeError::input(
            "maps",
            format!(
                "the basis images of {maps} maps of {tile}² by {} orders take {} MiB, of which every adapter binds {}",
                self.order,
                self.bytes().div_ceil(1 << 20),
                window >> 20
            ),
        )
        .help(advice))
    }
}

impl Pass for ConvolutionSoftShadows {
    fn info(&self) -> Info {
        Info {
            kind: "convolution-soft-shadows",
            about: "Makes lookups of shadow maps soft by prefiltered images of a series of the depth test.",
            paper: "Annen et al. 2007, 2008; ACRSM §3.1.2, §3.2.5",
            shaders: &[MODULE, SHADER],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(ConvolutionSoftShadowsSettings::schema())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![pass::input("maps", "Visibility", "An atlas of depth maps.")],
            outputs: vec![pass::output(
                "visibility",
                "Visibility",
                "The same atlas, with its basis images and soft lookups.",
            )],
            scene_bindings: SceneBindings::NONE,
        })
    }

    fn outputs(&self, _: &UseContext<'_>, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let mut visibility = visibility::with_other_lookups(cx, "maps", MODULE, 1.0)?;
        let maps = cx.input("maps");
        if maps.is_some_and(|maps| maps.member("basis").is_some()) {
            return Err(PassTypeError::input("maps", "these maps have basis images already")
                .help("let one `convolution-soft-shadows` stand between the maps and what gathers light"));
        }
        let atlas = maps.and_then(|maps| maps.member("atlas")?.texture());
        let layers = atlas.map_or(1, |atlas| atlas.layers);
        let tile = cx.fact("maps", TILE)?;
        let (columns, rows) = (cx.fact("maps", COLUMNS)?, cx.fact("maps", ROWS)?);
        let settings = ConvolutionSoftShadowsSettings::read(cx.settings);
        let basis = Basis::new(columns * rows * layers, tile, &settings);
        basis.check(self.window)?;
        let images = ("basis".to_owned(), ResourceDesc::buffer(basis.bytes()), Usage::Overwrites);
        visibility.members.push(images);
        Ok(vec![
            visibility
                .fact(ORDER, settings.order)
                .fact(LEVELS, basis.levels)
                .fact(ATTENUATION, settings.attenuation)
                .fact(OFFSET, settings.offset)
                .fact(SEARCH, settings.search)
                .fact(NEAREST, settings.nearest)
                .fact(STRIDE, basis.stride() as u32)
                // A search loads two pairs of terms an order, and the kernel a pair of each of two levels.
                .fact(LOOP_ITERATIONS, 2 * settings.order * (settings.search + 1)),
        ])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let settings = ConvolutionSoftShadowsSettings::read(cx.settings);
        let tile = cx.fact("maps", TILE)?;
        let maps = cx.fact("maps", COLUMNS)? * cx.fact("maps", ROWS)? * cx.layers("maps");
        let basis = Basis::new(maps, tile, &settings);
        let step = |entry: &str, level: u32, threads: [u32; 3]| {
            Compute::new(cx.shader(SHADER, &[]), entry, Threads::Grid(threads))
                .value("stride", Value::U32(basis.stride() as u32))
                .value("level", Value::U32(level))
        };
        let levels = (1..=basis.levels).map(|level| {
            let side = basis.side(level);
            step(if level == 1 { "transform" } else { "halve" }, level, [side, side, maps])
        });
        // The 64 threads of a workgroup share a map.
        Ok(Recording::one(step("measure", 0, [64, 1, maps])).then_all(levels))
    }
}
