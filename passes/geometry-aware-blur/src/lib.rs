//! Averages interleaved irradiance over pixels of the same surface.

pub mod cpu_reference;

use interfaces::irradiance::{INTERLEAVE_X, INTERLEAVE_Y, filter_output, filter_picture, filter_ports};
use pass::{
    Compute, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording, Setting,
    Settings, UseContext, Value, setting,
};

/// The pass type `geometry-aware-blur`.
pub const PASS: &dyn Pass = &GeometryAwareBlur;

/// A box filter that stops at edges of the geometry.
pub struct GeometryAwareBlur;

const SHADER: &str = "passes/geometry-aware-blur/geometry-aware-blur.wgsl";

pass::settings! {
    /// The settings of the pass type `geometry-aware-blur` that are not the shader's alone.
    pub struct GeometryAwareBlurSettings {
        /// Width of the window; 0 takes the interleaving of the input (the fact `interleave_x` of its output
        /// metadata). Multiples of the interleaving leave no pattern. Larger: less noise, but less detail.
        width: u32 = 0, max: 64, unit: "px";
        /// Height of the window; 0 takes the interleaving of the input (the fact `interleave_y` of its output
        /// metadata).
        height: u32 = 0, max: 64, unit: "px";
        /// Whether to filter rows first, then columns, which reads width + height pixels in place of width ·
        /// height. The result differs only where pixels are rejected.
        separable: bool = true;
    }
}

impl Pass for GeometryAwareBlur {
    fn info(&self) -> Info {
        Info {
            kind: "geometry-aware-blur",
            about: "Averages interleaved irradiance over pixels of one surface.",
            paper: "ISM §4, ACRSM §5.3.3",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = GeometryAwareBlurSettings::schema();
        all.extend(setting::of_shader(cx.shaders, SHADER)?);
        Ok(all)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(filter_ports())
    }

    fn outputs(&self, _: &UseContext<'_>, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let mut outputs = vec![filter_output(cx)?];
        if GeometryAwareBlurSettings::read(cx.settings).separable {
            outputs.push(OutputDesc::scratch("rows", filter_picture()));
        }
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let settings = GeometryAwareBlurSettings::read(cx.settings);
        let window = |setting, fact| match setting {
            0 => cx.fact("irradiance", fact).unwrap_or(1),
            given => given,
        };
        let (width, height) = (window(settings.width, INTERLEAVE_X), window(settings.height, INTERLEAVE_Y));
        let blur = |width, height| {
            Compute::per_texel(cx.shader(SHADER, &[]), "blur", cx.size("view"))
                .value("width", Value::U32(width))
                .value("height", Value::U32(height))
        };
        if settings.separable {
            let rows = blur(width, 1).bind("filtered", "rows");
            Ok(Recording::one(rows).then(blur(1, height).bind("irradiance", "rows")))
        } else {
            Ok(Recording::one(blur(width, height)))
        }
    }
}
