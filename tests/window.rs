//! The window as a user has it before them: opened under Xvfb, moved by keys and the mouse, fed with edits of files.

mod viewer;

use crate::adapter::root;
use metrics::{Image, srgb_from_linear};
use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;
use viewer::{Home, Tree, Viewer, flip, turn};
use window_test::Button;

/// Longer than anything takes on a slow and busy machine.
const PATIENCE: Duration = Duration::from_secs(600);

/// The least time that a picture must stay the same before it counts as the last one. A slower machine needs more.
const STILL: Duration = Duration::from_millis(2_000);

/// The window of most tests \[pixels\].
const SIZE: (u16, u16) = (480, 320);

/// `ism-invtm` at a cost that a processor bears.
const SMALL: &str = r#"Pipeline(
    extends: "ism-invtm.ron",
    about: "Few lights and small maps",
    parameters: { "lights": U32(default: 16), "map": U32(default: 32), "supersampling": U32(default: 1) },
    patch: [Set("rsm.size", 32)],
)
"#;

/// Another one, which looks different.
const DIM: &str = r#"Pipeline(extends: "small.ron", about: "Darker", patch: [Set("image.exposure", -1.5)])
"#;

/// The shader that ends the pipeline, and a line of it.
const DISPLAY: &str = "passes/composite/display.wgsl";
const SHOWN: &str = "displayed(seen, settings.exposure, settings.white)";

/// Opens the window with the small pipeline and nothing but its picture.
fn first_picture(tree: &Tree, home: &Home) -> Option<(Viewer, Image)> {
    first_picture_of(tree, home, "small", "cornell-box")
}

/// Opens the window with nothing but its picture, which is that of `lightloom render`.
fn first_picture_of(tree: &Tree, home: &Home, pipeline: &str, scene: &str) -> Option<(Viewer, Image)> {
    let rendered = tree.rendered(pipeline, scene, SIZE);
    let viewer = Viewer::bare(tree, home, &[pipeline, scene])?;
    viewer.wait_for_picture("the picture of `render`", |seen| flip(seen, &rendered) <= 0.02);
    let first = viewer.rest("the first picture");
    Some((viewer, first))
}

/// The mean red, green and blue of some columns and rows.
fn mean(image: &Image, columns: std::ops::Range<usize>, rows: std::ops::Range<usize>) -> [f32; 3] {
    let all = rows.clone().flat_map(|y| columns.clone().map(move |x| (x, y)));
    let mut sum = [0.0; 3];
    all.for_each(|(x, y)| (0..3).for_each(|c| sum[c] += image.pixels()[y * image.width() + x][c]));
    sum.map(|sum| sum / (columns.len() * rows.len()) as f32)
}

/// The part of a picture from a row on.
fn below(image: &Image, row: usize) -> &[[f32; 4]] {
    &image.pixels()[row * image.width()..]
}

/// Whether the codes of one picture are half those of another.
fn is_half(seen: &Image, whole: &Image) -> bool {
    let code = |linear: f32| srgb_from_linear(linear) * 255.0;
    let half = |(seen, whole): (&[f32; 4], &[f32; 4])| {
        (0..3).all(|c| (code(seen[c]) - code(whole[c]) * 0.5).abs() < 1.1)
    };
    seen.pixels().len() == whole.pixels().len() && seen.pixels().iter().zip(whole.pixels()).all(half)
}

/// The picture is that of `lightloom render`, and follows keys and the mouse.
#[test]
fn the_window_shows_the_picture_and_obeys() {
    let Some(_turn) = turn() else { return };
    let (tree, home) = (Tree::new(), Home::new(false));
    let Some((viewer, first)) = first_picture(&tree, &home) else { return };
    let (width, height) = (first.width(), first.height());
    let [left, right] =
        [90..110, width - 110..width - 90].map(|x| mean(&first, x, height / 3..height * 2 / 3));
    assert!(left[0] > 2.0 * left[1], "the wall on the left is red: {left:?}");
    assert!(right[1] > 1.3 * right[0], "the wall on the right is green: {right:?}");

    // The help covers the picture, and goes.
    viewer.key("F1");
    viewer.wait_for_other("the keys", &first);
    viewer.key("F1");
    viewer.wait_for_same("the keys gone", &first);

    // The camera goes and comes back.
    viewer.window.drag((200, 160), (260, 170), 6, Button::Left);
    let orbited = viewer.wait_for_other("another side of the scene", &first);
    viewer.window.hold("w", Duration::from_millis(400));
    viewer.wait_for_other("a step forward", &orbited);
    viewer.key("c");
    viewer.wait_for_same("the scene's own camera", &first);
    let back = |what: &str| {
        viewer.wait_for_picture(what, |seen| *seen != first);
        viewer.key("c");
        viewer.wait_for_same("the scene's own camera", &first);
    };
    for key in ["w", "a", "s", "d", "q", "e"] {
        viewer.window.hold(key, Duration::from_millis(300));
        back(key);
    }
    viewer.window.drag((200, 160), (230, 160), 3, Button::Right);
    back("a look aside");
    viewer.window.drag((200, 160), (230, 180), 3, Button::Middle);
    back("a shift");
    viewer.window.scroll(200, 160, 3);
    viewer.wait_for_other("a step nearer", &first);
    back("a step nearer");
    viewer.window.double_click(170, 200);
    viewer.wait_for_other("the point that was clicked", &first);
    back("the point that was clicked");

    // Another pipeline from the palette; the camera's key is text there.
    let dim = tree.rendered("dim", "cornell-box", SIZE);
    assert!(flip(&dim, &first) > 0.1, "the pipelines look different");
    viewer.key("ctrl+p");
    viewer.wait_for_picture("the palette", |seen| *seen != first);
    viewer.window.type_text("dim");
    viewer.key("Return");
    viewer.wait_for_picture("the other pipeline", |seen| flip(seen, &dim) <= 0.02);
    viewer.quit();
}

