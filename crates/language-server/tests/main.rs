//! An editor that asks within the process, so that the work of each answer is counted.

use catalog::{Assets, Catalog};
use frame_graph::{Source, parse};
use language_server::{begin, serve};
use lsp_server::{Connection, Message, Notification, Request};
use lsp_types::{InitializeParams, Uri};
use proptest::prelude::*;
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;
use std::thread::JoinHandle;

/// A folder in which nothing is but what the editor has open.
const FOLDER: &str = "/nowhere";

/// The most bytes of files that an answer reads: for this many, the time of reading, resolving and composing is within
/// 100 ms in a debug build. Most are shaders, which are read once.
const MOST_BYTES: u64 = 1 << 20;

struct Editor {
    client: Option<Connection>,
    server: Option<JoinHandle<()>>,
    catalog: Arc<Catalog>,
    count: i32,
}

impl Editor {
    fn new() -> Editor {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).unwrap().to_owned();
        let catalog = Arc::new(Catalog::new(Assets::new(Some(root))));
        let (server, client) = Connection::memory();
        let of_server = Arc::clone(&catalog);
        let server = std::thread::spawn(move || {
            let (params, folders) = begin(&server).unwrap();
            // What is wrong is found by another thread, whose work is not that of an answer.
            let check = Arc::new(|_: &str, _| Vec::new());
            assert!(serve(&server, (&params, folders), of_server, check).unwrap());
        });
        let mut editor = Editor { client: Some(client), server: Some(server), catalog, count: 0 };
        editor.ask("initialize", json!(InitializeParams::default()));
        editor.tell("initialized", json!({}));
        editor
    }

    fn send(&self, message: Message) {
        self.client.as_ref().unwrap().sender.send(message).unwrap();
    }

    fn tell(&self, method: &str, params: Value) {
        self.send(Notification::new(method.to_owned(), params).into());
    }

    fn ask(&mut self, method: &str, params: Value) -> Value {
        self.count += 1;
        self.send(Request::new(self.count.into(), method.to_owned(), params).into());
        for message in &self.client.as_ref().unwrap().receiver {
            if let Message::Response(response) = message {
                assert_eq!(response.id, self.count.into());
                return response.response_result.unwrap_or_else(|error| json!({ "error": error.message }));
            }
        }
        panic!("the server has ended, asked for {method}");
    }

    fn uri(name: &str) -> Uri {
        format!("file://{FOLDER}/{name}").parse().unwrap()
    }

    fn open(&self, name: &str, text: &str) {
        let document = json!({ "uri": Editor::uri(name), "languageId": "x", "version": 0, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": document }));
    }

    fn set(&self, name: &str, text: &str) {
        let document = json!({ "uri": Editor::uri(name), "version": 1 });
        let changes = json!([{ "text": text }]);
        self.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
    }

    /// Asks a question about a position, and returns how many bytes were read for the answer.
    fn at(&mut self, method: &str, name: &str, (line, character): (usize, usize)) -> u64 {
        let position = json!({ "line": line, "character": character });
        let params = json!({
            "textDocument": { "uri": Editor::uri(name) },
            "position": position,
            "range": { "start": { "line": 0, "character": 0 }, "end": position },
            "context": { "includeDeclaration": true, "diagnostics": [], "triggerKind": 1 },
            "options": { "tabSize": 4, "insertSpaces": true },
            "newName": "x",
        });
        let before = self.catalog.assets().bytes_read();
        let answer = self.ask(&format!("textDocument/{method}"), params);
        // Only a rename where no name is has no answer.
        assert!(
            answer.get("error").is_none() || method.ends_with("ename") || name.ends_with(".txt"),
            "{method}: {answer}"
        );
        self.catalog.assets().bytes_read() - before
    }
}

impl Drop for Editor {
    fn drop(&mut self) {
        if std::thread::panicking() {
            return;
        }
        self.ask("shutdown", Value::Null);
        self.tell("exit", Value::Null);
        self.server.take().unwrap().join().unwrap();
    }
}

const QUESTIONS: [&str; 10] = [
    "completion",
    "hover",
    "definition",
    "references",
    "prepareRename",
    "rename",
    "documentSymbol",
    "formatting",
    "codeAction",
    "inlayHint",
];

/// The last position of a text.
fn end(text: &str) -> (usize, usize) {
    let line = text.rsplit('\n').next().unwrap_or_default();
    (text.matches('\n').count(), line.encode_utf16().count())
}

/// The largest pipeline, as it is at each moment when it is typed from its beginning.
fn typed(step: usize) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../pipelines/acrsm.ron");
    let whole = std::fs::read_to_string(path).unwrap();
    let mut editor = Editor::new();
    editor.open("typed.ron", "");
    let mut most = (0, String::new());
    for (count, at) in (0..=whole.len()).filter(|at| whole.is_char_boundary(*at)).enumerate() {
        // Each question is asked at each `step`-th prefix, another one at each prefix.
        let prefix = &whole[..at];
        editor.set("typed.ron", prefix);
        for (i, question) in QUESTIONS.iter().enumerate() {
            if (count + i).is_multiple_of(step) {
                let bytes = editor.at(question, "typed.ron", end(prefix));
                if bytes > most.0 {
                    most = (
                        bytes,
                        format!(
                            "{question} behind {:?}",
                            &prefix[prefix.floor_char_boundary(at.saturating_sub(20))..]
                        ),
                    );
                }
            }
        }
    }
    assert!(most.0 > 0 && most.0 < MOST_BYTES, "{most:?}");
}

