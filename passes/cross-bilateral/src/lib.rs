//! Averages irradiance over a window, weighted by how alike the surfaces are that pixels see.

use interfaces::irradiance::{filter_output, filter_ports};
use pass::{
    Compute, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording, Setting,
    Settings, UseContext, setting,
};

/// The pass type `cross-bilateral`.
pub const PASS: &dyn Pass = &CrossBilateral;

/// The cross-bilateral filter, over depth and normals.
#[derive(Debug)]
pub struct CrossBilateral;

const SHADER: &str = "passes/cross-bilateral/cross-bilateral.wgsl";

impl Pass for CrossBilateral {
    fn info(&self) -> Info {
        Info {
            kind: "cross-bilateral",
            about: "Averages irradiance over a Gaussian window, weighted by how alike surfaces are.",
            paper: "Eisemann & Durand 2004",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        setting::of_shader(cx.shaders, SHADER)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(filter_ports())
    }

    fn outputs(&self, _: &UseContext<'_>, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        Ok(vec![filter_output(cx)?])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        Ok(Recording::one(Compute::per_texel(cx.shader(SHADER, &[]), "smooth_window", cx.size("view"))))
    }
}
