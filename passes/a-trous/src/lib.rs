//! Averages irradiance by an edge-avoiding wavelet filter.

use interfaces::irradiance::{INTERLEAVE_X, INTERLEAVE_Y, filter_output, filter_picture, filter_ports};
use pass::{
    Compute, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording, Setting,
    Settings, UseContext, Value, setting,
};

/// The pass type `a-trous`.
pub const PASS: &dyn Pass = &ATrous;

/// The edge-avoiding à-trous wavelet filter.
#[derive(Debug)]
pub struct ATrous;

const SHADER: &str = "passes/a-trous/a-trous.wgsl";

pass::settings! {
    /// The settings of the pass type `a-trous` that are not the shader's alone.
    pub struct ATrousSettings {
        /// Iterations, each of which doubles the window; 0 takes as many as leave no pattern of the interleaving
        /// (the facts `interleave_x`, `interleave_y` of the input): 2 for 4, 3 for 8. More: less noise, but less
        /// detail.
        iterations: u32 = 0, max: 8;
    }
}

/// Iterations after which each subset of an interleaving of this many sub-images along a side has the same weight.
fn iterations_without_pattern(interleave: u32) -> u32 {
    interleave.max(2).next_power_of_two().ilog2()
}

impl Pass for ATrous {
    fn info(&self) -> Info {
        Info {
            kind: "a-trous",
            about: "Averages irradiance by a wavelet filter that stops at edges of the geometry.",
            paper: "Dammertz et al. 2010",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = ATrousSettings::schema();
        all.extend(setting::of_shader(cx.shaders, SHADER)?);
        Ok(all)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(filter_ports())
    }

    fn outputs(&self, _: &UseContext<'_>, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let scratch = ["even", "odd"].map(|name| OutputDesc::scratch(name, filter_picture()));
        Ok([filter_output(cx)?].into_iter().chain(scratch).collect())
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let iterations = match ATrousSettings::read(cx.settings).iterations {
            0 => [INTERLEAVE_X, INTERLEAVE_Y]
                .map(|fact| iterations_without_pattern(cx.fact("irradiance", fact).unwrap_or(1)))
                .into_iter()
                .fold(1, u32::max),
            given => given,
        };
        let scratch = |i: u32| if i.is_multiple_of(2) { "even" } else { "odd" };
        let steps = (0..iterations).map(|i| {
            let from = if i == 0 { "irradiance" } else { scratch(i - 1) };
            let to = if i + 1 == iterations { "filtered" } else { scratch(i) };
            Compute::per_texel(cx.shader(SHADER, &[]), "smooth_once", cx.size("view"))
                .value("stride", Value::U32(1 << i))
                .bind("irradiance", from)
                .bind("filtered", to)
        });
        Ok(Recording::of(steps))
    }
}
