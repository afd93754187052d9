//! The names of pipelines across files: what extends what, what a name names, where it is used.

use crate::workspace::Workspace;
use catalog::Sort;
use data_file::grammar::closed;
use data_file::{Files as _, Name, Source, Span};
use frame_graph::description::{Symbol, SymbolKind, parse_broken};
use frame_graph::resolve::{named, resolve_description};
use frame_graph::{Description, Overrides, Resolved};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Deepest chain of `extends`, and of sub-graphs, that is followed.
const MAX_CHAIN: usize = 17;

/// A pipeline file.
#[derive(Debug)]
pub(crate) struct File {
    pub(crate) source: Arc<Source>,
    /// What it says; where it cannot be read, what it says with its brackets closed, or what it said last.
    pub(crate) description: Option<Arc<Description>>,
    /// The names in its text.
    pub(crate) symbols: Vec<Symbol>,
}

impl File {
    pub(crate) fn span(&self, symbol: &Symbol) -> Span {
        Span { source: Arc::clone(&self.source), start: symbol.place.start, end: symbol.place.end }
    }

    /// Returns the name that a byte is in, or at the end of.
    pub(crate) fn symbol_at(&self, at: usize) -> Option<&Symbol> {
        let holds = |symbol: &&Symbol| (symbol.place.start..=symbol.place.end).contains(&(at as u32));
        self.symbols.iter().filter(holds).min_by_key(|symbol| symbol.place.end - symbol.place.start)
    }
}

/// What a name names: a parameter, a pass, an input or an output, by the file that declares it first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Entity {
    pub(crate) file: String,
    pub(crate) kind: SymbolKind,
    scope: Name,
    pub(crate) name: Name,
}

impl Entity {
    /// Returns whether it may have this name.
    pub(crate) fn takes_name(&self, name: &str) -> bool {
        let is_name = |part: &str| {
            !part.is_empty() && part.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '-')
        };
        let is_pass = self.kind == SymbolKind::Pass;
        if is_pass { name.split('/').all(is_name) && !matches!(name, "in" | "out") } else { is_name(name) }
    }

    /// Returns by what [`Pipelines::declaration`] finds it, or another of its kind that has this name.
    pub(crate) fn renamed<'n>(&'n self, name: &'n str) -> (SymbolKind, &'n str, &'n str) {
        (self.kind, &self.scope, name)
    }
}

/// A name at a place, and what it names.
#[derive(Clone, Debug)]
pub(crate) struct Mention {
    pub(crate) entity: Entity,
    pub(crate) span: Span,
    pub(crate) declares: bool,
}

/// The pass that a path leads to, in the file that declares it.
struct Step {
    file: Arc<File>,
    scope: Name,
    name: Name,
    /// Bytes of the path.
    at: (usize, usize),
}

/// Files by the file that names them and the path.
type Meant = BTreeMap<(String, String), Option<Arc<File>>>;

/// Pipeline files by name, read again where their text has changed.
#[derive(Default)]
pub(crate) struct Pipelines {
    files: RefCell<BTreeMap<String, Arc<File>>>,
    /// What each was resolved to last.
    resolved: RefCell<BTreeMap<String, Arc<Resolved>>>,
    /// What paths mean, by the file that holds them, while one question is answered.
    meant: RefCell<Meant>,
}

impl Pipelines {
    /// Begins a question: files may have changed since the one before.
    pub(crate) fn begin(&self) {
        self.meant.borrow_mut().clear();
    }

    /// Returns a file by the name of its source.
    pub(crate) fn file(&self, workspace: &Workspace, name: &str) -> Option<Arc<File>> {
        self.meant(("", name), || workspace.catalog.pipelines().at(name))
    }

    /// Returns what a path in a file means; it is looked for once in a question.
    fn meant(
        &self,
        (by, path): (&str, &str),
        find: impl FnOnce() -> Option<Arc<Source>>,
    ) -> Option<Arc<File>> {
        let key = (by.to_owned(), path.to_owned());
        if let Some(known) = self.meant.borrow().get(&key) {
            return known.clone();
        }
        let found = find().map(|source| self.read(source));
        self.meant.borrow_mut().insert(key, found.clone());
        found
    }

    fn read(&self, source: Arc<Source>) -> Arc<File> {
        let mut files = self.files.borrow_mut();
        let known = files.get(&source.name);
        if let Some(known) = known.filter(|known| known.source.text == source.text) {
            return Arc::clone(known);
        }
        let read = parse_broken(&source);
        let symbols = read.as_ref().map(Description::symbols).unwrap_or_default();
        let closed = || parse_broken(&Source::new(&*source.name, closed(&source.text))).map(Arc::new);
        let last = || known.and_then(|known| known.description.clone());
        let description = read.map(Arc::new).or_else(closed).or_else(last);
        let file = Arc::new(File { description, symbols, source: Arc::clone(&source) });
        files.insert(source.name.clone(), Arc::clone(&file));
        file
    }

