//! Radiosity of points on surfaces, by paths that begin there.

use interfaces::{radiosity, surface_points};
use pass::{
    Compute, Define, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    ResourceDesc, SceneBindings, Setting, Settings, Threads, UseContext, Value, input, optional, output,
    setting,
};

/// The pass type `radiosity`.
pub const PASS: &dyn Pass = &Radiosity;

/// Paths with next-event estimation, begun at points.
#[derive(Debug)]
pub struct Radiosity;

const SHADER: &str = "passes/radiosity/radiosity.wgsl";

/// Bytes of what one path brings.
const PATH_BYTES: u64 = 16;

pass::settings! {
    /// The settings of the pass type `radiosity` that are not options of its shader.
    pub struct RadiositySettings {
        /// Number N of paths of a point. More: less noise, which falls as N^-½; time grows with N.
        paths: u32 = 16, min: 1, max: 1024;
        /// Bounces of light, from the lights of the scene to where it leaves the points: 1 is direct light that they
        /// reflect. More: brighter, and more time.
        bounces: u32 = 3, min: 1, max: 63;
    }
}

impl Pass for Radiosity {
    fn info(&self) -> Info {
        Info {
            kind: "radiosity",
            about: "Computes the radiosity of points on surfaces by paths from them, and keeps what it knows.",
            paper: "SMC-IR §3.2.3",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = RadiositySettings::schema();
        all.extend(setting::of_options(cx.shaders, SHADER, &["ALBEDO", "RAYS"])?);
        Ok(all)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                input("points", "SurfacePoints", "Where radiosity is wanted."),
                optional(
                    "past",
                    "Radiosity",
                    "What is known: `prev` of the output, reset by `Scene`, `Reload`, `Setting` and `Moved`.",
                ),
            ],
            outputs: vec![output("radiosity", "Radiosity", "What leaves the surface at each point.")],
            scene_bindings: SceneBindings::SCENE.and(SceneBindings::LIGHTS),
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let count = cx.fact("points", surface_points::COUNT)?;
        let paths = u64::from(count) * u64::from(RadiositySettings::read(cx.settings).paths);
        let bytes = PATH_BYTES * paths.max(1);
        if u32::try_from(paths).is_err() || bytes > u64::from(u32::MAX) {
            let said = format!("{paths} paths at once are more than fit into a buffer");
            return Err(
                PassTypeError::setting(RadiositySettings::paths, said).help("take fewer points or paths")
            );
        }
        Ok(vec![
            radiosity::output(use_cx, "radiosity", count)?,
            OutputDesc::scratch("arriving", ResourceDesc::buffer(bytes)),
        ])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let settings = RadiositySettings::read(cx.settings);
        let count = cx.fact("points", surface_points::COUNT)?;
        let defines = [
            ("PAST", Define::Bool(cx.connected("past"))),
            ("EMISSIVE", Define::Bool(cx.trait_bool("emissive"))),
            ("TEXTURED", Define::Bool(cx.trait_bool("textured"))),
            ("MASKED", Define::Bool(cx.trait_bool("masked"))),
            cx.option("ALBEDO"),
            cx.option("RAYS"),
        ];
        let shader = cx.shader(SHADER, &defines);
        // One more segment may meet what emits.
        let segments = settings.bounces - u32::from(!cx.trait_bool("emissive"));
        let step = |entry, length: u32| {
            Compute::new(shader.clone(), entry, Threads::Row(length.max(1)))
                .value("segments", Value::U32(segments))
        };
        let mut recording = Recording::default();
        if segments > 0 {
            recording = recording.then(step("trace_paths", count * settings.paths));
        }
        Ok(recording.then(step("collect", count)))
    }
}
