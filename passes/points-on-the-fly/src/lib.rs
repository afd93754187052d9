//! Triangles amplified into points when they are wanted, and stored nowhere.

pub mod cpu_reference;

use gpu_algorithms::{reduce, scan};
use pass::setting::{self, SettingExt};
use pass::{
    Compute, Define, Info, Module, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext,
    Recording, ResourceDesc, SceneBindings, Setting, Settings, Threads, UseContext, Value, output,
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

/// Bytes of struct Amplification without its array.
const HEADER_BYTES: u64 = 16;
/// Bytes of struct Bounds.
const BOUNDS_BYTES: u64 = 16;
/// Bytes of a weight.
const WEIGHT_BYTES: u64 = 4;

impl Pass for PointsOnTheFly {
    fn info(&self) -> Info {
        Info {
            kind: "points-on-the-fly",
            about: "Triangles amplified into points when they are wanted, and stored nowhere.",
            paper: "TCAS §5.2, ACRSM §5.2",
            shaders: &[BOUNDS, SUM, SHARE, GUIDE],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        let rule = "How many points a triangle has. `area`: its share of the area, of any number. `tessellation`: \
                    those of a tessellator whose levels rise with edges and area (ACRSM Eq. 5.3-5.4), so small \
                    triangles have more than their share; a number of its own, of which no more are made than fit.";
        let factor = |which: &str, more: &str| {
            format!(
                "{which} level of edges and inside, with the rule `tessellation` (ACRSM Alg. 5.2). {more}"
            )
        };
        let least = factor("Least", "Points of small triangles, and so of all, rise with it.");
        let greatest = factor("Greatest", "Points of large triangles rise with its square.");
        Ok(vec![
            setting::choice("rule", &["area", "tessellation"], rule),
            setting::u32("min_factor", 5, &least).range(1.0, 64.0),
            setting::u32("max_factor", 64, &greatest).range(1.0, 64.0),
        ])
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

    fn outputs(&self, _: &UseContext<'_>, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let triangles = cx.traits.0.get("triangles").and_then(Value::as_u32).unwrap_or(0);
        let guide = (1 << guide_bits(triangles)) + 1;
        let bytes = HEADER_BYTES + 4 * (u64::from(triangles) + 1 + guide);
        let mut outputs = vec![
            OutputDesc::one("points", ResourceDesc::buffer(bytes.next_multiple_of(16)))
                .module(Module::new(MODULE))
                .fact("count", Value::U32(if triangles > 0 { u32::MAX } else { 0 }))
                .fact("block", Value::U32(cpu_reference::BLOCK)),
            OutputDesc::scratch("total_weight", ResourceDesc::buffer(WEIGHT_BYTES)),
            reduce::scratch("weight_blocks", triangles, WEIGHT_BYTES),
        ];
        outputs.extend(scan::scratch("share_sums", triangles));
        if tessellates(cx.settings) {
            outputs.push(OutputDesc::scratch("bounds", ResourceDesc::buffer(BOUNDS_BYTES)));
            outputs.push(reduce::scratch("bounds_blocks", triangles, BOUNDS_BYTES));
        }
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let triangles = cx.trait_u32("triangles");
        let tessellates = tessellates(cx.settings);
        let defines = [("TESSELLATION", Define::Bool(tessellates))];
        let bounds = tessellates
            .then(|| reduce::steps(&cx.shader(BOUNDS, &[]), triangles, "bounds_blocks"))
            .into_iter()
            .flatten();
        let sum = reduce::steps(&cx.shader(SUM, &defines), triangles, "weight_blocks");
        let shares = scan::steps(&cx.shader(SHARE, &defines), triangles, "share_sums");
        let entries = (1 << guide_bits(triangles)) + 1;
        let guide = Compute::new(cx.shader(GUIDE, &[]), "guide", Threads::Row(entries));
        let with_guide = |step: Compute| step.value("guide_bits", Value::U32(guide_bits(triangles)));
        Ok(Recording::of(bounds.chain(sum))
            .then_all(shares.into_iter().map(with_guide))
            .then(with_guide(guide)))
    }
}

fn tessellates(settings: &Settings) -> bool {
    settings.text("rule") == "tessellation"
}

/// Binary logarithm of the entries of the guide: about as many as triangles.
fn guide_bits(triangles: u32) -> u32 {
    triangles.max(1).ilog2().min(20)
}
