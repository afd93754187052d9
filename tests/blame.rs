//! `lightloom blame`: shares of the error, and faults that it finds.

use crate::adapter::root;
use crate::program::{Done, Folder, command_of_tree};
use serde_json::Value;

/// A frame that takes some seconds with all its variants.
const QUICK: &[&str] =
    &["--size", "32x32", "--set", "lights=64", "--set", "map=32", "--samples", "64", "--json"];

fn blame(folder: &Folder, arguments: &[&str]) -> Done {
    let mut command = command_of_tree(folder);
    Done::of(command.arg("blame").args(arguments))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}

#[test]
fn shares_add_up_to_the_error_of_the_picture() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    let done = blame(&folder, &[&["ism-invtm", "cornell-box", "-o", "out"], QUICK].concat()).success();
    let record = done.json()["blame"].clone();
    let shares = &record["shares"];
    let rows = shares["rows"].as_array().unwrap();
    let name = |row: &Value| row["name"].as_str().unwrap().to_owned();
    let mut names: Vec<String> = rows.iter().map(name).collect();
    names.sort();
    let expected =
        ["bound", "filter", "interleaving", "lights", "maps", "one frame", "pixels", "reflectance"];
    assert_eq!(names, expected);
    for what in ["error", "bias_squared", "variance", "energy"] {
        let of = |row: &Value| number(&row[what]["mean"]);
        let sum = rows.iter().map(of).sum::<f64>() + of(&shares["rest"]);
        let whole = of(&shares["whole"]);
        assert!((sum - whole).abs() < 1e-9 * whole.abs().max(1.0), "{what}: {sum} for {whole}");
    }
    let saved: f64 = rows.iter().filter_map(|row| row["saves"]["mean"].as_f64()).sum();
    let [all, own] = ["rest", "whole"].map(|row| number(&shares[row]["saves"]["mean"]));
    assert!((all - saved - own).abs() < 1e-6 * all, "{all} - {saved} for {own}");
    let passes = |row: &str| {
        let row = rows.iter().find(|other| name(other) == row).unwrap();
        row["passes"].as_array().unwrap().iter().map(|pass| pass.as_str().unwrap()).collect::<Vec<_>>()
    };
    assert_eq!(passes("maps"), ["shadows/points", "shadows/splat", "shadows/fill", "shadows/settle"]);
    assert_eq!(passes("lights"), ["rsm", "importance", "sums", "lights"]);
    assert_eq!(passes("filter"), ["filter"]);
    let page = folder.read("out/report.html");
    for words in ["ism-invtm in cornell-box", "<td>shadows/points, shadows/splat", "data:image/png;base64,"] {
        assert!(page.contains(words), "no {words}");
    }
    assert_eq!(serde_json::from_str::<Value>(&folder.read("out/shares.json")).unwrap(), record);
}

/// The pipeline among its variants renders the bits that it renders alone, and what is exact without an approximation is it.
#[test]
fn what_approximates_nothing_is_exact() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    let set = ["--set", "gather.area_bound=0.0", "--set", "gather.geometry=disc"];
    let done = blame(&folder, &[&["exhaustive", "cornell-box", "-o", "out"], QUICK, &set].concat()).success();
    let rows = done.json()["blame"]["shares"]["rows"].clone();
    let names: Vec<&str> = rows.as_array().unwrap().iter().map(|row| row["name"].as_str().unwrap()).collect();
    assert!(
        !["maps", "interleaving", "filter", "bound"].iter().any(|name| names.contains(name)),
        "{names:?}"
    );
}

#[test]
fn bad_input_is_told() {
    let Some(folder) = Folder::with_gpu(&[("old.json", "{ \"scene\": \"atrium\" }"), ("no.json", "shares")])
    else {
        return;
    };
    let of =
        |more: &[&str]| blame(&folder, &[&["ism-invtm", "cornell-box", "-o", "out"], QUICK, more].concat());
    of(&["--output", "indirct"]).failure(1, &["`ism-invtm` has no output `indirct`; it has", "indirect"]);
    of(&["--against", "old.json"]).failure(1, &["old.json is of another run: its scene is"]);
    of(&["--against", "no.json"]).failure(1, &["no.json is no shares.json"]);
    of(&["--against", "none.json"]).failure(1, &["none.json cannot be read"]);
    of(&["--seeds", "2"]).failure(2, &["2 is not in 3..=1000"]);
    of(&["--set", "lihgts=3"]).failure(1, &["lihgts", "lights"]);
    let gather = std::fs::read_to_string(root().join("passes/gather/gather.wgsl")).unwrap();
    let other = gather.replacen(
        "#exact interleaving: set(interleave_x: 1",
        "#exact interleaving: set(interleave_z: 1",
        1,
    );
    folder.write("tree/passes/gather/gather.wgsl", &other);
    let tree = folder.name("tree");
    of(&["--root", &tree]).failure(1, &["`interleaving`", "gather declares as exact", "interleave_z"]);
}

