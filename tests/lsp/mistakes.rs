//! What is wrong, as an editor shows it, and how the server lives with its editor.

use super::editor::{Editor, edited, position};
use super::{BASE, EFFECT, folder, variant};
use crate::adapter::root;
use crate::program::{Folder, run_in};
use serde_json::{Value, json};

#[test]
fn mistakes_are_underlined_while_they_are_typed() {
    let folder = folder();
    let editor = Editor::of_tree(&folder);
    let wrong = variant("Set(\"interleve_x\", 2)");
    editor.open("my.ron", &wrong);
    let errors = editor.errors("my.ron", 0);
    assert_eq!(errors.len(), 1, "{errors:?}");
    let message = errors[0]["message"].as_str().unwrap();
    assert!(message.contains("did you mean `interleave_x`?"), "{message}");
    let context = json!({ "range": errors[0]["range"], "context": { "diagnostics": errors } });
    let actions = editor.at("codeAction", "my.ron", &json!({}), context);
    assert_eq!(actions[0]["title"], "change to `interleave_x`");
    let edits = &actions[0]["edit"]["changes"][editor.uri("my.ron")];
    assert_eq!(edited(&wrong, edits), wrong.replace("interleve_x", "interleave_x"));
    // Typed character by character, in a text beyond the basic plane.
    let begin = "// 😀 é\r\nPipeline(extends: \"ism.ron\", about: \"😀\", patch: [])";
    editor.set("my.ron", 1, begin);
    assert_eq!(editor.errors("my.ron", 1), [] as [Value; 0]);
    let mut text = begin.to_owned();
    for (version, typed) in (2..).zip("Remove(\"filtr\")".chars()) {
        let at = position(&text.replacen("])", "‸])", 1));
        let change = json!([{ "range": { "start": at, "end": at }, "text": typed.to_string() }]);
        editor.change("my.ron", version, change);
        text = text.replacen("])", &format!("{typed}])"), 1);
    }
    let errors = editor.errors("my.ron", 16);
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert_eq!(errors[0]["range"]["start"], position(&text.replacen("\"filtr", "‸\"filtr", 1)));
    assert!(errors[0]["message"].as_str().unwrap().contains("`filtr`"), "{errors:?}");
    // A base that is not saved.
    editor.set("my.ron", 20, "Pipeline(extends: \"base.ron\")");
    assert_eq!(editor.errors("my.ron", 20), [] as [Value; 0]);
    editor.open("base.ron", &BASE.replace("\"strength\"", "\"strenth\""));
    let errors = editor.errors_until("base.ron", |errors| !errors.is_empty());
    assert!(errors[0]["message"].as_str().unwrap().contains("`strength`"), "{errors:?}");
    editor.close("base.ron");
    editor.errors_until("base.ron", <[Value]>::is_empty);
}

/// An error with two places shows the other one, and warnings are shown as such.
#[test]
fn warnings_and_related_places_are_shown() {
    let folder = folder();
    let editor = Editor::of_tree(&folder);
    editor.open("my.ron", "Pipeline(\n    extends: \"ism.ron\",\n    patch: [Remove(\"filter\"), Remove(\"nosuch\"), Remove(\"other\")],\n)\n");
    assert_eq!(editor.errors("my.ron", 0).len(), 2, "all errors of a file");
    editor.set("my.ron", 1, "Pipeline(\n    extends: \"ism.ron\",\n    patch: [Set(\"filter.radius\", 2), Remove(\"filter\")],\n)\n");
    let found = editor.errors("my.ron", 1);
    let warning = found.iter().find(|found| found["severity"] == 2).unwrap_or_else(|| panic!("{found:?}"));
    assert_eq!(warning["relatedInformation"][0]["message"], "patched here", "{warning}");
    assert_eq!(warning["relatedInformation"][0]["location"]["uri"], editor.uri("my.ron"));
}

