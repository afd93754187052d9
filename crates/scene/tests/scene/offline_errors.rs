//! What is malformed in scenes of pbrt-v4 and Mitsuba 3: an error with its place, and never a panic.

use std::fs;
use std::path::Path;
use std::time::Duration;

use proptest::prelude::*;

use crate::broken::assert_sound;
use crate::common::{folder_of, load_bytes, try_load};

const LIMIT: Duration = Duration::from_secs(20);

/// Returns the errors of texts, one below the other, each as that of a file in a folder of its own.
fn errors(name: &str, texts: &[&str]) -> String {
    let mut all = String::new();
    for text in texts {
        let folder =
            folder_of(&[(name, text.as_bytes()), ("wedge.ply", b"ply\n"), ("broken.png", b"no picture")]);
        let error = try_load(&folder.path().join(name)).expect_err(text).to_string();
        let here = format!("{}/", folder.path().display());
        all += &error.replace(&here, "");
        all += "\n\n";
    }
    all
}

fn assert_snapshot(name: &str, text: &str) {
    insta::with_settings!({ prepend_module_to_snapshot => false, snapshot_path => "../snapshots", omit_expression => true }, {
        insta::assert_snapshot!(name, text);
    });
}

#[test]
fn errors_of_pbrt_state_what_was_expected() {
    let text = errors(
        "test.pbrt",
        &[
            "WorldBegin\nShpae \"sphere\"",
            "LookAt 0 0 0 0 0 1 0 1",
            "LookAt 0 0 0 0 0 1 0 0 2",
            "Rotate 20 0 0 0",
            "Scale 1 one 1",
            "Translate [ 1 2 3 4 ]",
            "WorldBegin AttributeBegin\nShape \"sphere\"",
            "WorldBegin AttributeBegin ObjectEnd",
            "AttributeEnd",
            "Shape \"sphere\" \"float radius\" [ 1 2 ]",
            "Shape \"sphere\" \"float radius\" -1",
            "Shape \"sphere\" \"point3 radius\" [ 1 2 3 ]",
            "Shape \"sphere\" \"flota radius\" 1",
            "Shape \"sphere\" \"float radius\" [ 1",
            "Shape \"sphere\" \"float radius\" 1 \"float radius\" 2",
            "Shape \"sphere",
            "Shape \"plymesh\" \"string filename\" \"wegde.ply\"",
            "Shape \"plymesh\" \"string filename\" \"wedge.ply\"",
            "Shape \"plymesh\" \"string filename\" \"../../etc/passwd\"",
            "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0 ] \"integer indices\" [ 0 1 3 ]",
            "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0  1 0 0  0 1 0 ] \"point2 uv\" [ 0 1 ]",
            "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0  1 0 ]",
            "MakeNamedMaterial \"wood\" \"string type\" \"diffuse\"\nNamedMaterial \"wod\"",
            "Material \"diffuse\" \"texture reflectance\" \"wood\"",
            "Material \"diffuse\" \"rgb reflectance\" [ 1 2 ]",
            "Material \"conductor\" \"spectrum eta\" \"metal-Ax-eta\"",
            "Material \"diffuse\" \"spectrum reflectance\" [ 500 1 400 1 ]",
            "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"broken.png\"",
            "LightSource \"spot\" \"float coneangle\" 100",
            "LightSource \"distant\" \"point3 to\" [ 0 0 0 ]",
            "ObjectInstance \"tree\"",
            "Include \"test.pbrt\"",
            "Transform [ 1 0 0 1  0 1 0 0  0 0 1 0  0 0 0 1 ]\nShape \"sphere\"",
            "Camera \"perspective\" \"float fov\" 180",
        ],
    );
    assert_snapshot("pbrt", &text);
}

