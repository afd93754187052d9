//! The reference: paths from the camera with next-event estimation, accumulated from frame to frame.

use gpu_algorithms::reduce;
use interfaces::progress;
use pass::{
    Compute, Define, Extent, Format, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports,
    RecordContext, Recording, ResourceDesc, SceneBindings, Setting, Settings, Usage, UseContext, Value,
    optional, output, setting,
};

/// The pass type `path-tracer`.
pub const PASS: &dyn Pass = &PathTracer;

/// A progressive path tracer.
#[derive(Debug)]
pub struct PathTracer;

const PATHS: &str = "passes/path-tracer/path-tracer.wgsl";
const ESTIMATE: &str = "passes/path-tracer/estimate.wgsl";
const MEAN: &str = "passes/path-tracer/mean.wgsl";

/// Textures of the means, by member of `PathSamples`.
const MEANS: [&str; 4] = ["image", "direct", "indirect", "irradiance"];

/// Most rays of a pixel in one dispatch. A driver may treat a dispatch that takes seconds as a hang, and
/// lavapipe ends all loops of a thread after 65,535 iterations, of which a ray takes up to some hundreds.
const RAYS: u32 = 128;

pass::choice! {
    /// What the value of a pixel is.
    pub enum Filter {
        /// The mean over the square of the pixel.
        Box = "box",
        /// The value at the centre of the pixel.
        Centre = "centre",
    }
}

pass::settings! {
    /// The settings of the pass type `path-tracer` that are not options of its shaders.
    pub struct PathTracerSettings {
        /// Most reflections between the surface that a light illuminates and the one that the camera sees; 0
        /// is direct light alone. Time grows with it.
        bounces: u32 = 3, min: 0, max: 63;
        /// Number N of samples per pixel after which rendering stops. Error falls as N^-½ or better.
        samples: u32 = 1024, min: 1, max: 16_777_216;
        /// Samples per pixel in one frame, or fewer if they would take more than 128 rays. More: the picture
        /// is complete after fewer frames, each of which takes longer.
        samples_per_frame: u32 = 4, min: 1, max: 64;
        /// Estimated relMSE of the whole picture at which rendering stops before all samples are taken; 0
        /// takes all samples.
        error: f32 = 0.0, min: 0.0, max: 1e6;
        /// Length of a path's first indirect segment below which its geometry term is bounded, as a fraction
        /// of the scene's extent; 0 is no bound. With the same value as the `clamp` of `gather`, the picture
        /// is what virtual lights with that clamp converge to.
        clamp: f32 = 0.0, min: 0.0, max: 1.0;
        /// What the value of a pixel is. box: the mean over its square. centre: what its centre sees, as in a
        /// G-buffer.
        filter: Filter = Filter::Box;
    }
}

impl Pass for PathTracer {
    fn info(&self) -> Info {
        Info {
            kind: "path-tracer",
            about: "Path tracing with next-event estimation, accumulated until there are enough samples.",
            paper: "SMC-IR §5.4",
            shaders: &[PATHS, ESTIMATE, MEAN],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = PathTracerSettings::schema();
        all.extend(setting::of_options(cx.shaders, PATHS, &["RAYS"])?);
        Ok(all)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![optional(
                "past",
                "PathSamples",
                "The samples so far: `prev` of the output `samples`. Without it each frame begins again.",
            )],
            outputs: vec![
                output("image", "Radiance", "All light."),
                output("direct", "Radiance", "Light that was reflected once."),
                output("indirect", "Radiance", "Light of bounces 1 to `bounces`."),
                output("irradiance", "Irradiance", "Indirect irradiance where the camera sees a surface."),
                output("samples", "PathSamples", "Means over all samples so far."),
            ],
            scene_bindings: SceneBindings::SCENE.and(SceneBindings::CAMERA).and(SceneBindings::LIGHTS),
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let texture = || ResourceDesc::texture_2d(Format::Rgba32Float, Extent::FRAME);
        let so_far = MEANS.iter().map(|name| ((*name).to_owned(), texture(), Usage::Overwrites));
        let progress = ("progress".to_owned(), progress::buffer(use_cx)?, Usage::Overwrites);
        let samples = OutputDesc::of("samples", so_far.chain([progress]).collect());
        let means = MEANS.iter().map(|name| OutputDesc::one(name, texture()));
        let pixels = cx.frame.0 * cx.frame.1;
        let sums = reduce::scratch(use_cx, "estimate_sums", pixels, 4)?;
        let luminance = OutputDesc::scratch("luminance_sum", ResourceDesc::buffer(4));
        Ok(means.chain([samples, sums, luminance]).collect())
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let size = cx.size("samples");
        let past = ("PAST", Define::Bool(cx.connected("past")));
        let of_scene = |define: &'static str, name: &str| (define, Define::Bool(cx.trait_bool(name)));
        let defines = [
            past.clone(),
            of_scene("EMISSIVE", "emissive"),
            of_scene("TEXTURED", "textured"),
            of_scene("GLOSSY", "glossy"),
            of_scene("MASKED", "masked"),
            cx.option("RAYS"),
        ];
        let paths = cx.shader(PATHS, &defines);
        // A ray to each light, one to an emitter and one onwards, at each surface.
        let settings = PathTracerSettings::read(cx.settings);
        let to_lights = cx.trait_u32("lights") + u32::from(cx.trait_bool("emissive"));
        let rays = (1 + to_lights) * (1 + settings.bounces);
        let at_once = Value::U32(settings.samples_per_frame.min((RAYS / rays).max(1)));
        let paths = Compute::per_texel(paths, "trace_paths", size)
            .value("samples_per_frame", at_once.clone())
            .value("over_square", switch(settings.filter == Filter::Box))
            // An output that nothing reads is not worth a ray.
            .value("direct", switch(cx.connected("image") || cx.connected("direct")));
        let mut estimate = Vec::new();
        for sum in ["luminance", "error"] {
            let shader = cx.shader(ESTIMATE, &[past.clone(), ("SUM", Define::from(sum))]);
            estimate.extend(reduce::steps(&cx.use_context(), &shader, size.0 * size.1, "estimate_sums")?);
        }
        Ok(Recording::one(paths)
            .then_all(estimate.into_iter().map(|step| step.value("samples_per_frame", at_once.clone())))
            .then(Compute::per_texel(cx.shader(MEAN, &[]), "mean", size)))
    }
}

fn switch(on: bool) -> Value {
    Value::U32(u32::from(on))
}
