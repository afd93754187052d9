//! Splats points of the scene into hemispherical depth maps, one a virtual light.

pub mod cpu_reference;

use pass::setting::{self, SettingExt};
use pass::{
    Compute, Define, Extent, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext,
    Recording, ResourceDesc, SceneBindings, Setting, Settings, SurfaceSamples, Threads, UseContext, Value,
};

/// The pass type `splat`.
pub const PASS: &dyn Pass = &Splat;

/// Imperfect shadow maps before their holes are filled.
pub struct Splat;

const SHADER: &str = "passes/splat/splat.wgsl";

/// The most texels of all maps: their index is a u32. What an adapter allows less is told when it is requested.
const MAX_TEXELS: u64 = u32::MAX as u64;

/// The most splats of a frame: each has a place of its own in 0..2³¹, also where maps are filled up to whole blocks.
const MAX_SPLATS: u32 = 1 << 30;

/// Bytes of struct Counters.
const TALLY_BYTES: u64 = 8;

impl Pass for Splat {
    fn info(&self) -> Info {
        Info {
            kind: "splat",
            about: "Splats points of the scene into hemispherical depth maps, one a virtual light.",
            paper: "ISM §3.2",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(vec![
            setting::u32("map", 64, "Side of a map (ISM uses 128 and 256). Shadows sharpen and time grows with it.")
                .range(1.0, 512.0)
                .unit("px"),
            setting::u32(
                "points_per_map",
                0,
                "Points splatted into each map. 0 takes ISM §5.2's guideline, a quarter of the texels of the \
                 hemisphere. Error falls and time grows with it.",
            ),
            setting::u32(
                "budget",
                33_554_432,
                "The most points of all maps together. Where more are requested, all maps lose alike, and the port \
                 `counters` says how many were left out. Time is bounded by it.",
            )
            .range(1.0, f64::from(MAX_SPLATS)),
            setting::f32("splat_scale", 1.0, "Factor on the side of a splat. Holes close and shadows thicken with it.")
                .range(0.0, 16.0),
            setting::f32(
                "max_splat",
                8.0,
                "Greatest side of a splat: a bound on the time that points near a light take. Holes near the light \
                 close with it.",
            )
            .range(1.0, 512.0)
            .unit("px"),
            setting::choice(
                "kernel",
                &["box", "surfel"],
                "What a splat stores: one distance (ISM §3.2), or in each texel the distance of the point's tangent \
                 plane, which shadows less of the surface itself and takes longer.",
            ),
            pass::depth_bias(),
        ])
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                pass::input("points", "Points", "What is splatted."),
                pass::input(
                    "lights",
                    "VirtualLights",
                    "From where: a map a light, over the hemisphere of its normal.",
                ),
            ],
            outputs: vec![
                pass::output("depth", "DepthAtlas", "The maps, with holes."),
                pass::output(
                    "counters",
                    "Counters",
                    "How many splats were wanted, and how many there were points for.",
                ),
            ],
            scene_bindings: SceneBindings::SCENE,
        })
    }

    fn outputs(&self, _: &UseContext<'_>, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let tile = cx.settings.u32("map");
        let count = cx.fact("lights", "count").and_then(Value::as_u32).unwrap_or(0).max(1);
        let texels = u64::from(count) * u64::from(tile).pow(2);
        if texels > MAX_TEXELS {
            let most = MAX_TEXELS / u64::from(tile).pow(2);
            return Err(PassTypeError::setting(
                "map",
                format!("{count} maps of {tile}² have more than 2³² texels"),
            )
            .help(format!("take smaller maps, or at most {most} virtual lights")));
        }
        // How far a receiver may be from where its distance was taken, in texels along the receiver's plane: within a
        // texel, or within a splat of the usual two to four.
        let needed = if cx.settings.text("kernel") == "surfel" { 1.0 } else { 2.0 };
        Ok(vec![
            OutputDesc::one("counters", ResourceDesc::<Extent>::buffer(TALLY_BYTES)),
            OutputDesc::one("depth", ResourceDesc::<Extent>::buffer(texels * 4))
                .fact("tile", Value::U32(tile))
                .fact("count", Value::U32(count))
                .fact("depth_bias", Value::F32(cx.settings.f32("depth_bias") * needed)),
        ])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let [tile, maps] = ["tile", "count"].map(|fact| cx.fact("depth", fact));
        let wanted = match cx.settings.u32("points_per_map") {
            0 => cpu_reference::points_per_map(tile),
            given => given,
        };
        let within_budget = (cx.settings.u32("budget") / maps.max(1)).max(1);
        let samples = SurfaceSamples::new(cx, maps, wanted.min(within_budget));
        let shader = cx.shader(SHADER, &[("KERNEL", Define::from(cx.settings.text("kernel")))]);
        let dispatch = |entry: &str, threads: u32| {
            samples
                .fill(Compute::new(shader.clone(), entry, Threads::Row(threads)), "samples")
                .value("wanted", Value::U32(wanted.saturating_mul(maps)))
                .value("threads", Value::U32(samples.threads()))
        };
        let texels = maps * tile * tile;
        let cleared = Recording::one(dispatch("clear", texels.div_ceil(4)).bind("cleared", "depth"));
        Ok(match samples.threads() {
            0 => cleared,
            threads => cleared.then(dispatch("splat", threads)),
        })
    }
}
