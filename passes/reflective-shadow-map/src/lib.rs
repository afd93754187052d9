//! Reflective shadow maps: what the lights see, and how much of their light it reflects.

use pass::{
    Compute, Define, DepthTarget, Draw, Extent, Format, Info, OutputContext, OutputDesc, Pass, PassTypeError,
    Ports, Raster, RecordContext, Recording, ResourceDesc, SceneBindings, Setting, Settings, Step, Target,
    Threads, Usage, UseContext, Value, output,
};

pub mod cpu_reference;

/// The pass.
pub const PASS: &dyn Pass = &ReflectiveShadowMap;

/// Rasterises the scene from each layer of each light, then computes the reflected flux of every texel.
#[derive(Debug)]
pub struct ReflectiveShadowMap;

const SURFACES: &str = "passes/reflective-shadow-map/surfaces.wgsl";
const FLUX: &str = "passes/reflective-shadow-map/flux.wgsl";

/// Number of layers of the scene's lights: one for a spot or directional light, six for a point light.
fn light_layers(traits: &pass::Traits) -> u32 {
    traits.0.get("light_layers").and_then(Value::as_u32).unwrap_or(0)
}

pass::settings! {
    /// The settings of the pass type `reflective-shadow-map`.
    pub struct ReflectiveShadowMapSettings {
        /// Side of a layer. Larger: sharper shadows and more positions for virtual lights; time and memory
        /// grow with its square.
        size: u32 = 512, min: 1, max: 8192, unit: "px";
    }
}

impl Pass for ReflectiveShadowMap {
    fn info(&self) -> Info {
        Info {
            kind: "reflective-shadow-map",
            about: "Renders what the lights see: position, normal and reflected flux. One layer for a spot or \
                    directional light, six for a point light.",
            paper: "Dachsbacher & Stamminger 2005, §3.1",
            shaders: &[SURFACES, FLUX],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(ReflectiveShadowMapSettings::schema())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: Vec::new(),
            outputs: vec![output("rsm", "ReflectiveShadowMap", "What the lights see.")],
            scene_bindings: SceneBindings::SCENE.and(SceneBindings::LIGHTS),
        })
    }

    fn outputs(
        &self,
        _: &UseContext<'_>,
        outputs: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let size = ReflectiveShadowMapSettings::read(outputs.settings).size;
        let extent = Extent::Fixed(size, size);
        let lit = light_layers(outputs.traits);
        let layers = lit.max(1);
        let array = |format| ResourceDesc::texture_2d_array(format, extent.clone(), layers);
        // Without lights nothing is rendered: there is one layer, which sees nothing.
        let usage = if lit == 0 { Usage::ClearFirst(pass::Clear::Zero) } else { Usage::Overwrites };
        let glossy = outputs.traits.0.get("glossy").and_then(Value::as_bool).unwrap_or(false);
        let members = [
            ("position", Format::Rgba32Float, true),
            ("normal", Format::Rgba16Float, true),
            ("flux", Format::Rgba32Float, true),
            ("albedo", Format::Rgba16Float, true),
            ("specular", Format::Rgba16Float, glossy),
        ];
        let members = members.into_iter().filter(|(_, _, present)| *present);
        let members = members.map(|(name, format, _)| (name.into(), array(format), usage.clone())).collect();
        let mut all = vec![OutputDesc::of("rsm", members)];
        if lit > 0 {
            all.push(OutputDesc::scratch("nearest", ResourceDesc::texture_2d(Format::Depth32Float, extent)));
        }
        Ok(all)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let layers = light_layers(cx.traits);
        let size = ReflectiveShadowMapSettings::read(cx.settings).size;
        let shader = cx.shader(SURFACES, &[("TEXTURED", Define::Bool(cx.trait_bool("textured")))]);
        let draw = |layer: u32, fragment: &str, members: &[&str]| {
            let target = |member: &&str| Target { layer, ..Target::clear(&format!("rsm.{member}")) };
            Step::Raster(Raster {
                shader: shader.clone(),
                vertex: "project".into(),
                fragment: Some(fragment.into()),
                targets: members.iter().map(target).collect(),
                depth: Some(DepthTarget { resource: "nearest".into(), layer: 0, clear: 0.0 }),
                draw: Draw::Scene,
                values: vec![("layer".into(), Value::U32(layer))],
                bind: Vec::new(),
                windows: Vec::new(),
            })
        };
        let mut steps = Vec::new();
        for layer in 0..layers {
            // All that a draw may write: WebGPU guarantees 32 bytes per texel.
            steps.push(draw(layer, "surfaces", &["position", "normal", "albedo"]));
            if cx.has_member("rsm", "specular") {
                steps.push(draw(layer, "specular", &["specular"]));
            }
        }
        if layers > 0 {
            steps.push(Step::Compute(Compute::new(
                cx.shader(FLUX, &[]),
                "flux",
                Threads::Grid([size, size, layers]),
            )));
        }
        Ok(Recording { steps })
    }
}