#[test]
fn saved_shaders_reach_the_window_and_broken_ones_keep_the_last_good_picture() {
    let Some(_turn) = turn() else { return };
    let (tree, home) = (Tree::new(), Home::new(false));
    let Some((viewer, first)) = first_picture(&tree, &home) else { return };
    let shader = tree.text(DISPLAY);
    let halved = shader.replace(SHOWN, &format!("{SHOWN} * 0.5"));
    assert!(halved != shader);

    // By a rename, and in place. From here on nothing is pressed or moved.
    tree.save(DISPLAY, &halved);
    viewer.wait_for_picture("half the light", |seen| is_half(seen, &first));
    tree.save_in_place(DISPLAY, &shader);
    viewer.wait_for_same("all the light", &first);
    assert_eq!(viewer.reloads(), 2, "{}", viewer.stdout());
    assert!(viewer.stdout().contains("display.wgsl read again: A: rebuilt image"), "{}", viewer.stdout());
    // Twice within the same breath, as some editors do: what is read is the second.
    tree.save_in_place(DISPLAY, &halved[..halved.len() / 2]);
    tree.save_in_place(DISPLAY, &halved);
    viewer.wait_for_picture("half the light again", |seen| is_half(seen, &first));

    // Two files of which one alone is broken.
    let tonemap = tree.text("shaders/tonemap.wgsl");
    let renamed = |text: &str| text.replace("displayed(", "as_displayed(");
    tree.save_all(&[("shaders/tonemap.wgsl", &renamed(&tonemap)), (DISPLAY, &renamed(&shader))]);
    viewer.wait_for_same("two files at once", &first);
    assert_eq!(viewer.stderr(), "", "nothing was broken");
    let reloads = viewer.reloads();
    tree.save_all(&[("shaders/tonemap.wgsl", &tonemap), (DISPLAY, &shader)]);

    // A broken one: the error is shown over the picture that stays, and in the terminal.
    let line = shader.lines().position(|line| line.contains(SHOWN)).unwrap() + 1;
    viewer.wait_for("reload", |viewer| viewer.reloads() > reloads);
    tree.save(DISPLAY, &shader.replace("seen, settings.exposure", "sean, settings.exposure"));
    viewer.wait_for("message", |viewer| viewer.stderr().contains(&format!("{DISPLAY}:{line}:")));
    assert!(viewer.stderr().contains("sean"), "{}", viewer.stderr());
    let broken = viewer.wait_for_other("the message", &first);
    let white = |image: &Image| image.pixels().iter().filter(|pixel| pixel[..3] == [1.0; 3]).count();
    assert!(white(&broken) > white(&first) + 100, "text is written over the picture");
    let row = SIZE.1 as usize * 4 / 5;
    assert!(below(&broken, row) == below(&first, row), "the last good picture stays");
    let length = viewer.stderr().len();
    std::thread::sleep(Duration::from_millis(500));
    assert_eq!(viewer.stderr().len(), length, "it is reported once: {}", viewer.stderr());
    tree.save(DISPLAY, &shader);
    viewer.wait_for_same("the mended picture", &first);

    // A file that goes and comes back; one that the program has built in too would be read from there.
    let length = viewer.stderr().len();
    std::fs::remove_file(tree.at("pipelines/small.ron")).unwrap();
    viewer.wait_for("message", |viewer| viewer.stderr()[length..].contains("small"));
    tree.save("pipelines/small.ron", SMALL);
    viewer.wait_for_same("the file that came back", &first);
    viewer.quit();
}

