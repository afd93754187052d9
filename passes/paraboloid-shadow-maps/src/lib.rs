#![doc = include_str!("../README.md")]

use interfaces::virtual_lights;
use interfaces::visibility::AtlasLayout;
use pass::{
    Compute, Draw, Format, Load, OutputContext, OutputDesc, Pass, PassTypeError, Raster, ReadSettings,
    RecordContext, Recording, Request, ResourceDesc, Step, Struct, Target, Threads, UseContext, reflected,
};

/// The pass type `paraboloid-shadow-maps`.
pub const PASS: &dyn Pass = &ParaboloidShadowMaps { side: AtlasLayout::SIDE };

/// Classic shadow maps of all virtual lights.
pub struct ParaboloidShadowMaps {
    /// The greatest side of a layer of the atlas \[px\].
    pub side: u32,
}

const LAYER_DRAWS: Struct = Struct::new("passes/paraboloid-shadow-maps/kept.wgsl", "LayerDraws");

/// Texels of a map for each triangle of the scene below which rays are faster, with a margin: on llvmpipe by three times where there
/// are four (study `growth-triangles`).
const TEXELS_FOR_TRIANGLE: u64 = 8;

/// Bytes of the arguments of a draw.
const DRAW_BYTES: u64 = 16;

impl Pass for ParaboloidShadowMaps {
    fn kind(&self) -> &'static str {
        "paraboloid-shadow-maps"
    }

    fn files(&self) -> pass::Files {
        pass::files!()
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let tile = cx.settings.u32("map")?;
        let count = cx.fact("lights", virtual_lights::COUNT)?;
        let Some(layout) = AtlasLayout::new(count, tile, self.side) else {
            let (side, layers) = (self.side, AtlasLayout::LAYERS);
            let message = format!("{count} maps of {tile}² do not fit in {layers} layers of {side}² texels");
            return Err(PassTypeError::setting("map", message).help("take smaller maps").limit(
                "lights",
                virtual_lights::COUNT,
                AtlasLayout::most(tile, side),
                "virtual lights",
            ));
        };
        let main = self.main_shader(&cx.use_)?;
        let mut outputs = reflected::outputs_with(use_cx, &main, cx, &layout.values())?;
        match [cx.input("past"), cx.input("rendered")].map(|input| input.is_some()) {
            [true, true] => outputs.extend([
                OutputDesc::scratch_u32("moved", count),
                OutputDesc::scratch_u32("begins", layout.layers()),
                OutputDesc::scratch("groups", ResourceDesc::buffer(16)),
                OutputDesc::scratch("draws", use_cx.buffer(LAYER_DRAWS, layout.layers().into())?),
            ]),
            [false, false] => {}
            _ => {
                let said = "maps are kept by two links, `past` and `rendered`: one of them is missing";
                return Err(PassTypeError::new(said));
            }
        }
        let nearness = ResourceDesc::texture_2d(Format::Depth32Float, layout.layer_size());
        outputs.push(OutputDesc::scratch("nearness", nearness));
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let count = cx.fact("lights", virtual_lights::COUNT)?;
        let layout = cx.port("visibility").and_then(|port| AtlasLayout::of_facts(&port.facts, count));
        let layout = layout.ok_or_else(|| PassTypeError::new("the atlas has no layout"))?;
        if is_traced(cx)? {
            return traced(cx, layout);
        }
        let Some(vertices) = cx.trait_u32("triangles").checked_mul(3) else {
            return Err(PassTypeError::new("a draw has at most 2³² vertices, a third as many triangles"));
        };
        if cx.connected("past") {
            return kept(cx, layout);
        }
        let steps = (0..layout.layers()).map(|layer| {
            let draw = Draw::Vertices { vertices, instances: layout.maps(layer).len() as u32 };
            let load = Load::Clear([AtlasLayout::NOTHING; 4]);
            let first_map = ("first_map", layout.maps(layer).start);
            Step::Raster(scene_into(cx.file("paraboloid-shadow-maps.wgsl"), layer, load, draw, first_map))
        });
        Ok(Recording { steps: steps.collect() })
    }
}

