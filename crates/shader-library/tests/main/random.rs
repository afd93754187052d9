//! Whatever the text, there is a shader or an error with a place, never a panic.

use crate::library;
use proptest::prelude::*;
use shader_library::Request;

/// Lines that are often right, so that random files get past the first of them.
fn line() -> impl Strategy<Value = String> {
    let wgsl = prop::sample::select(vec![
        "@compute @workgroup_size(1) fn main() { }",
        "struct Settings {",
        "/// Doc [default: 1.0, min: 0, max: 2]",
        "/// [default: \"é\", one_of: [\"é\", \"b\"]]",
        "/// [bool, default: tr",
        "a: f32,",
        "b: u32,",
        "}",
        "var<uniform> s: Settings;",
        "fn f() -> f32 { return 1.0; }",
        "/* comment /* */",
        "*/",
        "let é = 1u;",
        "var t: texture_storage_2d<rgba16float, write>;",
    ]);
    let directive = prop::sample::select(vec![
        "#option A true",
        "#option B 3 one_of [1, 3]",
        "#option C box",
        "#if A",
        "#if B == 3 || !(C != box && A)",
        "#elif C == gauss",
        "#else",
        "#endif",
        "#import \"a.wgsl\"",
        "#import \"b.wgsl\"",
        "#import interface \"i\"",
    ]);
    prop_oneof![4 => wgsl.prop_map(str::to_owned), 4 => directive.prop_map(str::to_owned), 1 => "#?\\PC{0,30}", 1 => any::<String>()]
}

fn file() -> impl Strategy<Value = String> {
    prop::collection::vec(line(), 0..14).prop_map(|lines| lines.join("\n"))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn any_files(main in file(), a in file(), b in file()) {
        let library = library(&[("main.wgsl", &main), ("a.wgsl", &a), ("b.wgsl", &b)]);
        let request = Request::new("main.wgsl").module("i", "b.wgsl");
        let errors = match library.load(&request) {
            Ok(shader) => {
                if let Some(layout) = &shader.interface.settings {
                    let _ = shader_library::write_struct(layout, &|_| Some(data_file::Value::U32(1)));
                }
                shader.settings().err()
            }
            Err(errors) => Some(errors),
        };
        for error in errors.iter().flat_map(|errors| &errors.0) {
            prop_assert_ne!(error.code, "S012", "naga panicked");
            prop_assert!(!error.labels.is_empty());
            for label in &error.labels {
                let text = label.span.source.text.get(label.span.start as usize..label.span.end as usize);
                prop_assert!(text.is_some(), "a place outside of the text: {:?}", label);
            }
        }
        prop_assert!(errors.is_none_or(|errors| !errors.to_string().is_empty()));
        let _ = library.variants(&request);
    }

    /// A valid file with a piece cut out: the half-written text that hot reload sees.
    #[test]
    fn half_written(start in 0_usize..900, len in 0_usize..60, insert in "\\PC{0,6}") {
        let mut text = HALF.to_owned();
        let start = text.floor_char_boundary(start);
        let end = text.ceil_char_boundary(start + len);
        text.replace_range(start..end, &insert);
        match library(&[("main.wgsl", &text)]).load(&Request::new("main.wgsl")) {
            Ok(shader) => drop(shader.settings()),
            Err(errors) => prop_assert!(errors.0.iter().all(|error| error.code != "S012"), "naga panicked"),
        }
    }
}

const HALF: &str = "\
#option TAPS 4 one_of [1, 4]
struct Settings {
    /// Brightness – more is brighter. [default: 1.0, min: 0.0, unit: \"EV\"]
    exposure: f32,
    /// How. [default: \"none\", one_of: [\"none\", \"all\"]]
    how: u32,
}
struct Light { position: vec3<f32>, flux: vec3<f32> }
var<uniform> settings: Settings;
var<storage> lights: array<Light>;
var source: texture_2d<f32>;
var image: texture_storage_2d<rgba16float, write>;
override size: u32 = 8u;
#if TAPS == 4
fn weight(x: f32) -> f32 { return exp2(settings.exposure) * x; }
#else
fn weight(x: f32) -> f32 { return x; }
#endif
@compute @workgroup_size(size, 8)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    var sum = vec3<f32>();
    for (var i = 0u; i < arrayLength(&lights); i++) { sum += lights[i].flux * weight(f32(i)); }
    switch settings.how { case 0u: { sum *= 2.0; } default: {} }
    textureStore(image, id.xy, vec4<f32>(sum + textureLoad(source, id.xy, 0).rgb, 1.0));
}
";
