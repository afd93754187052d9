//! Fills the holes of splatted depth maps through an image pyramid.

pub mod cpu_reference;

use interfaces::depth_atlas;
use interfaces::visibility::{AtlasLayout, DepthBias};
use pass::{
    Compute, Define, Info, LARGEST_WINDOW, OutputContext, OutputDesc, Pass, PassTypeError, Ports,
    RecordContext, Recording, ResourceDesc, SceneBindings, Setting, Settings, Threads, UseContext, Value,
    setting,
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

const PULL: &str = "passes/pull-push/pull.wgsl";
const PUSH: &str = "passes/pull-push/push.wgsl";
const FILL: &str = "passes/pull-push/fill.wgsl";

/// The option of the shader that says how texels are combined; in lower case, the name of the setting.
const PULL_BY: &str = "PULL";

/// The most workgroups along a dimension: WebGPU's default.
const MAX_GROUPS: u32 = 65_535;

pass::settings! {
    /// The settings of the pass type `pull-push` that are not the shaders' alone.
    pub struct PullPushSettings {
        /// Levels of the pyramid above the maps; 0 leaves holes as they are. More: larger holes close, but
        /// small openings close as well.
        levels: u32 = 2, min: 0, max: 4;
    }
}

/// The pyramids of the maps of a window without their finest levels, level 1 first. Those of one window after those of
/// another make one buffer.
#[derive(Clone, Copy)]
struct Pyramid {
    tile: u32,
    /// How many maps there are.
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

    /// Bytes of this many maps.
    fn bytes(self, maps: u32) -> u64 {
        let texels: u64 = (1..=self.levels).map(|level| u64::from(self.side(level)).pow(2)).sum();
        u64::from(maps) * texels * 4
    }

    /// The bytes of a window in the buffer; they begin where a window can.
    fn window(self, maps: &Range<u32>) -> Range<u64> {
        self.bytes(maps.start)..self.bytes(maps.end).next_multiple_of(16)
    }

    /// A step between a level and the coarser one, with one thread per texel of level `threads` of these maps.
    fn step(
        self,
        finer: u32,
        threads: u32,
        maps: &Range<u32>,
        shader: pass::Request,
        entry: &str,
    ) -> Compute {
        let side = self.side(threads);
        let begin = |level| Value::U32(self.begin(level));
        Compute::new(shader, entry, Threads::Grid([side, side, self.count]))
            .window("pyramid", self.window(maps))
            .value("fine_side", Value::U32(self.side(finer)))
            .value("coarse_side", Value::U32(self.side(finer + 1)))
            .value("fine_begin", begin(finer))
            .value("coarse_begin", begin(finer + 1))
            .value("scale", Value::F32((1 << finer) as f32))
    }
}

impl Pass for PullPush {
    fn info(&self) -> Info {
        Info {
            kind: "pull-push",
            about: "Fills the holes of splatted depth maps through an image pyramid.",
            paper: "ISM §3.2",
            shaders: &[PULL, PUSH, FILL],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = PullPushSettings::schema();
        all.extend(setting::of_options(cx.shaders, PULL, &[PULL_BY])?);
        all.extend(setting::of_shader(cx.shaders, PULL)?);
        all.extend(setting::of_shader(cx.shaders, PUSH)?);
        Ok(all)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![pass::input("depth", "DepthAtlas", "The maps, with holes.")],
            outputs: vec![pass::output("visibility", "Visibility", "The maps, filled.")],
            scene_bindings: SceneBindings::SCENE,
        })
    }

    fn outputs(&self, _: &UseContext<'_>, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let (tile, count) = (cx.fact("depth", depth_atlas::TILE)?, cx.fact("depth", depth_atlas::COUNT)?);
        let most = AtlasLayout::most(tile, self.side).min(u64::from(MAX_GROUPS));
        let layout = AtlasLayout::new(count, tile, self.side).filter(|_| count <= MAX_GROUPS);
        let layout = layout.ok_or_else(|| {
            PassTypeError::input("depth", format!("{count} maps of {tile}² are more than an atlas holds"))
                .help("take smaller maps")
                .limit("depth", depth_atlas::COUNT, most, "virtual lights")
        })?;
        let bias = DepthBias {
            depth: cx.fact("depth", depth_atlas::DEPTH_BIAS)?,
            slope: cx.fact("depth", depth_atlas::SLOPE_BIAS)?,
        };
        let levels = PullPushSettings::read(cx.settings).levels;
        let bytes = Pyramid { tile, count, levels }.bytes(count);
        let pyramid = OutputDesc::scratch("pyramid", ResourceDesc::buffer(bytes));
        Ok(vec![layout.visibility(bias), pyramid])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let levels = PullPushSettings::read(cx.settings).levels;
        let (tile, count) = (cx.fact("depth", depth_atlas::TILE)?, cx.fact("depth", depth_atlas::COUNT)?);
        let pyramid = |maps: &Range<u32>| Pyramid { tile, count: maps.end - maps.start, levels };
        let mut recording = Recording::default();
        let windows = depth_atlas::windows(count, tile, 1, self.window);
        let shader = |finest| cx.shader(PULL, &[("FINEST", Define::Bool(finest)), cx.option(PULL_BY)]);
        for depth_atlas::Window { maps, bytes } in &windows {
            let pyramid = pyramid(maps);
            for finer in 0..levels {
                let step = pyramid.step(finer, finer + 1, maps, shader(finer == 0), "pull");
                recording =
                    recording.then(if finer == 0 { step.window("depth", bytes.clone()) } else { step });
            }
            for finer in (1..levels).rev() {
                recording = recording.then(pyramid.step(finer, finer, maps, cx.shader(PUSH, &[]), "push"));
            }
        }
        let layout = cx.port("visibility").and_then(|port| AtlasLayout::of_facts(&port.facts, count));
        let layout = layout.ok_or_else(|| PassTypeError::new("the atlas has no layout"))?;
        // What is left of the atlas after the last map holds nothing.
        let rest = count..layout.layers() * layout.maps_of_layer();
        let of_windows = windows.iter().map(|window| (window.maps.clone(), window));
        let of_rest = windows.last().map(|window| (rest, window));
        for (maps, window) in of_windows.chain(of_rest).filter(|(maps, _)| !maps.is_empty()) {
            let shader = cx.shader(FILL, &[("PYRAMID", Define::Bool(levels > 0))]);
            let pyramid = pyramid(&window.maps);
            let fill = Compute::new(shader, "fill", Threads::Grid([tile, tile, maps.len() as u32]))
                .value("first_map", Value::U32(maps.start))
                .value("maps", Value::U32(count))
                .value("coarse_side", Value::U32(pyramid.side(1)))
                .bind("level_1", "pyramid")
                .window("level_1", pyramid.window(&window.maps))
                .window("depth", window.bytes.clone());
            recording = recording.then(fill);
        }
        Ok(recording)
    }
}
