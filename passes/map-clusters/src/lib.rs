#![doc = include_str!("../README.md")]

use pass::{
    OutputContext, OutputDesc, Pass, PassTypeError, ReadSettings, RecordContext, Recording, Settings,
    UseContext, reflected,
};

/// The pass type `map-clusters`.
pub const PASS: &dyn Pass = &MapClusters;

struct MapClusters;

/// The settings that are weights: of positions, normals, importance and flux.
const WEIGHTS: [&str; 4] = ["position_weight", "normal_weight", "importance_weight", "flux_weight"];

/// Returns the weights as the shader has them: they sum to 1, and importance that is not linked has none.
fn weights(settings: &Settings, has_importance: bool) -> Result<[f32; 4], PassTypeError> {
    let mut weights = [0.0; 4];
    for (weight, name) in weights.iter_mut().zip(WEIGHTS) {
        *weight = settings.f32(name)?;
    }
    weights[2] = if has_importance { weights[2] } else { 0.0 };
    let sum: f32 = weights.iter().sum();
    if sum > 0.0 {
        return Ok(weights.map(|weight| weight / sum));
    }
    Err(PassTypeError::setting(WEIGHTS[0], "all weights are 0, so all clusters are as near to each texel"))
}

impl Pass for MapClusters {
    fn kind(&self) -> &'static str {
        "map-clusters"
    }

    fn files(&self) -> pass::Files {
        pass::files!()
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        weights(cx.settings, cx.input("importance").is_some())?;
        reflected::outputs(use_cx, &self.main_shader(&cx.use_)?, cx)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let weights = weights(cx.settings, cx.connected("importance"))?;
        Ok(reflected::record(cx)?.map(|mut step| {
            step.shader = step.shader.define("IMPORTANCE", weights[2] > 0.0).define("FLUX", weights[3] > 0.0);
            WEIGHTS.into_iter().zip(weights).fold(step, |step, (name, weight)| step.value(name, weight))
        }))
    }
}
