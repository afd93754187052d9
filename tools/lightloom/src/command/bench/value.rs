//! The time from a value that a slider sets to the next frame.

use super::Bench;
use super::graph::milliseconds;
use super::table::{Goal, Row, Section, Spread};
use anyhow::Result;
use frame_graph::{Overrides, Value};
use renderer::Renderer;
use std::sync::Arc;
use std::time::Instant;

const PIPELINE: &str = "ism-invtm";

/// Factor of the number of runs.
const REPEATS: u32 = 20;

/// Settings of [`PIPELINE`], two values of each, the extent of their effect, and whether sizes stay the same.
const SETTINGS: [(&str, [Value; 2], &str, bool); 3] = [
    ("image.exposure", [Value::F32(0.0), Value::F32(1.0)], "read by one pass", true),
    ("shadows/splat.depth_bias", [Value::F32(1.0), Value::F32(2.0)], "a fact of the maps", true),
    ("lights", [Value::U32(64), Value::U32(128)], "sizes follow from it", false),
];

pub(super) fn measure(bench: &Bench<'_>) -> Result<Section> {
    let scene = renderer::load_scene(bench.catalog(), "cornell-box")?;
    let side = bench.size(256, 32);
    let mut renderer = Renderer::new(bench.gpu()?, Arc::clone(bench.catalog()), scene, (side, side))?;
    renderer.set_pipeline(PIPELINE, &Overrides(vec![("lights".to_owned(), Value::U32(64))]))?;
    renderer.frame()?;
    renderer.gpu().wait()?;
    let mut rows = Vec::new();
    for (path, values, reach, same_sizes) in SETTINGS {
        let mut times = Vec::new();
        for number in 0..=bench.args.runs * REPEATS {
            let value = values[number as usize % 2].clone();
            let start = Instant::now();
            renderer.set_value(path, value)?;
            times.push(milliseconds(start));
        }
        // In the first, shaders may be compiled.
        let times = Spread::of(times[1..].to_vec());
        let row = Row::new(format!("{path}: {reach}"), times, "ms");
        rows.push(if same_sizes { row.goal(Goal::AtMost(1.0), "own, two cores") } else { row });
    }
    let note = format!(
        "`set_value` in `{PIPELINE}` at {side}², without the frame that follows; {} runs.",
        bench.args.runs * REPEATS
    );
    Ok(Section { rows, note })
}
