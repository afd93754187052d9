//! How much each texel of a reflective shadow map matters as a virtual light.

pub mod cpu_reference;

use gpu_algorithms::reduce;
use pass::{
    Compute, Define, Extent, Format, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports,
    RecordContext, Recording, ResourceDesc, SceneBindings, Setting, Settings, Struct, Threads, UseContext,
    Value, input, output,
};

/// The pass, for the catalog.
pub const PASS: &dyn Pass = &ImportanceMap;

/// See the crate.
pub struct ImportanceMap;

const VIEW_SAMPLES: &str = "passes/importance-map/view-samples.wgsl";
const IMPORTANCE_MAP: &str = "passes/importance-map/importance-map.wgsl";
const SUM: &str = "passes/importance-map/sum.wgsl";
const MIX: &str = "passes/importance-map/mix.wgsl";

const VIEW_SAMPLE: Struct = Struct::new(VIEW_SAMPLES, "ViewSample");
const SUMS: Struct = Struct::new("passes/importance-map/sums.wgsl", "Sums");

pass::choice! {
    /// How importance is defined.
    pub enum Measure {
        /// What a texel contributes to samples of the view.
        Contribution = "contribution",
        /// The luminance of the flux that a texel reflects.
        Flux = "flux",
    }
}

pass::settings! {
    /// The settings of the pass type `importance-map`.
    pub struct ImportanceMapSettings {
        /// How importance is defined. contribution: what the texel contributes to samples of the view,
        /// without visibility (TCAS Eq. 1-2). flux: the luminance of the flux that it reflects, independent
        /// of the camera (ISM §4).
        measure: Measure = Measure::Contribution;
        /// Number P of samples of the view, for the measure contribution. Noise of the importance falls as
        /// P^-½; time rises with P × texels of the map. TCAS §2 names 0.1 % of the pixels.
        // DEVIATION(sample-count): a number, not a share of the pixels.
        view_samples: u32 = 256, min: 1, max: 65_536;
        /// Lower bound on the distance between a texel and a sample of the view in the geometry term. Larger:
        /// fewer lights cluster where a sample happens to lie near a lit surface. Too large: corners, which
        /// nearby lights illuminate, get too few lights.
        min_distance: f32 = 0.01, min: 1e-4, max: 1.0, unit: "scene extents";
        /// Share δ of the lights that is sampled by flux, independent of the view, for the measure
        /// contribution. It bounds the weight of a light to 1/δ times its weight when sampled by flux alone,
        /// and reaches texels that no sample of the view saw. Larger: fewer bright outliers, but more lights
        /// out of sight. 0: as in the paper.
        defensive: f32 = 0.05, min: 0.0, max: 1.0;
    }
}

impl ImportanceMapSettings {
    fn by_contribution(&self) -> bool {
        self.measure == Measure::Contribution
    }

    fn mixes(&self) -> bool {
        self.by_contribution() && self.defensive > 0.0
    }
}

impl Pass for ImportanceMap {
    fn info(&self) -> Info {
        Info {
            kind: "importance-map",
            about: "Computes the importance of each texel of a reflective shadow map as a virtual light.",
            paper: "TCAS §4.1, Eq. 1-2; ISM §4",
            shaders: &[VIEW_SAMPLES, IMPORTANCE_MAP, SUM, MIX],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(ImportanceMapSettings::schema())
    }

    fn ports(&self, _: &UseContext<'_>, settings: &Settings) -> Result<Ports, PassTypeError> {
        let rsm = input("rsm", "ReflectiveShadowMap", "Each texel is a potential virtual light.");
        let importance =
            output("importance", "ImportanceMap", "f(v) of each texel; the mean is 1 where it is a mixture.");
        Ok(if ImportanceMapSettings::read(settings).by_contribution() {
            Ports {
                inputs: vec![rsm, input("view", "GBuffer", "What the lights are to be important for.")],
                outputs: vec![importance],
                scene_bindings: SceneBindings::SCENE.and(SceneBindings::CAMERA),
            }
        } else {
            Ports { inputs: vec![rsm], outputs: vec![importance], scene_bindings: SceneBindings::NONE }
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let texture = cx
            .input("rsm")
            .and_then(|rsm| rsm.member("flux"))
            .and_then(ResourceDesc::texture)
            .ok_or_else(|| PassTypeError::input("rsm", "expected a member `flux`"))?;
        let map = || ResourceDesc::texture_2d_array(Format::R32Float, Extent::like("rsm"), texture.layers);
        let mut outputs = vec![OutputDesc::one("importance", map())];
        let settings = ImportanceMapSettings::read(cx.settings);
        if settings.by_contribution() {
            let samples = use_cx.buffer(VIEW_SAMPLE, u64::from(settings.view_samples))?;
            outputs.push(OutputDesc::scratch("samples", samples));
        }
        if settings.mixes() {
            let partial = use_cx.buffer(SUMS, u64::from(groups(use_cx, texture.size, texture.layers)?))?;
            outputs.push(OutputDesc::scratch("contribution", map()));
            outputs.push(OutputDesc::scratch("partial_sums", partial));
            outputs.push(OutputDesc::scratch("sums", use_cx.buffer(SUMS, 1)?));
        }
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let layers = cx.layers("importance");
        let (width, height) = cx.size("importance");
        let settings = ImportanceMapSettings::read(cx.settings);
        let (contribution, mixed) = (settings.by_contribution(), settings.mixes());
        let texels = Threads::Grid([width, height, layers]);
        let defines = [("CONTRIBUTION", Define::Bool(contribution)), ("SUMS", Define::Bool(mixed))];
        let measure = Compute::new(cx.shader(IMPORTANCE_MAP, &defines), "measure", texels.clone());
        if !contribution {
            return Ok(Recording::one(measure));
        }
        let samples = Threads::Row(settings.view_samples);
        let pick = Recording::one(Compute::new(cx.shader(VIEW_SAMPLES, &[]), "pick", samples));
        if !mixed {
            return Ok(pick.then(measure));
        }
        let sum = reduce::few(&cx.shader(SUM, &[]))
            .value("groups", Value::U32(groups(&cx.use_context(), (width, height), layers)?));
        let mix = Compute::new(cx.shader(MIX, &[]), "mix_with_flux", texels);
        Ok(pick.then(measure.bind("importance", "contribution")).then(sum).then(mix))
    }
}

/// Workgroups of importance-map.wgsl.
fn groups(cx: &UseContext<'_>, size: (u32, u32), layers: u32) -> Result<u32, PassTypeError> {
    let side = cx.constant(IMPORTANCE_MAP, "GROUP_SIDE")?;
    Ok(size.0.div_ceil(side) * size.1.div_ceil(side) * layers)
}
