//! The messages of the protocol.

use crate::completion::of_ron;
use crate::diagnostics::{self, Outbox, Target};
use crate::info::{self, Named};
use crate::offer::markdown;
use crate::pipelines::{Mention, Pipelines};
use crate::workspace::{Document, Language, Workspace, path_of_uri};
use crate::{Check, studies, text, wgsl};
use catalog::{Catalog, Sort};
use data_file::grammar::{Item, format, outline};
use lsp_server::{Connection, ErrorCode, Message, Notification, ProtocolError, Request, Response};
use lsp_types::{
    CodeActionParams, CompletionOptions, CompletionParams, DidChangeTextDocumentParams,
    DidChangeWatchedFilesParams, DidChangeWatchedFilesRegistrationOptions, DidCloseTextDocumentParams,
    DidOpenTextDocumentParams, DocumentFormattingParams, DocumentSymbol, DocumentSymbolParams,
    FileSystemWatcher, GlobPattern, GotoDefinitionParams, Hover, HoverContents, HoverParams,
    HoverProviderCapability, InitializeParams, InlayHintParams, Location, OneOf, ReferenceParams,
    Registration, RegistrationParams, RenameOptions, RenameParams, ServerCapabilities, SymbolKind,
    TextDocumentPositionParams, TextDocumentSyncCapability, TextDocumentSyncKind, TextDocumentSyncOptions,
    TextEdit, Uri, WorkDoneProgressOptions, WorkspaceEdit,
};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError, mpsc};

/// Waits for an editor to begin, and returns its parameters and the folders that it has opened.
///
/// # Errors
/// What the editor sends is not the protocol, or it ends before it begins.
pub fn begin(connection: &Connection) -> Result<(InitializeParams, Vec<PathBuf>), ProtocolError> {
    let (id, params) = connection.initialize_start()?;
    let result = json!({
        "capabilities": capabilities(),
        "serverInfo": { "name": "lightloom", "version": env!("CARGO_PKG_VERSION") },
    });
    connection.initialize_finish(id, result)?;
    let params: InitializeParams = serde_json::from_value(params).unwrap_or_default();
    #[expect(deprecated, reason = "editors send it that have no workspace folders")]
    let root = params.root_uri.iter();
    let folders = params.workspace_folders.iter().flatten().map(|folder| &folder.uri).chain(root);
    let mut folders: Vec<PathBuf> = folders.filter_map(path_of_uri).collect();
    folders.dedup();
    Ok((params, folders))
}

fn capabilities() -> ServerCapabilities {
    ServerCapabilities {
        text_document_sync: Some(TextDocumentSyncCapability::Options(TextDocumentSyncOptions {
            open_close: Some(true),
            change: Some(TextDocumentSyncKind::INCREMENTAL),
            save: Some(true.into()),
            ..TextDocumentSyncOptions::default()
        })),
        completion_provider: Some(CompletionOptions {
            trigger_characters: Some(["\"", "$", ".", "(", "[", "#"].map(str::to_owned).to_vec()),
            ..CompletionOptions::default()
        }),
        hover_provider: Some(HoverProviderCapability::Simple(true)),
        definition_provider: Some(OneOf::Left(true)),
        references_provider: Some(OneOf::Left(true)),
        rename_provider: Some(OneOf::Right(RenameOptions {
            prepare_provider: Some(true),
            work_done_progress_options: WorkDoneProgressOptions::default(),
        })),
        document_symbol_provider: Some(OneOf::Left(true)),
        document_formatting_provider: Some(OneOf::Left(true)),
        code_action_provider: Some(true.into()),
        inlay_hint_provider: Some(OneOf::Left(true)),
        ..ServerCapabilities::default()
    }
}

