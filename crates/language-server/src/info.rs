//! What is said of a name, where it is declared, and the values that a file inherits.

use crate::completion::named_pipeline;
use crate::offer::takes;
use crate::pipelines::{Entity, File, Pipelines};
use crate::text;
use crate::workspace::Workspace;
use catalog::{SceneAssets, Sort};
use data_file::grammar::{Cursor, Within};
use data_file::{Setting, Settings, Span, Value};
use frame_graph::description::{Symbol, SymbolKind};
use frame_graph::port::PassTypes as _;
use frame_graph::{Resolved, Use};
use lsp_types::{InlayHint, InlayHintKind, InlayHintLabel, Location, Position, Range};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::ops;
use std::sync::Arc;

/// A name of a pipeline file, and what is known of it.
pub(crate) struct Named<'n> {
    pub(crate) workspace: &'n Workspace,
    pub(crate) pipelines: &'n Pipelines,
    pub(crate) file: &'n Arc<File>,
}

/// The text that describes a setting, its value and where that was given.
fn describe(setting: &Setting, value: &Value, given: Option<&Span>) -> String {
    let origin = match given {
        Some(span) => format!("given at {span}"),
        None => "the default of the pass type".to_owned(),
    };
    let declared = if setting.declared.is_empty() {
        String::new()
    } else {
        format!("\n\nDeclared at {}", setting.declared)
    };
    format!(
        "**{}** {}\n\n{}\n\nValue: `{value}`, {origin}{declared}",
        setting.name,
        takes(setting),
        setting.doc
    )
}

/// Describes an interface with its members.
pub(crate) fn interface(known: &frame_graph::Interface) -> String {
    let mut text = format!("**{}** {}", known.name, known.doc);
    for member in known.members.iter().filter(|member| !member.name.is_empty()) {
        let _ = write!(text, "\n- `{}` {}", member.name, member.doc);
    }
    text
}

/// Returns the text about the name at a byte of a RON file, and the bytes of the name.
pub(crate) fn hover(
    workspace: &Workspace,
    pipelines: &Pipelines,
    (name, whole): (&str, &str),
    sort: Option<Sort>,
    at: usize,
) -> Option<(String, ops::Range<usize>)> {
    match sort {
        Some(Sort::Pipeline) => {
            let file = pipelines.file(workspace, name)?;
            let symbol = file.symbol_at(at)?;
            let text = Named { workspace, pipelines, file: &file }.text(symbol)?;
            Some((text, symbol.place.start as usize..symbol.place.end as usize))
        }
        Some(Sort::Study) => {
            let cursor = Cursor::new(whole, at);
            let range = cursor.content(whole);
            let word = whole.get(range.clone()).filter(|_| cursor.within == Within::Text)?;
            if let Some(measure) = study::Measure::all().find(|measure| measure.info().key == word) {
                let info = measure.info();
                return Some((format!("**{}** [{}] {}", info.label, info.unit, info.doc), range));
            }
            if let Some(base) = named_pipeline(workspace, name, word) {
                let about = pipelines.file(workspace, &base)?.description.as_ref()?.about()?.to_owned();
                return Some((about, range));
            }
            if field_of(&cursor) == Some("scenes") {
                let files = SceneAssets(workspace.catalog.assets().clone());
                return Some((scene::about(word, &files).ok()?, range));
            }
            // A path: of the first pipeline that has it.
            let mut named =
                whole.split('"').skip(1).step_by(2).filter_map(|word| named_pipeline(workspace, name, word));
            named.find_map(|base| {
                let file = pipelines.file(workspace, &base)?;
                let resolved = pipelines.resolved(workspace, &file)?;
                Some((Named { workspace, pipelines, file: &file }.setting(&resolved, word)?, range.clone()))
            })
        }
        Some(Sort::Scene) | None => None,
    }
}