#[test]
fn a_half_typed_pipeline_has_answers() {
    typed(10);
}

#[test]
#[ignore = "slow"]
fn every_half_typed_pipeline_has_every_answer() {
    typed(1);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn any_text_has_answers(
        parts in prop::collection::vec(
            prop::sample::select(vec![
                "Pipeline(", "Study(", "Scene(", "Pass(", "Sub(", "Replace(", "Insert(", "Set(", "(", ")", "[", "]", "{", "}",
                ",", ":", "\"", "\"lights\"", "\"$", "kind: \"gather\"", "in: {", "set: {", "patch: [", "extends: \"ism.ron\"",
                "file: \"parts/clusters.ron\"", "between: (", "\n", "\r\n", "é", "😀", "//", "/*", "*/", " ", "\\", "#import \"",
                "#input view: GBuffer", "settings.", "/// [", "struct S {", "fn f() {", "r#\"", "when: \"scene.", "'", "-1e99",
            ]),
            0..24,
        ),
        (line, character) in (0_usize..6, 0_usize..40),
    ) {
        let text = parts.concat();
        let mut editor = Editor::new();
        for name in ["any.ron", "any.wgsl", "any.txt"] {
            editor.open(name, &text);
            for question in QUESTIONS {
                editor.at(question, name, (line, character));
            }
            // A change whose range is outside of the text, and one within a surrogate pair.
            let range = json!({
                "start": { "line": line, "character": character },
                "end": { "line": line, "character": character / 2 },
            });
            let document = json!({ "uri": Editor::uri(name), "version": 2 });
            let changes = json!([{ "range": range, "text": "x" }]);
            editor.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
        }
    }
}

/// The place of every name of every pipeline holds that name.
#[test]
fn names_are_where_they_are_said_to_be() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../pipelines");
    let mut count = 0;
    for folder in [folder.join("parts"), folder] {
        for file in std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path()) {
            if file.extension().is_none_or(|ending| ending != "ron") {
                continue;
            }
            let source = Source::new(file.to_string_lossy(), std::fs::read_to_string(&file).unwrap());
            for symbol in parse(source.clone()).unwrap().symbols() {
                let written = &source.text[symbol.place.start as usize..symbol.place.end as usize];
                assert_eq!(written, symbol.name, "{symbol:?} of {}", source.name);
                count += 1;
            }
        }
    }
    assert!(count > 1000, "{count} names");
}

/// Files that extend each other, and sub-graphs that contain themselves.
#[test]
fn loops_of_files_end() {
    let mut editor = Editor::new();
    let variant = |base: &str| {
        format!(
            "Pipeline(extends: \"{base}\", passes: {{ \"a\": Sub(file: \"{base}\") }}, patch: [Set(\"a/a/a/a.b\", \"$c\")])"
        )
    };
    for (name, base) in
        [("a.ron", "./b.ron"), ("b.ron", "./c.ron"), ("c.ron", "./a.ron"), ("d.ron", "./d.ron")]
    {
        editor.open(name, &variant(base));
    }
    for name in ["a.ron", "b.ron", "c.ron", "d.ron"] {
        for question in QUESTIONS {
            for character in (0..130).step_by(3) {
                editor.at(question, name, (0, character));
            }
        }
    }
}
