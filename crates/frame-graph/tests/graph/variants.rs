//! Variants: `extends`, patches, parts, switches, overrides; and the flattened file.

use super::kinds::{MemoryFiles, TestPassTypes, traits};
use super::whole::{BASE, SHADOWS};
use frame_graph::plan::{Fate, Plan};
use frame_graph::{
    CompileOptions, LinkContext, Overrides, Resolved, Traits, Value, compile, diff, link, resolve,
};

const PAIR: &str = r#"Pipeline(
    inputs: { "irradiance": "Irradiance" },
    passes: {
        "pair": Pass(kind: "pair", in: { "irradiance": "in.irradiance" }),
        "mix": Pass(kind: "mix", in: { "a": "pair.a", "b": "pair.b" }),
        "blur": Pass(kind: "blur", in: { "irradiance": "mix" }, when: "scene.glossy", off: Input("irradiance")),
    },
    outputs: { "image": "blur" },
)"#;

/// Two inputs that must be linked.
const TWO: &str = r#"Pipeline(
    inputs: { "a": "Irradiance", "b": "Irradiance" },
    passes: { "mix": Pass(kind: "mix", in: { "a": "in.a", "b": "in.b" }) },
    outputs: { "image": "mix" },
)"#;

fn files(variant: &str) -> MemoryFiles {
    let variant = format!("Pipeline(extends: \"base.ron\", {variant})");
    MemoryFiles::new(&[
        ("base.ron", BASE),
        ("parts/shadows.ron", SHADOWS),
        ("parts/pair.ron", PAIR),
        ("parts/two.ron", TWO),
        ("variant.ron", &variant),
    ])
}

fn resolved(variant: &str, overrides: &[(&str, Value)]) -> Resolved {
    let overrides = overrides.iter().map(|(path, value)| ((*path).to_owned(), value.clone()));
    resolve("variant.ron", &files(variant), &Overrides(overrides.collect())).unwrap_or_else(|e| panic!("{e}"))
}

fn planned(resolved: &Resolved, traits: Traits, options: &CompileOptions) -> Plan {
    let context = LinkContext { frame: (320, 200), traits };
    let graph = link(resolved, &TestPassTypes::new(), &context).unwrap_or_else(|e| panic!("{e}"));
    compile(&graph, options).unwrap_or_else(|e| panic!("{e}"))
}

fn plan(variant: &str) -> Plan {
    planned(&resolved(variant, &[]), traits(), &CompileOptions::default())
}

fn setting(plan: &Plan, pass: &str, setting: &str) -> Value {
    plan.passes[plan.pass(pass).unwrap().0 as usize].settings.get(setting).unwrap().clone()
}

/// The resources that an input reads, by name.
fn read(plan: &Plan, pass: &str, input: &str) -> Vec<String> {
    let pass = &plan.passes[plan.pass(pass).unwrap().0 as usize];
    let input =
        pass.inputs.iter().find(|i| i.port == *input).unwrap_or_else(|| panic!("{input} is not linked"));
    input.members.iter().map(|(_, id)| plan.resources[id.0 as usize].name.to_string()).collect()
}

#[test]
fn replace_keeps_the_inputs_that_fit() {
    let plan = plan(
        r#"patch: [ Replace("gather", Pass(kind: "blur", in: { "irradiance": "noise" }, set: { "radius": 3 })) ], passes: { "noise": Pass(kind: "noise") }"#,
    );
    assert_eq!(read(&plan, "gather", "view"), ["view.view.depth", "view.view.normal", "view.view.motion"]);
    assert_eq!(read(&plan, "gather", "irradiance"), ["noise.irradiance"]);
    // `lights` and `visibility` are no inputs of the new kind.
    assert_eq!(plan.passes[plan.pass("gather").unwrap().0 as usize].inputs.len(), 2);
    assert_eq!(setting(&plan, "gather", "radius"), Value::F32(3.0));
    // Nothing reads the lights any more.
    assert!(plan.pass("shadows/splat").is_none() && plan.pass("lights").is_none());
}

