//! What is not supported of pbrt-v4 and Mitsuba 3: noted, as the table of the documentation says.

use std::fs;

use crate::common::{folder_of, root, states, try_load};
use crate::offline::{mitsuba, pbrt};

/// A triangle, which each scene has so that it is not empty.
const PBRT: &str = "Camera \"CAMERA\" WorldBegin LIGHT TEXTURE Material \"MATERIAL\" SHAPE
    Material \"diffuse\" Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ]";

const MITSUBA: &str =
    "<scene version=\"3.0.0\"><sensor type=\"CAMERA\"/>LIGHT<bsdf type=\"MATERIAL\" id=\"m\">INNER</bsdf>
    SHAPE<shape type=\"rectangle\"><bsdf type=\"diffuse\">TEXTURE</bsdf></shape></scene>";

/// Returns the parameters that a shape, a texture or a light of pbrt cannot be without.
fn needs_of_pbrt(name: &str) -> &'static str {
    match name {
        "trianglemesh" => "\"point3 P\" [ 0 0 0 1 0 0 0 1 0 ]",
        "bilinearmesh" => "\"point3 P\" [ 0 0 0 1 0 0 0 1 0 1 1 0 ]",
        "plymesh" => "\"string filename\" \"wedge.ply\"",
        "imagemap" => "\"string filename\" \"wall.png\"",
        _ => "",
    }
}

fn scene_of_pbrt(part: &str, name: &str) -> String {
    let statement = |directive: &str| format!("{directive} \"{name}\" {}", needs_of_pbrt(name));
    let of =
        |wanted: &str, made: String, default: &str| if part == wanted { made } else { default.to_owned() };
    PBRT.replace("CAMERA", &of("camera", name.to_owned(), "perspective"))
        .replace("LIGHT", &of("light", statement("LightSource"), "LightSource \"infinite\""))
        .replace(
            "TEXTURE",
            &of("texture", format!("Texture \"t\" \"spectrum\" \"{name}\" {}", needs_of_pbrt(name)), ""),
        )
        .replace("MATERIAL", &of("material", name.to_owned(), "diffuse"))
        .replace("SHAPE", &of("shape", statement("Shape"), "Shape \"sphere\""))
}

fn scene_of_mitsuba(part: &str, name: &str) -> String {
    let file = |name: &str| format!("<string name=\"filename\" value=\"{name}\"/>");
    let needs = match name {
        "ply" => file("wedge.ply"),
        "obj" => file("wall.obj"),
        "bitmap" => file("wall.png"),
        "envmap" => file("sky.exr"),
        _ => String::new(),
    };
    let inner = match name {
        "normalmap" => {
            "<texture name=\"normalmap\" type=\"bitmap\"><string name=\"filename\" value=\"wall.png\"/></texture><bsdf type=\"diffuse\"/>"
        }
        "bumpmap" => "<texture type=\"bitmap\"/><bsdf type=\"diffuse\"/>",
        "mask" => "<float name=\"opacity\" value=\"1\"/><bsdf type=\"diffuse\"/>",
        "twosided" | "blendbsdf" => "<bsdf type=\"diffuse\"/>",
        _ => "",
    };
    let of =
        |wanted: &str, made: String, default: &str| if part == wanted { made } else { default.to_owned() };
    let shape = |name: &str| format!("<shape type=\"{name}\">{needs}<ref id=\"m\"/></shape>");
    let texture = format!("<texture name=\"reflectance\" type=\"{name}\">{needs}</texture>");
    let light = format!("<emitter type=\"{name}\">{needs}</emitter>");
    MITSUBA
        .replace("CAMERA", &of("camera", name.to_owned(), "perspective"))
        .replace("LIGHT", &of("light", light, "<emitter type=\"constant\"/>"))
        .replace("TEXTURE", &of("texture", texture, ""))
        .replace("MATERIAL", &of("material", name.to_owned(), "diffuse"))
        .replace("INNER", if part == "material" { inner } else { "" })
        .replace(
            "SHAPE",
            &if part == "shape" {
                shape(name)
            } else {
                "<shape type=\"cube\"><ref id=\"m\"/></shape>".to_owned()
            },
        )
}

/// Loads a scene with the files of the room, and returns its notes that have places.
fn notes(name: &str, text: &str) -> Vec<String> {
    let folder = folder_of(&[(name, text.as_bytes())]);
    let room = root().join("crates/scene/tests/room");
    for file in ["wedge.ply", "wall.obj", "wall.png"] {
        fs::copy(room.join(file), folder.path().join(file)).unwrap();
    }
    let sky = metrics::Image::new(2, 1, vec![[1.0; 4]; 2]).unwrap();
    sky.write(folder.path().join("sky.exr"), metrics::Display::AS_IS, None).unwrap();
    let scene = try_load(&folder.path().join(name)).unwrap_or_else(|error| panic!("{text}\n{error}"));
    scene.repairs.into_iter().filter(|repair| repair.contains(name)).collect()
}