impl Named<'_> {
    fn setting(&self, resolved: &Resolved, path: &str) -> Option<String> {
        let settable = resolved.settable(&*self.workspace.catalog);
        let found = settable.into_iter().find(|settable| settable.path == path)?;
        Some(describe(&found.setting, &found.value, resolved.given_at(path).as_ref()))
    }

    fn pass_type(&self, kind: &str) -> Option<String> {
        let catalog = &self.workspace.catalog;
        let pass = catalog.pass(kind)?;
        let outputs = BTreeMap::new();
        let use_ = Use { kind, shader: None, inputs: &[], outputs: &outputs };
        let settings = catalog.settings(use_).unwrap_or_default();
        let mut text = format!("**{kind}** {}", pass.about(catalog.shaders()).about);
        if let Ok(ports) = catalog.ports(use_, &Settings::defaults(&settings)) {
            for port in &ports.inputs {
                let optional = if port.optional { ", optional" } else { "" };
                let _ = write!(text, "\n- in `{}`: {}{optional}. {}", port.name, port.interface, port.doc);
            }
            for port in &ports.outputs {
                let _ = write!(text, "\n- out `{}`: {}. {}", port.name, port.interface, port.doc);
            }
        }
        for setting in settings.iter() {
            let _ = write!(text, "\n- set `{}`: {}. {}", setting.name, takes(setting), setting.doc);
        }
        Some(text)
    }

    fn text(&self, symbol: &Symbol) -> Option<String> {
        let resolved = || self.pipelines.resolved(self.workspace, self.file);
        let catalog = &self.workspace.catalog;
        let of = |name: &str| catalog.interfaces().iter().find(|known| known.name == name).map(interface);
        match symbol.kind {
            SymbolKind::Parameter => self.setting(&*resolved()?, &symbol.name),
            SymbolKind::Setting => {
                let path = format!("{}.{}", symbol.of, symbol.name);
                resolved().and_then(|resolved| self.setting(&resolved, &path)).or_else(|| {
                    let (kind, shader) = self.pipelines.pass_type(self.workspace, self.file, &symbol.of)?;
                    let outputs = BTreeMap::new();
                    let use_ = Use { kind: &kind, shader: shader.as_deref(), inputs: &[], outputs: &outputs };
                    let settings = catalog.settings(use_).ok()?;
                    let setting = settings.iter().find(|setting| setting.name == symbol.name)?;
                    Some(describe(setting, &setting.default, None))
                })
            }
            SymbolKind::Pass => {
                let mention = self.pipelines.mentions(self.workspace, self.file, symbol).pop();
                let declared = mention.and_then(|mention| {
                    let file = self.pipelines.file(self.workspace, &mention.entity.file)?;
                    let key = (SymbolKind::Pass, "", &*mention.entity.name);
                    let (file, found) = self.pipelines.declaration(self.workspace, &file, key)?;
                    Some(format!("\n\nDeclared at {}", file.span(&found)))
                });
                let declared = declared.unwrap_or_default();
                match self.pipelines.pass_type(self.workspace, self.file, &symbol.name) {
                    Some((kind, _)) => {
                        let about = catalog.pass(&kind).map(|pass| pass.about(catalog.shaders()).about);
                        let about = about.unwrap_or_default();
                        Some(format!("**{}**: `{kind}`. {about}{declared}", symbol.name))
                    }
                    None if declared.is_empty() => None,
                    None => Some(format!("**{}**: a sub-graph{declared}", symbol.name)),
                }
            }
            SymbolKind::PassType => self.pass_type(&symbol.name),
            SymbolKind::InputPort | SymbolKind::OutputPort => {
                let resolved = resolved()?;
                if let Some(ports) = resolved.ports(&**catalog, &symbol.of) {
                    let inputs = ports.inputs.iter().map(|port| (&port.name, &port.interface, &port.doc));
                    let outputs = ports.outputs.iter().map(|port| (&port.name, &port.interface, &port.doc));
                    let mut all: Vec<_> = inputs.collect();
                    if symbol.kind == SymbolKind::OutputPort {
                        all = outputs.collect();
                    }
                    let (name, interface, doc) = all.into_iter().find(|(name, ..)| **name == *symbol.name)?;
                    return Some(format!("**{name}**: `{interface}`. {doc}"));
                }
                let outputs = resolved.outputs_of(&**catalog, &symbol.of);
                outputs.iter().find(|(name, _)| *name == symbol.name).and_then(|(_, interface)| of(interface))
            }
            SymbolKind::Output => {
                resolved()?.interface_of_output(&**catalog, &symbol.name).and_then(|name| of(&name))
            }
            SymbolKind::Input => {
                let key = (SymbolKind::Input, &*symbol.scope, &*symbol.name);
                let (file, found) = self.pipelines.declaration(self.workspace, self.file, key)?;
                let is_next = |other: &&Symbol| {
                    other.kind == SymbolKind::Interface && other.place.start > found.place.start
                };
                let interface = file.symbols.iter().filter(is_next).min_by_key(|other| other.place.start)?;
                of(&interface.name)
            }
            SymbolKind::Interface => of(&symbol.name),
            SymbolKind::File => {
                let file = self.pipelines.named(self.workspace, &symbol.name, self.file)?;
                let about = file.description.as_ref()?.about().unwrap_or_default().to_owned();
                Some(format!("`{}` {about}", file.source.name))
            }
            SymbolKind::Shader => {
                let name = self.shader(&symbol.name)?;
                Some(format!("`{name}`"))
            }
        }
    }

    /// Returns the name of the WGSL file that this file means.
    fn shader(&self, path: &str) -> Option<String> {
        let own = data_file::paths::beside(&self.file.source.name, path);
        let files = [own, Some(path.to_owned())].into_iter().flatten();
        files.into_iter().find(|name| self.workspace.assets().has(name))
    }

    /// Returns where what a name names is declared.
    pub(crate) fn definition(&self, at: usize) -> Option<Location> {
        let symbol = self.file.symbol_at(at)?;
        if let Some(mention) = self.pipelines.mention_at(self.workspace, self.file, at) {
            return declared(self.workspace, self.pipelines, &mention.entity);
        }
        let of_kind = |kind: &str| format!("passes/{kind}/{kind}.wgsl");
        let pass_type = || self.pipelines.pass_type(self.workspace, self.file, &symbol.of);
        match symbol.kind {
            SymbolKind::File => {
                let file = self.pipelines.named(self.workspace, &symbol.name, self.file)?;
                self.workspace.start(&file.source.name)
            }
            SymbolKind::Shader => self.workspace.start(&self.shader(&symbol.name)?),
            SymbolKind::PassType => self.workspace.start(&of_kind(&symbol.name)),
            SymbolKind::Interface => {
                let known =
                    self.workspace.catalog.interfaces().iter().find(|known| known.name == symbol.name)?;
                let files = self.workspace.catalog.shaders().folder(known.folder?);
                self.workspace.start(&files.first()?.path)
            }
            SymbolKind::InputPort | SymbolKind::OutputPort | SymbolKind::Setting => {
                let (kind, shader) = pass_type()?;
                let main = shader.and_then(|path| self.shader(&path)).unwrap_or_else(|| of_kind(&kind));
                crate::wgsl::declaration(self.workspace, &main, &symbol.name)
            }
            SymbolKind::Parameter | SymbolKind::Pass | SymbolKind::Input | SymbolKind::Output => None,
        }
    }

    /// Returns the values of parameters where they are used, and those that declarations inherit.
    pub(crate) fn hints(&self, range: Range) -> Vec<InlayHint> {
        let Some(resolved) = self.pipelines.resolved(self.workspace, self.file) else { return Vec::new() };
        let settable = resolved.settable(&*self.workspace.catalog);
        let whole = &self.file.source.text;
        let bytes = text::offset(whole, range.start)..=text::offset(whole, range.end);
        let symbols = self.file.symbols.iter().filter(|symbol| symbol.kind == SymbolKind::Parameter);
        let shown = symbols.filter(|symbol| bytes.contains(&(symbol.place.start as usize)));
        let hint = |symbol: &Symbol| {
            let path = &*symbol.name;
            let value = &settable.iter().find(|settable| settable.path == path)?.value;
            let end = symbol.place.end as usize;
            let position = |at: usize| text::position(whole, at);
            if symbol.declares {
                // `"lights": U32(…)` without a default of its own.
                let open = end + whole[end..].find('(')?;
                let own = data_file::grammar::entries(whole, open).iter().any(|(key, _)| *key == "default");
                return (!own).then(|| inlay(position(open + 1), format!("default: {value}")));
            }
            // A path that a patch sets has the value that stands there.
            let is_use = whole[..symbol.place.start as usize].ends_with('$');
            is_use.then(|| inlay(position(end), format!("= {value}")))
        };
        shown.filter_map(hint).collect()
    }
}