#[test]
fn replace_drops_inputs_that_a_shader_does_not_bind() {
    let variant = r#"passes: { "full": Pass(kind: "fullscreen", shader: "a.wgsl", in: { "color": "steady", "unbound": "view.depth" }) }, outputs: { "full": "full" }"#;
    let files = files(variant);
    let errors = resolve("variant.ron", &files, &Overrides::default()).map(|r| {
        link(&r, &TestPassTypes::new(), &LinkContext { frame: (8, 8), traits: traits() }).unwrap_err()
    });
    assert_eq!(errors.unwrap().0[0].code, "E025");
    let mut files = files;
    let second = r#"Pipeline(extends: "variant.ron", patch: [ Replace("full", Pass(kind: "fullscreen", shader: "b.wgsl")) ])"#;
    files.0.insert("second.ron".into(), frame_graph::Source::new("second.ron", second));
    let resolved = resolve("second.ron", &files, &Overrides::default()).unwrap();
    let plan = planned(&resolved, traits(), &CompileOptions::default());
    assert_eq!(read(&plan, "full", "color"), ["steady.color"]);
    assert_eq!(plan.passes[plan.pass("full").unwrap().0 as usize].inputs.len(), 1);
}

#[test]
fn insert_stands_between_two_ports() {
    let plan = plan(
        r#"patch: [
            Insert(name: "soft", pass: Pass(kind: "blur", set: { "mode": "gauss" }), between: ("gather.irradiance", "filter.irradiance")),
            Insert(name: "last", pass: Pass(kind: "blur"), between: ("filter", "out.indirect")),
        ]"#,
    );
    assert_eq!(read(&plan, "soft", "irradiance"), ["gather.irradiance"]);
    assert_eq!(read(&plan, "filter", "irradiance"), ["soft.irradiance"]);
    assert_eq!(plan.output("indirect").unwrap().from, "last.irradiance");
    assert_eq!(read(&plan, "image", "indirect"), ["filter.irradiance"]);
}

/// The input that an inserted pass is fed by is not linked in the file, and `off:` may name it all the same.
#[test]
fn an_inserted_pass_that_is_off_hands_on_what_it_is_fed() {
    let plan = plan(
        r#"patch: [ Insert(name: "soft", pass: Pass(kind: "blur", when: "scene.glossy", off: Input("irradiance")), between: ("gather.irradiance", "filter.irradiance")) ]"#,
    );
    assert!(plan.pass("soft").is_none());
    assert_eq!(read(&plan, "filter", "irradiance"), ["gather.irradiance"]);
}