/// Typed from its beginning to its end, a pipeline leaves nothing behind in memory.
#[cfg(target_os = "linux")]
#[test]
#[ignore = "slow"]
fn a_long_session_takes_no_more_memory() {
    let folder = folder();
    let editor = Editor::of_tree(&folder);
    let whole = std::fs::read_to_string(root().join("pipelines/acrsm.ron")).unwrap();
    editor.open("my.ron", &whole);
    editor.errors("my.ron", 0);
    let resident = || {
        let status = std::fs::read_to_string(format!("/proc/{}/status", editor.child.id())).unwrap();
        let line = status.lines().find(|line| line.starts_with("VmRSS")).unwrap();
        line.split_whitespace().nth(1).unwrap().parse::<u64>().unwrap()
    };
    let mut version = 0;
    let mut pass = || {
        for at in (0..whole.len()).filter(|at| whole.is_char_boundary(*at)) {
            version += 1;
            let at = editor.set("my.ron", version, &format!("{}‸", &whole[..at]));
            let answer = editor.at("completion", "my.ron", &at, json!({}));
            assert!(answer.is_array(), "{answer}");
        }
        editor.errors("my.ron", version.into());
        resident()
    };
    let (once, twice) = (pass(), pass());
    assert!(twice < once + (32 << 10), "{once} KiB, then {twice} KiB");
    assert!(twice < 1 << 20, "{twice} KiB");
}

#[test]
fn mistakes_in_wgsl_are_underlined() {
    let folder = folder();
    let editor = Editor::of_tree(&folder);
    let cases = [
        ("fn f() -> f32 { return nosuch; }", "nosuch", "nosuch"),
        ("#import \"nowhere.wgsl\"", "\"nowhere.wgsl\"", "nowhere.wgsl"),
        (
            "/// Sums. [scrach]\nvar<storage, read_write> sums: array<u32, 4>;\n@compute @workgroup_size(1) fn f() { sums[0] = 1u; }",
            "scrach",
            "did you mean `scratch`?",
        ),
        ("#input view: GBufer // V.", "GBufer", "did you mean `GBuffer`?"),
        (
            "struct Settings {\n    /// A. [default: 2.0, max: 1.0]\n    a: f32,\n}\nvar<uniform> settings: Settings;\n@compute @workgroup_size(1) fn f() { _ = settings.a; }",
            "",
            "default",
        ),
    ];
    for (version, (text, at, word)) in cases.iter().enumerate() {
        match version {
            0 => drop(editor.open("x.wgsl", text)),
            _ => drop(editor.set("x.wgsl", version as i32, text)),
        }
        let errors = editor.errors("x.wgsl", version as i64);
        let message = errors.first().map(|error| error["message"].to_string()).unwrap_or_default();
        assert!(message.contains(word), "{text}: {errors:?}");
        if !at.is_empty() {
            assert_eq!(
                errors[0]["range"]["start"],
                position(&text.replacen(at, &format!("‸{at}"), 1)),
                "{text}"
            );
        }
    }
    // In a file that another one imports, and in the pipeline that uses it.
    editor.set("x.wgsl", 9, "fn shade() -> f32 { return 1.0; }");
    assert_eq!(editor.errors("x.wgsl", 9), [] as [Value; 0]);
    editor.open(
        "effect.wgsl",
        &EFFECT.replace("* settings", "* shade() * settings").replacen(
            "struct",
            "#import \"x.wgsl\"\nstruct",
            1,
        ),
    );
    assert_eq!(editor.errors("effect.wgsl", 0).len(), 0);
    editor.open("base.ron", BASE);
    assert_eq!(editor.errors("base.ron", 0), [] as [Value; 0]);
    editor.set("x.wgsl", 10, "fn shad() -> f32 { return 1.0; }");
    let errors = editor.errors_until("effect.wgsl", |errors| !errors.is_empty());
    assert!(errors[0]["message"].as_str().unwrap().contains("shade"), "{errors:?}");
}

/// All shipped WGSL is good by itself.
#[test]
#[ignore = "slow"]
fn shipped_wgsl_has_no_mistakes() {
    let folder = folder();
    let editor = Editor::of_tree(&folder);
    let files = renderer::Assets::new(Some(root()));
    let all = ["shaders", "passes", "crates/interfaces"].map(|folder| files.list(folder, "wgsl")).concat();
    for path in all.iter().filter(|path| !path.contains("/tests/") && !path.contains("precision")) {
        let name = format!("tree:{path}");
        editor.open(&name, &std::fs::read_to_string(root().join(path)).unwrap());
        let errors = editor.errors(&name, 0);
        assert!(errors.is_empty(), "{path}: {errors:?}");
        editor.close(&name);
    }
}

