//! How much each texel of a reflective shadow map matters as a virtual light.

pub mod cpu_reference;

use gpu_algorithms::reduce;
use interfaces::importance::{self, VIEW_SAMPLE};
use interfaces::surface_points;
use pass::{
    Compute, Define, Extent, Format, Info, Module, OutputContext, OutputDesc, Pass, PassTypeError, Ports,
    RecordContext, Recording, ResourceDesc, SceneBindings, Setting, Settings, Struct, Threads, Usage,
    UseContext, Value, input, optional, output,
};

/// The pass, for the catalog.
pub const PASS: &dyn Pass = &ImportanceMap;

/// See the crate.
pub struct ImportanceMap;

const VIEW_SAMPLES: &str = "passes/importance-map/view-samples.wgsl";
const IMPORTANCE_MAP: &str = "passes/importance-map/importance-map.wgsl";
const REFLECTANCE: &str = "passes/importance-map/reflectance.wgsl";
const GREATEST: &str = "passes/importance-map/greatest.wgsl";
const NORMALISE: &str = "passes/importance-map/normalise.wgsl";
const STORED: &str = "shaders/importance-stored.wgsl";
const BY_BLOCKS: &str = "shaders/importance-by-blocks.wgsl";
const ON_DEMAND: &str = "shaders/importance-on-demand.wgsl";

const VALUES: Struct = Struct::new("passes/importance-map/reflectance-values.wgsl", "ReflectanceValues");
const GREATEST_VALUES: Struct =
    Struct::new("passes/importance-map/reflectance-values.wgsl", "GreatestValues");

pass::choice! {
    /// How importance is defined.
    pub enum Measure {
        /// What a texel contributes to samples of the view.
        Contribution = "contribution",
        /// The luminance of the flux that a texel reflects.
        Flux = "flux",
        /// How its surface reflects, and how it lies to samples of the view.
        Reflectance = "reflectance",
    }
}

pass::choice! {
    /// Where what depends on the view is evaluated.
    pub enum Evaluation {
        /// At each texel.
        Texels = "texels",
        /// At one texel of each block, for what depends on the view; what does not, at each texel.
        Blocks = "blocks",
        /// At the texels that a sampler asks for.
        OnDemand = "on-demand",
    }
}

pass::settings! {
    /// The settings of the pass type `importance-map`.
    pub struct ImportanceMapSettings {
        /// How importance is defined. contribution: what the texel contributes to samples of the view,
        /// without visibility (TCAS Eq. 1-2). flux: the luminance of the flux that it reflects, independent
        /// of the camera (ISM §4). reflectance: how the surface reflects, and how it lies to samples of the
        /// view; at most 1 (ACRSM Eq. 4.1-4.3).
        measure: Measure = Measure::Contribution;
        /// Where it is evaluated, for the measures contribution and reflectance. texels: at each texel, and
        /// stored. blocks: what the texel reflects at each, but what depends on the view at one texel of each
        /// block, which takes 1/stride² of the time. on-demand, for contribution alone: at the texels that the
        /// sampler asks for: of 512² texels, 1,024 Metropolis-Hastings chains of 5 steps ask for 5,120; the
        /// inverse transform asks for all, twice.
        evaluate: Evaluation = Evaluation::Blocks;
        /// Side of a block, for `evaluate: blocks`. Larger: less time, but the importance follows edges and
        /// contacts less closely, so that lights differ more in brightness.
        // DEVIATION(blocks): the texels of a block have one response, and one ρ_v.
        stride: u32 = 4, min: 1, max: 64, unit: "texels";
        /// Number P of samples of the view, for the measure contribution. Noise of the importance falls as
        /// P^-½; time rises with P × texels that are evaluated. TCAS §2 names 0.1 % of the pixels.
        // DEVIATION(sample-count): a number, not a share of the pixels.
        view_samples: u32 = 256, min: 1, max: 65_536;
        /// Lower bound on the distance between a texel and a sample of the view in the geometry term. Larger:
        /// fewer lights cluster where a sample happens to lie near a lit surface. Too large: corners, which
        /// nearby lights illuminate, get too few lights.
        // DEVIATION(min-distance): the paper does not bound the distance.
        min_distance: f32 = 0.01, min: 1e-4, max: 1.0, unit: "scene extents";
        /// Constant k in f = Φ (response + k), for the measure contribution: texels that no sample of the view
        /// saw are sampled too, in proportion to their flux. It does not depend on the view, so a change in
        /// one place changes no importance elsewhere. Larger: fewer bright outliers, but more lights out of
        /// sight. 0: as in the paper.
        // DEVIATION(defensive): the paper adds nothing.
        defensive: f32 = 0.02, min: 0.0, max: 1000.0, unit: "1/extents²";
        /// Weight w_d of diffuse against specular reflection, for the measure reflectance. 1: diffuse alone.
        diffuse_weight: f32 = 0.5, min: 0.0, max: 1.0;
        /// Weight w_v of how the texel lies to samples of the view against how it reflects, for the measure
        /// reflectance. 0: independent of the camera.
        view_weight: f32 = 0.5, min: 0.0, max: 1.0;
    }
}

