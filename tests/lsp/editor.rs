//! An editor that speaks the Language Server Protocol with the program.

use crate::adapter::root;
use crate::program::{Folder, command, command_of_tree};
use lsp_server::{Message, Notification, Request, Response};
use serde_json::{Value, json};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::BufReader;
use std::path::Path;
use std::process::{Child, ChildStdin, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// The position in a text that a test writes.
pub(crate) const MARK: char = '‸';

/// The version of a file, where it is open, and what is wrong with it.
type Reported = (Option<i64>, Vec<Value>);

pub(crate) struct Editor {
    pub(crate) child: Child,
    stdin: RefCell<Option<ChildStdin>>,
    messages: Receiver<Message>,
    /// The errors that were reported last, by the name of the file, with the version that has them.
    reported: RefCell<BTreeMap<String, Reported>>,
    count: RefCell<i32>,
    folder: String,
}

impl Editor {
    /// Starts in a folder, with the tree as `--root`.
    pub(crate) fn of_tree(folder: &Folder) -> Editor {
        Editor::start(folder, command_of_tree(folder))
    }

    /// Starts in a folder, with what is built into the program alone.
    pub(crate) fn alone(folder: &Folder) -> Editor {
        Editor::start(folder, command(folder))
    }

    /// Starts a command for an editor that has opened a folder.
    pub(crate) fn start(folder: &Path, mut command: std::process::Command) -> Editor {
        let child = command.args(["lsp", "--stdio"]).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = child.stderr(Stdio::inherit()).spawn().unwrap();
        let (stdin, stdout) = (child.stdin.take().unwrap(), child.stdout.take().unwrap());
        let (sender, messages) = channel();
        std::thread::spawn(move || {
            let mut stdout = BufReader::new(stdout);
            while let Ok(Some(message)) = Message::read(&mut stdout) {
                if sender.send(message).is_err() {
                    return;
                }
            }
        });
        let folder = folder.canonicalize().unwrap().to_string_lossy().into_owned();
        let editor = Editor {
            child,
            stdin: RefCell::new(Some(stdin)),
            messages,
            reported: RefCell::default(),
            count: RefCell::default(),
            folder,
        };
        let uri = format!("file://{}", editor.folder);
        let capabilities =
            json!({ "workspace": { "didChangeWatchedFiles": { "dynamicRegistration": true } } });
        let params = json!({
            "processId": null, "rootUri": uri, "capabilities": capabilities,
            "workspaceFolders": [{ "uri": uri, "name": "x" }],
        });
        editor.ask("initialize", params);
        editor.tell("initialized", json!({}));
        editor
    }

    /// Returns the URI of a file of the folder, or of the tree by `tree:PATH`.
    pub(crate) fn uri(&self, name: &str) -> String {
        match name.strip_prefix("tree:") {
            Some(path) => format!("file://{}/{path}", root().canonicalize().unwrap().display()),
            None => format!("file://{}/{name}", self.folder),
        }
    }

    pub(crate) fn send(&self, message: Message) {
        // A server that has ended takes nothing.
        if let Some(stdin) = &mut *self.stdin.borrow_mut() {
            let _ = message.write(stdin);
        }
    }

    pub(crate) fn tell(&self, method: &str, params: Value) {
        self.send(Notification::new(method.to_owned(), params).into());
    }

    fn receive(&self) -> Message {
        let message =
            self.messages.recv_timeout(Duration::from_secs(300)).expect("an answer in five minutes");
        match &message {
            Message::Notification(Notification { method, params })
                if method == "textDocument/publishDiagnostics" =>
            {
                let uri = params["uri"].as_str().unwrap().to_owned();
                let errors = params["diagnostics"].as_array().unwrap().clone();
                self.reported.borrow_mut().insert(uri, (params["version"].as_i64(), errors));
            }
            Message::Request(request) => {
                self.send(Response::new_ok(request.id.clone(), Value::Null).into());
            }
            _ => {}
        }
        message
    }

    /// Returns the answer to a request; its error where it has one.
    pub(crate) fn ask(&self, method: &str, params: Value) -> Value {
        *self.count.borrow_mut() += 1;
        let id = *self.count.borrow();
        self.send(Request::new(id.into(), method.to_owned(), params).into());
        loop {
            if let Message::Response(response) = self.receive()
                && response.id == id.into()
            {
                return response.response_result.unwrap_or_else(|error| json!({ "error": error.message }));
            }
        }
    }

    /// Opens a text; returns the position of its mark.
    pub(crate) fn open(&self, name: &str, marked: &str) -> Value {
        let text = marked.replace(MARK, "");
        let document = json!({ "uri": self.uri(name), "languageId": "x", "version": 0, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": document }));
        position(marked)
    }

    /// Replaces the text of an open file.
    pub(crate) fn set(&self, name: &str, version: i32, marked: &str) -> Value {
        let text = marked.replace(MARK, "");
        self.change(name, version, json!([{ "text": text }]));
        position(marked)
    }

    pub(crate) fn change(&self, name: &str, version: i32, changes: Value) {
        let document = json!({ "uri": self.uri(name), "version": version });
        self.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
    }

    pub(crate) fn close(&self, name: &str) {
        self.tell("textDocument/didClose", json!({ "textDocument": { "uri": self.uri(name) } }));
    }

    /// Asks about a position of an open file.
    pub(crate) fn at(&self, method: &str, name: &str, position: &Value, more: Value) -> Value {
        let mut params = json!({ "textDocument": { "uri": self.uri(name) }, "position": position });
        params.as_object_mut().unwrap().extend(more.as_object().cloned().unwrap_or_default());
        self.ask(&format!("textDocument/{method}"), params)
    }

    /// Waits for the errors of a version of a file.
    pub(crate) fn errors(&self, name: &str, version: i64) -> Vec<Value> {
        let uri = self.uri(name);
        loop {
            let known = self.reported.borrow().get(&uri).cloned();
            if let Some((Some(found), errors)) = known
                && found >= version
            {
                return errors;
            }
            self.receive();
        }
    }

    /// Waits until the errors of a file are such.
    pub(crate) fn errors_until(&self, name: &str, fits: impl Fn(&[Value]) -> bool) -> Vec<Value> {
        let uri = self.uri(name);
        loop {
            let known = self.reported.borrow().get(&uri).map(|(_, errors)| errors.clone());
            if let Some(errors) = known.filter(|errors| fits(errors)) {
                return errors;
            }
            self.receive();
        }
    }

    /// Ends without a word, as an editor that crashes.
    pub(crate) fn hang_up(&self) {
        self.stdin.borrow_mut().take();
    }

    /// Ends the server as the protocol says, and returns its exit code.
    pub(crate) fn end(mut self) -> Option<i32> {
        self.ask("shutdown", Value::Null);
        self.tell("exit", Value::Null);
        self.child.wait().unwrap().code()
    }
}

impl Drop for Editor {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Returns the position of the mark in a text.
pub(crate) fn position(marked: &str) -> Value {
    let before = marked.split(MARK).next().unwrap_or_default();
    let line = before.matches('\n').count();
    let start = before.rfind('\n').map_or(0, |at| at + 1);
    json!({ "line": line, "character": before[start..].encode_utf16().count() })
}

/// Returns a text with the edits of an answer.
pub(crate) fn edited(text: &str, edits: &Value) -> String {
    let offset = |position: &Value| {
        let line = position["line"].as_u64().unwrap() as usize;
        let start: usize = text.split_inclusive('\n').take(line).map(str::len).sum();
        let (mut units, wanted) = (0, position["character"].as_u64().unwrap() as usize);
        let rest = text[start..].char_indices();
        let found = rest.into_iter().find(|(_, c)| {
            let is_it = units >= wanted;
            units += c.len_utf16();
            is_it
        });
        found.map_or(text.len(), |(at, _)| start + at)
    };
    let mut edits: Vec<(usize, usize, &str)> = edits
        .as_array()
        .unwrap()
        .iter()
        .map(|edit| {
            let range = &edit["range"];
            (offset(&range["start"]), offset(&range["end"]), edit["newText"].as_str().unwrap())
        })
        .collect();
    edits.sort_by(|a, b| b.cmp(a));
    let mut text = text.to_owned();
    edits.iter().for_each(|(start, end, new)| text.replace_range(*start..*end, new));
    text
}
