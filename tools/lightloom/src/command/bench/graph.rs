//! The cost of the frame graph: compiling it, and the memory of its plans.

use super::Bench;
use super::table::{Goal, Row, Section, Spread};
use anyhow::Result;
use frame_graph::{
    CompileOptions, Description, Graph, LinkContext, Overrides, Plan, Resolved, Source, compile, link, parse,
    resolve, resolve_description,
};
use renderer::Catalog;
use std::collections::HashMap;
use std::fmt::Write as _;
use std::sync::Arc;
use std::time::Instant;

/// Factor of the number of runs: compiling takes less time than whole frames.
const REPEATS: u32 = 20;

/// Returns the text of a pipeline of `count` passes: a short way to an irradiance, and blurs of it one after the other, each a
/// single dispatch.
pub(super) fn chain(count: u32) -> String {
    let mut text = String::from(
        r#"Pipeline(passes: {
    "view": Pass(kind: "gbuffer"),
    "rsm": Pass(kind: "reflective-shadow-map", set: { "size": 16 }),
    "lights": Pass(kind: "sample-uniform", in: { "rsm": "rsm" }, set: { "count": 16 }),
    "blur-4": Pass(kind: "gather", in: { "view": "view", "lights": "lights" }, set: { "complete_below": 0 }),
"#,
    );
    for i in 5..=count {
        let _ = writeln!(
            text,
            r#"    "blur-{i}": Pass(kind: "geometry-aware-blur", in: {{ "view": "view", "irradiance": "blur-{}" }}, set: {{ "separable": false }}),"#,
            i - 1
        );
    }
    let _ = write!(text, r#"}}, outputs: {{ "irradiance": "blur-{count}" }})"#);
    text
}

pub(super) fn milliseconds(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

/// Returns what a program keeps of a description: plan, graph and resolved pipeline.
fn plan(
    catalog: &Catalog,
    description: &Description,
    context: &LinkContext,
) -> Result<(Plan, Graph, Resolved)> {
    let resolved = resolve_description("chain.ron", description, catalog.pipelines(), &Overrides::default())?;
    let graph = link(&resolved, catalog, context)?;
    let plan = compile(&graph, &options())?;
    Ok((plan, graph, resolved))
}

fn options() -> CompileOptions {
    CompileOptions { sharing: true, ..CompileOptions::default() }
}

pub(super) fn compiling(bench: &Bench<'_>) -> Result<Section> {
    let passes = bench.size(1000, 50);
    let source = Source::new("chain.ron", chain(passes));
    let context = LinkContext {
        frame: (512, 512),
        traits: renderer::load_scene(bench.catalog(), "cornell-box")?.traits(),
    };
    let (mut parsing, mut planning) = (Vec::new(), Vec::new());
    for _ in 0..=bench.args.runs * REPEATS {
        let start = Instant::now();
        let description = parse(Arc::clone(&source))?;
        parsing.push(milliseconds(start));
        let start = Instant::now();
        // Kept beyond the time: what is dropped later costs nothing here.
        let kept = plan(bench.catalog(), &description, &context)?;
        planning.push(milliseconds(start));
        drop(kept);
    }
    // In the first, pass types are asked for their settings.
    let [parsing, planning] = [parsing, planning].map(|times| Spread::of(times[1..].to_vec()));
    let rows = vec![
        Row::new(format!("{passes} passes, parsed file to plan"), planning, "ms")
            .goal(Goal::AtMost(1.0), "own, two cores"),
        Row::new(format!("{passes} passes, text to parsed file"), parsing, "ms"),
    ];
    let note = format!(
        "a G-buffer, a light and a chain of blurs, 512×512; resolve, link and compile, without shaders; {} runs.",
        bench.args.runs * REPEATS
    );
    Ok(Section { rows, note })
}

pub(super) fn memory(bench: &Bench<'_>) -> Result<Section> {
    let frame = (512, 512);
    let context =
        LinkContext { frame, traits: renderer::load_scene(bench.catalog(), "cornell-box")?.traits() };
    let files = bench.catalog().pipelines();
    let mut rows = Vec::new();
    for renderer::Named { name, .. } in bench.catalog().list_pipelines() {
        let resolved = resolve(&name, files, &Overrides::default())?;
        let plan = compile(&link(&resolved, &**bench.catalog(), &context)?, &options())?;
        let (memory, reachable) = (plan.memory, reachable_bound(&plan));
        let over =
            |bound: u64| Spread::exact(if bound == 0 { 1.0 } else { memory.shared as f64 / bound as f64 });
        let counts = vec![
            ("shared", memory.shared),
            ("reachable_bound", reachable),
            ("bound", memory.bound),
            ("unshared", memory.unshared),
        ];
        rows.push(
            Row::new(format!("transients of {name}, sort by sort"), over(reachable), "×")
                .goal(Goal::AtMost(1.05), "own, where descriptors allow")
                .counts(counts),
        );
        rows.push(Row::new(format!("transients of {name}, all sorts together"), over(memory.bound), "×"));
    }
    let note = format!(
        "bytes of shared objects over the largest sum alive at once, {}×{} pixels, cornell-box; counted, not timed. Whole objects are shared: textures of one format and size, or buffers. No plan can be below the bounds of these sorts, added up.",
        frame.0, frame.1
    );
    Ok(Section { rows, note })
}

/// Returns the largest sums alive at once, each of resources that can share an object at all: textures of one shape, or
/// buffers.
fn reachable_bound(plan: &Plan) -> u64 {
    let mut alive = HashMap::new();
    for resource in plan.resources.iter().filter(|resource| !resource.persistent) {
        let shape = resource.desc.texture().map(|t| (t.format, t.size, t.layers, t.array));
        let sums = alive.entry(shape).or_insert_with(|| vec![0; plan.passes.len()]);
        let (first, last) = resource.lifetime;
        sums[first as usize..=last as usize].iter_mut().for_each(|sum| *sum += resource.desc.bytes());
    }
    alive.values().filter_map(|sums| sums.iter().max()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use renderer::Assets;

    #[test]
    fn the_chain_has_so_many_passes_and_none_is_culled() {
        let catalog = Catalog::new(Assets::new(None));
        for count in [5, 50] {
            let description = parse(Source::new("chain.ron", chain(count))).unwrap();
            let traits = renderer::load_scene(&catalog, "empty").unwrap().traits();
            let context = LinkContext { frame: (8, 8), traits };
            let (plan, ..) = plan(&catalog, &description, &context).unwrap();
            assert_eq!(plan.passes.len(), count as usize);
        }
    }
}