/// A fault: the pass that has it, a file, and what stands there instead of what.
type Fault = (&'static str, &'static str, &'static str, &'static str);

const SAMPLER: &str = "passes/sample-inverse-transform/sample-inverse-transform.wgsl";
const RSM: &str = "passes/reflective-shadow-map/reflective-shadow-map.wgsl";
const FROM_RSM: &str = "shaders/rsm-light.wgsl";
const SPLAT: &str = "passes/splat/splat.wgsl";
const POINTS: &str = "shaders/points-on-the-fly.wgsl";
const SETTLE: &str = "passes/settle-by-rays/lookup.wgsl";
const GATHER: &str = "shaders/gather-lights.wgsl";
const FILTER: &str = "passes/geometry-aware-blur/geometry-aware-blur.wgsl";
const IMAGE: &str = "passes/composite/composite.wgsl";
const VIEW: &str = "passes/gbuffer/gbuffer.wgsl";

const FAULTS: &[Fault] = &[
    ("lights", FROM_RSM, "texel, whole.rgb, ON_SURFACE", "texel, whole.rgb * 1.1, ON_SURFACE"),
    ("lights", SAMPLER, "let weight = 1.0 / (", "let weight = 0.9 / ("),
    ("rsm", RSM, "albedo.rgb * beam.flux", "beam.flux"),
    ("rsm", RSM, "vec4(at.albedo, share)", "vec4(at.albedo * at.albedo, share)"),
    ("lights", SAMPLER, "row.probability * column.probability", "row.probability / f32(size.x)"),
    ("lights", SAMPLER, "layer.index, row.index), size.x", "layer.index, size.y / 2u), size.x"),
    (
        "lights",
        FROM_RSM,
        "VirtualLight(position.xyz, whole",
        "VirtualLight(position.xyz + 0.1 * normal, whole",
    ),
    ("lights", FROM_RSM, "share, normal, texel", "share, normalize(normal + vec3(0.0, 0.7, 0.0)), texel"),
    ("lights", FROM_RSM, "texel, whole.rgb, ON_SURFACE", "texel, vec3(luminance(whole.rgb)), ON_SURFACE"),
    ("lights", SAMPLER, "select(settings.count, 0u, none)", "select(settings.count - 4u, 0u, none)"),
    ("shadows/splat", SPLAT, "bitcast<u32>(stored)", "bitcast<u32>(stored * 0.9)"),
    ("shadows/splat", SPLAT, "at.y * tile + at.x]", "at.y * tile + at.x + 1u]"),
    ("shadows/splat", SPLAT, "frame_from_normal(light.normal);", "frame_from_normal(-light.normal);"),
    ("shadows/splat", SPLAT, "if stored >= 0.0 {", "if stored >= 0.0 && stored < 0.6 {"),
    (
        "shadows/splat",
        SPLAT,
        "map_position(light.kind, splat.local, distance);",
        "map_position(light.kind, splat.local, distance).yx;",
    ),
    ("shadows/points", POINTS, "shape.w * share", "0.1 * shape.w * share"),
    ("shadows/settle", SETTLE, "if own - doubt > stored {", "if own - doubt > stored * 0.7 {"),
    ("shadows/settle", SETTLE, "select(0.0, 1.0, is_free(light, at, normal, -verdict))", "1.0"),
    ("shadows/settle", SETTLE, "select(0.0, 1.0, is_free(light, at, normal, -verdict))", "0.0"),
    ("shadows/settle", SETTLE, "origin_in_atlas(index), texel)", "origin_in_atlas(index + 1u), texel)"),
    (
        "shadows/settle",
        SETTLE,
        "texel_in_map(lookup.position, tile);",
        "texel_in_map(lookup.position, tile).yx;",
    ),
    ("gather", GATHER, "receivers[r].sum * f32(subsets)", "receivers[r].sum * f32(subsets + subsets / 8u)"),
    ("gather", GATHER, "subsets - first, 1u)", "subsets - first - select(0u, 1u, subsets > 1u), 1u)"),
    ("gather", GATHER, "settings.view_size), whole);", "settings.view_size), whole * 0.5);"),
    ("filter", FILTER, "select(alone, sum / weights,", "select(alone, sum / weights * 1.1,"),
    (
        "filter",
        FILTER,
        "if !is_same_surface(around, vec2(column, row), settings.alpha, settings.beta) {",
        "if false {",
    ),
    ("filter", FILTER, "inside(i32(pixel.y) + y,", "inside(i32(pixel.y) + y + 4,"),
    ("filter", FILTER, "weights += weight;", "weights += 1.0;"),
    (
        "filter",
        FILTER,
        "weight * textureLoad(values, other, 0)",
        "weight * floor(textureLoad(values, other, 0) * 2.0) / 2.0",
    ),
    ("image", IMAGE, ".rgb / PI * texture", ".rgb / 3.0 * texture"),
    ("image", IMAGE, ".rgb / PI * texture", ".rrr / PI * texture"),
    ("image", IMAGE, "textureLoad(indirect, sample, 0)", "textureLoad(indirect, sample / 4u * 4u, 0)"),
    ("view", VIEW, "normals.share * at.albedo", "normals.share * sqrt(at.albedo)"),
    ("view", VIEW, "return depth + select(", "return 1.05 * depth + select("),
    (
        "view",
        VIEW,
        "vec4(normals.shading, 0.0)",
        "vec4(normalize(normals.shading + vec3(0.3, 0.0, 0.0)), 0.0)",
    ),
    (
        "gather",
        "shaders/bounded-geometry.wgsl",
        "max(-dot(normal, offset), 0.0)",
        "max(-dot(normal, offset), 0.5 * length(offset))",
    ),
    ("gather", "shaders/light-geometry.wgsl", "vec4(flux * terms.x,", "vec4(flux * terms.x * 1.1,"),
    ("gather", GATHER, "visibility(index, light, place.at, place.plane)", "1.0"),
    (
        "gather",
        "shaders/view-place.wgsl",
        "pixel_ray(vec2<f32>(inside),",
        "pixel_ray(vec2<f32>(inside) + 1.0,",
    ),
    (
        "gather",
        "passes/gather/gather.wgsl",
        "irradiance, pixel, sum)",
        "irradiance, pixel, sum * vec4(1.0, 1.0, 0.5, 1.0))",
    ),
];