#[test]
fn errors_of_mitsuba_state_what_was_expected() {
    let within = |texts: &[&str]| {
        let texts: Vec<String> =
            texts.iter().map(|text| format!("<scene version=\"3.0.0\">\n{text}\n</scene>")).collect();
        errors("test.xml", &texts.iter().map(String::as_str).collect::<Vec<_>>())
    };
    let text = within(&[
        "<shape type=\"sphere\"><float name=\"radius\" value=\"one\"/></shape>",
        "<shape type=\"sphere\"><string name=\"radius\" value=\"1\"/></shape>",
        "<shape type=\"sphere\"><float name=\"radius\"/></shape>",
        "<shape type=\"sphere\"><float name=\"radius\" value=\"$size\"/></shape>",
        "<shape/>",
        "<shape type=\"sphere\"></shap>",
        "<bsdf type=\"diffuse\" id=\"wood\"/><shape type=\"sphere\"><ref id=\"wod\"/></shape>",
        "<shape type=\"sphere\"><bsdf type=\"twosided\"/></shape>",
        "<shape type=\"ply\"><string name=\"filename\" value=\"wegde.ply\"/></shape>",
        "<shape type=\"obj\"><string name=\"filename\" value=\"wedge.ply\"/></shape>\n<shape type=\"ply\"/>",
        "<shape type=\"cube\"><transform name=\"to_world\"><matrix value=\"1 2 3\"/></transform></shape>",
        "<shape type=\"cube\"><transform name=\"to_world\"><translat x=\"1\"/></transform></shape>",
        "<shape type=\"cube\"><transform name=\"to_world\"><rotate angle=\"3\"/></transform></shape>",
        "<shape type=\"cube\"><transform name=\"to_world\"><lookat origin=\"0,0,0\" target=\"0,1,0\" up=\"0,1,0\"/></transform></shape>",
        "<shape type=\"cube\"><bsdf type=\"conductor\"><string name=\"material\" value=\"Agg\"/></bsdf></shape>",
        "<shape type=\"cube\"><bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"1 2\"/></bsdf></shape>",
        "<shape type=\"cube\"><bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"#12345\"/></bsdf></shape>",
        "<shape type=\"cube\"><emitter type=\"area\"/></shape>",
        "<shape type=\"instance\"/>",
        "<sensor type=\"perspective\"><string name=\"fov_axis\" value=\"z\"/><float name=\"fov\" value=\"4\"/></sensor>",
        "<include filename=\"test.xml\"/>",
        "<alias id=\"a\" as=\"b\"/>",
        "<emitter type=\"spot\"><float name=\"cutoff_angle\" value=\"20\"/><float name=\"beam_width\" value=\"30\"/></emitter>",
    ]);
    let root = errors("test.xml", &["<scenes/>", ""]);
    assert_snapshot("mitsuba", &(text + &root));
}

/// Refused for what it asks for.
fn too_much(name: &'static str, text: String) {
    assert!(text.len() < 400_000, "{} bytes", text.len());
    let result =
        mutation::within(LIMIT, move || load_bytes(name, text.as_bytes()).map(|scene| scene.triangles()));
    let error = result.expect_err("it asks for too much").to_string();
    assert!(error.contains("it asks for ") && error.len() < 2000, "{error}");
}

#[test]
fn scenes_cannot_ask_for_gigabytes() {
    too_much("test.pbrt", format!("WorldBegin {}", "Shape \"sphere\"\n".repeat(20_000)));
    let instances = "ObjectInstance \"a\" ".repeat(15_000);
    too_much(
        "test.pbrt",
        format!("ObjectBegin \"a\" {} ObjectEnd {instances}", "Shape \"sphere\" ".repeat(40)),
    );
    too_much(
        "test.xml",
        format!("<scene version=\"3.0.0\">{}</scene>", "<shape type=\"sphere\"/>".repeat(15_000)),
    );
    let doubled = |i: usize| format!("<default name=\"a{}\" value=\"$a{i}$a{i}\"/>", i + 1);
    let defaults: String = (0..60).map(doubled).collect();
    too_much(
        "test.xml",
        format!("<scene version=\"3.0.0\"><default name=\"a0\" value=\"xxxx\"/>{defaults}</scene>"),
    );
}

#[test]
fn what_is_nested_without_end_is_refused() {
    let result = |name: &'static str, text: String| {
        let result =
            mutation::within(LIMIT, move || load_bytes(name, text.as_bytes()).map(|scene| scene.triangles()));
        result.expect_err("it is nested").to_string()
    };
    assert!(result("test.pbrt", "AttributeBegin ".repeat(20_000)).contains("within each other"));
    let deep = |tag: &str| {
        format!(
            "<scene version=\"3\">{}{}</scene>",
            format!("<{tag}>").repeat(10_000),
            format!("</{tag}>").repeat(10_000)
        )
    };
    assert!(result("test.xml", deep("shape")).contains("within each other"));
    let itself = "<scene version=\"3\"><bsdf type=\"twosided\" id=\"a\"><ref id=\"a\"/></bsdf><shape type=\"cube\"><ref id=\"a\"/></shape></scene>";
    assert!(result("test.xml", itself.to_owned()).contains("within each other"));
}