    /// Forgets what files said before, of those that are closed.
    pub(crate) fn forget(&self, name: &str) {
        self.files.borrow_mut().remove(name);
        self.resolved.borrow_mut().remove(name);
    }

    /// Returns the file that another means by a path.
    pub(crate) fn named(&self, workspace: &Workspace, path: &str, by: &File) -> Option<Arc<File>> {
        let name = &by.source.name;
        self.meant((name, path), || named(path, name, workspace.catalog.pipelines()))
    }

    /// Returns a file and those that it extends, the base last.
    pub(crate) fn chain(&self, workspace: &Workspace, file: &Arc<File>) -> Vec<Arc<File>> {
        let mut chain = vec![Arc::clone(file)];
        while chain.len() < MAX_CHAIN {
            let last = &chain[chain.len() - 1];
            let base = last.description.as_ref().and_then(|description| description.extends());
            let Some(base) = base.and_then(|base| self.named(workspace, base, last)) else { break };
            if chain.iter().any(|known| known.source.name == base.source.name) {
                break;
            }
            chain.push(base);
        }
        chain
    }

    /// Returns what a file is resolved to; where it is broken, what it was last.
    pub(crate) fn resolved(&self, workspace: &Workspace, file: &File) -> Option<Arc<Resolved>> {
        let (name, files) = (&file.source.name, workspace.catalog.pipelines());
        let description = frame_graph::parse(Arc::clone(&file.source)).ok();
        let fresh = description.and_then(|description| {
            resolve_description(name, &description, files, &Overrides::default()).ok()
        });
        let mut resolved = self.resolved.borrow_mut();
        match fresh {
            Some(fresh) => resolved.entry(name.clone()).insert_entry(Arc::new(fresh)).get().clone().into(),
            None => resolved.get(name).cloned(),
        }
    }

    /// Returns the first declaration of a name, in a file or one that it extends.
    pub(crate) fn declaration(
        &self,
        workspace: &Workspace,
        file: &Arc<File>,
        (kind, scope, name): (SymbolKind, &str, &str),
    ) -> Option<(Arc<File>, Symbol)> {
        let is_it = |symbol: &&Symbol| {
            symbol.declares && symbol.kind == kind && symbol.name == name && symbol.scope == scope
        };
        self.chain(workspace, file).into_iter().rev().find_map(|file| {
            let symbol = file.symbols.iter().find(is_it).cloned()?;
            Some((file, symbol))
        })
    }

    /// Returns the file of a sub-graph of a file, by the name of its pass.
    pub(crate) fn part(&self, workspace: &Workspace, file: &Arc<File>, pass: &str) -> Option<Arc<File>> {
        for file in self.chain(workspace, file) {
            let Some(description) = &file.description else { continue };
            if let Some(path) = description.sub_file(pass) {
                return self.named(workspace, path, &file);
            }
            if description.pass_type(pass).is_some() {
                return None;
            }
        }
        None
    }

    /// Returns the pass type of a pass of a file, and its shader.
    pub(crate) fn pass_type(
        &self,
        workspace: &Workspace,
        file: &Arc<File>,
        pass: &str,
    ) -> Option<(String, Option<String>)> {
        let found = self.walk(workspace, file, "", pass).pop()?;
        let chain = self.chain(workspace, &found.file);
        // What a file that extends the declaring one says of it goes first.
        let own =
            if found.file.source.name == file.source.name { Vec::new() } else { self.chain(workspace, file) };
        let says = own.into_iter().chain(chain).filter_map(|file| file.description.clone());
        let mut says =
            says.filter(|says| says.pass_type(&found.name).is_some() || says.sub_file(&found.name).is_some());
        let says = says.next()?;
        let (kind, shader) = says.pass_type(&found.name)?;
        Some((kind.to_owned(), shader.map(str::to_owned)))
    }