/// A checkout of a branch is one reload, and none where every file is as it was.
#[test]
fn a_hundred_files_at_once_are_one_reload() {
    let Some(_turn) = turn() else { return };
    let (tree, home) = (Tree::new(), Home::new(false));
    let Some((viewer, first)) = first_picture(&tree, &home) else { return };
    let texts: Vec<(PathBuf, String)> = tree
        .shaders()
        .into_iter()
        .map(|path| (path.clone(), std::fs::read_to_string(path).unwrap()))
        .collect();
    assert!(texts.len() > 100);
    tree.check_out(&texts);
    assert!(viewer.rest("the same files") == first);
    assert!(viewer.reloads() <= 1, "{}", viewer.stdout());

    let before = viewer.reloads();
    let halved = |text: &str| text.replace(SHOWN, &format!("{SHOWN} * 0.5"));
    let other =
        texts.into_iter().map(|(path, text)| (path, format!("{}\n// another branch\n", halved(&text))));
    tree.check_out(&other.collect::<Vec<_>>());
    viewer.wait_for_picture("half the light", |seen| is_half(seen, &first));
    viewer.rest("the other branch");
    assert_eq!(viewer.reloads(), before + 1, "{}", viewer.stdout());
    assert_eq!(viewer.stderr(), "");
}

/// Numbers without end (xorshift, Marsaglia 2003).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }
}

/// Files that the picture is made of, and what in each can be replaced by what, soundly.
const EDITED: [(&str, &str, &str); 9] = [
    (DISPLAY, SHOWN, "displayed(seen.bgr, settings.exposure, settings.white)"),
    ("shaders/tonemap.wgsl", "* exp2(exposure)", "* exp2(exposure + 1.0)"),
    ("shaders/color.wgsl", "0.7152", "0.5152"),
    ("passes/gather/gather.wgsl", "\nstruct Receiver", "\nconst OWN: u32 = 1u;\nstruct Receiver"),
    ("passes/gbuffer/gbuffer.wgsl", "\n@vertex", "\nconst OWN: u32 = 1u;\n@vertex"),
    ("pipelines/parts/imperfect-shadow-maps-on-the-fly.ron", "about: \"", "about: \"Own. "),
    ("pipelines/small.ron", "default: 16", "default: 12"),
    ("pipelines/parts/deferred.ron", "\"geometry-aware-blur\"", "\"cross-bilateral\""),
    ("scenes/cornell-box.ron", "intensity: (0.8, 0.8, 0.8)", "intensity: (1.2, 0.8, 0.4)"),
];

/// Edits a file, soundly or in a way that breaks it, and says how.
fn edit(tree: &Tree, random: &mut Random, name: &str, original: &str, changed: &str, sound: bool) -> String {
    let half = original.floor_char_boundary(original.len() / 2);
    let (how, text) = match (sound, random.below(4)) {
        (true, 0) => ("as at first", original.to_owned()),
        (true, 1) => ("with a comment", format!("{changed}\n// More is said here.\n")),
        (true, 2) => {
            std::fs::remove_file(tree.at(name)).unwrap();
            std::thread::sleep(Duration::from_millis(random.next() % 60));
            ("gone and back", changed.to_owned())
        }
        (true, _) => ("changed", changed.to_owned()),
        (false, 0) => ("cut", original[..half].to_owned()),
        (false, 1) => ("empty", String::new()),
        (false, 2) => ("unfinished", format!("{original}\nfn unfinished( {{\n")),
        (false, _) => ("with a stranger", format!("%%% {original}")),
    };
    match random.below(2) {
        0 => tree.save(name, &text),
        _ => tree.save_in_place(name, &text),
    }
    format!("{name} {how}")
}

