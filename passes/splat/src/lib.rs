//! Splats points of the scene into hemispherical depth maps, one per virtual light.

pub mod cpu_reference;

use interfaces::points::SurfaceSamples;
use interfaces::visibility::{DepthBias, DepthBiasSettings};
use interfaces::{counters, depth_atlas, virtual_lights};
use pass::{
    Compute, Define, Info, LARGEST_WINDOW, OutputContext, OutputDesc, Pass, PassTypeError, Ports,
    RecordContext, Recording, ResourceDesc, SceneBindings, Setting, Settings, Threads, UseContext, Value,
    setting,
};
use std::f64::consts::PI;

/// The pass type `splat`.
pub const PASS: &dyn Pass = &Splat { window: LARGEST_WINDOW };

/// Imperfect shadow maps before their holes are filled.
pub struct Splat {
    /// The bytes of the maps that a dispatch binds at most.
    pub window: u64,
}

const SHADER: &str = "passes/splat/splat.wgsl";

/// The most texels of all maps together, since a texel's index is a u32. If an adapter allows less, the
/// allocation fails with an error.
const MAX_TEXELS: u64 = u32::MAX as u64;

/// The most splats of a frame: each has its own index in 0..2³¹, also where maps are padded to whole blocks.
const MAX_SPLATS: u32 = 1 << 30;

pass::choice! {
    /// What a splat stores.
    pub enum Kernel {
        /// One distance for all texels.
        Box = "box",
        /// The distance of the point's tangent plane, in each texel.
        Surfel = "surfel",
    }
}

pass::settings! {
    /// The settings of the pass type `splat` that are not the shader's alone.
    pub struct SplatSettings {
        /// Side of a map (ISM uses 128 and 256). Larger: sharper shadows, but more time.
        map: u32 = 64, min: 1, max: 512, unit: "px";
        /// Points that are splatted into each map; 0 takes as many as `points_per_texel` says.
        points_per_map: u32 = 0;
        /// Points for each texel of the hemisphere, where `points_per_map` is 0. ISM §5.2 has a quarter. More:
        /// fewer holes and so less light that leaks, but more time.
        points_per_texel: f32 = 0.25, min: 0.0, max: 64.0;
        /// The most points of all maps together, which bounds the time. If more are requested, all maps lose
        /// the same share; the port `counters` gives the numbers of points requested and produced.
        budget: u32 = 33_554_432, min: 1, max: MAX_SPLATS;
        /// What a splat stores. box: one distance (ISM §3.2). surfel: in each texel the distance of the
        /// point's tangent plane, so that a surface shadows itself less; takes longer.
        // DEVIATION(surfel): the paper stores one distance.
        kernel: Kernel = Kernel::Surfel;
    }
}

/// Returns the points of a map with so many for each texel of the hemisphere, which are π/4 of those of its map (ISM
/// §3.3): at least one.
pub fn points_of_map(tile: u32, per_texel: f32) -> u32 {
    (0.25 * PI * f64::from(tile).powi(2) * f64::from(per_texel)).round().max(1.0) as u32
}

impl Pass for Splat {
    fn info(&self) -> Info {
        Info {
            kind: "splat",
            about: "Splats points of the scene into hemispherical depth maps, one per virtual light.",
            paper: "ISM §3.2",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = SplatSettings::schema();
        all.extend(setting::of_shader(cx.shaders, SHADER)?);
        all.extend(DepthBiasSettings::schema());
        Ok(all)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                pass::input("points", "Points", "The points to splat."),
                pass::input(
                    "lights",
                    "VirtualLights",
                    "The lights: one map each, over the hemisphere around its normal.",
                ),
            ],
            outputs: vec![
                pass::output("depth", "DepthAtlas", "The maps, with holes."),
                pass::output(
                    "counters",
                    "Counters",
                    "The numbers of splats that were requested and that were produced.",
                ),
            ],
            scene_bindings: SceneBindings::SCENE,
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let settings = SplatSettings::read(cx.settings);
        let tile = settings.map;
        let count = cx.fact("lights", virtual_lights::COUNT)?;
        let texels = u64::from(count) * u64::from(tile).pow(2);
        if texels > MAX_TEXELS {
            let most = MAX_TEXELS / u64::from(tile).pow(2);
            return Err(PassTypeError::setting(
                SplatSettings::map,
                format!("{count} maps of {tile}² have more than 2³² texels"),
            )
            .help("take smaller maps")
            .limit("lights", virtual_lights::COUNT, most, "virtual lights"));
        }
        // Surfels store the distances of the centres of texels, and a box that of the middle of a splat, of the usual two to
        // four texels.
        let needed = match settings.kernel {
            Kernel::Surfel => DepthBias { depth: 0.3, slope: 0.0 },
            Kernel::Box => DepthBias { depth: 0.2, slope: 2.0 },
        };
        let bias = needed.times(DepthBiasSettings::read(cx.settings).depth_bias);
        Ok(vec![
            counters::output(use_cx, "counters")?,
            OutputDesc::one("depth", ResourceDesc::buffer(texels * 4))
                .fact(depth_atlas::TILE, tile)
                .fact(depth_atlas::COUNT, count)
                .fact(depth_atlas::DEPTH_BIAS, bias.depth)
                .fact(depth_atlas::SLOPE_BIAS, bias.slope),
        ])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let (tile, maps) = (cx.fact("depth", depth_atlas::TILE)?, cx.fact("depth", depth_atlas::COUNT)?);
        let settings = SplatSettings::read(cx.settings);
        let wanted = match settings.points_per_map {
            0 => points_of_map(tile, settings.points_per_texel),
            given => given,
        };
        let within_budget = (settings.budget / maps.max(1)).max(1);
        let samples = SurfaceSamples::new(cx, maps, wanted.min(within_budget))?;
        let shader = cx.shader(SHADER, &[("KERNEL", Define::from(settings.kernel))]);
        let mut recording = Recording::default();
        for window in depth_atlas::windows(maps, tile, samples.block(), self.window) {
            let of_maps = samples.of_maps(&window.maps);
            let dispatch = |entry: &str, global: &str, threads: u32| {
                samples
                    .fill(Compute::new(shader.clone(), entry, Threads::Row(threads)), "samples")
                    .bind(global, "depth")
                    .window(global, window.bytes.clone())
                    .value("wanted", Value::U32(wanted.saturating_mul(maps)))
                    .value("first_map", Value::U32(window.maps.start))
                    .value("first", Value::U32(of_maps.start))
                    .value("end", Value::U32(of_maps.end))
            };
            let texels = (window.maps.end - window.maps.start) * tile * tile;
            recording = recording.then(dispatch("clear", "cleared", texels.div_ceil(4)));
            if !of_maps.is_empty() {
                recording = recording.then(dispatch("splat", "depth", of_maps.end - of_maps.start));
            }
        }
        Ok(recording)
    }
}
