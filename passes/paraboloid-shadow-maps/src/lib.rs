//! Renders every triangle into one paraboloid depth map per virtual light: the exact baseline of visibility.

pub mod cpu_reference;

use interfaces::virtual_lights;
use interfaces::visibility::{AtlasLayout, DepthBias, DepthBiasSettings};
use pass::{
    DepthTarget, Draw, Format, Info, Load, OutputContext, OutputDesc, Pass, PassTypeError, Ports, Raster,
    RecordContext, Recording, ResourceDesc, SceneBindings, Setting, Settings, Step, Target, UseContext,
    Value,
};

/// The pass type `paraboloid-shadow-maps`.
pub const PASS: &dyn Pass = &ParaboloidShadowMaps { side: AtlasLayout::SIDE };

/// Classic shadow maps of all virtual lights.
pub struct ParaboloidShadowMaps {
    /// The greatest side of a layer of the atlas \[px\].
    pub side: u32,
}

const SHADER: &str = "passes/paraboloid-shadow-maps/paraboloid-shadow-maps.wgsl";

/// The depth bias that these maps need. Distances are those of the centres of texels, so a plane needs none; the rest is for
/// surfaces that bend within a texel, and for shading normals, which are not those of the triangles.
const DEPTH_BIAS: DepthBias = DepthBias { depth: 0.2, slope: 0.0 };

pass::settings! {
    /// The settings of the pass type `paraboloid-shadow-maps`, apart from the depth bias of its maps.
    pub struct ParaboloidShadowMapsSettings {
        /// Side of a map (ISM compares with 256). Larger: sharper shadows, but more time.
        map: u32 = 64, min: 1, max: 8192, unit: "px";
    }
}

impl Pass for ParaboloidShadowMaps {
    fn info(&self) -> Info {
        Info {
            kind: "paraboloid-shadow-maps",
            about: "Renders every triangle into one paraboloid depth map per virtual light: the exact baseline.",
            paper: "ISM §5",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = ParaboloidShadowMapsSettings::schema();
        all.extend(DepthBiasSettings::schema());
        Ok(all)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![pass::input(
                "lights",
                "VirtualLights",
                "The lights: one map each, over the hemisphere around its normal.",
            )],
            outputs: vec![pass::output("visibility", "Visibility", "The maps.")],
            scene_bindings: SceneBindings::SCENE,
        })
    }

    fn outputs(&self, _: &UseContext<'_>, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let tile = ParaboloidShadowMapsSettings::read(cx.settings).map;
        let count = cx.fact("lights", virtual_lights::COUNT)?;
        let Some(layout) = AtlasLayout::new(count, tile, self.side) else {
            let (side, layers) = (self.side, AtlasLayout::LAYERS);
            return Err(PassTypeError::setting(
                ParaboloidShadowMapsSettings::map,
                format!("{count} maps of {tile}² do not fit in {layers} layers of {side}² texels"),
            )
            .help(format!(
                "take smaller maps, or at most {} virtual lights",
                AtlasLayout::most(tile, side)
            )));
        };
        let bias = DEPTH_BIAS.times(DepthBiasSettings::read(cx.settings).depth_bias);
        // One layer after the other.
        let nearness = ResourceDesc::texture_2d(Format::Depth32Float, layout.layer_size());
        let nearness = OutputDesc::scratch("nearness", nearness);
        Ok(vec![layout.visibility(bias), nearness])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let Some(vertices) = cx.trait_u32("triangles").checked_mul(3) else {
            return Err(PassTypeError::new("a draw has at most 2³² vertices, a third as many triangles"));
        };
        let count = cx.fact("lights", virtual_lights::COUNT)?;
        let layout = cx.port("visibility").and_then(|port| AtlasLayout::of_facts(&port.facts, count));
        let layout = layout.ok_or_else(|| PassTypeError::new("the atlas has no layout"))?;
        let layer = |layer: u32| {
            Step::Raster(Raster {
                shader: cx.shader(SHADER, &[]),
                vertex: "cover".into(),
                fragment: Some("hit".into()),
                targets: vec![Target {
                    resource: "visibility.atlas".into(),
                    layer,
                    load: Load::Clear([AtlasLayout::NOTHING; 4]),
                }],
                depth: Some(DepthTarget { resource: "nearness".into(), layer: 0, clear: 0.0 }),
                draw: Draw::Vertices { vertices, instances: layout.maps(layer).len() as u32 },
                values: vec![("first_map".into(), Value::U32(layout.maps(layer).start))],
                bind: Vec::new(),
                windows: Vec::new(),
            })
        };
        Ok(Recording { steps: (0..layout.layers()).map(layer).collect() })
    }
}
