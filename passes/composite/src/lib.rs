//! Adds up what the camera receives, and maps it to a screen.

use pass::{
    Compute, Define, Extent, Format, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports,
    RecordContext, Recording, ResourceDesc, SceneBindings, Setting, Settings, UseContext, input, optional,
    output, setting,
};

pub mod cpu_reference;

/// The pass.
pub const PASS: &dyn Pass = &Composite;

/// Direct light + albedo/π × indirect irradiance + glossy light + emission.
#[derive(Debug)]
pub struct Composite;

const LIGHT: &str = "passes/composite/composite.wgsl";
const SCREEN: &str = "passes/composite/display.wgsl";

impl Pass for Composite {
    fn info(&self) -> Info {
        Info {
            kind: "composite",
            about: "Composes the picture: direct, indirect and glossy light and emission, linear and for a screen.",
            paper: "tone mapping: Reinhard et al. 2002, Eq. 3-4; Hable 2010; Narkowicz 2015",
            shaders: &[LIGHT, SCREEN],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = setting::of_options(cx.shaders, SCREEN, &["TONEMAP"])?;
        all.extend(setting::of_shader(cx.shaders, SCREEN)?);
        Ok(all)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                input("view", "GBuffer", "The surfaces: albedo, and emission where it has it."),
                optional("direct", "Radiance", "Direct light."),
                optional("indirect", "Irradiance", "Indirect irradiance, reflected here by the albedo."),
                optional("glossy", "Radiance", "Indirect light that surfaces reflect specularly."),
            ],
            outputs: vec![
                output("image", "Radiance", "All light."),
                output(
                    "indirect_radiance",
                    "Radiance",
                    "Neither direct nor emitted: albedo/π × irradiance + glossy.",
                ),
                output("display", "Display", "All light, for a screen."),
            ],
            scene_bindings: SceneBindings::NONE,
        })
    }

    fn outputs(
        &self,
        _: &UseContext<'_>,
        outputs: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let size = outputs.input("view").and_then(|view| view.size());
        for input in outputs.inputs.iter().filter(|input| input.name != "view") {
            if let (Some((w, h)), Some((width, height))) = (input.size(), size)
                && (w, h) != (width, height)
            {
                let message = format!("`{}` is {w}×{h}, but the G-buffer is {width}×{height}", input.name);
                return Err(PassTypeError::input(&input.name, message)
                    .help("a filter that takes the G-buffer brings it to its size"));
            }
        }
        let texture = |port: &str, format| {
            OutputDesc::one(port, ResourceDesc::texture_2d(format, Extent::like("view")))
        };
        Ok(vec![
            texture("image", Format::Rgba32Float),
            texture("indirect_radiance", Format::Rgba32Float),
            texture("display", Format::Rgba8Unorm),
        ])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let connected = |port: &str| Define::Bool(cx.connected(port));
        let defines = [
            ("DIRECT", connected("direct")),
            ("INDIRECT", connected("indirect")),
            ("GLOSSY", connected("glossy")),
            ("EMISSION", Define::Bool(cx.has_member("view", "emission"))),
            ("INDIRECT_RADIANCE", connected("indirect_radiance")),
        ];
        let size = cx.size("view");
        let mut recording = Recording::one(Compute::per_texel(cx.shader(LIGHT, &defines), "composite", size));
        if cx.connected("display") {
            let shader = cx.shader(SCREEN, &[cx.option("TONEMAP")]);
            let show = Compute::per_texel(shader, "show", size);
            recording = recording.then(show.bind("radiance", "image"));
        }
        Ok(recording)
    }
}
