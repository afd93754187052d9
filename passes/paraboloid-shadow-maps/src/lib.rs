//! Renders every triangle into a paraboloid depth map a virtual light: the exact baseline of visibility.

pub mod twin;

use pass::setting::{self, SettingExt};
use pass::{
    DepthTarget, Draw, Extent, Externals, Format, Info, KindError, Load, Module, OutputContext, OutputDesc,
    Pass, Ports, Raster, RecordContext, Recording, ResourceDesc, Setting, Settings, Step, Target, UseContext,
    Value,
};

/// The kind `paraboloid-shadow-maps`.
pub const PASS: &dyn Pass = &ParaboloidShadowMaps;

/// Classic shadow maps of all virtual lights.
pub struct ParaboloidShadowMaps;

const SHADER: &str = "passes/paraboloid-shadow-maps/paraboloid-shadow-maps.wgsl";

/// The greatest side of a texture on every adapter: WebGPU's default.
const MAX_SIDE: u32 = 8192;

/// Bias that the depth test needs, in widths of a texel along the receiver's plane: half a diagonal, which is how
/// far a receiver may be from the ray of its texel.
const DEPTH_BIAS: f32 = 0.7;

/// `NOTHING` of shaders/paraboloid.wgsl.
const NOTHING: f64 = 3.0e38;

impl Pass for ParaboloidShadowMaps {
    fn info(&self) -> Info {
        Info {
            kind: "paraboloid-shadow-maps",
            about: "Renders every triangle into a paraboloid depth map a virtual light: the exact baseline.",
            paper: "ISM §5",
            shaders: &[SHADER],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, KindError> {
        Ok(vec![
            setting::u32(
                "map",
                64,
                "Side of a map (ISM compares with 256). Shadows sharpen and time grows with it.",
            )
            .range(1.0, 8192.0)
            .unit("px"),
            setting::f32(
                "depth_bias",
                1.0,
                "Factor on the bias of the depth test that these maps need. Surfaces shadow themselves less and light \
                 leaks more with it.",
            )
            .at_least(0.0),
        ])
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, KindError> {
        Ok(Ports {
            inputs: vec![pass::input(
                "lights",
                "VirtualLights",
                "From where: a map a light, over the hemisphere of its normal.",
            )],
            outputs: vec![pass::output("visibility", "Visibility", "The maps.")],
            externals: Externals::SCENE,
        })
    }

    fn outputs(&self, _: &UseContext<'_>, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, KindError> {
        let tile = cx.settings.u32("map");
        let count = cx.fact("lights", "count").and_then(Value::as_u32).unwrap_or(1).max(1);
        // The narrowest atlas: where texels lie row by row, those of a map are near each other.
        let columns = count.div_ceil(MAX_SIDE / tile);
        if columns.saturating_mul(tile) > MAX_SIDE {
            let most = (MAX_SIDE / tile).pow(2);
            return Err(KindError::setting(
                "map",
                format!("{count} maps of {tile}² do not fit in {MAX_SIDE}² texels"),
            )
            .help(format!("take smaller maps, or at most {most} virtual lights")));
        }
        let size = Extent::Fixed(columns * tile, count.div_ceil(columns) * tile);
        let mut visibility =
            OutputDesc::one("visibility", ResourceDesc::texture_2d(Format::R32Float, size.clone()))
                .module(Module::new("shaders/visibility-atlas.wgsl"))
                .fact("tile", Value::U32(tile))
                .fact("columns", Value::U32(columns))
                .fact("depth_bias", Value::F32(cx.settings.f32("depth_bias") * DEPTH_BIAS));
        visibility.members[0].0 = "atlas".into();
        let nearness = OutputDesc::scratch("nearness", ResourceDesc::texture_2d(Format::Depth32Float, size));
        Ok(vec![visibility, nearness])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, KindError> {
        let Some(vertices) = cx.trait_u32("triangles").checked_mul(3) else {
            return Err(KindError::new("a draw has at most 2³² vertices, a third as many triangles"));
        };
        let maps = Raster {
            shader: cx.shader(SHADER, &[]),
            vertex: "cover".into(),
            fragment: Some("hit".into()),
            targets: vec![Target {
                resource: "visibility.atlas".into(),
                layer: 0,
                load: Load::Clear([NOTHING; 4]),
            }],
            depth: Some(DepthTarget { resource: "nearness".into(), layer: 0, clear: 0.0 }),
            draw: Draw::Vertices { vertices, instances: cx.fact("lights", "count") },
            values: Vec::new(),
            bind: Vec::new(),
        };
        Ok(Recording { steps: vec![Step::Raster(maps)] })
    }
}
