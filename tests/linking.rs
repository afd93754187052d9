//! Errors of linking shaders to a pipeline name the line of the shader and the pass that uses it; no GPU takes part.

use crate::program::Folder;
use frame_graph::{LinkContext, Overrides};
use renderer::{Assets, Catalog, Compiled};

const PIPELINE: &str = r#"Pipeline(
    passes: {
        "view": Pass(kind: "gbuffer"),
        "count": Pass(
            kind: "compute", shader: "shaders/count.wgsl",
            in: { "view": "view", "before": "prev count.after" },
            out: { "after": Out(size: (1, 1)) },
        ),
    },
    outputs: { "count": "count.after" },
)"#;

const SHADER: &str = r#"#import "settings.wgsl"
var<uniform> settings: Settings;
var view_depth: texture_2d<f32>;
var before: texture_2d<f32>;
var after: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(1)
fn count() {
    let last = textureLoad(before, vec2(0u), 0) + f32(textureDimensions(view_depth).x);
    textureStore(after, vec2(0u), last + f32(settings.before_age));
}
"#;

const SETTINGS: &str = "// Imported.\nstruct Settings {\n    before_age: u32,\n}\n";

/// Returns the errors of the pipeline with this text replaced in its files.
fn errors_with(from: &str, to: &str) -> String {
    let files = [
        ("pipelines/own.ron", PIPELINE),
        ("shaders/count.wgsl", SHADER),
        ("shaders/settings.wgsl", SETTINGS),
    ];
    let files = files.map(|(name, text)| (name, text.replace(from, to)));
    let folder = Folder::new(&files.each_ref().map(|(name, text)| (*name, text.as_str())));
    let catalog = Catalog::new(Assets::new(Some(folder.to_path_buf())));
    let scene = renderer::load_scene(&catalog, "cornell-box").expect("it is built in");
    let context = LinkContext { frame: (16, 16), traits: scene.traits() };
    let options = renderer::compile_options();
    let compiled = Compiled::new(&catalog, "own", &Overrides::default(), &context, &options);
    compiled.err().map_or_else(String::new, |errors| errors.to_string())
}

fn assert_states(errors: &str, words: &[&str]) {
    for word in words {
        assert!(errors.contains(word), "expected `{word}` in: {errors}");
    }
}

#[test]
fn a_member_without_a_value_is_shown_where_it_is_declared() {
    let errors = errors_with("before_age", "befor_age");
    let place = "shaders/settings.wgsl:3:5";
    assert_states(
        &errors,
        &["L006", place, "did you mean `before_age`?", "pipelines/own.ron:4:9", "in this pass"],
    );
}

#[test]
fn a_global_that_does_not_fit_is_shown_where_it_is_declared() {
    let errors = errors_with("var view_depth: texture_2d<f32>;", "var view_depth: texture_2d<u32>;");
    let line = "declare it as `var view_depth: texture_2d<f32>;`";
    let found = "`view_depth` is declared as texture_2d<u32>, but `view.depth` is a texture of r32float";
    assert_states(&errors, &["L004", "shaders/count.wgsl:3:5", "pipelines/own.ron:4:9", found, line]);
}

#[test]
fn a_mistake_in_the_output_of_a_pass_that_reads_its_own_history_is_reported_itself() {
    let size = errors_with("size: (1, 1)", "size: \"like(vew)\"");
    assert_states(&size, &["E050", "did you mean `view`?"]);
    let facts = r#"interface: "Irradiance", size: (1, 1), facts: { "interleav_x": 2 }"#;
    let fact = errors_with("size: (1, 1)", facts);
    assert_states(&fact, &["E025", "did you mean `interleave_x`?"]);
    assert!(![&size, &fact].iter().any(|errors| errors.contains("E051")), "{size}{fact}");
}

#[test]
fn no_name_is_offered_where_there_is_none() {
    let shader = "/// Counts. [threads: nosuch]\n@compute @workgroup_size(1)";
    let errors = errors_with("@compute @workgroup_size(1)", shader);
    assert_states(&errors, &["there is no setting `nosuch`"]);
    assert!(!errors.contains("there are nothing"), "{errors}");
}

#[test]
fn an_attribute_that_is_misspelt_is_refused() {
    let shader = "/// Sums. [scrach]\nvar<storage, read_write> sums: array<u32, 4>;\n\n@compute";
    let errors = errors_with("@compute", shader);
    assert_states(&errors, &["there is no `scrach`", "did you mean `scratch`?", "shaders/count.wgsl:7:"]);
    // Units are no attributes.
    assert_eq!(errors_with("@compute", "/// Counts. [px], [W/m²], [size], [samples/px]\n@compute"), "");
}
