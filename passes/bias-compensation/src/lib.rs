//! Returns by short rays the light that bounding virtual lights took away.

use interfaces::irradiance::{CLAMP, INTERLEAVE_X, INTERLEAVE_Y};
use pass::{
    Compute, Define, Extent, Format, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports,
    RecordContext, Recording, ResourceDesc, SceneBindings, Setting, Settings, UseContext, Value, setting,
};

/// The pass type `bias-compensation`.
pub const PASS: &dyn Pass = &BiasCompensation;

/// Short rays for what bounded virtual lights leave out.
#[derive(Debug)]
pub struct BiasCompensation;

const SHADER: &str = "passes/bias-compensation/bias-compensation.wgsl";

impl Pass for BiasCompensation {
    fn info(&self) -> Info {
        Info {
            kind: "bias-compensation",
            about: "Returns by short rays the light that the bound of virtual lights took away.",
            paper: "Kollig & Keller 2004",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = setting::of_options(cx.shaders, SHADER, &["RAYS"])?;
        all.extend(setting::of_shader(cx.shaders, SHADER)?);
        Ok(all)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                pass::input("view", "GBuffer", "The pixels at which light was gathered."),
                pass::input(
                    "irradiance",
                    "Irradiance",
                    "The irradiance of bounded lights, as `gather` has it: its fact `clamp` is the bound.",
                ),
            ],
            outputs: vec![pass::output(
                "compensated",
                "Irradiance",
                "The irradiance with what the bound took away.",
            )],
            scene_bindings: SceneBindings::SCENE.and(SceneBindings::CAMERA).and(SceneBindings::LIGHTS),
        })
    }

    fn outputs(&self, _: &UseContext<'_>, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        // Without it nobody knows what to return.
        if cx.fact("irradiance", CLAMP).is_err() {
            return Err(PassTypeError::input(
                "irradiance",
                "its lights are not bounded at one distance: connect the output of `gather` itself, with `area_bound` 0 \
                 and `geometry` \"bounded\"",
            ));
        }
        let image = ResourceDesc::texture_2d(Format::Rgba32Float, Extent::like("irradiance"));
        let mut output = OutputDesc::one("compensated", image);
        for fact in [INTERLEAVE_X, INTERLEAVE_Y] {
            if let Ok(value) = cx.fact("irradiance", fact) {
                output = output.fact(fact, value);
            }
        }
        Ok(vec![output])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let shader = cx.shader(
            SHADER,
            &[
                ("TEXTURED", Define::Bool(cx.trait_bool("textured"))),
                ("MASKED", Define::Bool(cx.trait_bool("masked"))),
                cx.option("RAYS"),
            ],
        );
        let window = |fact| Value::U32(cx.fact("irradiance", fact).unwrap_or(1));
        let bound = cx.fact("irradiance", CLAMP)?;
        Ok(Recording::one(
            Compute::per_texel(shader, "compensate", cx.size("view"))
                .value("interleave_x", window(INTERLEAVE_X))
                .value("interleave_y", window(INTERLEAVE_Y))
                .value("bound", Value::F32(bound)),
        ))
    }
}
