#![doc = include_str!("../README.md")]

use pass::{
    Clear, Compute, DepthTarget, Draw, Extent, Format, OutputContext, OutputDesc, Pass, PassTypeError,
    Raster, ReadSettings, RecordContext, Recording, ResourceDesc, Step, Target, Threads, Traits, Usage,
    UseContext, Value, reflected,
};

/// The pass type `reflective-shadow-map`.
pub const PASS: &dyn Pass = &ReflectiveShadowMap;

struct ReflectiveShadowMap;

/// Returns the number of layers of the scene's lights: one for a spot or directional light, six for a point light.
fn light_layers(traits: &Traits) -> u32 {
    traits.0.get("light_layers").and_then(Value::as_u32).unwrap_or(0)
}

impl Pass for ReflectiveShadowMap {
    fn kind(&self) -> &'static str {
        "reflective-shadow-map"
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let mut outputs = reflected::outputs(use_cx, &self.main_shader(&cx.use_)?, cx)?;
        if light_layers(cx.traits) == 0 {
            // Nothing is rendered: there is one layer, which sees nothing.
            for (_, _, usage) in &mut outputs[0].members {
                *usage = Usage::ClearFirst(Clear::Zero);
            }
            return Ok(outputs);
        }
        let side = cx.settings.u32("size")?;
        let nearest = ResourceDesc::texture_2d(Format::Depth32Float, Extent::Fixed(side, side));
        outputs.push(OutputDesc::scratch("nearest", nearest));
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let layers = light_layers(cx.traits);
        let shader = cx.file("reflective-shadow-map.wgsl");
        let draw = |layer: u32, fragment: &str, members: &[&str]| {
            let target = |member: &&str| Target { layer, ..Target::clear(&format!("rsm.{member}")) };
            Step::Raster(Raster {
                shader: shader.clone(),
                vertex: "project".into(),
                fragment: Some(fragment.into()),
                targets: members.iter().map(target).collect(),
                depth: Some(DepthTarget { resource: "nearest".into(), layer: 0, clear: 0.0 }),
                draw: Draw::Scene,
                values: vec![("layer".into(), layer.into())],
                bind: Vec::new(),
                windows: Vec::new(),
            })
        };
        let mut recording = Recording::default();
        for layer in 0..layers {
            recording.steps.push(draw(layer, "surfaces", &["position", "normal", "albedo"]));
            if cx.has_member("rsm", "specular") {
                recording.steps.push(draw(layer, "rsm_specular", &["specular"]));
            }
        }
        if layers > 0 {
            let (width, height) = cx.size("rsm");
            recording = recording.then(Compute::new(shader, "flux", Threads::Grid([width, height, layers])));
        }
        Ok(recording)
    }
}