/// Answers an editor until it ends; returns whether it has asked the server to end, and is not simply gone.
///
/// # Errors
/// The editor sends what is not the protocol.
pub fn serve(
    connection: &Connection,
    (params, folders): (&InitializeParams, Vec<PathBuf>),
    catalog: Arc<Catalog>,
    check: Arc<Check>,
) -> Result<bool, ProtocolError> {
    let sender = connection.sender.clone();
    let send: Box<dyn Fn(Message) + Send> = Box::new(move |message| drop(sender.send(message)));
    let outbox: Outbox = Arc::new(Mutex::new(Some(send)));
    let checks = diagnostics::start(Arc::clone(&catalog), check, Arc::clone(&outbox));
    let mut server = Server {
        workspace: Workspace::new(catalog, folders),
        pipelines: Pipelines::default(),
        checks,
        outbox: Arc::clone(&outbox),
    };
    if watches(params) {
        server.watch();
    }
    let ended = server.run(connection);
    // The thread that checks may still run, and says nothing more.
    *outbox.lock().unwrap_or_else(PoisonError::into_inner) = None;
    ended
}

/// Returns whether the editor watches files for the server.
fn watches(params: &InitializeParams) -> bool {
    let workspace = params.capabilities.workspace.as_ref();
    let watching = workspace.and_then(|workspace| workspace.did_change_watched_files.as_ref());
    watching.is_some_and(|watching| watching.dynamic_registration == Some(true))
}

struct Server {
    workspace: Workspace,
    pipelines: Pipelines,
    checks: mpsc::Sender<Vec<Target>>,
    outbox: Outbox,
}

/// Why a request has no answer.
struct Refused(String);

type Answer = Result<Value, Refused>;

fn read<P: serde::de::DeserializeOwned>(params: Value) -> Result<P, Refused> {
    serde_json::from_value(params).map_err(|error| Refused(error.to_string()))
}

/// A file that is asked about.
struct Asked<'s> {
    name: String,
    uri: &'s Uri,
    text: &'s str,
    language: Language,
}

impl Server {
    fn run(&mut self, connection: &Connection) -> Result<bool, ProtocolError> {
        for message in &connection.receiver {
            match message {
                Message::Request(request) => {
                    if connection.handle_shutdown(&request)? {
                        return Ok(true);
                    }
                    let response = self.answer(request);
                    diagnostics::send(&self.outbox, response.into());
                }
                Message::Notification(notification) if notification.method == "exit" => return Ok(false),
                Message::Notification(notification) => self.take(notification),
                Message::Response(_) => {}
            }
        }
        Ok(false)
    }

    /// Asks the editor to report files that change on disk.
    fn watch(&self) {
        let watcher = |pattern: &str| FileSystemWatcher {
            glob_pattern: GlobPattern::String(pattern.to_owned()),
            kind: None,
        };
        let watchers = vec![watcher("**/*.ron"), watcher("**/*.wgsl")];
        let options = DidChangeWatchedFilesRegistrationOptions { watchers };
        let registration = Registration {
            id: "files".to_owned(),
            method: "workspace/didChangeWatchedFiles".to_owned(),
            register_options: serde_json::to_value(options).ok(),
        };
        let params = RegistrationParams { registrations: vec![registration] };
        let request =
            Request::new("register".to_owned().into(), "client/registerCapability".to_owned(), params);
        diagnostics::send(&self.outbox, request.into());
    }

    fn answer(&mut self, request: Request) -> Response {
        let Request { id, method, params } = request;
        self.pipelines.begin();
        let answer = match &*method {
            "textDocument/completion" => read(params).and_then(|params| self.completion(&params)),
            "textDocument/hover" => read(params).and_then(|params| self.hover(&params)),
            "textDocument/definition" => read(params).and_then(|params| self.definition(&params)),
            "textDocument/references" => read(params).and_then(|params| self.references(&params)),
            "textDocument/prepareRename" => read(params).and_then(|params| self.prepare_rename(&params)),
            "textDocument/rename" => read(params).and_then(|params| self.rename(&params)),
            "textDocument/documentSymbol" => read(params).and_then(|params| self.symbols(&params)),
            "textDocument/formatting" => read(params).and_then(|params| self.formatting(&params)),
            "textDocument/codeAction" => read(params).and_then(|params| self.actions(&params)),
            "textDocument/inlayHint" => read(params).and_then(|params| self.hints(&params)),
            _ => {
                let message = format!("`{method}` is not known");
                return Response::new_err(id, ErrorCode::MethodNotFound as i32, message);
            }
        };
        match answer {
            Ok(value) => Response::new_ok(id, value),
            Err(Refused(message)) => Response::new_err(id, ErrorCode::InvalidParams as i32, message),
        }
    }

