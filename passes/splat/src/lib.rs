#![doc = include_str!("../README.md")]

use interfaces::points::SurfaceSamples;
use interfaces::{depth_atlas, virtual_lights};
use pass::{
    Compute, LARGEST_WINDOW, OutputContext, OutputDesc, Pass, PassTypeError, ReadSettings, RecordContext,
    Recording, Threads, UseContext, reflected,
};
use std::f64::consts::PI;

/// The pass type `splat`.
pub const PASS: &dyn Pass = &Splat { window: LARGEST_WINDOW };

/// Imperfect shadow maps before their holes are filled.
pub struct Splat {
    /// The bytes of the maps that a dispatch binds at most.
    pub window: u64,
}

/// The most texels of all maps together, since a texel's index is a u32. If an adapter allows less, the
/// allocation fails with an error.
const MAX_TEXELS: u64 = u32::MAX as u64;

/// The greatest side of a surfel \[px\] where `max_splat` does not say.
const LARGEST_SURFEL: f32 = 64.0;

/// Returns the number of points of a map with `per_texel` points for each texel of the hemisphere, which are π/4 of those of its map (ISM
/// §3.3): at least one.
pub fn points_of_map(tile: u32, per_texel: f32) -> u32 {
    (0.25 * PI * f64::from(tile).powi(2) * f64::from(per_texel)).round().max(1.0) as u32
}

impl Pass for Splat {
    fn kind(&self) -> &'static str {
        "splat"
    }

    fn files(&self) -> pass::Files {
        pass::files!()
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let tile = cx.settings.u32("map")?;
        let count = cx.fact("lights", virtual_lights::COUNT)?;
        if u64::from(count) * u64::from(tile).pow(2) > MAX_TEXELS {
            let most = MAX_TEXELS / u64::from(tile).pow(2);
            let message = format!("{count} maps of {tile}² have more than 2³² texels");
            return Err(PassTypeError::setting("map", message).help("take smaller maps").limit(
                "lights",
                virtual_lights::COUNT,
                most,
                "virtual lights",
            ));
        }
        reflected::outputs(use_cx, &self.main_shader(&cx.use_)?, cx)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let (tile, maps) = (cx.fact("depth", depth_atlas::TILE)?, cx.fact("depth", depth_atlas::COUNT)?);
        let wanted = match cx.settings.u32("points_per_map")? {
            0 => points_of_map(tile, cx.settings.f32("points_per_texel")?),
            given => given,
        };
        let (candidates, budget) = (cx.settings.u32("candidates")?, cx.settings.u32("budget")?);
        let (samples, candidates) = SurfaceSamples::of_splats(cx, maps, wanted, candidates, budget)?;
        let side = match cx.settings.f32("max_splat")? {
            0.0 if cx.settings.text("kernel")? == "box" => {
                let texels = points_of_map(tile, 1.0) as f32;
                (4.0 * (texels / (samples.per_map() / candidates) as f32).sqrt()).max(1.0)
            }
            0.0 => LARGEST_SURFEL,
            given => given,
        };
        let shader = cx.file("splat.wgsl");
        let rays_across = match cx.settings.bool("traced")? {
            true => tile.div_ceil(cx.settings.u32("texels_per_ray")?),
            false => 0,
        };
        let keep = cx.settings.bool("keep")?;
        if ["past", "rendered"].map(|port| cx.connected(port)) != [keep; 2] {
            let said = "maps are kept where `keep` is set and the links `past` and `rendered` are there";
            return Err(PassTypeError::setting("keep", said));
        }
        let maps_of = if keep { "kept" } else { "depth" };
        let mut recording = Recording::default();
        for window in depth_atlas::windows(maps, tile, samples.block(), self.window) {
            let of_maps = samples.of_maps(&window.maps);
            let of_maps = of_maps.start / candidates..of_maps.end / candidates;
            let step = |entry: &str, threads: u32| {
                samples
                    .fill(Compute::new(shader.clone(), entry, Threads::Row(threads)), "samples")
                    .value("wanted", wanted.saturating_mul(maps).saturating_mul(candidates))
                    .value("candidates", candidates)
                    .value("side", side)
                    .value("rays_across", rays_across)
                    .value("first_map", window.maps.start)
                    .value("end_map", window.maps.end)
                    .value("first", of_maps.start)
                    .value("end", of_maps.end)
            };
            let dispatch = |entry, global, threads| {
                step(entry, threads).bind(global, maps_of).window(global, window.bytes.clone())
            };
            let maps_here = window.maps.end - window.maps.start;
            let texels = maps_here * tile * tile;
            let hits = maps_here * rays_across * rays_across;
            if keep && window.maps.start == 0 {
                recording = recording.then(step("note_stands", maps));
            }
            // What is kept, and the output.
            let with_both = |entry| {
                let step = step(entry, texels.div_ceil(4)).bind("cleared", "depth");
                ["cleared", "kept"]
                    .into_iter()
                    .fold(step, |step, global| step.window(global, window.bytes.clone()))
            };
            recording = recording.then(if keep {
                with_both("clear")
            } else {
                dispatch("clear", "cleared", texels.div_ceil(4))
            });
            for (entry, threads) in [("splat_hits", hits), ("splat", of_maps.end - of_maps.start)] {
                if threads == 0 {
                    continue;
                }
                let step = dispatch(entry, "depth", threads);
                recording = recording.then(if keep {
                    step.bind("there", "depth").window("there", window.bytes.clone())
                } else {
                    step
                });
            }
            if keep {
                recording = recording.then(with_both("show_distances"));
            }
        }
        Ok(recording)
    }
}
