//! Splats points of the scene into hemispherical depth maps, one a virtual light.

pub mod twin;

use pass::setting::{self, SettingExt};
use pass::{
    Compute, Define, Extent, Externals, Info, KindError, OutputContext, OutputDesc, Pass, Ports,
    RecordContext, Recording, ResourceDesc, Setting, Settings, Threads, UseContext, Value,
};

/// The kind `splat`.
pub const PASS: &dyn Pass = &Splat;

/// Imperfect shadow maps before their holes are filled.
pub struct Splat;

const SHADER: &str = "passes/splat/splat.wgsl";

/// The most texels of all maps: their index is a u32. What an adapter allows less is told when it is asked for.
const MAX_TEXELS: u64 = u32::MAX as u64;

impl Pass for Splat {
    fn info(&self) -> Info {
        Info {
            kind: "splat",
            about: "Splats points of the scene into hemispherical depth maps, one a virtual light.",
            paper: "ISM §3.2",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, KindError> {
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
        ])
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, KindError> {
        Ok(Ports {
            inputs: vec![
                pass::input("points", "Points", "What is splatted."),
                pass::input(
                    "lights",
                    "VirtualLights",
                    "From where: a map a light, over the hemisphere of its normal.",
                ),
            ],
            outputs: vec![pass::output("depth", "DepthAtlas", "The maps, with holes.")],
            externals: Externals::SCENE,
        })
    }

    fn outputs(&self, _: &UseContext<'_>, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, KindError> {
        let tile = cx.settings.u32("map");
        let count = cx.fact("lights", "count").and_then(Value::as_u32).unwrap_or(0).max(1);
        let texels = u64::from(count) * u64::from(tile).pow(2);
        if texels > MAX_TEXELS {
            let most = MAX_TEXELS / u64::from(tile).pow(2);
            return Err(KindError::setting(
                "map",
                format!("{count} maps of {tile}² have more than 2³² texels"),
            )
            .help(format!("take smaller maps, or at most {most} virtual lights")));
        }
        // How far a receiver may be from where its distance was taken, in texels along the receiver's plane: within a
        // texel, or within a splat of the usual two to four.
        let slack = if cx.settings.text("kernel") == "surfel" { 1.0 } else { 2.0 };
        Ok(vec![
            OutputDesc::one("depth", ResourceDesc::<Extent>::buffer(texels * 4))
                .fact("tile", Value::U32(tile))
                .fact("count", Value::U32(count))
                .fact("slack", Value::F32(slack)),
        ])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, KindError> {
        let [tile, count] = ["tile", "count"].map(|fact| cx.fact("depth", fact));
        let points = cx.fact("points", "count");
        let per_map = match cx.settings.u32("points_per_map") {
            0 => twin::points_per_map(tile),
            given => given,
        }
        .clamp(1, points.max(1));
        let Some(splats) = per_map.checked_mul(count) else {
            return Err(KindError::setting(
                "points_per_map",
                format!("{count} maps of {per_map} points each are more than 2³² splats"),
            ));
        };
        let texels = count * tile * tile;
        let shader = cx.shader(SHADER, &[("KERNEL", Define::from(cx.settings.text("kernel")))]);
        let cleared =
            Compute::new(shader.clone(), "clear", Threads::Row(texels.div_ceil(4))).bind("cleared", "depth");
        if points == 0 {
            return Ok(Recording::one(cleared));
        }
        let splatted =
            Compute::new(shader, "splat", Threads::Row(splats)).value("points_per_map", Value::U32(per_map));
        Ok(Recording::one(cleared).then(splatted))
    }
}