    fn take(&mut self, notification: Notification) {
        let Notification { method, params } = notification;
        match &*method {
            "textDocument/didOpen" => {
                let Ok(DidOpenTextDocumentParams { text_document: opened }) = read(params) else { return };
                let Some(path) = path_of_uri(&opened.uri) else { return };
                let document = Document { uri: opened.uri, version: opened.version, text: opened.text };
                self.workspace.open.insert(path.clone(), document);
                self.changed(&path);
            }
            "textDocument/didChange" => {
                let Ok(params) = read::<DidChangeTextDocumentParams>(params) else { return };
                let Some(path) = path_of_uri(&params.text_document.uri) else { return };
                let Some(document) = self.workspace.open.get_mut(&path) else { return };
                document.version = params.text_document.version;
                params
                    .content_changes
                    .into_iter()
                    .for_each(|change| text::change(&mut document.text, change));
                self.changed(&path);
            }
            "textDocument/didClose" => {
                let Ok(params) = read::<DidCloseTextDocumentParams>(params) else { return };
                let Some(path) = path_of_uri(&params.text_document.uri) else { return };
                self.workspace.open.remove(&path);
                self.pipelines.forget(&self.workspace.name(&path));
                self.changed(&path);
            }
            "textDocument/didSave" => self.check(None),
            "workspace/didChangeWatchedFiles" => {
                let Ok(params) = read::<DidChangeWatchedFilesParams>(params) else { return };
                let paths: Vec<PathBuf> =
                    params.changes.iter().filter_map(|change| path_of_uri(&change.uri)).collect();
                for path in paths.iter().filter(|path| !self.workspace.open.contains_key(*path)) {
                    self.stale(path);
                }
                self.check(None);
            }
            _ => {}
        }
    }

    /// Lays the text of a file over that on disk, or takes it away, and has all open files checked.
    fn changed(&self, path: &Path) {
        let text = self.workspace.open.get(path).map(|document| &*document.text);
        self.workspace.assets().set_open(path, text);
        self.stale(path);
        self.check(Some(path));
    }

    /// Drops the shaders that were made of a file.
    fn stale(&self, path: &Path) {
        // What is kept of shaders stays where a pipeline changes.
        if path.extension().is_none_or(|ending| ending != "wgsl") {
            return;
        }
        let paths = [self.workspace.name(path), path.to_string_lossy().into_owned()];
        self.workspace.catalog.shaders().invalidate(&paths);
    }

    fn check(&self, first: Option<&Path>) {
        let targets = self.workspace.open.iter().filter_map(|(path, document)| {
            let name = self.workspace.name(path);
            let language = Language::of(&name, &document.text)?;
            let target = Target { name, uri: document.uri.clone(), version: document.version, language };
            Some((Some(path.as_path()) != first, target))
        });
        let mut targets: Vec<(bool, Target)> = targets.collect();
        targets.sort_by_key(|(later, _)| *later);
        // The thread ends only with the server.
        let _ = self.checks.send(targets.into_iter().map(|(_, target)| target).collect());
    }

    /// Returns an open file by its URI.
    fn asked<'s>(&'s self, uri: &'s Uri) -> Result<Asked<'s>, Refused> {
        let open = path_of_uri(uri).and_then(|path| Some((self.workspace.open.get(&path)?, path)));
        let Some((document, path)) = open else { return Err(Refused("the file is not open".to_owned())) };
        let name = self.workspace.name(&path);
        match Language::of(&name, &document.text) {
            Some(language) => Ok(Asked { name, uri, text: &document.text, language }),
            None => Err(Refused("files end in `.ron` or `.wgsl`".to_owned())),
        }
    }