impl Pass for ImportanceMap {
    fn info(&self) -> Info {
        Info {
            kind: "importance-map",
            about: "Computes the importance of the texels of a reflective shadow map as virtual lights.",
            paper: "TCAS §4.1, Eq. 1-2; ISM §4; ACRSM §4.5",
            shaders: &[VIEW_SAMPLES, IMPORTANCE_MAP, REFLECTANCE, GREATEST, NORMALISE],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(ImportanceMapSettings::schema())
    }

    fn ports(&self, _: &UseContext<'_>, settings: &Settings) -> Result<Ports, PassTypeError> {
        let rsm = input("rsm", "ReflectiveShadowMap", "Each texel is a potential virtual light.");
        let importance = output("importance", "Importance", "f(v) of each texel.");
        let view = input("view", "GBuffer", "What the lights are to be important for.");
        let points = optional(
            "points",
            "SurfacePoints",
            "Samples of the view, in place of `view_samples` of its pixels.",
        );
        let of_view = SceneBindings::SCENE.and(SceneBindings::CAMERA);
        let (inputs, scene_bindings) = match ImportanceMapSettings::read(settings).measure {
            Measure::Contribution => (vec![rsm, view, points], of_view),
            Measure::Flux => (vec![rsm], SceneBindings::NONE),
            Measure::Reflectance => (vec![rsm, view, points], of_view.and(SceneBindings::LIGHTS)),
        };
        Ok(Ports { inputs, outputs: vec![importance], scene_bindings })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let flux = cx.input("rsm").and_then(|rsm| rsm.member("flux")).and_then(ResourceDesc::texture);
        let flux = flux.ok_or_else(|| PassTypeError::input("rsm", "expected a member `flux`"))?;
        let layers = flux.layers;
        let settings = ImportanceMapSettings::read(cx.settings);
        let port = |members: Vec<(&str, ResourceDesc<Extent>)>| {
            let members = members.into_iter();
            OutputDesc::of(
                "importance",
                members.map(|(n, desc)| (n.to_owned(), desc, Usage::Overwrites)).collect(),
            )
        };
        let stored = || {
            let map = ResourceDesc::texture_2d_array(Format::R32Float, Extent::like("rsm"), layers);
            port(vec![("map", map)]).module(Module::new(STORED))
        };
        if settings.measure == Measure::Flux {
            return Ok(vec![stored()]);
        }
        let view_samples = match cx.input("points") {
            Some(_) => cx.fact("points", surface_points::COUNT)?,
            None => settings.view_samples,
        };
        let samples = use_cx.buffer(VIEW_SAMPLE, u64::from(view_samples))?;
        let scratch = OutputDesc::scratch("samples", samples.clone());
        if settings.measure == Measure::Reflectance {
            if cx.input("rsm").is_some_and(|rsm| rsm.member("albedo").is_none()) {
                return Err(PassTypeError::input("rsm", "expected a member `albedo`"));
            }
            let side = block_side(&settings).ok_or_else(|| {
                PassTypeError::setting(
                    "evaluate",
                    "importance by reflectance is divided by its greatest value, so all texels are evaluated",
                )
                .help("take `blocks` or `texels`")
            })?;
            let texels = flux.size.0 * flux.size.1 * layers;
            let blocks = flux.size.0.div_ceil(side) * flux.size.1.div_ceil(side) * layers;
            return Ok(vec![
                stored(),
                scratch,
                OutputDesc::scratch("block_seen", ResourceDesc::buffer(4 * u64::from(blocks))),
                OutputDesc::scratch("values", use_cx.buffer(VALUES, u64::from(texels))?),
                OutputDesc::scratch("greatest", use_cx.buffer(GREATEST_VALUES, 1)?),
                reduce::scratch(use_cx, "blocks", texels, size_of::<f32>() as u64)?,
            ]);
        }
        Ok(match settings.evaluate {
            Evaluation::Texels => vec![stored(), scratch],
            Evaluation::Blocks => {
                let blocks = Extent::Like { input: "rsm".to_owned(), num: 1, den: settings.stride };
                let response = ResourceDesc::texture_2d_array(Format::Rgba32Float, blocks, layers);
                let importance = port(vec![("response", response)])
                    .handed("flux", "rsm", "flux")
                    .module(Module::new(BY_BLOCKS))
                    .fact(importance::STRIDE, settings.stride)
                    .fact(importance::DEFENSIVE, settings.defensive);
                vec![importance, scratch]
            }
            Evaluation::OnDemand => {
                let handed = ["position", "normal", "flux"];
                let importance = port(vec![("samples", samples)]).module(Module::new(ON_DEMAND));
                let importance =
                    handed.iter().fold(importance, |port, member| port.handed(member, "rsm", member));
                let importance = importance
                    .fact(importance::VIEW_SAMPLES, view_samples)
                    .fact(importance::MIN_DISTANCE, settings.min_distance)
                    .fact(importance::DEFENSIVE, settings.defensive);
                vec![importance]
            }
        })
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let settings = ImportanceMapSettings::read(cx.settings);
        let given = cx.connected("points");
        let view_samples =
            if given { cx.fact("points", surface_points::COUNT)? } else { settings.view_samples };
        let of_samples = |step: Compute| step.value("view_samples", Value::U32(view_samples));
        let shader = cx.shader(VIEW_SAMPLES, &[("POINTS", Define::Bool(given))]);
        let pick = of_samples(Compute::new(shader, "pick", Threads::Row(view_samples)));
        let stored = match (settings.measure, settings.evaluate) {
            (Measure::Flux, _) => return Ok(Recording::one(measure(cx, "flux"))),
            (Measure::Reflectance, _) => {
                return by_reflectance(cx, pick, of_samples, block_side(&settings).unwrap_or(1));
            }
            (Measure::Contribution, Evaluation::OnDemand) => {
                return Ok(Recording::one(pick.bind("samples", "importance.samples")));
            }
            (Measure::Contribution, Evaluation::Blocks) => "response",
            (Measure::Contribution, Evaluation::Texels) => "contribution",
        };
        Ok(Recording::one(pick).then(of_samples(measure(cx, stored))))
    }
}

/// The side of the blocks of which one texel is compared with the view \[texels\]; `None` where texels are evaluated on demand.
fn block_side(settings: &ImportanceMapSettings) -> Option<u32> {
    match settings.evaluate {
        Evaluation::Texels => Some(1),
        Evaluation::Blocks => Some(settings.stride),
        Evaluation::OnDemand => None,
    }
}

/// A thread for each texel of what is stored.
fn threads(cx: &RecordContext<'_>) -> Threads {
    let (width, height) = cx.size("importance");
    Threads::Grid([width, height, cx.layers("importance")])
}

fn measure(cx: &RecordContext<'_>, stored: &str) -> Compute {
    Compute::new(cx.shader(IMPORTANCE_MAP, &[("STORED", Define::from(stored))]), "measure", threads(cx))
}

/// Importance by reflectance: the greatest value of all texels divides what they reflect, and then their importance.
fn by_reflectance(
    cx: &RecordContext<'_>,
    pick: Compute,
    of_samples: impl Fn(Compute) -> Compute,
    side: u32,
) -> Result<Recording, PassTypeError> {
    let specular = Define::Bool(cx.has_member("rsm", "specular"));
    let (width, height) = cx.size("importance");
    let layers = cx.layers("importance");
    let blocks = Threads::Grid([width.div_ceil(side), height.div_ceil(side), layers]);
    let steps = [("compare_with_view", blocks), ("reflectance", threads(cx))].map(|(entry, threads)| {
        let step = Compute::new(cx.shader(REFLECTANCE, &[("SPECULAR", specular.clone())]), entry, threads);
        of_samples(step.value("block_side", Value::U32(side)))
    });
    let mut recording = Recording::one(pick).then_all(steps);
    let texels = width * height * layers;
    for of in ["reflected", "importance"] {
        let shader = cx.shader(GREATEST, &[("OF", Define::from(of))]);
        let steps = reduce::steps(&cx.use_context(), &shader, texels, "blocks")?;
        recording =
            recording.then_all(steps.into_iter().map(|step| step.value("texels", Value::U32(texels))));
    }
    Ok(recording.then(Compute::new(cx.shader(NORMALISE, &[]), "normalise", threads(cx))))
}
