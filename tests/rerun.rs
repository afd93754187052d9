//! `lightloom rerun`: pictures again from their own records.

use crate::adapter::{gpu, root};
use crate::cli::{QUICK, err, out, render, run_in};
use metrics::Image;

#[test]
fn a_picture_can_be_made_again_from_itself() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let done =
        render(folder.path(), "ism", "a.exr", &["--seed", "7", "--output", "indirect", "--frames", "2"]);
    assert!(done.status.success(), "{}", err(&done));
    let again = run_in(folder.path(), &["rerun", "a.exr", "-o", "b.exr"]);
    assert!(out(&again).contains("the same, bit for bit"), "{}{}", out(&again), err(&again));
    let compared = run_in(folder.path(), &["compare", "a.exr", "b.exr", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&out(&compared)).unwrap();
    assert_eq!(json["rmse"], 0.0, "{json}");
    assert_eq!(json["ssim"], 1.0, "{json}");
    std::fs::write(folder.path().join("c.png"), b"no picture").unwrap();
    assert_eq!(run_in(folder.path(), &["rerun", "c.png"]).status.code(), Some(1));
}

#[test]
fn a_picture_is_made_again_from_any_folder_with_the_files_that_it_names() {
    if gpu().is_none() {
        return;
    }
    let (folder, elsewhere) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let (mine, moved) = (folder.path().join("mine"), folder.path().join("moved"));
    std::fs::create_dir_all(mine.join("files")).unwrap();
    let pipeline = "Pipeline(extends: \"ism.ron\", patch: [Insert(name: \"shade\", pass: Pass(kind: \"fullscreen\", \
                    shader: \"shade.wgsl\", out: { \"result\": Out(interface: \"Display\") }), \
                    between: (\"image.display\", \"out.display\"))])";
    let shade = "var picture: texture_2d<f32>;\n@fragment\nfn shade(@builtin(position) at: vec4<f32>) -> \
                 @location(0) vec4<f32> {\nreturn textureLoad(picture, vec2<u32>(at.xy), 0);\n}\n";
    std::fs::write(mine.join("files/mine.ron"), pipeline).unwrap();
    std::fs::write(mine.join("files/shade.wgsl"), shade).unwrap();
    std::fs::copy(root().join("scenes/cornell-box.ron"), mine.join("files/box.ron")).unwrap();
    let arguments = ["render", "files/mine", "files/box.ron", "-o", "out/a.exr", "--output", "display"];
    let done = run_in(&mine, &[&arguments, QUICK].concat());
    assert!(done.status.success(), "{}", err(&done));
    // The folder and the picture in it can be moved together, and asked from elsewhere.
    std::fs::rename(&mine, &moved).unwrap();
    let picture = moved.join("out/a.exr").to_string_lossy().into_owned();
    let again = run_in(elsewhere.path(), &["rerun", &picture, "-o", "b.exr"]);
    assert!(out(&again).contains("the same, bit for bit"), "{}{}", out(&again), err(&again));
    assert!(err(&again).contains("made again from") && elsewhere.path().join("b.exr").is_file());
    // A picture that was moved alone is made again from the folder where the files are, and else tells where it looked.
    std::fs::copy(&picture, elsewhere.path().join("c.exr")).unwrap();
    let c = elsewhere.path().join("c.exr").to_string_lossy().into_owned();
    let again = run_in(&moved, &["rerun", &c]);
    assert!(out(&again).contains("the same, bit for bit"), "{}{}", out(&again), err(&again));
    let lost = run_in(elsewhere.path(), &["rerun", &c]);
    let here = elsewhere.path().canonicalize().unwrap();
    assert_eq!(lost.status.code(), Some(1));
    let told = err(&lost);
    assert!(
        told.contains("the pipeline `files/mine` of the record is not there: looked in the tree"),
        "{told}"
    );
    assert!(told.contains(&here.display().to_string()), "{told}");
}

#[test]
fn display_light_is_made_again_as_it_was_shown() {
    if gpu().is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let shown: [&[&str]; 3] = [&[], &["--tonemap", "aces", "--exposure", "2"], &["--output", "display"]];
    for (i, more) in shown.into_iter().enumerate() {
        let (first, second) = (format!("{i}.png"), format!("{i}-again.png"));
        assert!(render(folder.path(), "ism", &first, more).status.success());
        let again = run_in(folder.path(), &["rerun", &first, "-o", &second]);
        assert!(out(&again).contains("the same picture, in 8 bits"), "{}{}", out(&again), err(&again));
        let [a, b] = [first, second].map(|name| Image::read(folder.path().join(name)).unwrap());
        assert_eq!(a.pixels(), b.pixels(), "{more:?}");
    }
    // What differs is told: another exposure than that of the record.
    let text = metrics::read_provenance(folder.path().join("1.png")).unwrap().unwrap();
    let picture = Image::read(folder.path().join("0.png")).unwrap();
    picture.write(folder.path().join("mixed.png"), metrics::Display::AS_IS, Some(&text)).unwrap();
    let told = out(&run_in(folder.path(), &["rerun", "mixed.png"]));
    assert!(told.contains("the largest difference of a channel"), "{told}");
}