    fn at<'s>(&'s self, params: &'s TextDocumentPositionParams) -> Result<(Asked<'s>, usize), Refused> {
        let asked = self.asked(&params.text_document.uri)?;
        let at = text::offset(asked.text, params.position);
        Ok((asked, at))
    }

    fn completion(&self, params: &CompletionParams) -> Answer {
        let (asked, at) = self.at(&params.text_document_position)?;
        let file = (&*asked.name, asked.text);
        Ok(json!(match asked.language {
            Language::Ron(sort) => of_ron(&self.workspace, &self.pipelines, file, sort, at),
            Language::Wgsl => wgsl::completion(&self.workspace, file, at),
        }))
    }

    fn hover(&self, params: &HoverParams) -> Answer {
        let (asked, at) = self.at(&params.text_document_position_params)?;
        let file = (&*asked.name, asked.text);
        let found = match asked.language {
            Language::Ron(sort) => info::hover(&self.workspace, &self.pipelines, file, sort, at),
            Language::Wgsl => wgsl::hover(&self.workspace, file, at),
        };
        Ok(json!(found.map(|(said, bytes)| Hover {
            contents: HoverContents::Markup(markdown(said)),
            range: Some(text::range(asked.text, bytes)),
        })))
    }

    fn definition(&self, params: &GotoDefinitionParams) -> Answer {
        let (asked, at) = self.at(&params.text_document_position_params)?;
        let file = (&*asked.name, asked.text);
        Ok(json!(match asked.language {
            Language::Ron(Some(Sort::Pipeline)) => {
                let file = self.pipelines.file(&self.workspace, &asked.name);
                file.and_then(|file| {
                    Named { workspace: &self.workspace, pipelines: &self.pipelines, file: &file }
                        .definition(at)
                })
            }
            Language::Ron(_) => {
                let found = self.mention(&params.text_document_position_params)?;
                let declared =
                    found.and_then(|found| info::declared(&self.workspace, &self.pipelines, &found.entity));
                declared.or_else(|| info::definition_of_file(&self.workspace, file, at))
            }
            Language::Wgsl => wgsl::definition(&self.workspace, file, at),
        }))
    }

    /// Returns what the name at a position of a pipeline or a study names.
    fn mention(&self, params: &TextDocumentPositionParams) -> Result<Option<Mention>, Refused> {
        let (asked, at) = self.at(params)?;
        let file = || self.pipelines.file(&self.workspace, &asked.name);
        Ok(match asked.language {
            Language::Ron(Some(Sort::Pipeline)) => {
                file().and_then(|file| self.pipelines.mention_at(&self.workspace, &file, at))
            }
            Language::Ron(Some(Sort::Study)) => file()
                .and_then(|file| studies::mention_at(&self.workspace, &self.pipelines, &file.source, at)),
            Language::Ron(_) | Language::Wgsl => None,
        })
    }

    fn references(&self, params: &ReferenceParams) -> Answer {
        let Some(mention) = self.mention(&params.text_document_position)? else { return Ok(json!([])) };
        let uses = self.pipelines.uses(&self.workspace, &mention.entity).into_iter();
        let wanted = uses.filter(|found| params.context.include_declaration || !found.declares);
        let places: Vec<Location> = wanted.filter_map(|found| self.workspace.location(&found.span)).collect();
        Ok(json!(places))
    }

    fn prepare_rename(&self, params: &TextDocumentPositionParams) -> Answer {
        let mention =
            self.mention(params)?.ok_or_else(|| Refused("no pass or parameter is here".to_owned()))?;
        let span = &mention.span;
        Ok(json!(text::range(&span.source.text, span.start as usize..span.end as usize)))
    }

    #[expect(clippy::mutable_key_type, reason = "the protocol's type; a URI does not change")]
    fn rename(&self, params: &RenameParams) -> Answer {
        let mention = self.mention(&params.text_document_position)?;
        let Mention { entity, .. } =
            mention.ok_or_else(|| Refused("no pass or parameter is here".to_owned()))?;
        let new = &params.new_name;
        if !entity.takes_name(new) {
            return Err(Refused(format!(
                "{new:?} is no name: names are made of letters, digits, `-` and `_`"
            )));
        }
        let uses = self.pipelines.uses(&self.workspace, &entity);
        if let Some(foreign) = uses.iter().find(|found| !self.workspace.is_own(&found.span.source.name)) {
            return Err(Refused(format!("`{}` is built into the program", foreign.span.source.name)));
        }
        let files =
            uses.iter().filter_map(|found| self.pipelines.file(&self.workspace, &found.span.source.name));
        for file in files {
            if let Some((taken, at)) = self.pipelines.declaration(&self.workspace, &file, entity.renamed(new))
            {
                return Err(Refused(format!("`{new}` is declared at {}", taken.span(&at))));
            }
        }
        let mut changes: HashMap<Uri, Vec<TextEdit>> = HashMap::new();
        for found in uses {
            let Some(Location { uri, range }) = self.workspace.location(&found.span) else { continue };
            changes.entry(uri).or_default().push(TextEdit::new(range, new.clone()));
        }
        Ok(json!(WorkspaceEdit::new(changes)))
    }

    fn symbols(&self, params: &DocumentSymbolParams) -> Answer {
        let asked = self.asked(&params.text_document.uri)?;
        Ok(json!(match asked.language {
            Language::Ron(_) =>
                outline(asked.text).into_iter().map(|item| symbol(asked.text, item)).collect(),
            Language::Wgsl => declarations(asked.text),
        }))
    }

    fn formatting(&self, params: &DocumentFormattingParams) -> Answer {
        let asked = self.asked(&params.text_document.uri)?;
        let formatted = match asked.language {
            Language::Ron(_) => format(asked.text),
            Language::Wgsl => None,
        };
        let whole = text::range(asked.text, 0..asked.text.len());
        let edits = formatted.filter(|new| new != asked.text).map(|new| vec![TextEdit::new(whole, new)]);
        Ok(json!(edits.unwrap_or_default()))
    }

    fn actions(&self, params: &CodeActionParams) -> Answer {
        let asked = self.asked(&params.text_document.uri)?;
        Ok(json!(diagnostics::actions(asked.uri, asked.text, &params.context.diagnostics)))
    }

    fn hints(&self, params: &InlayHintParams) -> Answer {
        let asked = self.asked(&params.text_document.uri)?;
        if asked.language != Language::Ron(Some(Sort::Pipeline)) {
            return Ok(json!([]));
        }
        let Some(file) = self.pipelines.file(&self.workspace, &asked.name) else { return Ok(json!([])) };
        let named = Named { workspace: &self.workspace, pipelines: &self.pipelines, file: &file };
        Ok(json!(named.hints(params.range)))
    }
}