/// Returns the text of the file with the fault.
fn with_fault((_, file, good, bad): &Fault) -> String {
    let text = std::fs::read_to_string(root().join(file)).unwrap();
    assert!(text.contains(good), "{file} has no `{good}`");
    text.replace(good, bad)
}

#[test]
fn the_forty_faults_are_faults_of_these_files() {
    assert_eq!(FAULTS.len(), 40);
    FAULTS.iter().for_each(|fault| assert!(with_fault(fault).contains(fault.3), "{fault:?}"));
}

/// Returns the faults that are blamed on another pass than the one that has them; without a fault, nothing must be blamed.
fn missed(folder: &Folder, faults: &[Fault]) -> Vec<String> {
    let run = |more: &[&str]| {
        let own = ["ism-invtm", "cornell-box", "--seeds", "4"];
        blame(folder, &[&own, QUICK, more].concat()).success().json()
    };
    run(&["-o", "clean"]);
    assert_eq!(run(&["-o", "again", "--against", "clean/shares.json"])["changes"], serde_json::json!([]));
    let mut missed = Vec::new();
    for (at, fault @ (pass, file, _, bad)) in faults.iter().enumerate() {
        folder.write(&format!("{at}/{file}"), &with_fault(fault));
        let tree = folder.name(&at.to_string());
        let found = run(&["--root", &tree, "-o", "faulty", "--against", "clean/shares.json"]);
        let blamed = found["blamed"].as_array().unwrap();
        let owes = |row: &Value| row["passes"].as_array().unwrap().iter().any(|name| name == pass);
        if !blamed.iter().any(owes) {
            missed.push(format!("{pass}: `{bad}` in {file}: {:#}", found["changes"]));
        }
    }
    missed
}

#[test]
fn a_fault_is_blamed_on_the_pass_that_has_it() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    // One of each row: sampling, maps, the pattern, the filter, what reflects, and what is left.
    let faults = [0, 12, 21, 24, 32, 36].map(|at| FAULTS[at]);
    assert_eq!(missed(&folder, &faults), Vec::<String>::new());
}

/// All forty faults: some ten minutes.
#[test]
#[ignore = "slow"]
fn measurement_of_forty_faults() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    let missed = missed(&folder, FAULTS);
    println!("{} of {} faults are blamed on another pass: {missed:#?}", missed.len(), FAULTS.len());
    assert!(missed.len() <= 6, "{missed:#?}");
}
