//! `lightloom rerun`: pictures again from their own records.

use crate::adapter::root;
use crate::program::{Folder, QUICK, render, run_in};
use metrics::Image;

#[test]
fn a_picture_can_be_made_again_from_itself() {
    let Some(folder) = Folder::with_gpu(&[("c.png", "no picture")]) else { return };
    let values = ["--seed", "7", "--output", "indirect", "--frames", "2"];
    render(&folder, "ism", "a.exr", &values).success();
    run_in(&folder, &["rerun", "a.exr", "-o", "b.exr"]).says(&["the same, bit for bit"]);
    let json = run_in(&folder, &["compare", "a.exr", "b.exr", "--json"]).json();
    assert_eq!(json["rmse"], 0.0, "{json}");
    assert_eq!(json["ssim"], 1.0, "{json}");
    run_in(&folder, &["rerun", "c.png"]).failure(1, &[]);
}

#[test]
fn a_picture_is_made_again_from_any_folder_with_the_files_that_it_names() {
    let pipeline = "Pipeline(extends: \"ism.ron\", patch: [Insert(name: \"shade\", pass: Pass(kind: \"fullscreen\", \
                    shader: \"shade.wgsl\", out: { \"result\": Out(interface: \"Display\") }), \
                    between: (\"image.display\", \"out.display\"))])";
    let shade = "var picture: texture_2d<f32>;\n@fragment\nfn shade(@builtin(position) at: vec4<f32>) -> \
                 @location(0) vec4<f32> {\nreturn textureLoad(picture, vec2<u32>(at.xy), 0);\n}\n";
    let files = [("mine/files/mine.ron", pipeline), ("mine/files/shade.wgsl", shade)];
    let Some(folder) = Folder::with_gpu(&files) else { return };
    let elsewhere = Folder::new(&[]);
    let (mine, moved) = (folder.at("mine"), folder.at("moved"));
    std::fs::copy(root().join("scenes/cornell-box.ron"), mine.join("files/box.ron")).unwrap();
    let arguments = ["render", "files/mine", "files/box.ron", "-o", "out/a.exr", "--output", "display"];
    run_in(&mine, &[&arguments, QUICK].concat()).success();
    // The folder and the picture in it can be moved together, and rendered again from elsewhere.
    std::fs::rename(&mine, &moved).unwrap();
    let picture = folder.name("moved/out/a.exr");
    run_in(&elsewhere, &["rerun", &picture, "-o", "b.exr"])
        .says(&["the same, bit for bit", "made again from"]);
    assert!(elsewhere.at("b.exr").is_file());
    // A picture that was moved alone is made again from the folder where the files are; elsewhere the message lists the
    // folders that were searched.
    std::fs::copy(&picture, elsewhere.at("c.exr")).unwrap();
    let c = elsewhere.name("c.exr");
    run_in(&moved, &["rerun", &c]).says(&["the same, bit for bit"]);
    let here = elsewhere.canonicalize().unwrap().display().to_string();
    let words = "the pipeline `files/mine` of the record is not there: looked in the tree";
    run_in(&elsewhere, &["rerun", &c]).failure(1, &[words, &here]);
}

#[test]
fn display_light_is_made_again_as_it_was_shown() {
    let Some(folder) = Folder::with_gpu(&[]) else { return };
    let shown: [&[&str]; 3] = [&[], &["--tonemap", "aces", "--exposure", "2"], &["--output", "display"]];
    for (i, more) in shown.into_iter().enumerate() {
        let (first, second) = (format!("{i}.png"), format!("{i}-again.png"));
        render(&folder, "ism", &first, more).success();
        run_in(&folder, &["rerun", &first, "-o", &second]).says(&["the same picture, in 8 bits"]);
        let [a, b] = [first, second].map(|name| Image::read(folder.at(&name)).unwrap());
        assert_eq!(a.pixels(), b.pixels(), "{more:?}");
    }
    // The difference is reported: another exposure than that of the record.
    let text = metrics::read_provenance(folder.at("1.png")).unwrap().unwrap();
    let picture = Image::read(folder.at("0.png")).unwrap();
    picture.write(folder.at("mixed.png"), metrics::Display::AS_IS, Some(&text)).unwrap();
    run_in(&folder, &["rerun", "mixed.png"]).says(&["the largest difference of a channel"]);
}
