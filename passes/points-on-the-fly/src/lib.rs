//! Amplifies triangles into on-the-fly points, which are generated where they are read and stored nowhere.

pub mod cpu_reference;

use gpu_algorithms::{reduce, scan};
use interfaces::points;
use pass::{
    Compute, Define, Info, Module, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext,
    Recording, ResourceDesc, SceneBindings, Setting, Settings, Struct, Threads, UseContext, Value, output,
    setting,
};

/// The pass, for the catalog.
pub const PASS: &dyn Pass = &PointsOnTheFly;

/// See the crate.
pub struct PointsOnTheFly;

const BOUNDS: &str = "passes/points-on-the-fly/bounds.wgsl";
const SUM: &str = "passes/points-on-the-fly/sum.wgsl";
const SHARE: &str = "passes/points-on-the-fly/share.wgsl";
const GUIDE: &str = "passes/points-on-the-fly/guide.wgsl";
const MODULE: &str = "shaders/points-on-the-fly.wgsl";

const AMPLIFICATION: Struct = Struct::new("shaders/amplification.wgsl", "Amplification");
const BOUNDS_OF_SCENE: Struct = Struct::new(BOUNDS, "Bounds");
/// Bytes of a weight, a f32.
const WEIGHT_BYTES: u64 = 4;

/// The most maps whose samples neighbouring threads generate in turn, so that this many threads work on
/// nearby triangles. A power of two.
pub const BLOCK: u32 = 32;

pass::choice! {
    /// How many points a triangle gets.
    pub enum Rule {
        /// In proportion to its area.
        Area = "area",
        /// The number of vertices of its tessellation.
        Tessellation = "tessellation",
    }
}

pass::settings! {
    /// The settings of the pass type `points-on-the-fly` that are not the shaders' alone.
    pub struct PointsOnTheFlySettings {
        /// How many points a triangle gets. area: in proportion to its area; the total is as many as are
        /// requested. tessellation: as many as the vertices of a tessellator whose levels rise with edges and
        /// area (ACRSM Eq. 5.3-5.4), so that small triangles get more than in proportion to their area; the
        /// total follows from the scene, and is cut to the points that fit.
        rule: Rule = Rule::Area;
    }
}

impl Pass for PointsOnTheFly {
    fn info(&self) -> Info {
        Info {
            kind: "points-on-the-fly",
            about: "Generates on-the-fly points: triangles are amplified into points while these are splatted.",
            paper: "TCAS §5.2, ACRSM §5.2",
            shaders: &[BOUNDS, SUM, SHARE, GUIDE],
        }
    }

    fn settings(&self, cx: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let mut all = PointsOnTheFlySettings::schema();
        all.extend(setting::of_shader(cx.shaders, SUM)?);
        Ok(all)
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            outputs: vec![output(
                "points",
                "Points",
                "Each triangle's share of the points, and the module that makes them of it.",
            )],
            scene_bindings: SceneBindings::SCENE,
            ..Ports::default()
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let triangles = cx.traits.0.get("triangles").and_then(Value::as_u32).unwrap_or(0);
        let guide = (1 << guide_bits(triangles)) + 1;
        let points = use_cx.buffer(AMPLIFICATION, u64::from(triangles) + 1 + guide)?;
        let mut outputs = vec![
            OutputDesc::one("points", points)
                .module(Module::new(MODULE))
                .fact(points::COUNT, if triangles > 0 { u32::MAX } else { 0 })
                .fact(points::BLOCK, BLOCK),
            OutputDesc::scratch("total_weight", ResourceDesc::buffer(WEIGHT_BYTES)),
            reduce::scratch(use_cx, "weight_blocks", triangles, WEIGHT_BYTES)?,
        ];
        outputs.extend(scan::scratch(use_cx, "share_sums", triangles)?);
        if tessellates(cx.settings) {
            outputs.push(OutputDesc::scratch("bounds", use_cx.buffer(BOUNDS_OF_SCENE, 1)?));
            outputs.push(reduce::scratch(
                use_cx,
                "bounds_blocks",
                triangles,
                use_cx.size_of(BOUNDS_OF_SCENE)?,
            )?);
        }
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let (use_cx, triangles) = (cx.use_context(), cx.trait_u32("triangles"));
        let tessellates = tessellates(cx.settings);
        let defines = [("TESSELLATION", Define::Bool(tessellates))];
        let bounds = tessellates
            .then(|| reduce::steps(&use_cx, &cx.shader(BOUNDS, &[]), triangles, "bounds_blocks"))
            .transpose()?
            .into_iter()
            .flatten();
        let sum = reduce::steps(&use_cx, &cx.shader(SUM, &defines), triangles, "weight_blocks")?;
        let shares = scan::steps(&use_cx, &cx.shader(SHARE, &defines), triangles, "share_sums")?;
        let entries = (1 << guide_bits(triangles)) + 1;
        let guide = Compute::new(cx.shader(GUIDE, &[]), "guide", Threads::Row(entries));
        let with_guide = |step: Compute| step.value("guide_bits", Value::U32(guide_bits(triangles)));
        Ok(Recording::of(bounds.chain(sum))
            .then_all(shares.into_iter().map(with_guide))
            .then(with_guide(guide)))
    }
}

fn tessellates(settings: &Settings) -> bool {
    PointsOnTheFlySettings::read(settings).rule == Rule::Tessellation
}

/// Binary logarithm of the number of entries of the guide table, which is about the number of triangles.
fn guide_bits(triangles: u32) -> u32 {
    triangles.max(1).ilog2().min(20)
}
