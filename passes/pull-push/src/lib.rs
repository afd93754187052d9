#![doc = include_str!("../README.md")]

use interfaces::depth_atlas;
use interfaces::visibility::AtlasLayout;
use pass::{
    Compute, LARGEST_WINDOW, OutputContext, OutputDesc, Pass, PassTypeError, ReadSettings, RecordContext,
    Recording, Request, Threads, UseContext, reflected,
};
use std::ops::Range;

/// The pass type `pull-push`.
pub const PASS: &dyn Pass = &PullPush { side: AtlasLayout::SIDE, window: LARGEST_WINDOW };

/// Hole filling by pull and push with rejection of outliers.
pub struct PullPush {
    /// The greatest side of a layer of the atlas \[px\].
    pub side: u32,
    /// The bytes of the splatted maps that a step binds at most; of their pyramids it binds those of the same maps.
    pub window: u64,
}

/// The most workgroups along a dimension: WebGPU's default.
const MAX_GROUPS: u32 = 65_535;

/// The pyramids of the maps of a window without their finest levels, level 1 first. Those of one window after those of
/// another make one buffer.
#[derive(Clone, Copy)]
struct Pyramid {
    tile: u32,
    /// The number of maps.
    count: u32,
    /// Levels above the maps.
    levels: u32,
}

impl Pyramid {
    /// Side of a map at a level [px].
    fn side(self, level: u32) -> u32 {
        self.tile.div_ceil(1 << level)
    }

    /// Offset at which a level begins; level 0 is stored elsewhere.
    fn begin(self, level: u32) -> u32 {
        (1..level).map(|finer| self.count * self.side(finer).pow(2)).sum()
    }

    /// Texels of a map.
    fn texels(self) -> u32 {
        (1..=self.levels).map(|level| self.side(level).pow(2)).sum()
    }

    /// The bytes of a window in the buffer; they begin where a window can.
    fn window(self, maps: &Range<u32>) -> Range<u64> {
        let bytes = |maps: u32| 4 * u64::from(maps) * u64::from(self.texels());
        bytes(maps.start)..bytes(maps.end).next_multiple_of(16)
    }

    /// A step between a level and the coarser one, with one thread per texel of level `threads` of these maps.
    fn step(self, finer: u32, threads: u32, maps: &Range<u32>, shader: Request, entry: &str) -> Compute {
        let side = self.side(threads);
        Compute::new(shader, entry, Threads::Grid([side, side, self.count]))
            .window("pyramid", self.window(maps))
            .value("fine_side", self.side(finer))
            .value("coarse_side", self.side(finer + 1))
            .value("fine_begin", self.begin(finer))
            .value("coarse_begin", self.begin(finer + 1))
            .value("scale", (1 << finer) as f32)
    }
}

impl Pass for PullPush {
    fn kind(&self) -> &'static str {
        "pull-push"
    }

    fn files(&self) -> pass::Files {
        pass::files!()
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let (tile, count) = (cx.fact("depth", depth_atlas::TILE)?, cx.fact("depth", depth_atlas::COUNT)?);
        let most = AtlasLayout::most(tile, self.side).min(u64::from(MAX_GROUPS));
        let layout = AtlasLayout::new(count, tile, self.side).filter(|_| count <= MAX_GROUPS);
        let layout = layout.ok_or_else(|| {
            PassTypeError::input("depth", format!("{count} maps of {tile}² are more than an atlas holds"))
                .help("take smaller maps")
                .limit("depth", depth_atlas::COUNT, most, "virtual lights")
        })?;
        let pyramid = Pyramid { tile, count, levels: cx.settings.u32("levels")? };
        let mut values = layout.values().to_vec();
        values.push(("pyramid_texels", count.saturating_mul(pyramid.texels()).into()));
        reflected::outputs_with(use_cx, &self.main_shader(&cx.use_)?, cx, &values)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let levels = cx.settings.u32("levels")?;
        let (tile, count) = (cx.fact("depth", depth_atlas::TILE)?, cx.fact("depth", depth_atlas::COUNT)?);
        let pyramid = |maps: &Range<u32>| Pyramid { tile, count: maps.end - maps.start, levels };
        let mut recording = Recording::default();
        let windows = depth_atlas::windows(count, tile, 1, self.window);
        let shader = |finest| cx.file("pull.wgsl").define("FINEST", finest);
        for depth_atlas::Window { maps, bytes } in &windows {
            let pyramid = pyramid(maps);
            for finer in 0..levels {
                let step = pyramid.step(finer, finer + 1, maps, shader(finer == 0), "pull");
                recording =
                    recording.then(if finer == 0 { step.window("depth", bytes.clone()) } else { step });
            }
            for finer in (1..levels).rev() {
                recording = recording.then(pyramid.step(finer, finer, maps, cx.file("push.wgsl"), "push"));
            }
        }
        let layout = cx.port("visibility").and_then(|port| AtlasLayout::of_facts(&port.facts, count));
        let layout = layout.ok_or_else(|| PassTypeError::new("the atlas has no layout"))?;
        // The rest of the atlas after the last map holds nothing.
        let rest = count..layout.layers() * layout.maps_of_layer();
        let of_windows = windows.iter().map(|window| (window.maps.clone(), window));
        let of_rest = windows.last().map(|window| (rest, window));
        for (maps, window) in of_windows.chain(of_rest).filter(|(maps, _)| !maps.is_empty()) {
            let shader = cx.file("fill.wgsl").define("PYRAMID", levels > 0);
            let pyramid = pyramid(&window.maps);
            let fill = Compute::new(shader, "fill", Threads::Grid([tile, tile, maps.len() as u32]))
                .value("first_map", maps.start)
                .value("maps", count)
                .value("coarse_side", pyramid.side(1))
                .bind("level_1", "pyramid")
                .window("level_1", pyramid.window(&window.maps))
                .window("depth", window.bytes.clone());
            recording = recording.then(fill);
        }
        Ok(recording)
    }
}
