//! Soft shadows of area lights in lookups of shadow maps.

pub mod cpu_reference;

use interfaces::visibility::{self, LOOP_ITERATIONS, NEAREST, SEARCH, TAPS};
use pass::{
    Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording, SceneBindings,
    Setting, Settings, UseContext,
};

/// The pass type `percentage-closer-soft-shadows`.
pub const PASS: &dyn Pass = &PercentageCloserSoftShadows;

/// Penumbrae of lights that have an area, for shadow maps of any producer.
pub struct PercentageCloserSoftShadows;

const MODULE: &str = "passes/percentage-closer-soft-shadows/percentage-closer-soft-shadows.wgsl";

pass::settings! {
    /// The settings of the pass type `percentage-closer-soft-shadows`.
    pub struct PercentageCloserSoftShadowsSettings {
        /// Taps that look for blockers. More: small blockers are found, and time grows in proportion.
        search: u32 = 16, min: 1, max: 32;
        /// Taps that are filtered, which make as many shades and one more. More: smoother penumbrae, and time grows in
        /// proportion. ACRSM §5.3.3 has 16.
        taps: u32 = 16, min: 1, max: 32;
        /// Least height of a blocker above the light's plane that is looked for, as a share of the receiver's. It bounds the
        /// region of the search and the penumbra, to (1 - n) / n of the light's radius. Smaller: wider penumbrae of
        /// blockers near the light; but more blockers are found that hide nothing, and fewer of the small ones.
        nearest: f32 = 0.5, min: 0.01, max: 1.0;
    }
}

impl Pass for PercentageCloserSoftShadows {
    fn info(&self) -> Info {
        Info {
            kind: "percentage-closer-soft-shadows",
            about: "Makes lookups of shadow maps soft, by the area of the light and the distance of what blocks it.",
            paper: "Fernando 2005; ACRSM §5.3.3",
            shaders: &[MODULE],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(PercentageCloserSoftShadowsSettings::schema())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![pass::input("maps", "Visibility", "An atlas of depth maps.")],
            outputs: vec![pass::output("visibility", "Visibility", "The same atlas, with soft lookups.")],
            scene_bindings: SceneBindings::NONE,
        })
    }

    fn outputs(&self, _: &UseContext<'_>, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let settings = PercentageCloserSoftShadowsSettings::read(cx.settings);
        Ok(vec![
            visibility::with_other_lookups(cx, "maps", MODULE, 1.0)?
                .fact(SEARCH, settings.search)
                .fact(TAPS, settings.taps)
                .fact(NEAREST, settings.nearest)
                .fact(LOOP_ITERATIONS, settings.search + settings.taps),
        ])
    }

    fn record(&self, _: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        Ok(Recording::default())
    }
}
