//! Triangles amplified into points when they are wanted, and stored nowhere.

pub mod twin;

use pass::setting::{self, SettingExt};
use pass::{
    Compute, Define, Externals, Info, KindError, OutputContext, OutputDesc, Pass, Ports, RecordContext,
    Recording, ResourceDesc, Setting, Settings, Threads, UseContext, Value, output,
};

/// The pass, for the catalog.
pub const PASS: &dyn Pass = &PointsOnTheFly;

/// See the crate.
pub struct PointsOnTheFly;

const AMPLIFY: &str = "passes/points-on-the-fly/amplify.wgsl";
const MODULE: &str = "shaders/points-on-the-fly.wgsl";

/// Threads of a workgroup: SCAN_SIZE of shaders/prefix-sum.wgsl.
const SCAN_SIZE: u32 = 256;
/// Triangles of a workgroup: RUN of amplify.wgsl for each thread.
const GROUP_SIZE: u32 = 8 * SCAN_SIZE;
/// Bytes of struct Amplification without its array.
const HEADER_BYTES: u64 = 16;
/// Bytes of struct Part.
const PART_BYTES: u64 = 24;

impl Pass for PointsOnTheFly {
    fn info(&self) -> Info {
        Info {
            kind: "points-on-the-fly",
            about: "Triangles amplified into points when they are wanted, and stored nowhere.",
            paper: "TCAS §5.2, ACRSM §5.2",
            shaders: &[AMPLIFY],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, KindError> {
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

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, KindError> {
        Ok(Ports {
            outputs: vec![output(
                "points",
                "Points",
                "Each triangle's share of the points, and the module that makes them of it.",
            )],
            externals: Externals::SCENE,
            ..Ports::default()
        })
    }

    fn outputs(&self, _: &UseContext<'_>, cx: &OutputContext<'_>) -> Result<Vec<OutputDesc>, KindError> {
        let triangles = cx.traits.0.get("triangles").and_then(Value::as_u32).unwrap_or(0);
        let groups = u64::from(triangles.div_ceil(GROUP_SIZE).max(1));
        let guide = (1 << guide_bits(triangles)) + 1;
        let bytes = HEADER_BYTES + 4 * (u64::from(triangles) + 1 + guide);
        Ok(vec![
            OutputDesc::one("points", ResourceDesc::buffer(bytes.next_multiple_of(16)))
                .fact("module", Value::Text(MODULE.into()))
                .fact("count", Value::U32(if triangles > 0 { u32::MAX } else { 0 }))
                .fact("block", Value::U32(twin::BLOCK)),
            OutputDesc::scratch("parts", ResourceDesc::buffer(PART_BYTES * (groups + 1))),
            OutputDesc::scratch("blocks", ResourceDesc::buffer(4 * groups)),
        ])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, KindError> {
        let triangles = cx.trait_u32("triangles");
        let groups = triangles.div_ceil(GROUP_SIZE).max(1);
        let tessellated = cx.settings.text("rule") == "tessellation";
        let shader = cx.shader(AMPLIFY, &[("TESSELLATION", Define::Bool(tessellated))]);
        let step = |entry: &str, threads: u32| {
            Compute::new(shader.clone(), entry, Threads::Row(threads))
                .value("groups", Value::U32(groups))
                .value("guide_bits", Value::U32(guide_bits(triangles)))
        };
        let all = groups * SCAN_SIZE;
        let mut recording = Recording::one(step("measure", all)).then(step("sum_up", SCAN_SIZE));
        if tessellated {
            recording = recording.then(step("count", all)).then(step("sum_up", SCAN_SIZE));
        }
        let guide = (1 << guide_bits(triangles)) + 1;
        Ok(recording
            .then(step("share", all))
            .then(step("offset", SCAN_SIZE))
            .then(step("place", triangles))
            .then(step("guide", guide)))
    }
}

/// Binary logarithm of the entries of the guide: about as many as triangles.
fn guide_bits(triangles: u32) -> u32 {
    triangles.max(1).ilog2().min(20)
}