/// A hundred edits, good and bad, some within the same breath: the session goes on, and ends where a fresh one begins.
#[test]
#[ignore = "slow"]
fn no_edit_ends_the_session() {
    let Some(_turn) = turn() else { return };
    let (tree, home) = (Tree::new(), Home::new(false));
    let Some((viewer, first)) = first_picture(&tree, &home) else { return };
    let originals = EDITED.map(|(name, ..)| tree.text(name));
    let restore = || EDITED.iter().zip(&originals).for_each(|((name, ..), text)| tree.save(name, text));
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut broken: Vec<usize> = Vec::new();
    for number in 0..100 {
        // What breaks files that are as they were is waited for, so that not all edits are read as one, however slow the machine.
        let breaks = number % 25 == 0;
        // Half of the time what is broken is mended, so that there are pictures in between.
        let mends = random.below(2) == 0 && !broken.is_empty();
        let which = if mends { broken[random.below(broken.len())] } else { random.below(EDITED.len()) };
        let sound = !breaks && (mends || random.below(3) > 0);
        broken.retain(|&file| file != which);
        broken.extend((!sound).then_some(which));
        let (name, from, to) = EDITED[which];
        let changed = originals[which].replace(from, to);
        assert!(changed != originals[which], "{name} has {from:?}");
        let reported = viewer.stderr().len();
        let done = edit(&tree, &mut random, name, &originals[which], &changed, sound);
        assert!(viewer.ended().is_none(), "after edit {number}: {done}\n{}", viewer.printed());
        // Many in the same breath, many while the one before is being taken in, some with time for that.
        match random.below(3) {
            _ if breaks => viewer.wait_for("error", |viewer| viewer.stderr().len() > reported),
            0 => std::thread::sleep(Duration::from_millis(random.next() % 20)),
            1 => std::thread::sleep(Duration::from_millis(20 + random.next() % 60)),
            _ => viewer.wait_for_output(),
        }
        if number % 25 == 24 {
            restore();
            broken.clear();
            viewer.wait_for_same("the picture of the files as they were", &first);
        }
    }
    let other = Home::new(false);
    let Some((_fresh, fresh)) = first_picture(&tree, &other) else { return };
    viewer.wait_for_same("the picture of a fresh start", &fresh);
    assert!(viewer.rest("the last picture") == fresh);
    viewer.quit();
}

/// A value that was found by a slider becomes a file that every command takes.
#[test]
fn what_a_slider_found_is_saved_as_a_variant() {
    let Some(_turn) = turn() else { return };
    let (tree, home) = (Tree::new(), Home::new(true));
    let size = (800, 480);
    let Some(viewer) = Viewer::open(&tree, &home, &["small", "cornell-box"], size) else { return };
    // The picture is on the right of the settings.
    let picture = |image: &Image| -> Vec<[f32; 4]> {
        image.pixels().chunks(image.width()).skip(40).take(380).flat_map(|row| &row[400..]).copied().collect()
    };
    viewer.wait_for_picture("the walls", |seen| mean(seen, 350..780, 60..420)[0] > 0.01);
    let first = viewer.rest("the first picture");
    // The settings begin under the name, the buttons and the filter; how far is a matter of fonts.
    let moved = (130..260).step_by(12).any(|y| {
        viewer.window.drag((116, y), (98, y), 4, Button::Left);
        viewer.window.move_to(700, 200);
        picture(&viewer.rest("a row of the settings")) != picture(&first)
    });
    assert!(moved, "no slider changes the picture");

    let found = viewer.rest("the value that was found");
    viewer.key("ctrl+s");
    // Its cursor blinks, so that it never comes to rest.
    viewer.wait_for_picture("the dialog", |seen| *seen != found);
    viewer.key("Return");
    viewer.wait_for("file", |viewer| viewer.stdout().contains("wrote "));
    let file = home.at("small-variant.ron");
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.lines().count() <= 5, "{text}");
    assert!(text.contains("small") && text.contains("extends"), "{text}");
    let file = file.to_string_lossy();
    let checked = tree.lightloom(&["check", &file]);
    let printed = [&checked.stdout[..], &checked.stderr].map(String::from_utf8_lossy).concat();
    assert!(checked.status.success(), "{printed}");
    let plain = tree.rendered("small", "cornell-box", (96, 64));
    assert!(tree.rendered(&file, "cornell-box", (96, 64)) != plain, "the variant looks different: {text}");
}

/// Without a display, the program prints what to do instead.
#[test]
fn without_a_display_it_names_another_way() {
    let done = Command::new(env!("CARGO_BIN_EXE_lightloom"))
        .arg("view")
        .current_dir(root())
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .output()
        .unwrap();
    let printed = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(1), "{printed}");
    assert!(printed.contains("lightloom render") && printed.contains("--watch"), "{printed}");
    assert!(!printed.contains("panicked"), "{printed}");
}

/// Pipeline, scene and camera come back at the next start.
#[test]
fn the_window_remembers() {
    let Some(_turn) = turn() else { return };
    let (tree, home) = (Tree::new(), Home::new(false));
    let Some((viewer, first)) = first_picture_of(&tree, &home, "dim", "cornell-box-point") else { return };
    viewer.window.drag((200, 160), (150, 150), 5, Button::Left);
    viewer.window.move_to(479, 319);
    let orbited = viewer.wait_for_other("another side of the scene", &first);
    viewer.quit();

    let Some(viewer) = Viewer::bare(&tree, &home, &[]) else { return };
    viewer.wait_for_same("what was there last", &orbited);
    viewer.key("c");
    viewer.wait_for_same("the scene's own camera", &first);
}