/// Returns whether a ray is traced for each texel.
fn is_traced(cx: &RecordContext<'_>) -> Result<bool, PassTypeError> {
    let texels = u64::from(cx.settings.u32("map")?).pow(2);
    Ok(match cx.settings.text("method")? {
        "auto" => u64::from(cx.trait_u32("triangles")) * TEXELS_FOR_TRIANGLE > texels,
        method => method == "traced",
    })
}

/// The steps that trace rays.
fn traced(cx: &RecordContext<'_>, layout: AtlasLayout) -> Result<Recording, PassTypeError> {
    let group = threads_of_group(cx)?;
    let groups = groups_of_map(cx)?;
    let trace =
        |threads| Compute::new(cx.file("trace.wgsl"), "trace_maps", threads).value("groups_of_map", groups);
    if cx.connected("past") {
        let threads = Threads::Indirect { buffer: "groups".into(), offset: 0 };
        return Ok(Recording::one(list_moved(cx, layout)?).then(trace(threads)));
    }
    // The rest of the last layer after the last map holds nothing.
    let layers = (0..layout.layers()).map(|layer| {
        let (first, maps) = (layout.maps(layer).start, layout.maps_of_layer());
        let threads = Threads::Row((maps * groups).saturating_mul(group));
        trace(threads).value("first_map", first).value("end_map", first + maps)
    });
    Ok(Recording::of(layers))
}

/// Returns the number of threads of a workgroup that traces rays.
fn threads_of_group(cx: &RecordContext<'_>) -> Result<u32, PassTypeError> {
    cx.use_context().constant("passes/paraboloid-shadow-maps/trace.wgsl", "GROUP")
}

/// Returns the number of workgroups that trace the rays of a map.
fn groups_of_map(cx: &RecordContext<'_>) -> Result<u32, PassTypeError> {
    Ok(cx.settings.u32("map")?.pow(2).div_ceil(threads_of_group(cx)?))
}

/// The step that lists the maps to render, for draws and for rays.
fn list_moved(cx: &RecordContext<'_>, layout: AtlasLayout) -> Result<Compute, PassTypeError> {
    Ok(Compute::new(cx.file("list-moved.wgsl"), "list", Threads::Row(1))
        .value("maps_of_layer", layout.maps_of_layer())
        .value("vertices", cx.trait_u32("triangles").saturating_mul(3))
        .value("groups_of_map", groups_of_map(cx)?))
}

/// The draw of the scene into the maps of a layer.
fn scene_into(shader: Request, layer: u32, load: Load, draw: Draw, value: (&str, u32)) -> Raster {
    let targets = vec![Target { resource: "visibility.atlas".into(), layer, load }];
    Raster::new(shader, "cover", "hit", targets, draw).depth("nearness").value(value.0, value.1)
}

/// The steps where maps are kept: those of lights that moved are listed, cleared and rendered.
fn kept(cx: &RecordContext<'_>, layout: AtlasLayout) -> Result<Recording, PassTypeError> {
    let mut recording = Recording::one(list_moved(cx, layout)?);
    for layer in 0..layout.layers() {
        let draw = |which: u64| Draw::Indirect {
            buffer: "draws".into(),
            offset: DRAW_BYTES * (2 * u64::from(layer) + which),
        };
        let scene =
            scene_into(cx.file("paraboloid-shadow-maps.wgsl"), layer, Load::Keep, draw(1), ("layer", layer));
        let clear = Raster {
            shader: cx.file("clear.wgsl"),
            vertex: "square".into(),
            fragment: Some("nothing".into()),
            depth: None,
            draw: draw(0),
            ..scene.clone()
        };
        recording.steps.extend([Step::Raster(clear), Step::Raster(scene)]);
    }
    Ok(recording)
}
