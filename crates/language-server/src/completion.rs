//! What may be typed at a position of a RON file.

use crate::offer::{Offer, takes};
use crate::pipelines::{File, Pipelines};
use crate::wgsl;
use crate::workspace::Workspace;
use catalog::Sort;
use data_file::grammar::{Cursor, Expected, Within};
use data_file::{Setting, Settings};
use frame_graph::description::{SymbolKind, TypedPass, Wanted, first, typed_pass, wanted};
use frame_graph::port::PassTypes as _;
use frame_graph::{Format, Ports, Resolved, Use};
use lsp_types::{CompletionItem, CompletionItemKind};
use shader_library::DeclaredPort;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// Returns what may be typed at a byte of a RON file.
pub(crate) fn of_ron(
    workspace: &Workspace,
    pipelines: &Pipelines,
    (name, whole): (&str, &str),
    sort: Option<Sort>,
    at: usize,
) -> Vec<CompletionItem> {
    let cursor = Cursor::new(whole, at);
    if cursor.within == Within::Comment {
        return Vec::new();
    }
    let position = Position { workspace, pipelines, name, whole, cursor, at };
    let mut items = position.forms(sort);
    let start = items.len();
    let offers = match sort {
        Some(Sort::Pipeline) => position.of_pipeline(),
        Some(Sort::Study) => position.of_study(),
        Some(Sort::Scene) => position.of_scene(),
        None => Vec::new(),
    };
    items.extend(offers.into_iter().enumerate().map(|(order, offer)| position.quoted(offer, start + order)));
    items
}

struct Position<'p> {
    workspace: &'p Workspace,
    pipelines: &'p Pipelines,
    name: &'p str,
    whole: &'p str,
    cursor: Cursor<'p>,
    at: usize,
}

/// An offer for each name.
fn offers(names: impl IntoIterator<Item = impl Into<String>>, kind: CompletionItemKind) -> Vec<Offer> {
    names.into_iter().map(|name| Offer::new(name, kind)).collect()
}