#[expect(deprecated, reason = "a field of the type that must be given")]
fn of(name: String, detail: &str, kind: SymbolKind, places: [lsp_types::Range; 2]) -> DocumentSymbol {
    let [range, selection_range] = places;
    DocumentSymbol {
        name,
        detail: Some(detail.to_owned()).filter(|detail| !detail.is_empty()),
        kind,
        tags: None,
        deprecated: None,
        range,
        selection_range,
        children: None,
    }
}

fn symbol(whole: &str, item: Item) -> DocumentSymbol {
    let kind = match (&*item.form, item.items.is_empty()) {
        ("Pass", _) => SymbolKind::CLASS,
        ("Sub", _) => SymbolKind::MODULE,
        ("U32" | "F32" | "Bool" | "Text", _) => SymbolKind::VARIABLE,
        (_, false) => SymbolKind::NAMESPACE,
        (_, true) => SymbolKind::FIELD,
    };
    let places = [item.range, item.selection].map(|bytes| text::range(whole, bytes));
    // Editors refuse a symbol without a name.
    let name = if item.name.trim().is_empty() { "(…)".to_owned() } else { item.name };
    let children: Vec<DocumentSymbol> = item.items.into_iter().map(|item| symbol(whole, item)).collect();
    DocumentSymbol {
        children: Some(children).filter(|children| !children.is_empty()),
        ..of(name, &item.form, kind, places)
    }
}

/// Returns what a WGSL file declares outside of functions.
fn declarations(whole: &str) -> Vec<DocumentSymbol> {
    let declared = shader_library::declared(whole).into_iter();
    declared
        .map(|(keyword, name)| {
            let kind = match keyword {
                "fn" => SymbolKind::FUNCTION,
                "struct" | "alias" => SymbolKind::STRUCT,
                "var" => SymbolKind::VARIABLE,
                _ => SymbolKind::CONSTANT,
            };
            let start = name.as_ptr() as usize - whole.as_ptr() as usize;
            let range = text::range(whole, start..start + name.len());
            of(name.to_owned(), keyword, kind, [range; 2])
        })
        .collect()
}
