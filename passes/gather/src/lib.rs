//! Sums the irradiance of virtual lights at the camera's pixels, interleaved.

pub mod cpu_reference;

use gpu_algorithms::{LOOP_ITERATIONS, Part};
use pass::setting::{self, SettingExt};
use pass::{
    Compute, Define, Extent, Format, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports,
    RecordContext, Recording, ResourceDesc, SceneBindings, Setting, Settings, Threads, UseContext, Value,
};

/// The pass type `gather`.
pub const PASS: &dyn Pass = &Gather;

/// Diffuse illumination by virtual lights.
pub struct Gather;

/// Pixels of a thread along each side; as in the shader.
const SPAN: u32 = 2;

const SHADER: &str = "passes/gather/gather.wgsl";

/// Lights of a subset that one dispatch takes, where a lookup of visibility makes so many loop iterations.
fn lights_of_part(lookup_iterations: u32) -> u32 {
    // An iteration for the light itself.
    (LOOP_ITERATIONS / (1 + SPAN * SPAN * (1 + lookup_iterations))).max(1)
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

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let interleave = |name, along| {
            setting::u32(
                name,
                4,
                &format!(
                    "Sub-images {along}; each pixel takes one of interleave_x · interleave_y subsets of the lights. \
                     Time falls, and the noise that a filter must remove rises with it; 1 × 1 takes all lights. ISM \
                     Tab. 1 uses 4 and 8."
                ),
            )
            .range(1.0, 16.0)
        };
        Ok(vec![
            interleave("interleave_x", "along a row"),
            interleave("interleave_y", "along a column"),
            setting::choice(
                "subsets",
                &["runs", "strides"],
                "Which lights a sub-image takes: a run of neighbours in their order, or every n·m-th. Runs of a \
                 Halton sequence are even; strides of it share digits, and so lie in strips. Strides suit lights \
                 that are sorted by place.",
            ),
            setting::f32(
                "clamp",
                0.01,
                "Distance below which a light's geometry term grows no more, as a fraction of the scene's extent; 0 \
                 is no bound. Bright spots near lights shrink with it, and energy near corners is lost: alpha says \
                 how much. 0.01 is of the order of the distance between 1,024 lights on a lit tenth of the scene.",
            )
            .range(0.0, 1.0),
        ])
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                pass::input("view", "GBuffer", "Where the light is gathered."),
                pass::input("lights", "VirtualLights", "What gives it."),
                pass::optional("visibility", "Visibility", "Which lights are seen; without it, all."),
            ],
            outputs: vec![pass::output(
                "irradiance",
                "Irradiance",
                "Diffuse irradiance, noisy where interleaved.",
            )],
            scene_bindings: SceneBindings::SCENE.and(SceneBindings::CAMERA),
        })
    }

    fn outputs(&self, _: &UseContext<'_>, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let interleave = |name| Value::U32(cx.settings.u32(name));
        let mut outputs = vec![
            OutputDesc::one(
                "irradiance",
                ResourceDesc::texture_2d(Format::Rgba32Float, Extent::like("view")),
            )
            .fact("interleave_x", interleave("interleave_x"))
            .fact("interleave_y", interleave("interleave_y")),
        ];
        let fact = |input, name| cx.fact(input, name).and_then(Value::as_u32).unwrap_or(0);
        if parts(cx.settings, fact("lights", "count"), fact("visibility", "loop_iterations")).len() > 1 {
            let (width, height) = cx.input("view").and_then(|view| view.size()).unwrap_or(cx.frame);
            let bytes = u64::from(width) * u64::from(height) * 16;
            outputs.push(OutputDesc::scratch("sums", ResourceDesc::buffer(bytes)));
        }
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let size = cx.size("view");
        let [n, m] = ["interleave_x", "interleave_y"].map(|name| cx.settings.u32(name));
        let groups = |pixels: u32, sub_images: u32| pixels.div_ceil(sub_images).div_ceil(SPAN * 8);
        let grid = [groups(size.0, n) * 8, groups(size.1, m) * n * m * 8, 1];
        let (count, iterations) = (cx.fact("lights", "count"), cx.fact("visibility", "loop_iterations"));
        let parts = parts(cx.settings, count, iterations);
        let shader = cx.shader(
            SHADER,
            &[
                ("PARTS", Define::Bool(parts.len() > 1)),
                ("VISIBILITY", Define::Bool(cx.connected("visibility"))),
            ],
        );
        let runs = u32::from(cx.settings.text("subsets") == "runs");
        let gather = |part: Part| {
            Compute::new(shader.clone(), "gather", Threads::Grid(grid))
                .value("runs", Value::U32(runs))
                .value("begin", Value::U32(part.begin))
                .value("end", Value::U32(part.end))
                .value("last", Value::U32(u32::from(part.last)))
        };
        Ok(Recording::of(parts.map(gather)))
    }
}

/// The dispatches that the lights of the largest subset take.
fn parts(
    settings: &Settings,
    lights: u32,
    lookup_iterations: u32,
) -> impl ExactSizeIterator<Item = Part> + use<> {
    let subsets = settings.u32("interleave_x") * settings.u32("interleave_y");
    gpu_algorithms::parts(lights.div_ceil(subsets.max(1)), lights_of_part(lookup_iterations))
}