#[test]
fn insert_puts_a_sub_graph_into_a_link() {
    let insert = |decl: &str, between: &str| {
        format!(r#"patch: [ Insert(name: "extra", pass: {decl}, between: {between}) ]"#)
    };
    let pair = r#"Sub(file: "parts/pair.ron")"#;
    let plan = plan(&insert(pair, r#"("gather", "filter")"#));
    assert_eq!(read(&plan, "extra/pair", "irradiance"), ["gather.irradiance"]);
    assert_eq!(read(&plan, "filter", "irradiance"), ["extra/mix.irradiance"], "its blur is off");
    let refused = |decl: &str| {
        resolve("variant.ron", &files(&insert(decl, r#"("gather", "filter")"#)), &Overrides::default())
            .expect_err("nothing says which input takes the link")
            .to_string()
    };
    let full = refused(r#"Sub(file: "parts/pair.ron", in: { "irradiance": "gather" })"#);
    assert!(full.contains("no input of `extra` is left to take what is fed to it"), "{full}");
    let two = refused(r#"Sub(file: "parts/two.ron")"#);
    assert!(two.contains("more than one input of `extra`") && two.contains("not linked yet: a, b"), "{two}");
}

#[test]
fn what_is_inserted_and_removed_leaves_the_link_as_it_was() {
    let insert = |name: &str, from: &str, to: &str| {
        format!(r#"Insert(name: "{name}", pass: Pass(kind: "blur"), between: ("{from}", "{to}"))"#)
    };
    let (soft, last) = (insert("soft", "gather", "filter"), insert("last", "filter", "out.indirect"));
    let twice = insert("twice", "soft", "filter");
    let base = plan("patch: []");
    let none = plan(&format!(r#"patch: [ {soft}, {last}, Remove("soft"), Remove("last") ]"#));
    assert_eq!(read(&none, "filter", "irradiance"), read(&base, "filter", "irradiance"));
    assert_eq!(none.output("indirect").unwrap().from, base.output("indirect").unwrap().from);
    let second = plan(&format!(r#"patch: [ {soft}, {twice}, Remove("soft") ]"#));
    assert_eq!(read(&second, "twice", "irradiance"), ["gather.irradiance"]);
    assert_eq!(read(&second, "filter", "irradiance"), ["twice.irradiance"]);
}

/// Patches of extended files come first, and a variant may take out what they set.
#[test]
fn values_go_with_the_pass_that_they_were_given_to() {
    let before = r#"Set("shadows/splat.map", 64), Set("shadows.map", 16), Set("filter.radius", 2)"#;
    let removed = plan(&format!(r#"patch: [ {before}, Remove("shadows") ]"#));
    assert!(removed.pass("shadows/splat").is_none());
    assert_eq!(setting(&removed, "filter", "radius"), Value::F32(2.0));
    let sub = r#"Sub(file: "parts/shadows.ron", set: { "map": 8 })"#;
    let replaced = plan(&format!(r#"patch: [ {before}, Replace("shadows", {sub}) ]"#));
    assert_eq!(setting(&replaced, "shadows/splat", "map"), Value::U32(8));
    let after = plan(&format!(r#"patch: [ Replace("shadows", {sub}), {before} ]"#));
    assert_eq!(setting(&after, "shadows/splat", "map"), Value::U32(64));
    // What is set after the pass is gone is an error, as it is where there never was one.
    let files = files(r#"patch: [ Remove("shadows"), Set("shadows.map", 16) ]"#);
    let error = resolve("variant.ron", &files, &Overrides::default()).expect_err("nothing takes it");
    assert_eq!(error.0[0].code, "E017", "{error}");
}

#[test]
fn remove_leaves_optional_inputs_unlinked_or_what_off_says() {
    // `visibility` of gather is optional.
    let plan = plan(r#"patch: [ Remove("shadows") ]"#);
    assert!(plan.pass("shadows/splat").is_none());
    let gather = &plan.passes[plan.pass("gather").unwrap().0 as usize];
    assert!(gather.inputs.iter().all(|input| input.port != "visibility"));
    // `glossy` has `off: "filter"`.
    let resolved = resolved(r#"patch: [ Remove("glossy") ]"#, &[]);
    let mut glossy = traits();
    glossy.values.insert("glossy".into(), Value::Bool(true));
    let plan = planned(&resolved, glossy, &CompileOptions::default());
    assert!(
        matches!(&plan.fates.iter().find(|(n, _)| n == "glossy").unwrap().1, Fate::Off { why, .. } if why == "removed by a patch")
    );
    assert_eq!(read(&plan, "image", "glossy"), ["filter.irradiance"]);
}

#[test]
fn settings_come_from_the_nearest_hand() {
    let plain = plan("");
    assert_eq!(setting(&plain, "lights", "count"), Value::U32(256));
    assert_eq!(setting(&plain, "shadows/splat", "map"), Value::U32(64));
    let patched = plan(
        r#"parameters: { "count": U32(default: 512) },
           patch: [ Set("shadows.map", 32), Set("filter.radius", 2), Set("filter.radius", 5.5) ]"#,
    );
    assert_eq!(setting(&patched, "lights", "count"), Value::U32(512));
    assert_eq!(setting(&patched, "shadows/splat", "map"), Value::U32(32));
    assert_eq!(setting(&patched, "filter", "radius"), Value::F32(5.5));
    let overrides =
        [("count", Value::U32(8)), ("shadows/splat.map", Value::U32(16)), ("filter.radius", Value::U32(1))];
    let given = resolved(r#"patch: [ Set("shadows.map", 32), Set("filter.radius", 2) ]"#, &overrides);
    let given = planned(&given, traits(), &CompileOptions::default());
    assert_eq!(setting(&given, "lights", "count"), Value::U32(8));
    assert_eq!(setting(&given, "shadows/splat", "map"), Value::U32(16));
    assert_eq!(setting(&given, "filter", "radius"), Value::F32(1.0));
    assert_ne!(plain.id, given.id);
}

/// A patch that gives a pass a parameter gives it what the parameter is in the end, not what the file says.
#[test]
fn a_patch_hands_on_the_value_that_a_parameter_is_given() {
    let variant = r#"parameters: { "count": U32(default: 512), "width": F32(default: 2.5) },
        patch: [ Set("filter.radius", "$width"), Set("shadows.map", "$count"), Set("shadows/splat.map", "$count") ]"#;
    let of = |overrides: &[(&str, Value)]| {
        planned(&resolved(variant, overrides), traits(), &CompileOptions::default())
    };
    let plain = of(&[]);
    assert_eq!(setting(&plain, "filter", "radius"), Value::F32(2.5));
    assert_eq!(setting(&plain, "shadows/splat", "map"), Value::U32(512));
    let given = of(&[("width", Value::F32(4.5)), ("count", Value::U32(16))]);
    assert_eq!(setting(&given, "filter", "radius"), Value::F32(4.5));
    assert_eq!(setting(&given, "shadows/splat", "map"), Value::U32(16));
    // What is given for the setting itself is nearer still.
    let nearer = of(&[("filter.radius", Value::F32(1.0)), ("width", Value::F32(4.5))]);
    assert_eq!(setting(&nearer, "filter", "radius"), Value::F32(1.0));
}

#[test]
fn off_hands_on_an_input_through_borders_of_parts() {
    let part = r#"passes: { "part": Sub(file: "parts/pair.ron", in: { "irradiance": "gather" }) },
        outputs: { "soft": "part" }"#;
    // The blur inside is off: its input stands for it.
    let off = plan(part);
    assert!(off.pass("part/blur").is_none());
    assert_eq!(off.output("soft").unwrap().from, "part/mix.irradiance");
    let mut glossy = traits();
    glossy.values.insert("glossy".into(), Value::Bool(true));
    let on = planned(&resolved(part, &[]), glossy, &CompileOptions::default());
    assert_eq!(on.output("soft").unwrap().from, "part/blur.irradiance");
    // The whole part off: what goes in comes out.
    let variant = r#"passes: { "part": Sub(file: "parts/pair.ron", in: { "irradiance": "gather" }, when: "scene.glossy", off: Input("irradiance")) },
               outputs: { "soft": "part" }"#;
    let whole = plan(variant);
    assert_eq!(whole.output("soft").unwrap().from, "gather.irradiance");
    assert!(
        matches!(&whole.fates.iter().find(|(n, _)| n == "part/mix").unwrap().1, Fate::Off { why, .. } if why.starts_with("`part` is off: scene.glossy"))
    );
}

#[test]
fn the_flattened_file_says_the_same() {
    for variant in [
        "",
        r#"patch: [ Replace("gather", Pass(kind: "blur", in: { "irradiance": "noise" })), Remove("shadows"), Set("filter.radius", 2) ], passes: { "noise": Pass(kind: "noise") }"#,
        r#"patch: [ Insert(name: "soft", pass: Pass(kind: "blur"), between: ("gather", "filter.irradiance")), Remove("glossy") ]"#,
        r#"passes: {
            "part": Sub(file: "parts/pair.ron", in: { "irradiance": "prev gather" }, when: "$count > 3 && !(scene.name == 'x' || scene.glossy)", off: "gather"),
            "full": Pass(kind: "fullscreen", shader: "a.wgsl", in: { "x": "part" }, set: { "strength": 0.25 }, out: { "out": Out(format: "r32float", size: "like(x) * 3 / 2", count: "$count", interface: "Irradiance") }),
        }, outputs: { "full": "full" }"#,
    ] {
        let first = resolved(variant, &[("count", Value::U32(77))]);
        let text = first.to_ron(&TestPassTypes::new(), true);
        let files = MemoryFiles::new(&[("flat.ron", &text)]);
        let second =
            resolve("flat.ron", &files, &Overrides::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
        assert_eq!(first.to_ron(&TestPassTypes::new(), false), second.to_ron(&TestPassTypes::new(), false));
        assert!(
            diff(&first, &second, &TestPassTypes::new()).is_empty(),
            "{:?}",
            diff(&first, &second, &TestPassTypes::new())
        );
        assert!(text.contains("// --set:1:7"), "{text}");
        let options = CompileOptions::default();
        let (a, b) = (planned(&first, traits(), &options), planned(&second, traits(), &options));
        assert_eq!(a.id, b.id);
        let kinds = |plan: &Plan| -> Vec<_> {
            plan.fates.iter().map(|(name, fate)| (name.clone(), std::mem::discriminant(fate))).collect()
        };
        assert_eq!(kinds(&a), kinds(&b));
    }
}

#[test]
fn origins_stand_behind_what_came_from_elsewhere() {
    let text = resolved(r#"patch: [ Set("filter.radius", 2) ]"#, &[]).to_ron(&TestPassTypes::new(), true);
    let line = |part: &str| {
        text.lines().find(|line| line.contains(part)).unwrap_or_else(|| panic!("{part}\n{text}"))
    };
    assert!(line("\"radius\": 2,").ends_with("// variant.ron:1:61"), "{}", line("\"radius\""));
    assert!(line("\"count\": 256,").contains("// base.ron:5:"), "{}", line("\"count\""));
    assert!(line("\"splat\": Pass(").contains("// parts/shadows.ron:6:"));
}

#[test]
fn differences_are_reported_one_by_one() {
    let base = resolve("base.ron", &files(""), &Overrides::default()).unwrap();
    let other = resolved(
        r#"parameters: { "map": U32(default: 32) },
           patch: [ Replace("gather", Pass(kind: "noise")), Remove("unused"), Set("filter.radius", 2) ],
           passes: { "extra": Pass(kind: "noise") }, outputs: { "extra": "extra" }"#,
        &[],
    );
    let lines: Vec<String> =
        diff(&base, &other, &TestPassTypes::new()).iter().map(ToString::to_string).collect();
    assert_eq!(
        lines,
        [
            "~ parameter map: 64 → 32",
            "~ setting shadows/splat.map: 64 → 32",
            "~ pass gather: gather → noise",
            // The new pass type takes none of them.
            "- link gather.view: \"view\"",
            "- link gather.lights: \"lights\"",
            "- link gather.visibility: \"shadows\"",
            "~ setting filter.radius: 4.0 → 2.0",
            "~ pass unused: noise → removed",
            "+ pass extra: noise",
            "+ output extra: \"extra\"",
        ]
    );
}

#[test]
fn the_order_lowers_the_peak() {
    // Four wide sources, each reduced by a narrow pass, then joined. In the file's order all four wide ones are
    // alive at once; source by source, one is.
    let mut text = String::from("passes: {");
    for i in 0..4 {
        text.push_str(&format!("\"wide{i}\": Pass(kind: \"fullscreen\", shader: \"s.wgsl\", out: {{ \"out\": Out(size: \"frame * 4\") }}),"));
    }
    for i in 0..4 {
        text.push_str(&format!("\"small{i}\": Pass(kind: \"fullscreen\", shader: \"s.wgsl\", in: {{ \"x\": \"wide{i}\" }}, out: {{ \"out\": Out(size: \"frame / 8\") }}),"));
    }
    text.push_str("\"join\": Pass(kind: \"fullscreen\", shader: \"s.wgsl\", in: { \"a\": \"small0\", \"b\": \"small1\", \"c\": \"small2\", \"d\": \"small3\" }) }, outputs: { \"join\": \"join\" }");
    let resolved = resolved(&text, &[]);
    let options = CompileOptions { outputs: vec!["join".into()], ..CompileOptions::default() };
    let plan = planned(&resolved, traits(), &options);
    let names: Vec<&str> = plan.passes.iter().map(|pass| pass.name.as_str()).collect();
    assert_eq!(names, ["wide0", "small0", "wide1", "small1", "wide2", "small2", "wide3", "small3", "join"]);
    let (wide, small) = (320 * 4 * 200 * 4 * 8, 40 * 25 * 8);
    assert_eq!(plan.memory.bound, wide + 4 * small);
    assert_eq!(plan.memory.shared, plan.memory.bound);
    // One object for all wide resources, four for the small ones.
    assert_eq!(plan.memory.objects, 5);
}

#[test]
fn what_is_kept_is_kept() {
    let resolved = resolved("", &[]);
    let keep = |keep: &[&str]| CompileOptions {
        keep: keep.iter().map(|k| (*k).to_owned()).collect(),
        outputs: vec!["indirect".into()],
        ..CompileOptions::default()
    };
    let plain = planned(&resolved, traits(), &keep(&[]));
    assert!(plain.pass("unused").is_none() && plain.pass("image").is_none());
    let kept = planned(&resolved, traits(), &keep(&["unused.irradiance", "view.view.depth", "lights"]));
    for name in ["unused.irradiance", "view.view.depth", "lights.lights"] {
        assert!(kept.resources[kept.resource(name).unwrap().0 as usize].persistent, "{name}");
    }
    assert!(!kept.resources[kept.resource("lights.scan").unwrap().0 as usize].persistent);
    // By the pass alone, and by a member of its port; of a pass that would be culled, too.
    for (name, found) in [
        ("unused", vec!["unused.irradiance"]),
        ("view", vec!["view.view.depth", "view.view.normal", "view.view.motion"]),
        ("view.normal", vec!["view.view.normal"]),
        ("image", vec!["image.image"]),
        ("lights.scan", vec!["lights.scan"]),
    ] {
        let kept = planned(&resolved, traits(), &keep(&[name]));
        for resource in &kept.resources {
            let was =
                plain.resource(&resource.name).is_some_and(|id| plain.resources[id.0 as usize].persistent);
            let is = was || found.contains(&resource.name.as_str());
            assert_eq!(resource.persistent, is, "{name}: {}", resource.name);
        }
        assert!(found.iter().all(|name| kept.resource(name).is_some()), "{name}");
    }
}

#[test]
fn interfaces_are_kept_of_passes_that_run_anyway() {
    let resolved = resolved("", &[]);
    let options = |interfaces: &[&str]| CompileOptions {
        outputs: vec!["indirect".into()],
        keep_interfaces: interfaces.iter().map(|name| (*name).to_owned()).collect(),
        ..CompileOptions::default()
    };
    let persistent =
        |plan: &Plan, name: &str| plan.resources[plan.resource(name).unwrap().0 as usize].persistent;
    let plain = planned(&resolved, traits(), &options(&[]));
    assert!(!persistent(&plain, "lights.lights"));
    let kept = planned(&resolved, traits(), &options(&["Lights", "Irradiance"]));
    assert!(persistent(&kept, "lights.lights") && !persistent(&kept, "lights.scan"));
    assert!(kept.pass("unused").is_none(), "it makes an Irradiance that nothing reads");
}

#[test]
fn drawings_hold_every_pass() {
    let plan = plan("");
    let (svg, dot, text, json) = (plan.to_svg(), plan.to_dot(), plan.to_text(), plan.to_json());
    for (name, _) in &plan.fates {
        assert!(svg.contains(&format!(">{name}</text>")), "{name}");
        assert!(dot.contains(&format!("\"{name}\"")), "{name}");
        assert!(text.contains(name.as_str()), "{name}");
    }
    assert!(svg.contains("past: color → history"));
    // Links to the past are dashed, and no others.
    let is_past = |line: &str| line.contains("→ history");
    let links = dot.lines().filter(|line| line.contains('→'));
    assert!(links.clone().any(is_past) && links.clone().any(|line| !is_past(line)), "{dot}");
    for link in links {
        assert_eq!(link.contains("style=dashed"), is_past(link), "{link}");
    }
    assert_eq!(svg.matches("stroke-dasharray").count(), dot.lines().filter(|line| is_past(line)).count());
    assert!(svg.ends_with("</svg>\n") && svg.contains("lower bound"));
    assert!(!svg.contains("NaN") && svg.matches("<g>").count() == svg.matches("</g>").count());
    assert_eq!(json["passes"].as_array().unwrap().len(), plan.passes.len());
    let view = json["passes"].as_array().unwrap().iter().find(|pass| pass["name"] == "view").unwrap();
    let bindings: Vec<_> =
        view["scene_bindings"].as_array().unwrap().iter().map(|name| name.as_str()).collect();
    assert_eq!(bindings, [Some("scene"), Some("camera")]);
    assert_eq!(json["id"], plan.id.to_string());
    assert_eq!(json["memory"]["bound"], plan.memory.bound);
    insta::with_settings!({ prepend_module_to_snapshot => false, snapshot_path => "../snapshots", omit_expression => true }, {
        insta::assert_snapshot!("plan-as-text", text);
    });
}

#[test]
fn the_name_of_a_plan_changes_with_all_that_matters() {
    let base = plan("");
    let ids: Vec<_> = [
        r#"patch: [ Set("filter.radius", 2) ]"#,
        r#"patch: [ Set("lights.mode", "importance") ]"#,
        r#"parameters: { "map": U32(default: 32) }"#,
        r#"patch: [ Replace("filter", Pass(kind: "blur", in: { "irradiance": "gather", "view": "prev view" })) ]"#,
        r#"patch: [ Replace("filter", Pass(kind: "mix", in: { "a": "gather", "b": "gather" })) ]"#,
        r#"patch: [ Remove("shadows") ]"#,
        r#"outputs: { "more": "gather" }"#,
        r#"patch: [ Replace("steady", Pass(kind: "accumulate", history: (reset: [Cut, Scene]))) ]"#,
    ]
    .map(plan)
    .iter()
    .map(|plan| plan.id)
    .collect();
    let different: std::collections::HashSet<_> = ids.iter().chain([&base.id]).collect();
    assert_eq!(different.len(), ids.len() + 1);
    // What is never run does not matter, nor what is only said of the pipeline.
    assert_eq!(plan(r#"patch: [ Remove("unused") ], about: "other""#).id, base.id);
    // The size of the frame does.
    let context = LinkContext { frame: (321, 200), traits: traits() };
    let graph = link(&resolved("", &[]), &TestPassTypes::new(), &context).unwrap();
    assert_ne!(compile(&graph, &CompileOptions::default()).unwrap().id, base.id);
}

#[test]
fn movement_ends_the_past_of_what_reads_it() {
    use frame_graph::{Change, FrameState, ResetCause, SceneBindings};
    let with = |reset: &str| {
        plan(&format!(
            r#"patch: [
                Replace("view", Pass(kind: "gbuffer", history: (reset: [{reset}]))),
                Replace("filter", Pass(kind: "blur", in: {{ "irradiance": "gather", "view": "prev view" }})),
            ]"#
        ))
    };
    let reset_of = |plan: &Plan, scene_bindings: SceneBindings, pass: &str| {
        let mut state = FrameState::new(plan);
        state.begin(plan, &Change { scene_bindings, ..Change::default() });
        let schedule = state.begin(plan, &Change { scene_bindings, ..Change::default() });
        let of_view =
            |h: &frame_graph::plan::History| plan.resources[h.resource.0 as usize].name.starts_with(pass);
        let found = plan.histories.iter().position(of_view).expect("a history buffer of the pass");
        schedule.histories[found].reset
    };
    let reset_by = |plan: &Plan, scene_bindings| reset_of(plan, scene_bindings, "view.");
    // The blur reads no scene binding itself; what it reads does.
    for (cause, reset) in
        [("Moved", None), ("MovedUpstream", Some(ResetCause::Moved)), ("All", Some(ResetCause::Moved))]
    {
        let reset_by_cause = if cause == "All" { cause.to_owned() } else { format!("[{cause}]") };
        let blur = plan(&format!(
            r#"patch: [ Replace("filter", Pass(kind: "mix", in: {{ "a": "gather", "b": "prev filter" }}, history: (reset: {reset_by_cause}))) ]"#
        ));
        assert_eq!(reset_of(&blur, SceneBindings::LIGHTS, "filter."), reset, "{cause}");
        assert_eq!(reset_of(&blur, SceneBindings::FRAME, "filter."), None, "{cause}");
    }
    let moved = with("Cut, Moved");
    assert_eq!(reset_by(&moved, SceneBindings::CAMERA), Some(ResetCause::Moved));
    assert_eq!(reset_by(&moved, SceneBindings::SCENE.and(SceneBindings::FRAME)), Some(ResetCause::Moved));
    // The view reads no lights, and time goes on in a still scene too.
    assert_eq!(reset_by(&moved, SceneBindings::LIGHTS), None);
    assert_eq!(reset_by(&moved, SceneBindings::FRAME), None);
    let clock = plan(
        r#"patch: [
            Replace("unused", Pass(kind: "noise", history: (reset: [Moved]))),
            Replace("filter", Pass(kind: "mix", in: { "a": "gather", "b": "prev unused" })),
        ]"#,
    );
    assert_eq!(
        reset_of(&clock, SceneBindings::FRAME, "unused."),
        None,
        "also of what reads the frame's number"
    );
    assert_eq!(reset_by(&with("Cut"), SceneBindings::CAMERA), None);
    assert_eq!(reset_by(&with("MovedUpstream"), SceneBindings::LIGHTS), None);
    assert_eq!(reset_by(&with("MovedUpstream"), SceneBindings::CAMERA), Some(ResetCause::Moved));
}
