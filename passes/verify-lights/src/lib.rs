//! Which lights reach what the camera sees.

use gpu_algorithms::scan;
use interfaces::surface_points;
use pass::{
    Compute, Define, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    ResourceDesc, SceneBindings, Setting, Settings, Struct, Threads, UseContext, Value, input, output,
    setting,
};

/// The pass type `verify-lights`.
pub const PASS: &dyn Pass = &VerifyLights;

/// Mailboxes, and rays to lights whose mailbox is out of sight.
#[derive(Debug)]
pub struct VerifyLights;

const FOLLOW: &str = "passes/verify-lights/follow.wgsl";
const LIST: &str = "passes/verify-lights/list.wgsl";
const CAST: &str = "passes/verify-lights/cast.wgsl";
const SETTLE: &str = "passes/verify-lights/settle.wgsl";
const ROUND: Struct = Struct::new("passes/verify-lights/verify.wgsl", "Round");

/// Threads of a workgroup that casts rays.
const GROUP: u32 = 64;

pass::settings! {
    /// The settings of the pass type `verify-lights` that are not options or settings of its shaders.
    pub struct VerifyLightsSettings {
        /// Rounds in a frame. More: fewer lights count as unseen that are seen; a round after the last unseen light costs
        /// nothing.
        rounds: u32 = 2, min: 0, max: 16;
        /// The most points that cast rays in a round: the first of them. More: fewer lights count as unseen that are seen,
        /// and more time where some are.
        casters: u32 = 2048, min: 1, max: 2_097_152;
    }
}

impl Pass for VerifyLights {
    fn info(&self) -> Info {
        Info {
            kind: "verify-lights",
            about: "Marks the lights that no point in view reaches, as far as mailboxes and a few rays tell.",
            paper: "SMC-IR §3.2.2",
            shaders: &[FOLLOW, LIST, CAST, SETTLE],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = VerifyLightsSettings::schema();
        all.extend(setting::of_shader(cx.shaders, CAST)?);
        all.extend(setting::of_options(cx.shaders, CAST, &["RAYS"])?);
        Ok(all)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                input("points", "SurfacePoints", "Points that the camera sees."),
                input("lights", "SurfacePoints", "Where the lights of the frame before are."),
                input("mailboxes", "SurfacePoints", "For each light, a point in view that it reached."),
            ],
            outputs: vec![
                output(
                    "verified",
                    "SurfacePoints",
                    "The lights where they are now; marked are those that reach nothing in view, and counted.",
                ),
                output(
                    "witnesses",
                    "SurfacePoints",
                    "The mailboxes where they are now, or others in their place.",
                ),
            ],
            scene_bindings: SceneBindings::SCENE.and(SceneBindings::CAMERA),
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let count = cx.fact("lights", surface_points::COUNT)?;
        let list = |name: &str| OutputDesc::scratch(name, ResourceDesc::buffer(4 * u64::from(count.max(1))));
        let mut outputs = vec![
            surface_points::output(use_cx, "verified", count)?,
            surface_points::output(use_cx, "witnesses", count)?,
            list("claims"),
            list("unseen"),
            OutputDesc::scratch("round", use_cx.buffer(ROUND, 1)?),
        ];
        outputs.extend(scan::scratch(use_cx, "places", count)?);
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let settings = VerifyLightsSettings::read(cx.settings);
        let lights = cx.fact("lights", surface_points::COUNT)?.max(1);
        let casters = settings.casters.min(cx.fact("points", surface_points::COUNT)?);
        let of_scene = |define: &'static str, name: &str| (define, Define::Bool(cx.trait_bool(name)));
        let rays = [of_scene("TEXTURED", "textured"), of_scene("MASKED", "masked"), cx.option("RAYS")];
        let following = [&rays[..], &[of_scene("MOVES", "moving_geometry")]].concat();

        let follow = Compute::new(cx.shader(FOLLOW, &following), "follow", Threads::Row(lights));
        let workgroups = Value::U32(casters.div_ceil(GROUP));
        let list: Vec<Compute> = scan::steps(&cx.use_context(), &cx.shader(LIST, &[]), lights, "places")?
            .into_iter()
            .map(|step| step.value("workgroups", workgroups.clone()))
            .collect();
        let settle = |entry| Compute::new(cx.shader(SETTLE, &[]), entry, Threads::Row(lights));
        let mut recording = Recording::one(follow).then_all(list.clone());
        for round in 0..settings.rounds {
            let threads = Threads::Indirect { buffer: "round".into(), offset: 0 };
            let cast = Compute::new(cx.shader(CAST, &rays), "cast_rays", threads)
                .value("round_number", Value::U32(round));
            recording = recording.then(cast).then(settle("settle")).then_all(list.clone());
        }
        Ok(recording.then(settle("finish")))
    }
}