fn inlay(position: Position, label: String) -> InlayHint {
    InlayHint {
        position,
        label: InlayHintLabel::String(label),
        kind: Some(InlayHintKind::PARAMETER),
        text_edits: None,
        tooltip: None,
        padding_left: Some(true),
        padding_right: Some(true),
        data: None,
    }
}

/// Returns where what is named is declared first.
pub(crate) fn declared(workspace: &Workspace, pipelines: &Pipelines, entity: &Entity) -> Option<Location> {
    let file = pipelines.file(workspace, &entity.file)?;
    let (file, symbol) = pipelines.declaration(workspace, &file, entity.renamed(&entity.name))?;
    workspace.location(&file.span(&symbol))
}

/// Returns the field whose value is at a position, or has it in a list.
fn field_of<'t>(cursor: &Cursor<'t>) -> Option<&'t str> {
    cursor.frames.iter().rev().find_map(|frame| frame.key)
}

/// Returns where the file is that a name in a study or a scene names.
pub(crate) fn definition_of_file(
    workspace: &Workspace,
    (name, whole): (&str, &str),
    at: usize,
) -> Option<Location> {
    let cursor = Cursor::new(whole, at);
    let word = whole.get(cursor.content(whole)).filter(|_| cursor.within == Within::Text)?;
    let key = field_of(&cursor)?;
    let scene = || {
        let own = data_file::paths::beside(name, word);
        let of_tree = Some(format!("scenes/{word}.ron"));
        [own, of_tree].into_iter().flatten().find(|name| workspace.assets().has(name))
    };
    let found = if key == "scenes" { scene() } else { named_pipeline(workspace, name, word) };
    workspace.start(&found?)
}
