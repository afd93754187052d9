//! Settings declared in WGSL.

use crate::{library, shader};
use data_file::{Setting, Value, ValueType};
use shader_library::Request;

const SETTINGS: &str = "
struct Other { /** no */ exposure: u32 }
/* struct Settings { not: this } */
struct Settings {
    /// Brightness of the picture; more is brighter,
    /// and values in [0, 1] are dark [sic].
    /// [default: 1.0, min: 0.0,
    ///  max: 4.0, unit: \"EV\"].
    exposure: f32,
    // The framework fills this.
    seed: u32,
    /// Taps. [default: 4, one_of: [1, 4, 9]]
    @align(16) taps: u32,
    /// Shift in texels [px]. [default: -2, min: -8]
    shift: i32,
    /// [bool, default: true] Whether it is on.
    on: u32,
    /// How. [default: \"reinhard\", one_of: [\"none\", \"reinhard\", \"aces\"]]
    curve: u32, /// Tint. [default: (1, 0.5, 1e-3), min: 0]
    tint: vec3<f32>,
    table: array<vec4<f32>, 2>,
}
var<uniform> settings: Settings;
@compute @workgroup_size(1) fn main() { _ = settings.exposure; }
";

#[test]
fn declarations_are_read() {
    let setting = |name: &str, ty, default, doc: &str, declared: &str| Setting {
        name: name.to_owned(),
        ty,
        default,
        min: None,
        max: None,
        one_of: Vec::new(),
        unit: String::new(),
        doc: doc.to_owned(),
        declared: declared.to_owned(),
    };
    let doc = "Brightness of the picture; more is brighter, and values in [0, 1] are dark [sic].";
    let text = |text: &str| Value::Text(text.to_owned());
    let expected = [
        Setting {
            min: Some(0.0),
            max: Some(4.0),
            unit: "EV".to_owned(),
            ..setting("exposure", ValueType::F32, Value::F32(1.0), doc, "main.wgsl:9:5")
        },
        Setting {
            one_of: [1, 4, 9].map(Value::U32).to_vec(),
            ..setting("taps", ValueType::U32, Value::U32(4), "Taps.", "main.wgsl:13:16")
        },
        Setting {
            min: Some(-8.0),
            ..setting("shift", ValueType::I32, Value::I32(-2), "Shift in texels [px].", "main.wgsl:15:5")
        },
        setting("on", ValueType::Bool, Value::Bool(true), "Whether it is on.", "main.wgsl:17:5"),
        Setting {
            one_of: ["none", "reinhard", "aces"].map(text).to_vec(),
            ..setting("curve", ValueType::Text, text("reinhard"), "How.", "main.wgsl:19:5")
        },
        Setting {
            min: Some(0.0),
            ..setting(
                "tint",
                ValueType::Vector(3),
                Value::Vector(vec![1.0, 0.5, 1e-3]),
                "Tint.",
                "main.wgsl:20:5",
            )
        },
    ];
    assert_eq!(shader(SETTINGS).settings().unwrap(), expected);
}

#[test]
fn a_shader_without_settings_has_none() {
    let shader = shader("@compute @workgroup_size(1) fn main() {}");
    assert_eq!(shader.settings().unwrap(), []);
}

#[test]
fn broken_declarations() {
    let members = [
        "[defualt: 1.0] a: f32",
        "[default 1.0] b: f32",
        "[default: 1.0 c: f32",
        "[default: 1.0, min: 2.0] d: f32",
        "[min: 2.0] e: f32",
        "[default: 1.5] f: u32",
        "[default: -1] g: u32",
        "[default: true] h: u32",
        "[default: 1.0, unit: px] i: f32",
        "[default: 1.0, unit: 3] j: f32",
        "[default: 3, one_of: [1, 2]] k: u32",
        "[default: 3, one_of: 3] l: u32",
        "[default: 1.0, min: 3, max: 2] m: f32",
        "[default: (1, 2)] n: vec3<f32>",
        "[default: 1] o: mat3x3<f32>",
        "[default: 1, bool] p: i32",
        "[default: 1.0] and [default: 2.0] q: f32",
        "[default: 1.0, default: 2.0] r: f32",
        "[default: 1.0, default] s: f32",
        "[default: 1e99] t: f32",
        "[default: \"x] u: u32",
        "[default: inf] v: f32",
        "[default: ] w: f32",
        "[default: 1.0, , ] x: f32",
        "[range: 1.0] y: f32",
        "[default: \"a\", one_of: [\"a\", 2]] z: u32",
        "[default: true, bool, min: 0] zz: u32",
    ];
    let mut text = "struct Settings {\n".to_owned();
    for member in members {
        let (doc, declaration) = member.rsplit_once(' ').unwrap();
        let (doc, name) = doc.rsplit_once(' ').unwrap();
        text.push_str(&format!("    /// Ä. {doc}\n    {name} {declaration},\n"));
    }
    text.push_str("}\nvar<uniform> s: Settings;\n@compute @workgroup_size(1) fn main() { _ = s.a; }\n");
    let files = [("main.wgsl", "#import \"settings.wgsl\"\n"), ("settings.wgsl", &text)];
    let shader = library(&files).load(&Request::new("main.wgsl")).unwrap_or_else(|errors| panic!("{errors}"));
    let errors = shader.settings().unwrap_err();
    assert_eq!(errors.0.len(), members.len(), "{errors}");
    insta::with_settings!({ prepend_module_to_snapshot => false, omit_expression => true }, {
        insta::assert_snapshot!("settings", errors.to_string());
    });
}

#[test]
fn an_option_that_the_scene_chooses_has_a_value_for_that() {
    let text = "#option RAYS bvh one_of [bvh, query] auto query where QUERIES internal // How.\n@compute @workgroup_size(1) fn main() {}";
    let library = library(&[("main.wgsl", text)]);
    let outline = library.outline(&Request::new("main.wgsl")).unwrap();
    let option = &outline.options[0];
    let setting = option.setting();
    let words = |words: &[&str]| words.iter().map(|word| Value::Text((*word).to_owned())).collect::<Vec<_>>();
    assert_eq!(
        (setting.default, setting.one_of),
        (words(&["auto"])[0].clone(), words(&["auto", "bvh", "query"]))
    );
    assert_eq!((option.default.clone(), option.internal, &*option.doc), ("bvh".into(), true, "How."));
    assert_eq!(option.auto, Some(("query".into(), "queries".to_owned())));
    assert_eq!(library.variants(&Request::new("main.wgsl")).unwrap().len(), 2, "auto is no variant");
}
