//! What is wrong with the open files, found by another thread and sent to the editor; and what the editor may do about
//! it.

use crate::workspace::{Language, uri_of_path};
use crate::{Check, text};
use catalog::Catalog;
use data_file::{Diagnostic, Severity, Span, nearest};
use lsp_server::{Message, Notification};
use lsp_types::{
    CodeAction, CodeActionKind, CodeActionOrCommand, DiagnosticRelatedInformation, DiagnosticSeverity,
    Location, NumberOrString, PublishDiagnosticsParams, TextEdit, Uri, WorkspaceEdit,
};
use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::thread;

/// An open file that is to be checked.
#[derive(Clone, Debug)]
pub(crate) struct Target {
    /// The name by which the front end knows it.
    pub(crate) name: String,
    pub(crate) uri: Uri,
    pub(crate) version: i32,
    pub(crate) language: Language,
}

/// Where messages go; nowhere once the editor has asked the server to end.
pub(crate) type Outbox = Arc<Mutex<Option<Box<dyn Fn(Message) + Send>>>>;

pub(crate) fn send(outbox: &Outbox, message: Message) {
    if let Some(send) = &*outbox.lock().unwrap_or_else(PoisonError::into_inner) {
        send(message);
    }
}

/// Starts the thread that checks; what is sent to it are all open files, those that changed last first.
pub(crate) fn start(catalog: Arc<Catalog>, check: Arc<Check>, outbox: Outbox) -> mpsc::Sender<Vec<Target>> {
    let (sender, receiver) = mpsc::channel::<Vec<Target>>();
    let run = move || {
        let mut checker = Checker { catalog, check, outbox, found: BTreeMap::new(), shown: BTreeMap::new() };
        let mut next = receiver.recv();
        while let Ok(targets) = next {
            next = checker.check_all(&targets, &receiver).map_or_else(|| receiver.recv(), Ok);
        }
    };
    thread::Builder::new()
        .name("check".to_owned())
        .spawn(run)
        .map_or_else(|error| panic!("no thread can be started: {error}"), |_| sender)
}

struct Checker {
    catalog: Arc<Catalog>,
    check: Arc<Check>,
    outbox: Outbox,
    /// What was found in each open file, by its name.
    found: BTreeMap<String, Vec<Diagnostic>>,
    /// What the editor shows, by URI.
    shown: BTreeMap<String, Vec<lsp_types::Diagnostic>>,
}

impl Checker {
    /// Checks open files; returns those that are to be checked instead, where something has changed meanwhile.
    fn check_all(
        &mut self,
        targets: &[Target],
        receiver: &mpsc::Receiver<Vec<Target>>,
    ) -> Option<Vec<Target>> {
        self.found.retain(|name, _| targets.iter().any(|target| target.name == *name));
        self.publish(targets, None);
        for target in targets {
            if let Some(newer) = receiver.try_iter().last() {
                return Some(newer);
            }
            let found = (self.check)(&target.name, target.language);
            self.found.insert(target.name.clone(), found);
            self.publish(targets, Some(target));
        }
        None
    }

    /// Sends what has changed; `checked` is sent in any case, so that the editor knows that the version was checked.
    fn publish(&mut self, targets: &[Target], checked: Option<&Target>) {
        let mut now: BTreeMap<String, Vec<lsp_types::Diagnostic>> = BTreeMap::new();
        for (name, found) in &self.found {
            let Some(target) = targets.iter().find(|target| target.name == *name) else { continue };
            for diagnostic in found {
                let main = diagnostic.labels.first().and_then(|label| self.location(targets, &label.span));
                // What is built into the program is no file: what is wrong there is wrong with the file that uses it.
                let place = main.unwrap_or_else(|| Location::new(target.uri.clone(), Default::default()));
                let shown = self.convert(targets, diagnostic, &place);
                let list = now.entry(place.uri.as_str().to_owned()).or_default();
                if !list.contains(&shown) {
                    list.push(shown);
                }
            }
        }
        let gone: Vec<String> = self.shown.keys().filter(|uri| !now.contains_key(*uri)).cloned().collect();
        now.extend(gone.into_iter().map(|uri| (uri, Vec::new())));
        if let Some(checked) = checked {
            now.entry(checked.uri.as_str().to_owned()).or_default();
        }
        for (uri, diagnostics) in &now {
            let target = targets.iter().find(|target| target.uri.as_str() == uri);
            let is_checked = checked.is_some_and(|checked| checked.uri.as_str() == uri);
            if !is_checked && self.shown.get(uri).is_some_and(|shown| shown == diagnostics) {
                continue;
            }
            let Ok(uri) = uri.parse() else { continue };
            let version = target.map(|target| target.version);
            let params = PublishDiagnosticsParams::new(uri, diagnostics.clone(), version);
            let note = Notification::new("textDocument/publishDiagnostics".to_owned(), params);
            send(&self.outbox, note.into());
        }
        now.retain(|_, diagnostics| !diagnostics.is_empty());
        self.shown = now;
    }

