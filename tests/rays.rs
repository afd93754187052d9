//! How rays are traced: one parameter of every pipeline that traces, and the same picture however it is done.

use crate::adapter::{gpu, names_in, rel_mse, renderer, root, set};
use frame_graph::{CompileOptions, LinkContext, Value, compile, link, resolve};
use renderer::{Assets, Catalog};

const SIZE: (u32, u32) = (48, 36);

#[test]
fn one_parameter_of_every_pipeline_that_traces() {
    let catalog = Catalog::new(Assets::new(Some(root())));
    let traits = renderer::load_scene(&catalog, "cornell-box-lights").unwrap().traits();
    let context = LinkContext { frame: SIZE, traits };
    // The values of the setting `rays` of all passes.
    let of = |pipeline: &str, values: &[&str]| -> Result<Vec<Value>, String> {
        let resolved =
            resolve(pipeline, catalog.pipelines(), &set(values)).map_err(|error| error.to_string())?;
        let graph = link(&resolved, &catalog, &context).map_err(|error| error.to_string())?;
        let plan = compile(&graph, &CompileOptions::default()).map_err(|error| error.to_string())?;
        Ok(plan.passes.iter().filter_map(|pass| pass.settings.0.get("rays").cloned()).collect())
    };
    let mut tracing = 0;
    for pipeline in names_in("pipelines") {
        let unless_said = of(&pipeline, &[]).unwrap_or_else(|error| panic!("{pipeline}: {error}"));
        assert!(unless_said.iter().all(|rays| rays.as_text() == Some("auto")), "{pipeline}: {unless_said:?}");
        if unless_said.is_empty() {
            continue;
        }
        tracing += 1;
        let said = of(&pipeline, &["rays=query"]).unwrap_or_else(|error| panic!("{pipeline}: {error}"));
        assert_eq!(said.len(), unless_said.len(), "{pipeline}");
        assert!(said.iter().all(|rays| rays.as_text() == Some("query")), "{pipeline}: {said:?}");
    }
    assert!(tracing > 15, "{tracing} pipelines trace rays");
}

/// Where the adapter has ray queries, they are taken unless something else is said; elsewhere they are refused by name.
#[test]
fn queries_of_the_adapter_give_the_picture_of_the_hierarchy() {
    let Some(gpu) = gpu() else { return };
    if !gpu.has_ray_queries() {
        eprintln!("queries are refused, and not compared: {} has none", gpu.describe());
        let Some(mut refused) = renderer("ism-ray-traced", "cornell-box", SIZE, &[]) else { return };
        let error = refused.set_pipeline("ism-ray-traced", &set(&["rays=query"])).unwrap_err().to_string();
        assert!(error.contains("uses ray queries, which") && error.contains("`rays` is \"bvh\""), "{error}");
        return;
    }
    // Masks and normal maps; vertices that move; lights chosen by what rays find.
    for (pipeline, scene, values, bound) in [
        ("ism-ray-traced", "arcade", &["lights=16"][..], 1e-4),
        ("ism-ray-traced", "cornell-box-cloth", &["lights=16"], 1e-4),
        ("restir-vpl", "cornell-box-lights", &["lights=64"], 1e-2),
        ("reference", "atrium-spot", &["samples=8"], 1e-3),
        ("smc-ir-ray-traced", "cornell-box", &["lights=32", "moved=0"], 1e-2),
    ] {
        let picture = |rays: &str| {
            let mut renderer = renderer(pipeline, scene, SIZE, &[values, &[rays]].concat())?;
            crate::adapter::done(&mut renderer);
            Some(renderer.output("indirect").unwrap())
        };
        let (Some(auto), Some(query)) = (picture("rays=auto"), picture("rays=query")) else { return };
        let Some(hierarchy) = picture("rays=bvh") else { return };
        let [auto_bits, query_bits] = [&auto, &query].map(crate::adapter::bits);
        assert!(
            auto_bits == query_bits,
            "{pipeline}, {scene}: queries are taken unless something else is said"
        );
        let error = rel_mse(&query, &hierarchy);
        assert!(error < bound, "{pipeline}, {scene}: relMSE {error:e}");
    }
}
