//! The mean of a picture over frames, each of which is another sample of it.

use interfaces::progress;
use pass::{
    Compute, Define, Extent, Format, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports,
    RecordContext, Recording, ResourceDesc, SceneBindings, Setting, Settings, Usage, UseContext, setting,
};

/// The pass type `accumulate`.
pub const PASS: &dyn Pass = &Accumulate;

/// The mean over frames.
///
/// It reads [`SceneBindings::SAMPLE`], so each frame of a plan that has it takes another seed and another place
/// within the pixels.
#[derive(Debug)]
pub struct Accumulate;

const SHADER: &str = "passes/accumulate/accumulate.wgsl";

impl Pass for Accumulate {
    fn info(&self) -> Info {
        Info {
            kind: "accumulate",
            about: "Takes the mean of a picture over frames, each of which is another sample of it.",
            paper: "Haeberli & Akeley 1990",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        setting::of_shader(cx.shaders, SHADER)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                pass::input("radiance", "Radiance", "The picture of a frame."),
                pass::optional(
                    "past",
                    "RadianceMean",
                    "The mean so far: `Prev` of the output `mean`. Without it each frame begins again.",
                ),
            ],
            outputs: vec![
                pass::output("image", "Radiance", "The mean of all frames so far."),
                pass::output("mean", "RadianceMean", "The same, and how many frames there were."),
            ],
            // The first three are not read here; but what moves makes the mean worthless (`Moved`).
            scene_bindings: SceneBindings::SCENE
                .and(SceneBindings::CAMERA)
                .and(SceneBindings::LIGHTS)
                .and(SceneBindings::SAMPLE),
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        _: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let texture = || ResourceDesc::texture_2d(Format::Rgba32Float, Extent::like("radiance"));
        let mean = vec![
            ("radiance".to_owned(), texture(), Usage::Overwrites),
            ("progress".to_owned(), progress::buffer(use_cx)?, Usage::Overwrites),
        ];
        Ok(vec![OutputDesc::one("image", texture()), OutputDesc::of("mean", mean)])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let shader = cx.shader(SHADER, &[("PAST", Define::Bool(cx.connected("past")))]);
        Ok(Recording::one(Compute::per_texel(shader, "accumulate", cx.size("radiance"))))
    }
}