fn room(endings: &[&str]) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/room");
    let mut files: Vec<_> = fs::read_dir(folder).unwrap().flatten().map(|entry| entry.path()).collect();
    files.sort();
    files.retain(|file| endings.iter().any(|ending| file.extension().is_some_and(|known| known == *ending)));
    files.iter().map(|file| fs::read(file).unwrap()).collect()
}

fn texts(ending: &str) -> Vec<String> {
    // Small scenes, besides the room, whose other files are not there.
    let more = match ending {
        "pbrt" => "Film \"rgb\" \"integer xresolution\" 4\nLookAt 1 2 3 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" 40\nWorldBegin
            LightSource \"spot\" \"blackbody I\" 3000 \"float power\" 3\nLightSource \"infinite\" \"rgb L\" [ 1 2 3 ]
            Texture \"c\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [ 1 0 0 ] \"float uscale\" 4
            Material \"coateddiffuse\" \"texture reflectance\" \"c\" \"float roughness\" 0.1
            AttributeBegin AreaLightSource \"diffuse\" \"float power\" 4 Rotate 20 1 1 0 Shape \"disk\" AttributeEnd
            ObjectBegin \"o\" Shape \"cylinder\" Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ] ObjectEnd
            Scale 1 2 3 ObjectInstance \"o\" Material \"conductor\" Shape \"sphere\" \"float radius\" 2",
        _ => "<scene version=\"3.0.0\"><default name=\"r\" value=\"2\"/><sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/></sensor>
            <bsdf type=\"twosided\" id=\"b\"><bsdf type=\"roughplastic\"><texture name=\"diffuse_reflectance\" type=\"checkerboard\"/></bsdf></bsdf>
            <shape type=\"sphere\"><float name=\"radius\" value=\"$r\"/><ref id=\"b\"/></shape><emitter type=\"spot\"/>
            <shape type=\"shapegroup\" id=\"g\"><shape type=\"cube\"/></shape><shape type=\"instance\"><ref id=\"g\"/></shape>
            <shape type=\"disk\"><transform name=\"to_world\"><rotate x=\"1\" angle=\"3\"/></transform>
            <emitter type=\"area\"><spectrum name=\"radiance\" value=\"400:1, 500:2\"/></emitter></shape></scene>",
    };
    let room = room(&[ending]).into_iter().map(|bytes| String::from_utf8(bytes).unwrap());
    room.chain([more.to_owned()]).collect()
}

#[test]
fn the_small_scenes_themselves_are_good() {
    for (name, ending) in [("a.pbrt", "pbrt"), ("a.xml", "xml")] {
        let scene = load_bytes(name, texts(ending).pop().unwrap().as_bytes()).unwrap();
        assert!(scene.triangles() > 100 && !scene.materials.is_empty(), "{}", scene.triangles());
    }
}

proptest! {
    #![proptest_config(mutation::config(300))]

    #[test]
    fn scenes_of_pbrt_with_edits(text in mutation::texts(texts("pbrt"))) {
        assert_sound(mutation::within(LIMIT, move || load_bytes("test.pbrt", text.as_bytes())))?;
    }

    #[test]
    fn scenes_of_mitsuba_with_edits(text in mutation::texts(texts("xml"))) {
        assert_sound(mutation::within(LIMIT, move || load_bytes("test.xml", text.as_bytes())))?;
    }

    #[test]
    fn meshes_with_edits(bytes in mutation::bytes(room(&["ply", "obj"]))) {
        let load = move || {
            let kind = if bytes.starts_with(b"ply") { "ply" } else { "obj" };
            let scene = format!("<scene version=\"3\"><shape type=\"{kind}\"><string name=\"filename\" value=\"mesh\"/></shape></scene>");
            let folder = folder_of(&[("a.xml", scene.as_bytes()), ("mesh", &bytes)]);
            try_load(&folder.path().join("a.xml"))
        };
        assert_sound(mutation::within(LIMIT, load))?;
    }
}