#[test]
fn the_table_of_what_is_understood_is_right() {
    let page = fs::read_to_string(root().join("docs/scenes.md")).unwrap();
    let names =
        |cell: &str| -> Vec<String> { cell.split('`').skip(1).step_by(2).map(str::to_owned).collect() };
    let mut checked = 0;
    for line in page.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| part")) {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let [_, part, of_pbrt, of_mitsuba, _, noted, _] = cells[..] else { panic!("{line}") };
        let of_pbrt = names(of_pbrt).into_iter().map(|name| ("test.pbrt", scene_of_pbrt(part, &name), name));
        let of_mitsuba =
            names(of_mitsuba).into_iter().map(|name| ("test.xml", scene_of_mitsuba(part, &name), name));
        for (file, text, name) in of_pbrt.chain(of_mitsuba) {
            let notes = notes(file, &text);
            assert_eq!(!notes.is_empty(), noted == "yes", "{part} `{name}` in {file}: {notes:?}\n{text}");
            checked += 1;
        }
    }
    assert!(checked > 70, "{checked} names are in the table");
}

#[test]
fn what_is_not_supported_is_noted_with_its_place() {
    let scene = pbrt(
        "Material \"dielectric\" \"float eta\" 1.5\nShape \"sphere\"\nMaterial \"hair\" \"float eumelanin\" 1\nShape \"disk\"
LightSource \"goniometric\"\nShape \"curve\" \"string type\" \"flat\"\nShape \"sphere\" \"float zmin\" 0 \"float twist\" 3
Texture \"n\" \"float\" \"fbm\"\nMakeNamedMedium \"fog\" \"string type\" \"homogeneous\"\nAttribute \"shape\" \"float radius\" 2
ColorSpace \"aces2065-1\"\n",
    );
    for words in [
        "test.pbrt:3:1: material `dielectric` is of glass (`dielectric`): what has it is left out",
        "test.pbrt:5:1: material `hair` is of the type `hair`, which is not supported: it is taken as matte grey",
        "test.pbrt:7:1: the light of type `goniometric` is left out",
        "test.pbrt:8:1: the shape of type `curve` is left out",
        "test.pbrt:9:16: the shape is not cut by `zmin`: all of it is there",
        "test.pbrt:9:31: Shape \"sphere\": the parameter `twist` is not supported: it is left out",
        "test.pbrt:10:1: a texture of type `fbm` is taken as grey",
        "test.pbrt:11:1: the medium `fog` is left out",
        "test.pbrt:12:1: `Attribute \"shape\"` is not supported: it is left out",
        "test.pbrt:13:12: the color space `aces2065-1` is not supported: its colors are taken as sRGB",
    ] {
        assert!(states(&scene, words), "no `{words}` in {:#?}", scene.repairs);
    }
    let scene = mitsuba(
        "<medium type=\"homogeneous\" id=\"m\"/>
<shape type=\"sphere\"><bsdf type=\"roughdielectric\"/></shape>
<shape type=\"cube\"><float name=\"twist\" value=\"1\"/><bsdf type=\"measured\" id=\"x\"/></shape>
<shape type=\"serialized\"><string name=\"filename\" value=\"a.serialized\"/></shape>
<emitter type=\"sunsky\"/><shape type=\"disk\"><bsdf type=\"bumpmap\"><texture type=\"bitmap\"/><bsdf type=\"diffuse\"/></bsdf></shape>
<shape type=\"disk\"><bsdf type=\"bumpmap\"><texture type=\"bitmap\"/><bsdf type=\"diffuse\"/></bsdf></shape>",
    );
    for words in [
        "test.xml:2:1: the element `<medium>` is not supported: it is left out",
        "test.xml:3:22: material `roughdielectric` is of glass (`roughdielectric`): what has it is left out",
        "test.xml:4:20: shape `cube`: `twist` is not supported: it is left out",
        "material `x` is of the type `measured`, which is not supported: it is taken as matte grey",
        "test.xml:5:1: the shape of type `serialized` is left out",
        "test.xml:6:1: the emitter of type `sunsky` is left out",
        "test.xml:6:44 and one more place: material `bumpmap`: its bumps are left out",
    ] {
        assert!(states(&scene, words), "no `{words}` in {:#?}", scene.repairs);
    }
}
