//! Sums the irradiance of virtual lights at the camera's pixels, interleaved.

pub mod cpu_reference;

use gpu_algorithms::{LOOP_ITERATIONS, Part};
use interfaces::{irradiance, virtual_lights, visibility};
use pass::{
    Compute, Define, Extent, Format, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports,
    RecordContext, Recording, ResourceDesc, SceneBindings, Setting, Settings, Threads, UseContext, Value,
    setting,
};

/// The pass type `gather`.
pub const PASS: &dyn Pass = &Gather;

/// Diffuse illumination by virtual lights.
pub struct Gather;

const SHADER: &str = "passes/gather/gather.wgsl";

/// The option of the shader that says what a light near a receiver gives; in lower case, the name of the setting.
const GEOMETRY: &str = "GEOMETRY";

/// The constant of the shader that is the pixels of a thread along each side.
const SPAN: &str = "SPAN";

pass::choice! {
    /// Which subset of the lights a sub-image takes.
    pub enum Subsets {
        /// Consecutive lights.
        Runs = "runs",
        /// Every (n·m)-th light.
        Strides = "strides",
    }
}

pass::settings! {
    /// The settings of the pass type `gather` that are not the shader's alone.
    pub struct GatherSettings {
        /// Number of sub-images along a row, at most one per pixel. Each pixel takes one of interleave_x ·
        /// interleave_y subsets of the lights. More: less time, but more noise for a filter to remove. With 1 × 1 each pixel takes
        /// all lights. ISM Tab. 1 uses 4 and 8.
        interleave_x: u32 = 4, min: 1, max: 16;
        /// Number of sub-images along a column, at most one per pixel. Each pixel takes one of interleave_x ·
        /// interleave_y subsets of the lights. More: less time, but more noise for a filter to remove. With 1 × 1 each pixel takes
        /// all lights. ISM Tab. 1 uses 4 and 8.
        interleave_y: u32 = 4, min: 1, max: 16;
        /// Which lights form a subset. runs: consecutive lights. strides: every (n·m)-th light. Consecutive
        /// elements of a Halton sequence are stratified; every (n·m)-th ones share digits, and so lie in
        /// strips. Strides suit lights that are sorted by position.
        subsets: Subsets = Subsets::Runs;
        /// Distance below which a light's geometry term is bounded, as a fraction of the scene's extent; 0 is no
        /// such bound. Larger: smaller bright spots near lights, but more energy lost near corners, which alpha has
        /// and `bias-compensation` returns.
        clamp: f32 = 0.0, min: 0.0, max: 1.0;
        /// The same in radii of a disc of the area that each light stands for: where lights are dense, they are bounded
        /// at less distance. 0 is no such bound. With more lights, less is lost.
        area_bound: f32 = 1.0, min: 0.0, max: 100.0;
    }
}

/// Lights of a subset that one dispatch takes, if a visibility lookup takes `lookup_iterations` loop
/// iterations.
fn lights_of_part(span: u32, lookup_iterations: u32) -> u32 {
    // One iteration is for the light itself.
    (LOOP_ITERATIONS / (1 + span * span * (1 + lookup_iterations))).max(1)
}

impl Pass for Gather {
    fn info(&self) -> Info {
        Info {
            kind: "gather",
            about: "Sums the irradiance of virtual lights at the camera's pixels, interleaved.",
            paper: "ISM §4",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = GatherSettings::schema();
        all.extend(setting::of_options(cx.shaders, SHADER, &[GEOMETRY])?);
        all.extend(setting::of_shader(cx.shaders, SHADER)?);
        Ok(all)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                pass::input("view", "GBuffer", "The pixels at which light is gathered."),
                pass::input("lights", "VirtualLights", "The lights."),
                pass::optional(
                    "visibility",
                    "Visibility",
                    "The visibility of the lights; without it, all are visible.",
                ),
            ],
            outputs: vec![pass::output(
                "irradiance",
                "Irradiance",
                "Diffuse irradiance, with noise if interleaved.",
            )],
            scene_bindings: SceneBindings::SCENE.and(SceneBindings::CAMERA),
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let (width, height) = cx.input("view").and_then(|view| view.size()).unwrap_or(cx.frame);
        let settings = settings_for(cx.settings, (width, height));
        let mut irradiance = OutputDesc::one(
            "irradiance",
            ResourceDesc::texture_2d(Format::Rgba32Float, Extent::like("view")),
        )
        .fact(irradiance::INTERLEAVE_X, settings.interleave_x)
        .fact(irradiance::INTERLEAVE_Y, settings.interleave_y);
        let disc = setting::value_of_option(cx.settings, GEOMETRY).as_text() == Some("disc");
        if settings.area_bound == 0.0 && !disc {
            irradiance = irradiance.fact(irradiance::CLAMP, settings.clamp);
        }
        let mut outputs = vec![irradiance];
        let iterations = cx.fact("visibility", visibility::LOOP_ITERATIONS).unwrap_or(0);
        let span = use_cx.constant(SHADER, SPAN)?;
        if parts(&settings, span, cx.fact("lights", virtual_lights::COUNT)?, iterations).len() > 1 {
            let bytes = u64::from(width) * u64::from(height) * 16;
            outputs.push(OutputDesc::scratch("sums", ResourceDesc::buffer(bytes)));
        }
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let size = cx.size("view");
        let settings = settings_for(cx.settings, size);
        let (n, m) = (settings.interleave_x, settings.interleave_y);
        let use_cx = cx.use_context();
        let constant = |name| use_cx.constant(SHADER, name);
        let (span, side) = (constant(SPAN)?, constant("GROUP_SIDE")?);
        let groups = |pixels: u32, sub_images: u32| pixels.div_ceil(sub_images).div_ceil(span * side);
        let grid = [groups(size.0, n) * side, groups(size.1, m) * n * m * side, 1];
        let iterations = cx.fact("visibility", visibility::LOOP_ITERATIONS).unwrap_or(0);
        let parts = parts(&settings, span, cx.fact("lights", virtual_lights::COUNT)?, iterations);
        let shader = cx.shader(
            SHADER,
            &[
                ("PARTS", Define::Bool(parts.len() > 1)),
                ("VISIBILITY", Define::Bool(cx.connected("visibility"))),
                cx.option(GEOMETRY),
            ],
        );
        let runs = u32::from(settings.subsets == Subsets::Runs);
        let gather = |part: Part| {
            Compute::new(shader.clone(), "gather", Threads::Grid(grid))
                .value("interleave_x", Value::U32(n))
                .value("interleave_y", Value::U32(m))
                .value("runs", Value::U32(runs))
                .value("begin", Value::U32(part.begin))
                .value("end", Value::U32(part.end))
                .value("last", Value::U32(u32::from(part.last)))
        };
        Ok(Recording::of(parts.map(gather)))
    }
}

/// The settings for a frame: a block of interleaving is no larger than the frame, whose pixels would else not have all lights
/// among them.
fn settings_for(settings: &Settings, (width, height): (u32, u32)) -> GatherSettings {
    let given = GatherSettings::read(settings);
    GatherSettings {
        interleave_x: given.interleave_x.min(width),
        interleave_y: given.interleave_y.min(height),
        ..given
    }
}

/// The dispatches that the lights of the largest subset take.
fn parts(
    settings: &GatherSettings,
    span: u32,
    lights: u32,
    lookup_iterations: u32,
) -> impl ExactSizeIterator<Item = Part> + use<> {
    let subsets = settings.interleave_x * settings.interleave_y;
    gpu_algorithms::parts(lights.div_ceil(subsets.max(1)), lights_of_part(span, lookup_iterations))
}