impl Position<'_> {
    /// Returns the item of a name that stands in quotes; numbers and words of values do not.
    fn quoted(&self, offer: Offer, order: usize) -> CompletionItem {
        let bare = offer.kind == CompletionItemKind::VALUE;
        let in_text = self.cursor.within == Within::Text;
        let text = match (in_text, bare) {
            (true, true) => offer.name.trim_matches('"').to_owned(),
            (true, false) | (false, true) => offer.name.clone(),
            (false, false) => format!("\"{}\"", offer.name),
        };
        let range = if in_text { self.cursor.content(self.whole) } else { self.cursor.token.clone() };
        let range = if in_text { self.tail(range) } else { range };
        offer.item(self.whole, range, text, order)
    }

    /// Of an expression, the part that is typed: from `$` or a space on.
    fn tail(&self, range: std::ops::Range<usize>) -> std::ops::Range<usize> {
        let typed = &self.whole[range.start..self.at.clamp(range.start, range.end)];
        match typed.rfind(['$', ' ', '(', ',']) {
            Some(from) if typed.contains('$') || typed.contains(' ') => {
                let from = range.start + from;
                let sign = usize::from(self.whole[from..].starts_with('$'));
                from + 1 - sign..self.at
            }
            _ => range,
        }
    }

    /// Returns the fields and forms that the grammar takes.
    fn forms(&self, sort: Option<Sort>) -> Vec<CompletionItem> {
        if self.cursor.within == Within::Text {
            return Vec::new();
        }
        let expected = match sort {
            Some(Sort::Pipeline) => frame_graph::description::expected(self.whole, self.at),
            Some(Sort::Study) => study::description::expected(self.whole, self.at),
            Some(Sort::Scene) => scene::expected(self.whole, self.at),
            // Other programs have files in RON, too.
            None if !self.cursor.frames.is_empty() => Expected::default(),
            None => {
                let forms = ["Pipeline(…)", "Scene(…)", "Study(…)"].map(str::to_owned).to_vec();
                Expected { forms, ..Expected::default() }
            }
        };
        let given: Vec<&str> = match self.cursor.frames.last() {
            Some(frame) => {
                let entries = data_file::grammar::entries(self.whole, frame.open);
                entries.into_iter().map(|(key, _)| key).collect()
            }
            None => Vec::new(),
        };
        let typed = self.cursor.prefix(self.whole, self.at);
        let range = self.cursor.token.clone();
        let fields = expected.fields.into_iter().filter(|field| !given.contains(field) || *field == typed);
        let colon = if self.whole[range.end..].trim_start().starts_with(':') { "" } else { ": " };
        let fields =
            fields.map(|field| (Offer::new(field, CompletionItemKind::FIELD), format!("{field}{colon}")));
        let forms = expected.forms.into_iter().map(|form| {
            let (word, bracket) = form.split_once('(').map_or((&*form, ""), |(word, _)| (word, "("));
            let bracket = if self.whole[range.end..].starts_with('(') { "" } else { bracket };
            let text = format!("{word}{bracket}");
            (Offer::new(word, CompletionItemKind::CONSTRUCTOR).detail(form.clone()), text)
        });
        let all = fields.chain(forms).enumerate();
        all.map(|(order, (offer, text))| offer.item(self.whole, range.clone(), text, order)).collect()
    }

    fn file(&self) -> Option<Arc<File>> {
        self.pipelines.file(self.workspace, self.name)
    }

    /// Returns the names that a file and those that it extends declare, each once.
    fn declared(&self, files: &[Arc<File>], kind: SymbolKind) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for file in files {
            // Of a file that is broken, what it said last.
            let last =
                || file.description.as_ref().map(|description| description.symbols()).unwrap_or_default();
            let symbols = if file.symbols.is_empty() { last() } else { file.symbols.clone() };
            let own = symbols.into_iter().filter(|symbol| symbol.declares && symbol.kind == kind);
            for symbol in own.filter(|symbol| symbol.scope.is_empty()) {
                if !names.contains(&symbol.name.to_string()) {
                    names.push(symbol.name.to_string());
                }
            }
        }
        names
    }

    /// Returns what the file is resolved to, or the nearest that it extends.
    fn resolved(&self, chain: &[Arc<File>]) -> Option<Arc<Resolved>> {
        chain.iter().find_map(|file| self.pipelines.resolved(self.workspace, file))
    }

    fn ports(&self, pass: &TypedPass<'_>) -> Option<Arc<Ports>> {
        let inputs: Vec<String> = pass.inputs.iter().map(|input| (*input).to_owned()).collect();
        let outputs = BTreeMap::new();
        let use_ = Use { kind: pass.kind, shader: pass.shader, inputs: &inputs, outputs: &outputs };
        let settings = self.workspace.catalog.settings(use_).unwrap_or_default();
        self.workspace.catalog.ports(use_, &Settings::defaults(&settings)).ok()
    }

    fn settings(&self, pass: &TypedPass<'_>) -> Vec<Setting> {
        let outputs = BTreeMap::new();
        let use_ = Use { kind: pass.kind, shader: pass.shader, inputs: &[], outputs: &outputs };
        self.workspace.catalog.settings(use_).map(|settings| settings.to_vec()).unwrap_or_default()
    }

    fn of_pipeline(&self) -> Vec<Offer> {
        let Some(wanted) = wanted(&self.cursor, self.whole) else { return Vec::new() };
        let Some(file) = self.file() else { return Vec::new() };
        let chain = self.pipelines.chain(self.workspace, &file);
        let catalog = &self.workspace.catalog;
        let pass = typed_pass(&self.cursor, self.whole).unwrap_or_default();
        let part = || {
            let path = pass.file?;
            self.pipelines.named(self.workspace, path, &file)
        };
        match wanted {
            Wanted::Pass => self.passes(&chain),
            Wanted::Link | Wanted::LinkEnd => self.links(&chain, &file, &pass, wanted),
            Wanted::Path => self.paths(self.resolved(&chain).as_deref()),
            Wanted::PassType => {
                let kinds = self.fitting(&chain, &pass);
                let offer = |kind: String| {
                    let about = wgsl::declared_by(self.workspace, &kind, |_, about| about.to_owned());
                    Offer::new(kind, CompletionItemKind::CLASS).doc(about)
                };
                kinds.into_iter().map(offer).collect()
            }
            Wanted::InputPort => match part() {
                Some(part) => {
                    let files = self.pipelines.chain(self.workspace, &part);
                    offers(self.declared(&files, SymbolKind::Input), CompletionItemKind::FIELD)
                }
                None => {
                    let ports = self.ports(&pass);
                    let inputs = ports.iter().flat_map(|ports| &ports.inputs);
                    let own = self.cursor.token.clone();
                    let typed = data_file::grammar::unquoted(&self.whole[own]);
                    let free =
                        inputs.filter(|port| port.name == typed || !pass.inputs.contains(&&*port.name));
                    free.map(|port| {
                        let optional = if port.optional { ", optional" } else { "" };
                        Offer::new(&*port.name, CompletionItemKind::FIELD)
                            .detail(format!("{}{optional}", port.interface))
                            .doc(&*port.doc)
                    })
                    .collect()
                }
            },
            Wanted::OutputPort => {
                let ports = self.ports(&pass);
                let outputs = ports.iter().flat_map(|ports| &ports.outputs);
                let offer = |port: &frame_graph::OutputPort| {
                    Offer::new(&*port.name, CompletionItemKind::FIELD)
                        .detail(&*port.interface)
                        .doc(&*port.doc)
                };
                outputs.map(offer).collect()
            }
            Wanted::Setting => match part() {
                Some(part) => {
                    let resolved = self.pipelines.resolved(self.workspace, &part);
                    self.paths(resolved.as_deref())
                        .into_iter()
                        .filter(|path| !path.name.contains('.'))
                        .collect()
                }
                None => {
                    let typed = data_file::grammar::unquoted(&self.whole[self.cursor.token.clone()]);
                    let settings = self.settings(&pass).into_iter();
                    let free = settings.filter(|s| s.name == typed || !pass.settings.contains(&&*s.name));
                    free.map(|setting| offer_setting(&setting.name, &setting)).collect()
                }
            },
            Wanted::Value => self.values(&chain, &pass, part()),
            Wanted::Parameter => {
                let names = self.declared(&chain, SymbolKind::Parameter);
                let mut found =
                    offers(names.iter().map(|name| format!("${name}")), CompletionItemKind::VARIABLE);
                if self.cursor.frame(0).is_some_and(|frame| frame.key == Some("when")) {
                    let traits = pass::scene_bindings::TRAITS.iter().map(|name| format!("scene.{name}"));
                    found.extend(offers(traits, CompletionItemKind::VARIABLE));
                }
                found
            }
            Wanted::InheritedParameter => {
                let names = self.declared(chain.get(1..).unwrap_or_default(), SymbolKind::Parameter);
                let resolved = self.resolved(chain.get(1..).unwrap_or_default());
                let settable = resolved.map(|resolved| resolved.settable(&**catalog)).unwrap_or_default();
                let offer = |name: String| match settable.iter().find(|settable| settable.path == name) {
                    Some(settable) => offer_setting(&name, &settable.setting),
                    None => Offer::new(name, CompletionItemKind::VARIABLE),
                };
                names.into_iter().map(offer).collect()
            }
            Wanted::InheritedOutput => {
                let names = self.declared(chain.get(1..).unwrap_or_default(), SymbolKind::Output);
                offers(names, CompletionItemKind::FIELD)
            }
            Wanted::Interface => {
                let all = catalog.interfaces().iter();
                all.map(|known| Offer::new(known.name, CompletionItemKind::INTERFACE).doc(known.doc))
                    .collect()
            }
            Wanted::Format => {
                offers(Format::ALL.iter().map(|format| format.name()), CompletionItemKind::ENUM_MEMBER)
            }
            Wanted::File => self.files("ron"),
            Wanted::Shader => self.files("wgsl"),
        }
    }

    fn passes(&self, chain: &[Arc<File>]) -> Vec<Offer> {
        let Some(file) = chain.first() else { return Vec::new() };
        let offer = |name: String| {
            let kind = self.pipelines.pass_type(self.workspace, file, &name).map(|(kind, _)| kind);
            Offer::new(name, CompletionItemKind::CLASS).detail(kind.unwrap_or_else(|| "sub-graph".to_owned()))
        };
        self.declared(chain, SymbolKind::Pass).into_iter().map(offer).collect()
    }

    /// Returns links to what an input takes; all where that is not known.
    fn links(
        &self,
        chain: &[Arc<File>],
        file: &Arc<File>,
        pass: &TypedPass<'_>,
        wanted: Wanted,
    ) -> Vec<Offer> {
        let resolved = self.resolved(chain);
        let catalog = &*self.workspace.catalog;
        let frame = self.cursor.frame(0);
        let is_input = self.cursor.frame(1).is_some_and(|outer| outer.key == Some("in"));
        let port = frame.and_then(|frame| frame.key).filter(|_| is_input);
        let interface = port.and_then(|port| {
            let ports = self.ports(pass)?;
            Some(ports.inputs.iter().find(|input| input.name == port)?.interface.clone())
        });
        let takes = interface.filter(|name| !["Any", "Texture", "Buffer"].contains(&&**name));
        let fits =
            |interface: &str| takes.as_ref().is_none_or(|takes| interface.is_empty() || takes == interface);
        let mut found = Vec::new();
        for name in self.declared(chain, SymbolKind::Pass) {
            let outputs =
                resolved.as_ref().map(|resolved| resolved.outputs_of(catalog, &name)).unwrap_or_default();
            let (fitting, rest): (Vec<_>, Vec<_>) =
                outputs.iter().partition(|(_, interface)| fits(interface));
            if wanted == Wanted::LinkEnd {
                let ports = resolved.as_ref().and_then(|resolved| resolved.ports(catalog, &name));
                let inputs = ports.iter().flat_map(|ports| &ports.inputs);
                found.extend(inputs.map(|input| {
                    Offer::new(format!("{name}.{}", input.name), CompletionItemKind::FIELD)
                        .detail(&*input.interface)
                }));
                continue;
            }
            if fitting.is_empty() && !rest.is_empty() {
                continue;
            }
            let detail: Vec<&str> = fitting.iter().map(|(_, interface)| interface.as_str()).collect();
            found.push(Offer::new(&*name, CompletionItemKind::CLASS).detail(detail.join(", ")));
            found.extend(fitting.iter().filter(|_| outputs.len() > 1).map(|(port, interface)| {
                Offer::new(format!("{name}.{port}"), CompletionItemKind::FIELD).detail(interface.as_str())
            }));
        }
        let of_file =
            if wanted == Wanted::LinkEnd { ("out", SymbolKind::Output) } else { ("in", SymbolKind::Input) };
        let names = self.declared(&self.pipelines.chain(self.workspace, file), of_file.1);
        found.extend(offers(
            names.iter().map(|name| format!("{}.{name}", of_file.0)),
            CompletionItemKind::FIELD,
        ));
        found
    }

    fn paths(&self, resolved: Option<&Resolved>) -> Vec<Offer> {
        let settable =
            resolved.map(|resolved| resolved.settable(&*self.workspace.catalog)).unwrap_or_default();
        settable.iter().map(|settable| offer_setting(&settable.path, &settable.setting)).collect()
    }

    /// Returns the pass types whose outputs have all interfaces that are read of what a pass replaces.
    fn fitting(&self, chain: &[Arc<File>], pass: &TypedPass<'_>) -> Vec<String> {
        let catalog = &*self.workspace.catalog;
        let names = catalog.names();
        let replaces = self.cursor.frames.iter().any(|frame| frame.name == Some("Replace"));
        let resolved = self.resolved(chain);
        let read = match (&resolved, pass.from) {
            (Some(resolved), Some(from)) => resolved.interface_of_link(catalog, from).into_iter().collect(),
            (Some(resolved), None) if replaces => resolved.interfaces_read(catalog, pass.name),
            _ => Vec::new(),
        };
        let fits = |kind: &String| {
            if catalog.takes_shader(kind) == Some(true) {
                return true;
            }
            let has =
                |ports: &[DeclaredPort], wanted: &String| ports.iter().any(|port| port.interface == *wanted);
            wgsl::declared_by(self.workspace, kind, |declared, _| {
                let takes = |wanted: &String| pass.from.is_none() || has(&declared.inputs, wanted);
                read.iter().all(|wanted| has(&declared.outputs, wanted) && takes(wanted))
            })
        };
        names.into_iter().filter(fits).collect()
    }

    /// Returns the values of the setting that a position is the value of.
    fn values(&self, chain: &[Arc<File>], pass: &TypedPass<'_>, part: Option<Arc<File>>) -> Vec<Offer> {
        let frame = self.cursor.frame(0);
        let path =
            frame.filter(|frame| frame.name == Some("Set")).and_then(|frame| first(self.whole, frame.open));
        let key = frame.and_then(|frame| frame.key);
        let of = |resolved: Option<Arc<Resolved>>, path: &str| {
            let settable = resolved?.settable(&*self.workspace.catalog);
            settable.into_iter().find(|settable| settable.path == path).map(|settable| settable.setting)
        };
        let setting = match (path, part) {
            (Some(path), _) => of(self.resolved(chain), path),
            (None, Some(part)) => key.and_then(|key| of(self.pipelines.resolved(self.workspace, &part), key)),
            (None, None) => self.settings(pass).into_iter().find(|setting| Some(&*setting.name) == key),
        };
        let mut found: Vec<Offer> = Vec::new();
        if let Some(setting) = setting {
            let mut values: Vec<String> = setting.one_of.iter().map(ToString::to_string).collect();
            if setting.ty == data_file::ValueType::Bool {
                values = vec!["false".to_owned(), "true".to_owned()];
            }
            let in_text = self.cursor.within == Within::Text;
            values.retain(|value| !in_text || value.starts_with('"'));
            if values.is_empty() && !in_text {
                values.push(setting.default.to_string());
            }
            let detail = takes(&setting);
            found.extend(values.into_iter().map(|value| {
                Offer::new(value, CompletionItemKind::VALUE).detail(&*detail).doc(&*setting.doc)
            }));
        }
        let names = self.declared(chain, SymbolKind::Parameter);
        found.extend(offers(names.iter().map(|name| format!("${name}")), CompletionItemKind::VARIABLE));
        found
    }

    /// Returns the files of a sort, as this file names them.
    fn files(&self, extension: &str) -> Vec<Offer> {
        let folder = self.name.rsplit_once('/').map_or("", |(folder, _)| folder);
        let names = self.workspace.names(extension).into_iter().filter(|name| *name != self.name);
        let offer = |name: String| {
            let own = name
                .strip_prefix(folder)
                .and_then(|rest| rest.strip_prefix('/'))
                .filter(|_| !folder.is_empty());
            let of_root = name.strip_prefix("pipelines/").filter(|_| extension == "ron");
            let shown = own.or(of_root).unwrap_or(&name).to_owned();
            Offer::new(shown, CompletionItemKind::FILE)
        };
        let is_pipeline =
            |name: &String| !["scenes/", "studies/"].iter().any(|folder| name.starts_with(folder));
        names.filter(|name| extension != "ron" || is_pipeline(name)).map(offer).collect()
    }

    /// Returns the names of a folder of the tree without their ending.
    fn listed(&self, folder: &str) -> Vec<Offer> {
        let names = self.workspace.assets().list(folder, "ron").into_iter();
        let stem = |path: String| path[folder.len() + 1..].trim_end_matches(".ron").to_owned();
        offers(names.map(stem).filter(|name| !name.starts_with("parts/")), CompletionItemKind::FILE)
    }

    fn of_study(&self) -> Vec<Offer> {
        let Some(frame) = self.cursor.frame(0) else { return Vec::new() };
        let outer = self.cursor.frame(1);
        let key = frame.key.or(outer.and_then(|outer| outer.key)).unwrap_or_default();
        let in_grid = outer.is_some_and(|outer| matches!(outer.name, Some("Grid" | "Paired" | "At")));
        if in_grid || key == "set" {
            return if self.cursor.at_key(self.whole) { self.paths_of_study() } else { Vec::new() };
        }
        match key {
            "scenes" => self.listed("scenes"),
            "pipelines" | "pipeline" | "except" => self.listed("pipelines"),
            "measures" | "measure" => study::Measure::all()
                .map(|measure| {
                    let info = measure.info();
                    Offer::new(info.key, CompletionItemKind::ENUM_MEMBER).detail(info.unit).doc(info.doc)
                })
                .collect(),
            "by" => self.paths_of_study(),
            _ => Vec::new(),
        }
    }

    /// Returns the paths of the first pipeline that the study names.
    fn paths_of_study(&self) -> Vec<Offer> {
        let root = self.cursor.frames.first().map_or(0, |frame| frame.open);
        let fields = data_file::grammar::entries(self.whole, root);
        let pipelines = fields.iter().find(|(key, _)| *key == "pipelines").map(|(_, value)| *value);
        let named = pipelines.and_then(|list| list.split('"').nth(1)).unwrap_or("ism");
        let resolved = named_pipeline(self.workspace, self.name, named)
            .and_then(|name| self.pipelines.file(self.workspace, &name))
            .and_then(|file| self.pipelines.resolved(self.workspace, &file));
        self.paths(resolved.as_deref())
    }

    fn of_scene(&self) -> Vec<Offer> {
        let Some(frame) = self.cursor.frame(0) else { return Vec::new() };
        match (frame.name, frame.index) {
            (Some("BuiltIn"), 0) => offers(scene::built_in_names(), CompletionItemKind::ENUM_MEMBER),
            (Some("File"), 0) => {
                let folder = self.workspace.path(self.name).and_then(|path| Some(path.parent()?.to_owned()));
                let files =
                    folder.and_then(|folder| std::fs::read_dir(folder).ok()).into_iter().flatten().flatten();
                let names = files.filter_map(|file| file.file_name().into_string().ok());
                let of_environment =
                    self.cursor.frame(1).is_some_and(|around| around.name == Some("Environment"));
                let fits = |name: &String| match of_environment {
                    true => scene::Environment::may_be(Path::new(name)),
                    false => scene::is_geometry(name),
                };
                offers(names.filter(fits), CompletionItemKind::FILE)
            }
            _ => Vec::new(),
        }
    }
}

fn offer_setting(name: &str, setting: &Setting) -> Offer {
    Offer::new(name, CompletionItemKind::PROPERTY).detail(takes(setting)).doc(&*setting.doc)
}

/// Returns the name of the pipeline file that a study means.
pub(crate) fn named_pipeline(workspace: &Workspace, by: &str, named: &str) -> Option<String> {
    let with_ending = if named.ends_with(".ron") { named.to_owned() } else { format!("{named}.ron") };
    let files = workspace.catalog.pipelines();
    Some(frame_graph::resolve::named(&with_ending, by, files)?.name.clone())
}
