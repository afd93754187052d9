//! Frames of other engines: their measures, and what is wrong with them.

use crate::program::{Done, Folder, command};
use metrics::{Display, Image};
use std::path::Path;

fn judge(folder: &Path, arguments: &[&str]) -> Done {
    Done::of(command(folder).arg("judge").args(arguments))
}

/// Writes a picture: a bright corner on a slope, times a level.
fn write(folder: &Folder, name: &str, level: f32, size: (usize, usize), mirrored: bool) {
    let path = folder.at(name);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    let pixel = |index: usize| {
        let (x, y) = (index % size.0, index / size.0);
        let x = if mirrored { size.0 - 1 - x } else { x };
        let value = level * if x < 5 && y < 9 { 3.0 } else { 0.1 + 0.1 * x as f32 };
        [value, value, value, 1.0]
    };
    let image = Image::new(size.0, size.1, (0..size.0 * size.1).map(pixel).collect()).unwrap();
    image.write(&path, Display::AS_IS, None).unwrap();
}

const SIZE: (usize, usize) = (16, 12);

fn frames(folder: &Folder, name: &str, levels: &[f32]) {
    for (number, level) in (3..).zip(levels) {
        write(folder, &format!("{name}/beauty.{number:04}.exr"), *level, SIZE, false);
    }
}

#[test]
fn frames_are_measured_against_a_sequence() {
    let folder = Folder::new(&[("times.csv", "frame,ms\n3,2\n4,9\n5,4\n6,4\n7,4\n8,4\n")]);
    // The light changes in frame 5; the engine arrives two frames later.
    frames(&folder, "truth", &[1.0, 1.0, 2.0, 2.0, 2.0, 2.0]);
    frames(&folder, "engine", &[1.0, 1.0, 1.2, 1.6, 2.0, 2.0]);
    frames(&folder, "prompt", &[1.1, 1.1, 2.2, 2.2, 2.2, 2.2]);
    let arguments =
        ["engine", "prompt", "truth", "--change-at", "5", "--ms", "times.csv", "--ms", "6", "-o", "out"];
    let json = judge(&folder, &[&arguments[..], &["--json"]].concat()).success().json();
    let of =
        |engine: usize, measure: &str| json["engines"][engine]["measures"][measure]["mean"].as_f64().unwrap();
    let near = |found: f64, expected: f64| {
        assert!((found - expected).abs() < 1e-4, "{found} is not {expected}: {json}");
    };
    assert_eq!(
        (&json["engines"][0]["name"], &json["engines"][1]["name"]),
        (&"engine".into(), &"prompt".into())
    );
    near(of(0, "lag"), 2.0);
    near(of(1, "lag"), 0.0);
    // The mean over frames of 1, 1, 0.6, 0.8, 1, 1.
    near(of(0, "energy"), 0.9);
    near(of(1, "energy"), 1.1);
    near(of(0, "gpu-ms"), 4.0);
    near(of(1, "gpu-ms"), 6.0);
    assert!(of(0, "tone-change") > of(1, "tone-change"), "{json}");
    let table = folder.read("out/frames.csv");
    assert!(table.contains("truth,engine,1,5,energy,0.6"), "{table}");
    let page = folder.read("out/report.html");
    for word in
        ["given time", "lightloom judge engine prompt truth --change-at 5 --ms times.csv --ms 6 -o DIR"]
    {
        assert!(page.contains(word), "no `{word}` in the page");
    }
    // The same again measures nothing again, and says the same.
    let again = judge(&folder, &arguments).success();
    again.says(&["2 of 2 cells are finished already", "engine", "lag", "report.html"]);
}

