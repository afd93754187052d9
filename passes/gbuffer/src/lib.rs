//! The geometry buffer: what the camera sees at each pixel.

use pass::{
    Define, DepthTarget, Draw, Extent, Format, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports,
    Raster, RecordContext, Recording, ResourceDesc, SceneBindings, Setting, Settings, Step, Target, Usage,
    UseContext, Value, output,
};

pub mod cpu_reference;

/// The pass.
pub const PASS: &dyn Pass = &Gbuffer;

/// Rasterises the scene from the camera.
#[derive(Debug)]
pub struct Gbuffer;

const GEOMETRY: &str = "passes/gbuffer/gbuffer.wgsl";
const MOTION: &str = "passes/gbuffer/motion.wgsl";

pass::choice! {
    /// What a component of a normal is stored in.
    pub enum Normals {
        /// 16-bit floats.
        Half = "half",
        /// 32-bit floats.
        Full = "full",
    }
}

pass::settings! {
    /// The settings of the pass type `gbuffer`.
    pub struct GbufferSettings {
        /// Whether the G-buffer has the member `motion`, which takes one more draw over the frame. The scene
        /// is assumed to stand still: only the camera moves.
        motion: bool = false;
        /// What a normal is stored in. half: 8 bytes, to a thousandth. full: 16 bytes, to ten millionths; a glossy scene is
        /// drawn once more.
        normals: Normals = Normals::Half;
    }
}

fn full_normals(settings: &Settings) -> bool {
    GbufferSettings::read(settings).normals == Normals::Full
}

impl Pass for Gbuffer {
    fn info(&self) -> Info {
        Info {
            kind: "gbuffer",
            about: "Renders what the camera sees: depth, normal and material at each pixel.",
            paper: "",
            shaders: &[GEOMETRY, MOTION],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(GbufferSettings::schema())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: Vec::new(),
            outputs: vec![output("view", "GBuffer", "What the camera sees.")],
            scene_bindings: SceneBindings::SCENE.and(SceneBindings::CAMERA),
        })
    }

    fn outputs(
        &self,
        _: &UseContext<'_>,
        outputs: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let has = |name: &str| outputs.traits.0.get(name).and_then(Value::as_bool).unwrap_or(false);
        let members = [
            ("depth", Format::R32Float, true),
            (
                "normal",
                if full_normals(outputs.settings) { Format::Rgba32Float } else { Format::Rgba16Float },
                true,
            ),
            ("albedo", Format::Rgba16Float, true),
            ("specular", Format::Rgba16Float, has("glossy")),
            ("emission", Format::Rgba32Float, has("emissive")),
            ("motion", Format::Rg32Float, GbufferSettings::read(outputs.settings).motion),
        ];
        let texture = |format| ResourceDesc::texture_2d(format, Extent::FRAME);
        let members = members.into_iter().filter(|(_, _, present)| *present);
        let members = members.map(|(name, format, _)| (name.into(), texture(format), Usage::Overwrites));
        let view = OutputDesc::of("view", members.collect());
        Ok(vec![view, OutputDesc::scratch("nearest", texture(Format::Depth32Float))])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let has = |member: &str| cx.has_member("view", member);
        let draw = |path: &str, defines: &[(&str, Define)], fragment: &str, members: &[&str]| Raster {
            shader: cx.shader(path, defines),
            vertex: "project".into(),
            fragment: Some(fragment.into()),
            targets: members.iter().map(|member| Target::clear(&format!("view.{member}"))).collect(),
            depth: Some(DepthTarget { resource: "nearest".into(), layer: 0, clear: 0.0 }),
            draw: Draw::Scene,
            values: Vec::new(),
            bind: Vec::new(),
            windows: Vec::new(),
        };
        let specular = has("specular");
        // WebGPU guarantees 32 bytes per pixel for the targets of one draw.
        let with_specular = specular && !full_normals(cx.settings);
        let defines = [
            ("TEXTURED", Define::Bool(cx.trait_bool("textured"))),
            ("SPECULAR", Define::Bool(with_specular)),
        ];
        let members: &[&str] = if with_specular {
            &["depth", "normal", "albedo", "specular"]
        } else {
            &["depth", "normal", "albedo"]
        };
        let mut steps = vec![Step::Raster(draw(GEOMETRY, &defines, "geometry", members))];
        if specular && !with_specular {
            steps.push(Step::Raster(draw(GEOMETRY, &defines, "specular", &["specular"])));
        }
        if has("emission") {
            steps.push(Step::Raster(draw(GEOMETRY, &defines, "emission", &["emission"])));
        }
        if has("motion") {
            let motion = draw(MOTION, &[], "motion", &["motion"]);
            steps.push(Step::Raster(Raster {
                vertex: "fullscreen".into(),
                draw: Draw::Fullscreen,
                depth: None,
                ..motion
            }));
        }
        Ok(Recording { steps })
    }
}