/// A broken file has the errors that `check` prints, at the same places.
#[test]
fn the_editor_and_check_agree_on_broken_files() {
    let of_crate = |name: &str| root().join("crates").join(name).join("tests/broken");
    let mut broken = Vec::new();
    for folder in ["frame-graph", "scene", "study"].map(of_crate) {
        let files = std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path());
        let mut files: Vec<_> = files.filter(|file| file.extension().is_some_and(|e| e == "ron")).collect();
        files.sort();
        // Every third, and more than thirty.
        broken.extend(files.into_iter().step_by(3));
    }
    assert!(broken.len() > 30, "{}", broken.len());
    let folder = folder();
    let names: Vec<String> = broken.iter().map(|path| path.to_string_lossy().into_owned()).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let tree = root().to_string_lossy().into_owned();
    let checked =
        run_in(&folder, &[&["--root", &tree, "--json", "check", "--scene", "cornell-box"], &*names].concat());
    let checked = checked.json();
    let editor = Editor::of_tree(&folder);
    for row in checked["checked"].as_array().unwrap() {
        let path = row["name"].as_str().unwrap();
        let name = format!("tree:{}", path.strip_prefix(&format!("{tree}/")).unwrap());
        let text = std::fs::read_to_string(path).unwrap();
        // Files that are no pipeline, scene or study have no sort.
        if !["Pipeline", "Scene", "Study"].iter().any(|word| text.contains(&format!("{word}("))) {
            continue;
        }
        editor.open(&name, &text);
        let shown = editor.errors(&name, 0);
        let say = |error: &Value| error["message"].as_str().unwrap().lines().next().unwrap().to_owned();
        let is_error = |error: &&Value| error["severity"] == 1 || error["severity"] == "error";
        let mut shown: Vec<String> = shown.iter().filter(is_error).map(say).collect();
        let in_file = |error: &&Value| {
            error["file"].is_null()
                || error["file"].as_str().unwrap().ends_with(path.rsplit('/').next().unwrap())
        };
        let mut printed: Vec<String> =
            row["errors"].as_array().unwrap().iter().filter(is_error).filter(in_file).map(say).collect();
        shown.sort();
        printed.sort();
        shown.dedup();
        printed.dedup();
        assert_eq!(shown, printed, "{path}");
        editor.close(&name);
    }
}

#[test]
fn files_that_others_change_are_read_again() {
    let folder = folder();
    let editor = Editor::of_tree(&folder);
    let changed = |name: &str, kind: u32| {
        let change = json!({ "uri": editor.uri(name), "type": kind });
        editor.tell("workspace/didChangeWatchedFiles", json!({ "changes": [change] }));
    };
    editor.open("base.ron", BASE);
    assert_eq!(editor.errors("base.ron", 0), [] as [Value; 0]);
    let fails = |word: &'static str| {
        move |errors: &[Value]| errors.iter().any(|error| error["message"].as_str().unwrap().contains(word))
    };
    folder.write("effect.wgsl", &EFFECT.replace("strength: f32", "force: f32"));
    changed("effect.wgsl", 2);
    editor.errors_until("base.ron", fails("`strength`"));
    folder.write("effect.wgsl", EFFECT);
    changed("effect.wgsl", 2);
    editor.errors_until("base.ron", <[Value]>::is_empty);
    std::fs::rename(folder.at("effect.wgsl"), folder.at("other.wgsl")).unwrap();
    changed("effect.wgsl", 3);
    changed("other.wgsl", 1);
    editor.errors_until("base.ron", fails("effect.wgsl"));
    editor.set("base.ron", 1, &BASE.replace("effect.wgsl", "other.wgsl"));
    editor.errors_until("base.ron", <[Value]>::is_empty);
    // An open file that is deleted is still open, and one that extends it is right.
    std::fs::remove_file(folder.at("base.ron")).unwrap();
    changed("base.ron", 3);
    editor.open("my.ron", "Pipeline(extends: \"base.ron\")");
    assert_eq!(editor.errors("my.ron", 0), [] as [Value; 0]);
    editor.close("base.ron");
    editor.errors_until("my.ron", fails("base.ron"));
}

