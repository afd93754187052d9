//! Renders every triangle into one paraboloid depth map per virtual light: the exact baseline of visibility.

pub mod cpu_reference;

use interfaces::visibility::{AtlasLayout, DepthBias, DepthBiasSettings};
use interfaces::{stands, virtual_lights};
use pass::{
    Compute, Define, DepthTarget, Draw, Format, Info, Load, OutputContext, OutputDesc, Pass, PassTypeError,
    Ports, Raster, RecordContext, Recording, Request, ResourceDesc, SceneBindings, Setting, Settings, Step,
    Struct, Target, Threads, UseContext, Value,
};

/// The pass type `paraboloid-shadow-maps`.
pub const PASS: &dyn Pass = &ParaboloidShadowMaps { side: AtlasLayout::SIDE };

/// Classic shadow maps of all virtual lights.
pub struct ParaboloidShadowMaps {
    /// The greatest side of a layer of the atlas \[px\].
    pub side: u32,
}

const SHADER: &str = "passes/paraboloid-shadow-maps/paraboloid-shadow-maps.wgsl";
const LIST: &str = "passes/paraboloid-shadow-maps/list-moved.wgsl";
const CLEAR: &str = "passes/paraboloid-shadow-maps/clear.wgsl";
const LAYER_DRAWS: Struct = Struct::new("passes/paraboloid-shadow-maps/kept.wgsl", "LayerDraws");

/// Bytes of the arguments of a draw.
const DRAW_BYTES: u64 = 16;

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
            shaders: &[SHADER, LIST, CLEAR],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = ParaboloidShadowMapsSettings::schema();
        all.extend(DepthBiasSettings::schema());
        Ok(all)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                pass::input(
                    "lights",
                    "VirtualLights",
                    "The lights: one map each, over the hemisphere around its normal.",
                ),
                pass::optional(
                    "past",
                    "Visibility",
                    "The maps of the frame before, which are kept where a light stays: `prev` of the output `visibility`, \
                     reset by `Scene`, `Reload`, `Setting` and `Moved`.",
                ),
                pass::optional(
                    "rendered",
                    "Stands",
                    "`prev` of the output `stands`, reset by the same; needed with `past`.",
                ),
            ],
            outputs: vec![
                pass::output("visibility", "Visibility", "The maps."),
                pass::output(
                    "stands",
                    "Stands",
                    "Where the lights stand whose maps these are; zero where maps are not kept.",
                ),
            ],
            scene_bindings: SceneBindings::SCENE,
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let tile = ParaboloidShadowMapsSettings::read(cx.settings).map;
        let count = cx.fact("lights", virtual_lights::COUNT)?;
        let Some(layout) = AtlasLayout::new(count, tile, self.side) else {
            let (side, layers) = (self.side, AtlasLayout::LAYERS);
            return Err(PassTypeError::setting(
                ParaboloidShadowMapsSettings::map,
                format!("{count} maps of {tile}² do not fit in {layers} layers of {side}² texels"),
            )
            .help("take smaller maps")
            .limit(
                "lights",
                virtual_lights::COUNT,
                AtlasLayout::most(tile, side),
                "virtual lights",
            ));
        };
        let bias = DEPTH_BIAS.times(DepthBiasSettings::read(cx.settings).depth_bias);
        // One layer after the other.
        let nearness = ResourceDesc::texture_2d(Format::Depth32Float, layout.layer_size());
        let nearness = OutputDesc::scratch("nearness", nearness);
        let mut maps = layout.visibility(bias);
        let mut stands = stands::output(use_cx, "stands", count)?;
        let mut outputs = vec![nearness];
        let list =
            |name: &str, length: u32| OutputDesc::scratch(name, ResourceDesc::buffer(4 * u64::from(length)));
        match [cx.input("past"), cx.input("rendered")].map(|input| input.is_some()) {
            [true, true] => {
                maps = maps.continuing("past");
                outputs.push(list("moved", count));
                outputs.push(list("begins", layout.layers()));
                outputs.push(OutputDesc::scratch(
                    "draws",
                    use_cx.buffer(LAYER_DRAWS, u64::from(layout.layers()))?,
                ));
            }
            [false, false] => stands = stands.cleared(),
            _ => {
                let said = "maps are kept by two links, `past` and `rendered`: one of them is missing";
                return Err(PassTypeError::new(said));
            }
        }
        outputs.extend([maps, stands]);
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let Some(vertices) = cx.trait_u32("triangles").checked_mul(3) else {
            return Err(PassTypeError::new("a draw has at most 2³² vertices, a third as many triangles"));
        };
        let count = cx.fact("lights", virtual_lights::COUNT)?;
        let layout = cx.port("visibility").and_then(|port| AtlasLayout::of_facts(&port.facts, count));
        let layout = layout.ok_or_else(|| PassTypeError::new("the atlas has no layout"))?;
        if cx.connected("past") {
            return Ok(kept(cx, layout, vertices));
        }
        let steps = (0..layout.layers()).map(|layer| {
            let draw = Draw::Vertices { vertices, instances: layout.maps(layer).len() as u32 };
            let load = Load::Clear([AtlasLayout::NOTHING; 4]);
            let first_map = ("first_map", layout.maps(layer).start);
            Step::Raster(scene_into(
                cx.shader(SHADER, &[("KEPT", Define::Bool(false))]),
                layer,
                load,
                draw,
                first_map,
            ))
        });
        Ok(Recording { steps: steps.collect() })
    }
}

/// The draw of the scene into the maps of a layer.
fn scene_into(shader: Request, layer: u32, load: Load, draw: Draw, value: (&str, u32)) -> Raster {
    Raster {
        shader,
        vertex: "cover".into(),
        fragment: Some("hit".into()),
        targets: vec![Target { resource: "visibility.atlas".into(), layer, load }],
        depth: Some(DepthTarget { resource: "nearness".into(), layer: 0, clear: 0.0 }),
        draw,
        values: vec![(value.0.into(), Value::U32(value.1))],
        bind: Vec::new(),
        windows: Vec::new(),
    }
}

/// The steps where maps are kept: those of lights that moved are listed, cleared and rendered.
fn kept(cx: &RecordContext<'_>, layout: AtlasLayout, vertices: u32) -> Recording {
    let list = Compute::new(cx.shader(LIST, &[]), "list", Threads::Row(1))
        .value("maps_of_layer", Value::U32(layout.maps_of_layer()))
        .value("vertices", Value::U32(vertices));
    let mut recording = Recording::one(list);
    for layer in 0..layout.layers() {
        let draw = |which: u64| Draw::Indirect {
            buffer: "draws".into(),
            offset: DRAW_BYTES * (2 * u64::from(layer) + which),
        };
        let scene = cx.shader(SHADER, &[("KEPT", Define::Bool(true))]);
        let scene = scene_into(scene, layer, Load::Keep, draw(1), ("layer", layer));
        let clear = Raster {
            shader: cx.shader(CLEAR, &[]),
            vertex: "square".into(),
            fragment: Some("nothing".into()),
            depth: None,
            draw: draw(0),
            ..scene.clone()
        };
        recording.steps.extend([Step::Raster(clear), Step::Raster(scene)]);
    }
    recording
}