    /// Returns the passes on a path, `sub-graph/pass`, seen from a file.
    fn walk(&self, workspace: &Workspace, file: &Arc<File>, scope: &str, path: &str) -> Vec<Step> {
        let (mut steps, mut file, mut scope, mut from) = (Vec::new(), Arc::clone(file), scope.to_owned(), 0);
        while steps.len() < MAX_CHAIN && from < path.len() {
            let ends = path[from..].match_indices('/').map(|(at, _)| from + at).chain([path.len()]);
            // A name may have slashes itself: the longest that there is is meant.
            let ends: Vec<usize> = ends.collect();
            let found = ends.into_iter().rev().find_map(|end| {
                let declared = (SymbolKind::Pass, &*scope, &path[from..end]);
                Some((end, self.declaration(workspace, &file, declared)?))
            });
            let Some((end, (declaring, symbol))) = found else { break };
            let name = symbol.name.clone();
            steps.push(Step { file: declaring, scope: symbol.scope, name: name.clone(), at: (from, end) });
            match self.part(workspace, &file, &name).filter(|_| scope.is_empty()) {
                Some(part) => (file, scope) = (part, String::new()),
                None if scope.is_empty() => scope = name.to_string(),
                None => scope = format!("{scope}/{name}"),
            }
            from = end + 1;
        }
        steps
    }

    /// Returns what a name of a file names; a path names a pass for each of its parts.
    pub(crate) fn mentions(&self, workspace: &Workspace, file: &Arc<File>, symbol: &Symbol) -> Vec<Mention> {
        let own = |file: &Arc<File>, kind, scope: &str| {
            let (declaring, found) = self.declaration(workspace, file, (kind, scope, &symbol.name))?;
            let entity = Entity {
                file: declaring.source.name.clone(),
                kind,
                scope: found.scope,
                name: symbol.name.clone(),
            };
            Some(entity)
        };
        let of_part = |kind| {
            let part = self.walk(workspace, file, &symbol.scope, &symbol.of).pop().and_then(|step| {
                // The file that extends the declaring one may say another.
                self.part(workspace, file, &step.name)
                    .or_else(|| self.part(workspace, &step.file, &step.name))
            });
            own(&part?, kind, "")
        };
        let entity = match symbol.kind {
            SymbolKind::Pass => {
                let steps = self.walk(workspace, file, &symbol.scope, &symbol.name);
                let start = symbol.place.start;
                return steps
                    .into_iter()
                    .map(|step| Mention {
                        entity: Entity {
                            file: step.file.source.name.clone(),
                            kind: SymbolKind::Pass,
                            scope: step.scope,
                            name: step.name,
                        },
                        span: Span {
                            source: Arc::clone(&file.source),
                            start: start + step.at.0 as u32,
                            end: start + step.at.1 as u32,
                        },
                        declares: symbol.declares,
                    })
                    .collect();
            }
            SymbolKind::Parameter => own(file, SymbolKind::Parameter, ""),
            SymbolKind::Input | SymbolKind::Output => own(file, symbol.kind, &symbol.scope),
            SymbolKind::InputPort => of_part(SymbolKind::Input),
            SymbolKind::OutputPort => of_part(SymbolKind::Output),
            SymbolKind::Setting => of_part(SymbolKind::Parameter),
            SymbolKind::PassType | SymbolKind::Interface | SymbolKind::File | SymbolKind::Shader => None,
        };
        let mention =
            entity.map(|entity| Mention { entity, span: file.span(symbol), declares: symbol.declares });
        mention.into_iter().collect()
    }

    /// Returns what the name at a byte of a file names.
    pub(crate) fn mention_at(&self, workspace: &Workspace, file: &Arc<File>, at: usize) -> Option<Mention> {
        let symbol = file.symbol_at(at)?;
        let mentions = self.mentions(workspace, file, symbol);
        mentions.into_iter().find(|mention| (mention.span.start..=mention.span.end).contains(&(at as u32)))
    }

    /// Returns every name of what is named, in all pipelines and studies there are.
    pub(crate) fn uses(&self, workspace: &Workspace, entity: &Entity) -> Vec<Mention> {
        let mut found = Vec::new();
        for name in workspace.all_ron().iter().filter(|name| !name.starts_with("scenes/")) {
            // Only what holds the name needs to be parsed.
            let source = workspace.catalog.pipelines().at(name);
            let Some(source) = source.filter(|source| source.text.contains(&*entity.name)) else { continue };
            let file = self.read(source);
            if Sort::of_text(&file.source.text) == Some(Sort::Study) {
                found.extend(crate::studies::uses(workspace, self, &file.source, entity));
                continue;
            }
            // The last part of a path, or of a name, is what it names.
            let may_be = |symbol: &&Symbol| symbol.name.ends_with(&*entity.name) || symbol.name.contains('/');
            let symbols = file.symbols.iter().filter(may_be);
            let mentions = symbols.flat_map(|symbol| self.mentions(workspace, &file, symbol));
            found.extend(mentions.filter(|mention| mention.entity == *entity));
        }
        found
    }
}