#[test]
fn runs_give_intervals_and_a_still_scene_its_flicker() {
    let folder = Folder::new(&[]);
    write(&folder, "truth.exr", 1.0, SIZE, false);
    for (run, levels) in
        [("engine/a", [1.1, 0.9, 1.1]), ("engine/b", [0.9, 1.1, 0.9]), ("engine/c", [1.0, 1.0, 1.0])]
    {
        frames(&folder, run, &levels);
    }
    let json = judge(&folder, &["engine", "truth.exr", "--json"]).success().json();
    let measures = &json["engines"][0]["measures"];
    let energy = &measures["energy"];
    assert!((energy["mean"].as_f64().unwrap() - 1.0).abs() < 1e-5 && energy["seeds"] == 3, "{json}");
    // Student's t of two degrees of freedom, 4.303, times 0.1 / √3.
    assert!((energy["half"].as_f64().unwrap() - 0.2484).abs() < 1e-3, "{json}");
    let flicker = measures["static-deviation"]["mean"].as_f64().unwrap();
    let expected = (0.2 / 3.0_f64.sqrt() / (3.1 / 3.0) + 0.2 / 3.0_f64.sqrt() / (2.9 / 3.0)) / 3.0;
    assert!((flicker - expected).abs() < 1e-3, "{flicker} is not {expected}");
    assert!(measures["variance"]["mean"].as_f64().unwrap() > 0.0, "{json}");
    assert!(folder.at("out/judge/report.html").is_file());
    // A single picture, and the frames as a shell lists them.
    judge(&folder, &["truth.exr", "truth.exr", "-o", "one"]).success().says(&["truth", "relMSE"]);
    let listed = ["engine/a/beauty.0003.exr", "engine/a/beauty.0004.exr", "truth.exr", "-o", "two"];
    judge(&folder, &listed).success().says(&["static deviation"]);
}

#[test]
fn what_is_wrong_with_frames_is_said() {
    let folder =
        Folder::new(&[("few.csv", "1\n2\n"), ("odd.csv", "ms\n1\nfast\n3\n"), ("text/readme.txt", "")]);
    write(&folder, "truth.exr", 1.0, SIZE, false);
    frames(&folder, "engine", &[1.0, 1.0, 1.0]);
    frames(&folder, "truth", &[1.0, 1.0]);
    let fails = |arguments: &[&str], words: &[&str]| {
        judge(&folder, arguments).failure(1, words);
    };
    fails(&["nowhere", "truth.exr"], &["nowhere: there is no such file or folder"]);
    fails(&["engine", "nowhere.exr"], &["nowhere.exr: there is no such file or folder"]);
    fails(
        &["text", "truth.exr"],
        &["text: expected pictures, files that end in .exr, .pfm or .hdr; found none"],
    );
    fails(&["engine", "truth"], &["expected one picture, or as many as there are frames, 3; found 2"]);
    fails(&["engine", "truth.exr", "--change-at", "3"], &["--change-at 3", "from 4 to 5"]);
    fails(&["engine", "truth.exr", "--ms", "few.csv"], &["expected a line for each of 3 frames, found 2"]);
    fails(&["engine", "truth.exr", "--ms", "odd.csv"], &["odd.csv:3: expected milliseconds", "`fast`"]);
    fails(&["engine", "truth.exr", "--ms", "none.csv"], &["--ms none.csv: expected a number, or a CSV file"]);
    fails(&["engine", "truth.exr", "--ms", "1", "--ms", "2"], &["--ms is given 2 times for 1 engines"]);
    judge(&folder, &["engine", "truth.exr", "--ms", "-1"]).failure(2, &[]);
    judge(&folder, &["engine"]).failure(2, &[]);

    std::fs::remove_file(folder.at("engine/beauty.0004.exr")).unwrap();
    fails(&["engine", "truth.exr"], &["frame 4 is missing between"]);
    frames(&folder, "engine", &[1.0, 1.0, 1.0]);
    write(&folder, "engine/normal.0004.exr", 1.0, SIZE, false);
    fails(&["engine", "truth.exr"], &["frame 4 is twice", "beauty.0004.exr", "normal.0004.exr"]);
    std::fs::rename(folder.at("engine/normal.0004.exr"), folder.at("engine/normal.exr")).unwrap();
    fails(&["engine", "truth.exr"], &["normal.exr: expected a number in the name of each frame"]);

    write(&folder, "large/0.exr", 1.0, (17, 12), false);
    fails(&["large", "truth.exr"], &["large/0.exr", "17x12", "16x12"]);
    std::fs::remove_file(folder.at("engine/normal.exr")).unwrap();
    write(&folder, "engine/beauty.0005.exr", 1.0, (17, 12), false);
    fails(
        &["engine", "truth.exr", "-o", "sizes"],
        &["beauty.0005.exr: it is 17x12", "1 of 1 could not be measured"],
    );
    write(&folder, "mirrored.exr", 1.0, SIZE, true);
    judge(&folder, &["mirrored.exr", "truth.exr", "-o", "mirrored"])
        .success()
        .says(&["mirrored.exr may be of another camera: it fits the reference when mirrored left to right"]);
}
