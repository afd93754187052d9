//! Every producer of an interface works with every consumer of it: samplers with kinds of visibility, for each kind
//! of light.

use crate::adapter::{SMALL, bits, energy, mean, renderer, renderer_in, set, shown};
use crate::bounces::path_traced;
use crate::program::Folder;
use frame_graph::{CompileOptions, LinkContext, Value};
use metrics::{Epsilon, Image, Pair};
use pass::Step;
use renderer::{Assets, Catalog, Compiled};
use std::fmt::Write as _;
use std::sync::Arc;

const SAMPLERS: [(&str, &str); 4] = [
    ("uniform", r#"Replace("lights", Pass(kind: "sample-uniform", set: { "count": "$lights" }))"#),
    (
        "Metropolis-Hastings",
        r#"Replace("lights", Pass(kind: "sample-metropolis", in: { "importance": "importance" }, set: { "count": "$lights" }))"#,
    ),
    ("inverse transform, 3 numbers", r#"Set("lights.dimensions", 3)"#),
    ("inverse transform, 2 numbers", r#"Set("lights.dimensions", 2)"#),
];

const IMPORTANCES: [(&str, &str); 3] = [
    ("contribution of each texel", r#"Set("importance.evaluate", "texels")"#),
    ("contribution on demand", r#"Set("importance.evaluate", "on-demand")"#),
    ("flux", r#"Replace("importance", Pass(kind: "importance-map", set: { "measure": "flux" }))"#),
];

const VISIBILITIES: [(&str, &str); 5] = [
    ("imperfect", r#"Set("shadows.map", 32)"#),
    ("exact", r#"Replace("shadows", Pass(kind: "paraboloid-shadow-maps", set: { "map": 32 }))"#),
    ("ray-traced", r#"Replace("shadows", Pass(kind: "visibility-ray-traced"))"#),
    ("none", r#"Replace("shadows", Pass(kind: "visibility-none"))"#),
    ("unconnected", r#"Remove("shadows")"#),
];

/// The energy of each combination is that of its kind of visibility, whatever drew the lights.
#[test]
fn samplers_agree_under_imperfect_maps() {
    assert_samplers_agree(&VISIBILITIES[..1]);
}

#[test]
#[ignore = "slow"]
fn samplers_agree_under_each_other_visibility() {
    assert_samplers_agree(&VISIBILITIES[1..]);
}

fn assert_samplers_agree(visibilities: &[(&str, &str)]) {
    let folder = Folder::new(&[]);
    for (visibility, shadows) in visibilities {
        let mut energies: Vec<(String, f64)> = Vec::new();
        for (importance, measure) in IMPORTANCES {
            for (sampler, lights) in SAMPLERS {
                let mut text = String::from("Pipeline(extends: \"ism-invtm.ron\", patch: [\n");
                for patch in [measure, lights, shadows] {
                    let _ = writeln!(text, "    {patch},");
                }
                text.push_str("])\n");
                folder.write("pipelines/pair.ron", &text);
                let values =
                    ["lights=512", "rsm.size=64", "interleave_x=1", "interleave_y=1", "gather.clamp=0.02"];
                let Some(mut renderer) = renderer_in(&folder, "pair", "cornell-box", (24, 24), &values)
                else {
                    return;
                };
                let indirect = shown(&mut renderer, "indirect");
                energies.push((format!("{importance}, {sampler}, {visibility}"), energy(&indirect)));
            }
        }
        let middle = energies.iter().map(|(_, energy)| energy).sum::<f64>() / energies.len() as f64;
        for (name, energy) in &energies {
            // 512 lights of a smooth integrand: the spread over samplers was measured at 3 %.
            assert!((energy / middle - 1.0).abs() < 0.08, "{name}: {energy} against a mean of {middle}");
        }
    }
}

/// Every kind of light, alone and together, in every pipeline.
#[test]
fn every_pipeline_lights_a_scene_of_all_lights() {
    assert_pipelines_light(&["cornell-box-lights"]);
}

#[test]
#[ignore = "slow"]
fn every_pipeline_lights_every_kind_of_scene() {
    assert_pipelines_light(&["cornell-box", "cornell-box-point", "cornell-box-sun"]);
}

fn assert_pipelines_light(scenes: &[&str]) {
    let with_maps = ["ism", "ism-invtm", "ism-uniform", "ism-invtm-2", "ism-by-scene", "tcas", "ism-classic"];
    let by_rays = ["ism-ray-traced", "ism-invtm-ray-traced", "exhaustive"];
    for pipeline in with_maps.into_iter().chain(by_rays) {
        for scene in scenes {
            let values = match pipeline {
                "ism-classic" => &["lights=32", "map=16", "rsm.size=32"][..],
                // Rays need no maps.
                rays if by_rays.contains(&rays) => &["lights=64", "rsm.size=64"][..],
                _ => SMALL,
            };
            let Some(mut renderer) = renderer(pipeline, scene, (20, 20), values) else { return };
            let indirect = shown(&mut renderer, "indirect");
            assert!(energy(&indirect) > 0.0, "{pipeline} gives {scene} no indirect light");
        }
    }
}

/// Scenes without light or without surfaces are black, not broken.
#[test]
fn nothing_gives_nothing() {
    for pipeline in ["ism", "ism-invtm", "ism-uniform", "reference"] {
        let values = if pipeline == "reference" { &[][..] } else { SMALL };
        let Some(mut renderer) = renderer(pipeline, "empty", (8, 8), values) else { return };
        renderer.frame().unwrap();
        assert_eq!(mean(&renderer.output("image").unwrap()), [0.0; 3], "{pipeline}");
    }
}

/// A filter of lookups stands between maps and whoever reads them: the reader gets another module, and nothing else is
/// another.
#[test]
fn a_filter_of_lookups_changes_only_the_module_of_the_reader() {
    let folder = Folder::new(&[]);
    let insert = r#"Insert(
        name: "soft",
        pass: Pass(kind: "percentage-closer-filtering", set: { "taps": 3 }),
        between: ("shadows.visibility", "gather.visibility"),
    )"#;
    let text = format!("Pipeline(extends: \"ism.ron\", patch: [{insert}])");
    folder.write("pipelines/soft.ron", &text);
    let catalog = Arc::new(Catalog::new(Assets::new(Some(folder.to_path_buf()))));
    let scene = renderer::load_scene(&catalog, "cornell-box").unwrap();
    let context = LinkContext { frame: (24, 24), traits: scene.traits() };
    let compiled = |name: &str| {
        Compiled::new(&catalog, name, &set(SMALL), &context, &CompileOptions::default())
            .unwrap_or_else(|error| panic!("{error}"))
    };
    let (plain, soft) = (compiled("ism"), compiled("soft"));
    let resources = |compiled: &Compiled| -> Vec<String> {
        let resources = compiled.plan.resources.iter();
        resources.map(|resource| format!("{} {:?}", resource.name, resource.desc)).collect()
    };
    assert_eq!(resources(&plain), resources(&soft), "the maps are handed on");
    let steps = |compiled: &Compiled| -> Vec<(String, Vec<Step>)> {
        let steps = compiled.steps.iter().map(|steps| steps.iter().map(|step| step.step.clone()).collect());
        compiled.plan.passes.iter().map(|pass| pass.name.to_string()).zip(steps).collect()
    };
    let mut filtered = steps(&soft);
    filtered.retain(|(name, steps)| {
        assert!(name != "soft" || steps.is_empty(), "the filter has no work of its own");
        name != "soft"
    });
    for (name, steps) in &mut filtered {
        for step in steps.iter_mut().filter(|_| name == "gather") {
            let Step::Compute(compute) = step else { panic!("{step:?}") };
            let module =
                compute.shader.modules.insert("visibility".into(), "shaders/visibility-atlas.wgsl".into());
            let wanted = "passes/percentage-closer-filtering/lookup.wgsl";
            assert_eq!(module.as_deref(), Some(wanted));
        }
    }
    assert_eq!(steps(&plain), filtered);

    let indirect = |name| {
        let mut renderer = renderer_in(&folder, name, "cornell-box", (24, 24), SMALL)?;
        Some(shown(&mut renderer, "indirect"))
    };
    let (Some(plain), Some(soft)) = (indirect("ism"), indirect("soft")) else { return };
    assert_ne!(bits(&plain), bits(&soft), "edges are softer");
    let [plain, soft] = [plain, soft].map(|image| energy(&image));
    assert!((soft / plain - 1.0).abs() < 0.15, "{soft} against {plain}: as much light as before, or nearly");
}

/// The place of the pass by which lookups are soft.
#[derive(Clone, Copy)]
enum Soft {
    Nowhere,
    BeforeSharing(&'static str),
    AfterSharing(&'static str),
}

/// Renders indirect light in the Cornell box by maps of its virtual lights, or of clusters of them.
fn by_maps_of(name: &str, clusters: Option<u32>, soft: Soft) -> Option<metrics::Image> {
    let folder = Folder::new(&[]);
    let (passes, of) = match clusters {
        None => (String::new(), "lights"),
        Some(count) => {
            let links = format!(r#"in: {{ "lights": "lights" }}, set: {{ "count": {count} }}"#);
            (
                format!(r#"passes: {{ "clusters": Pass(kind: "cluster-lights", {links}) }},"#),
                "clusters.clusters",
            )
        }
    };
    let links = format!(r#"in: {{ "lights": "{of}" }}, set: {{ "map": 32 }}"#);
    let mut patches = vec![format!(r#"Replace("shadows", Pass(kind: "paraboloid-shadow-maps", {links}))"#)];
    let mut last = "shadows";
    let mut insert = |name: &'static str, pass: &str| {
        let between = format!(r#"("{last}.visibility", "gather.visibility")"#);
        patches.push(format!(r#"Insert(name: "{name}", pass: Pass({pass}), between: {between})"#));
        last = name;
    };
    if let Soft::BeforeSharing(filter) = soft {
        insert("soft", &format!(r#"kind: "{filter}""#));
    }
    if clusters.is_some() {
        let links = r#"{ "lights": "clusters.clusters", "owners": "clusters.owners" }"#;
        insert("shared", &format!(r#"kind: "share-visibility", in: {links}"#));
    }
    if let Soft::AfterSharing(filter) = soft {
        insert("soft", &format!(r#"kind: "{filter}""#));
    }
    let text = format!(r#"Pipeline(extends: "ism-uniform.ron", {passes} patch: [{}])"#, patches.join(", "));
    folder.write(&format!("pipelines/{name}.ron"), &text);
    let values = ["lights=64", "rsm.size=64"];
    let mut renderer = renderer_in(&folder, name, "cornell-box", (24, 24), &values)?;
    Some(shown(&mut renderer, "indirect"))
}

/// Clustered visibility with a cluster a light is the visibility of the lights, to the bit, also where lookups are soft,
/// before or after maps are shared. With fewer clusters it is another picture, about as bright.
#[test]
#[ignore = "slow"]
fn clusters_of_one_light_are_as_visible_as_the_light() {
    let Some(hard) = by_maps_of("hard", None, Soft::Nowhere) else { return };
    let whole = |name, clusters, soft| by_maps_of(name, clusters, soft).unwrap();
    let shared = whole("shared", Some(64), Soft::Nowhere);
    assert!(bits(&hard) == bits(&shared), "64 clusters of 64 lights");
    for filter in ["percentage-closer-soft-shadows", "convolution-soft-shadows"] {
        let wanted = whole("soft", None, Soft::BeforeSharing(filter));
        assert!(bits(&hard) != bits(&wanted), "shadows are softer by {filter}");
        for (name, soft) in [("before", Soft::BeforeSharing(filter)), ("after", Soft::AfterSharing(filter))] {
            assert!(bits(&wanted) == bits(&whole(name, Some(64), soft)), "{filter} {name}");
        }
        let few = whole("few", Some(24), Soft::BeforeSharing(filter));
        assert!(bits(&few) != bits(&wanted), "maps are shared");
        let [few, wanted] = [few, wanted].map(|image| energy(&image));
        assert!((few / wanted - 1.0).abs() < 0.2, "{filter}: {few} by 24 clusters, {wanted} by 64 lights");
    }
}

/// Returns relMSE and energy of gathered light by maps against rays, with the same lights, by the pass that
/// stands for `shadows`, of each seed.
fn against_rays(scene: &str, shadows: &str, seeds: &[u32]) -> Option<Vec<(f64, f64)>> {
    let measured = |[maps, rays]: [Image; 2]| {
        let pair = Pair::new(&maps, &rays).unwrap();
        pair.rel_mse(Epsilon::default()).zip(pair.energy_ratio())
    };
    maps_and_rays(scene, shadows, seeds)?.into_iter().map(measured).collect()
}

/// Irradiance of the same lights with shadows by maps, and by rays, of each seed.
fn maps_and_rays(scene: &str, shadows: &str, seeds: &[u32]) -> Option<Vec<[Image; 2]>> {
    let folder = Folder::new(&[]);
    let gathered = |name: &str, shadows: &str| {
        let maps_alone = r#"parameters: { "settle": Bool(default: false) }"#;
        let patch = format!(r#"patch: [Remove("filter"), {shadows}]"#);
        let text = format!(r#"Pipeline(extends: "ism-invtm.ron", {maps_alone}, {patch})"#);
        folder.write(&format!("pipelines/{name}.ron"), &text);
        // One bound for all lights, so that those near a wall do not outweigh what maps get wrong elsewhere.
        let bound = ["gather.clamp=0.01", "gather.area_bound=0.0"];
        let one = ["interleave_x=1", "interleave_y=1", "supersampling=1"];
        let values = ["lights=64", "rsm.size=128", "map=64"];
        let values = [&values[..], &one].concat();
        let values = [&values[..], &bound].concat();
        let mut renderer = renderer_in(&folder, name, scene, (64, 48), &values)?;
        renderer.keep("gather").unwrap();
        let of_seed = |seed: &u32| {
            renderer.set_seed(*seed);
            renderer.frame().unwrap();
            renderer.picture("gather", 0).unwrap()
        };
        Some(seeds.iter().map(of_seed).collect::<Vec<_>>())
    };
    let rays = gathered("rays", r#"Replace("shadows", Pass(kind: "visibility-ray-traced"))"#)?;
    let maps = gathered("maps", shadows)?;
    Some(maps.into_iter().zip(rays).map(|(maps, rays)| [maps, rays]).collect())
}

/// Imperfect maps come nearer to rays with more points, and with larger maps: they are consistent.
#[test]
fn imperfect_maps_converge_to_rays() {
    for scene in ["atrium-spot", "blinds", "hall-4k"] {
        let error = |map: u32, per_texel: f32| {
            let changes =
                format!(r#"Set("shadows.map", {map}), Set("shadows.points_per_texel", {per_texel:?})"#);
            Some(against_rays(scene, &changes, &[0])?[0])
        };
        let Some((coarse, _)) = error(64, 0.25) else { return };
        let (many, _) = error(64, 8.0).unwrap();
        let (fine, energy) = error(256, 8.0).unwrap();
        assert!(many < 0.8 * coarse && fine < 0.8 * many, "{scene}: {coarse}, {many}, {fine}");
        assert!((energy - 1.0).abs() < 0.03, "{scene}: energy {energy}");
    }
}

/// Rays give back most of what maps hide wrongly.
#[test]
fn rays_settle_what_maps_cannot_tell() {
    for scene in ["atrium-spot", "nave"] {
        let settled = |settle: bool| {
            let of_seeds = maps_and_rays(scene, &format!(r#"Set("shadows.settle", {settle})"#), &[0])?;
            let pair = Pair::new(&of_seeds[0][0], &of_seeds[0][1]).unwrap();
            pair.rel_mse(Epsilon::default()).zip(pair.excess_and_missing())
        };
        let Some((error_of_maps, [_, missing_of_maps])) = settled(false) else { return };
        let (error, [_, missing]) = settled(true).unwrap();
        assert!(error < 0.95 * error_of_maps, "{scene}: {error} for {error_of_maps}");
        assert!(
            missing < 0.6 * missing_of_maps,
            "{scene}: {missing} is missing, by maps alone {missing_of_maps}"
        );
    }
}

/// The bound by the area of each light leaves corners dark; rays give back what it takes, whatever the bound.
#[test]
fn short_rays_give_back_what_lights_lack_near_them() {
    let size = (64, 48);
    let Some(truth) = path_traced("cornell-box", size, 1) else { return };
    let of_near = |near: &str, rays: &str| {
        let values = ["lights=64", "interleave_x=1", "interleave_y=1", "supersampling=1", near, rays];
        let mut renderer = renderer("ism-invtm-ray-traced", "cornell-box", size, &values).unwrap();
        // The energy of one seed is off by 1.5 %.
        let of_seeds = (1..=16).map(|seed| {
            renderer.set_seed(seed);
            energy(&shown(&mut renderer, "indirect"))
        });
        of_seeds.sum::<f64>() / 16.0 / truth
    };
    for (near, most) in [("near=1", 0.98), ("near=2", 0.97)] {
        let [without, with] =
            ["near.rays_per_pixel=0", "near.rays_per_pixel=1"].map(|rays| of_near(near, rays));
        assert!(without < most, "{near}, without rays: {without}");
        assert!((with - 1.0).abs() < 0.015, "{near}, with rays: {with}");
    }
}

/// Exact maps differ from rays by their texels alone, imperfect ones by their points too. Bounds lie between what is
/// measured and what a bias that grows with the slope of the receiver gave: with exact maps 0.12 in the atrium and 0.35 in
/// the nave.
#[test]
fn maps_are_close_to_rays() {
    let exact = r#"Replace("shadows", Pass(kind: "paraboloid-shadow-maps", set: { "map": "$map" }))"#;
    let imperfect = r#"Set("shadows.points_per_texel", 1.0)"#;
    for (scene, shadows, most, off) in [
        ("cornell-box", exact, 0.005, 0.02),
        ("atrium-spot", exact, 0.075, 0.02),
        ("nave", exact, 0.31, 0.03),
        ("cornell-box", imperfect, 0.026, 0.04),
        ("atrium-spot", imperfect, 0.85, 0.07),
        ("nave", imperfect, 1.5, 0.06),
    ] {
        // A few bright pixels decide the error of one seed.
        let Some(mut of_seeds) = against_rays(scene, shadows, &[1, 2, 3, 4, 5, 6, 7, 8]) else { return };
        let energy = of_seeds.iter().map(|(_, energy)| energy).sum::<f64>() / of_seeds.len() as f64;
        of_seeds.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (error, _) = of_seeds[of_seeds.len() / 2];
        let how = if shadows == exact { "exact" } else { "imperfect" };
        assert!(error < most, "{scene}, {how} maps: relMSE {error}");
        assert!((energy - 1.0).abs() < off, "{scene}, {how} maps: energy {energy}");
    }
}

/// A scene of few triangles gets exact maps, another one imperfect maps, and the picture is that of the pipeline that has
/// nothing else.
#[test]
fn the_scene_decides_which_maps_are_made() {
    let values = ["lights=32", "rsm.size=64", "map=32"];
    for (scene, exact) in [("cornell-box", true), ("atrium-spot", false)] {
        let Some(mut renderer) = renderer("ism-by-scene", scene, (32, 24), &values) else { return };
        let plan = Arc::clone(renderer.plan().unwrap());
        let runs = |pass: &str| plan.pass(pass).is_some();
        assert_eq!((runs("shadows/exact"), runs("shadows/imperfect/splat")), (exact, !exact), "{scene}");
        let picture = shown(&mut renderer, "image");
        if !exact {
            let mut imperfect = crate::adapter::renderer("ism-invtm", scene, (32, 24), &values).unwrap();
            imperfect.frame().unwrap();
            assert!(bits(&picture) == bits(&imperfect.output("image").unwrap()), "{scene}");
        }
        // As many triangles as the scene has, and one less.
        let triangles = renderer.scene().triangles() as u32;
        for (most, exact) in [(triangles, true), (triangles - 1, false)] {
            renderer.set_value("exact_up_to", Value::U32(most)).unwrap();
            assert_eq!(renderer.plan().unwrap().pass("shadows/exact").is_some(), exact, "{scene}, {most}");
        }
    }
}