    fn location(&self, targets: &[Target], span: &Span) -> Option<Location> {
        let name = &span.source.name;
        let open = targets.iter().find(|target| target.name == *name).map(|target| target.uri.clone());
        let on_disk = || {
            let in_root = self.catalog.assets().root().map(|root| root.join(name));
            let built_in = self.catalog.assets().embedded(name).is_some();
            let in_working = || std::path::absolute(name).ok().filter(|_| !built_in);
            let path = in_root.filter(|path| path.is_file()).or_else(in_working)?;
            path.is_file().then(|| uri_of_path(&path)).flatten()
        };
        let range = text::range(&span.source.text, span.start as usize..span.end as usize);
        Some(Location::new(open.or_else(on_disk)?, range))
    }

    fn convert(&self, targets: &[Target], found: &Diagnostic, place: &Location) -> lsp_types::Diagnostic {
        let others = found.labels.iter().skip(1);
        let related = others.filter_map(|label| {
            let location = self.location(targets, &label.span)?;
            let message = if label.message.is_empty() { "here".to_owned() } else { label.message.clone() };
            Some(DiagnosticRelatedInformation { location, message })
        });
        let first = found.labels.first().map(|label| &label.message).filter(|message| !message.is_empty());
        let lines = std::iter::once(&found.message).chain(first).chain(&found.notes);
        let severity = match found.severity {
            Severity::Error => DiagnosticSeverity::ERROR,
            Severity::Warning => DiagnosticSeverity::WARNING,
            Severity::Note => DiagnosticSeverity::INFORMATION,
        };
        lsp_types::Diagnostic {
            range: place.range,
            severity: Some(severity),
            code: Some(found.code)
                .filter(|code| !code.is_empty())
                .map(|code| NumberOrString::String(code.into())),
            source: Some("lightloom".to_owned()),
            message: lines.map(String::as_str).collect::<Vec<_>>().join("\n"),
            related_information: Some(related.collect::<Vec<_>>()).filter(|related| !related.is_empty()),
            ..lsp_types::Diagnostic::default()
        }
    }
}

/// Returns the changes of a text that errors in it propose: `did you mean …?`.
pub(crate) fn actions(
    uri: &Uri,
    whole: &str,
    diagnostics: &[lsp_types::Diagnostic],
) -> Vec<CodeActionOrCommand> {
    let mut actions = Vec::new();
    for diagnostic in diagnostics {
        let start = text::offset(whole, diagnostic.range.start);
        let end = text::offset(whole, diagnostic.range.end);
        let Some(written) = whole.get(start..end) else { continue };
        let near = diagnostic
            .message
            .lines()
            .filter_map(|line| line.split("did you mean `").nth(1)?.split_once("`?").map(|(near, _)| near));
        for near in near {
            // The name that is wrong is quoted in the message, and part of what is underlined.
            let quoted =
                diagnostic.message.lines().next().unwrap_or_default().split(['`', '"']).skip(1).step_by(2);
            let inner = data_file::grammar::unquoted(written);
            let mut wrong: Vec<&str> =
                quoted.filter(|word| !word.is_empty() && written.contains(word)).collect();
            if wrong.is_empty() {
                wrong.push(inner);
            }
            let wrong = nearest(near, wrong.iter().copied()).unwrap_or(wrong[0]);
            let Some(at) = written.find(wrong).map(|at| start + at).filter(|_| wrong != near) else {
                continue;
            };
            let edit = TextEdit::new(text::range(whole, at..at + wrong.len()), near.to_owned());
            actions.push(CodeActionOrCommand::CodeAction(CodeAction {
                title: format!("change to `{near}`"),
                kind: Some(CodeActionKind::QUICKFIX),
                diagnostics: Some(vec![diagnostic.clone()]),
                edit: Some(WorkspaceEdit::new(HashMap::from([(uri.clone(), vec![edit])]))),
                is_preferred: Some(true),
                ..CodeAction::default()
            }));
        }
    }
    actions
}