#[test]
fn loops_and_files_outside_are_errors() {
    let outside = Folder::new(&[("base.ron", "Pipeline(extends: \"ism.ron\")")]);
    let folder = folder();
    let editor = Editor::of_tree(&folder);
    editor.open("a.ron", "Pipeline(extends: \"b.ron\")");
    editor.open("b.ron", "Pipeline(extends: \"a.ron\")");
    let says =
        |errors: &[Value], word: &str| errors.iter().any(|e| e["message"].as_str().unwrap().contains(word));
    editor.errors_until("b.ron", |errors| says(errors, "extends itself"));
    editor.close("a.ron");
    editor.close("b.ron");
    let path = outside.name("base.ron");
    editor.open("my.ron", &format!("Pipeline(extends: \"{path}\")"));
    editor.errors_until("my.ron", |errors| says(errors, "neither in the folder"));
    // A file of another folder is checked as it stands there.
    let other = format!("../{}/other.ron", outside.file_name().unwrap().to_string_lossy());
    editor.open(&other, "Pipeline(extends: \"base.ron\", patch: [Remove(\"nosuch\")])");
    editor.errors_until(&other, |errors| says(errors, "nosuch"));
}

/// Two editors in one folder, which nobody may write to.
#[cfg(unix)]
#[test]
fn two_editors_work_in_a_folder_that_cannot_be_written() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = folder();
    let allow = |mode| std::fs::set_permissions(&*folder, std::fs::Permissions::from_mode(mode)).unwrap();
    allow(0o555);
    let editors = [Editor::of_tree(&folder), Editor::alone(&folder)];
    for (editor, name) in editors.iter().zip(["filtr", "gathr"]) {
        editor.open("my.ron", &variant(&format!("Remove(\"{name}\")")));
    }
    for (editor, name) in editors.iter().zip(["filtr", "gathr"]) {
        let errors = editor.errors("my.ron", 0);
        assert!(errors[0]["message"].as_str().unwrap().contains(name), "{errors:?}");
    }
    for editor in editors {
        assert_eq!(editor.end(), Some(0));
    }
    allow(0o755);
}

/// A root that is named from the folder in which the server is started, which is not that of the editor.
#[test]
fn a_root_on_the_command_line_is_that_of_the_program() {
    let started = Folder::new(&[("tree/pipelines/own.ron", "Pipeline(extends: \"ism.ron\")")]);
    std::fs::create_dir_all(started.at("tree/shaders")).unwrap();
    let folder = folder();
    let mut command = crate::program::command(&started);
    command.args(["--root", "tree"]);
    let editor = Editor::start(&folder, command);
    editor.open("my.ron", "Pipeline(extends: \"own.ron\", patch: [Remove(\"filtr\")])");
    let errors = editor.errors("my.ron", 0);
    assert!(errors.len() == 1 && errors[0]["message"].as_str().unwrap().contains("filtr"), "{errors:?}");
}

/// The server ends when it is asked to, whatever is still to be answered or checked, and when the editor is gone.
#[test]
fn the_server_ends_in_the_middle_of_its_work() {
    let folder = folder();
    let mut editor = Editor::of_tree(&folder);
    editor.open("scene.ron", "Scene(geometry: BuiltIn(\"hall-1m\"))");
    for id in 100..150 {
        let params = json!({ "textDocument": { "uri": editor.uri("base.ron") }, "position": { "line": 0, "character": 0 } });
        editor.send(lsp_server::Request::new(id.into(), "textDocument/references".to_owned(), params).into());
    }
    editor.send(lsp_server::Request::new(200.into(), "shutdown".to_owned(), Value::Null).into());
    editor.tell("exit", Value::Null);
    assert_eq!(editor.child.wait().unwrap().code(), Some(0));
    let mut gone = Editor::of_tree(&folder);
    gone.hang_up();
    assert_eq!(gone.child.wait().unwrap().code(), Some(1));
    let mut rude = Editor::of_tree(&folder);
    rude.tell("exit", Value::Null);
    assert_eq!(rude.child.wait().unwrap().code(), Some(1));
}
