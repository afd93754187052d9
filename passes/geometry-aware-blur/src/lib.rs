//! Averages interleaved irradiance over pixels of one surface.

pub mod twin;

use pass::setting::{self, SettingExt};
use pass::{
    Compute, Extent, Externals, Format, Info, KindError, OutputContext, OutputDesc, Pass, Ports,
    RecordContext, Recording, ResourceDesc, Setting, Settings, UseContext, Value,
};

/// The kind `geometry-aware-blur`.
pub const PASS: &dyn Pass = &GeometryAwareBlur;

/// A box filter that stops at edges of the geometry.
pub struct GeometryAwareBlur;

const SHADER: &str = "passes/geometry-aware-blur/geometry-aware-blur.wgsl";

impl Pass for GeometryAwareBlur {
    fn info(&self) -> Info {
        Info {
            kind: "geometry-aware-blur",
            about: "Averages interleaved irradiance over pixels of one surface.",
            paper: "ISM §4, ACRSM §5.3.3",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, KindError> {
        let window = |name, fact| {
            setting::u32(
                name,
                0,
                &format!(
                    "Window; 0 takes the interleaving of the input (its fact `{fact}`). Multiples of that leave no \
                     pattern. Noise falls and detail is lost with it."
                ),
            )
            .range(0.0, 64.0)
            .unit("px")
        };
        Ok(vec![
            window("width", "interleave_x"),
            window("height", "interleave_y"),
            setting::f32(
                "alpha",
                0.02,
                "Pixels count whose distance from the plane of the middle one is at most this fraction of its depth \
                 (ACRSM gives none). More blurs over steps, less leaves noise on curved surfaces.",
            )
            .at_least(0.0),
            setting::f32(
                "beta",
                0.9,
                "Pixels count whose normals have at least this cosine with that of the middle one (ACRSM gives \
                 none). Less blurs over creases, more leaves noise on curved surfaces.",
            )
            .range(-1.0, 1.0),
            setting::bool(
                "separable",
                true,
                "Filter rows, then columns: the time of width + height reads in place of width · height. Differs only \
                 where pixels are rejected.",
            ),
        ])
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, KindError> {
        Ok(Ports {
            inputs: vec![
                pass::input("view", "GBuffer", "Says which pixels see the same surface."),
                pass::input("irradiance", "Irradiance", "What is averaged; of the size of `view`."),
            ],
            outputs: vec![pass::output("filtered", "Irradiance", "The averages.")],
            externals: Externals::CAMERA,
        })
    }

    fn outputs(&self, _: &UseContext<'_>, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, KindError> {
        let sizes = ["view", "irradiance"].map(|port| cx.input(port).and_then(|input| input.size()));
        if let [Some(view), Some(irradiance)] = sizes
            && view != irradiance
        {
            return Err(KindError::input(
                "irradiance",
                format!(
                    "irradiance is {}×{}, but the view is {}×{}",
                    irradiance.0, irradiance.1, view.0, view.1
                ),
            ));
        }
        let image = || ResourceDesc::texture_2d(Format::Rgba32Float, Extent::like("view"));
        let mut outputs = vec![OutputDesc::one("filtered", image())];
        if cx.settings.bool("separable") {
            outputs.push(OutputDesc::scratch("rows", image()));
        }
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, KindError> {
        let window = |setting, fact| match cx.settings.u32(setting) {
            0 => cx.fact("irradiance", fact).max(1),
            given => given,
        };
        let (width, height) = (window("width", "interleave_x"), window("height", "interleave_y"));
        let blur = |width, height| {
            Compute::per_texel(cx.shader(SHADER, &[]), "blur", cx.size("view"))
                .value("width", Value::U32(width))
                .value("height", Value::U32(height))
        };
        if cx.settings.bool("separable") {
            let rows = blur(width, 1).bind("filtered", "rows");
            Ok(Recording::one(rows).then(blur(1, height).bind("irradiance", "rows")))
        } else {
            Ok(Recording::one(blur(width, height)))
        }
    }
}
