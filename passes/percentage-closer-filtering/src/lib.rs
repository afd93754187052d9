//! Filters shadow-map lookups after the depth test.

pub mod cpu_reference;

use interfaces::visibility::{self, LOOP_ITERATIONS, TAPS};
use pass::{
    Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording, SceneBindings,
    Setting, Settings, UseContext,
};

/// The pass type `percentage-closer-filtering`.
pub const PASS: &dyn Pass = &PercentageCloserFiltering;

/// Shadows with soft edges, for shadow maps of any producer.
pub struct PercentageCloserFiltering;

const MODULE: &str = "passes/percentage-closer-filtering/percentage-closer-filtering.wgsl";

pass::settings! {
    /// The settings of the pass type `percentage-closer-filtering`.
    pub struct PercentageCloserFilteringSettings {
        /// Bilinear taps along each side of the window, one texel apart; 1 is bilinear filtering of four
        /// texels. More: softer edges of shadows; but contact shadows fade, since the depth bias grows with
        /// the window, and time grows with the square.
        taps: u32 = 1, min: 1, max: 16;
    }
}

impl Pass for PercentageCloserFiltering {
    fn info(&self) -> Info {
        Info {
            kind: "percentage-closer-filtering",
            about: "Filters shadow-map lookups after the depth test.",
            paper: "Reeves, Salesin & Cook 1987",
            shaders: &[MODULE],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(PercentageCloserFilteringSettings::schema())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![pass::input("maps", "Visibility", "An atlas of depth maps.")],
            outputs: vec![pass::output("visibility", "Visibility", "The same atlas, with filtered lookups.")],
            scene_bindings: SceneBindings::NONE,
        })
    }

    fn outputs(&self, _: &UseContext<'_>, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let taps = PercentageCloserFilteringSettings::read(cx.settings).taps;
        // The farthest texel is farther from the receiver than with one tap, in proportion to the width of
        // the window.
        let reach = (taps + 1) as f32 / 2.0;
        let maps = visibility::with_other_lookups(cx, "maps", MODULE, reach)?;
        Ok(vec![maps.fact(TAPS, taps).fact(LOOP_ITERATIONS, (taps + 1) * (taps + 1))])
    }

    fn record(&self, _: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        Ok(Recording::default())
    }
}
