//! The names of pipelines in studies: paths that are set or varied, and passes of phases.

use crate::completion::named_pipeline;
use crate::pipelines::{Entity, File, Mention, Pipelines};
use crate::workspace::Workspace;
use data_file::grammar::{Cursor, Within, entries};
use data_file::{Name, Place, Source, Span};
use frame_graph::description::{Symbol, SymbolKind};
use std::ops::Range;
use std::sync::Arc;

/// Returns the texts in quotes of a file, with their bytes.
fn quoted(text: &str) -> impl Iterator<Item = Range<usize>> {
    let mut marks = text.match_indices('"').map(|(at, _)| at);
    std::iter::from_fn(move || Some(marks.next()? + 1..marks.next()?))
}

/// Returns the symbols of a path, `parameter` or `pass.setting`, or of a pass, at a byte of a study.
fn symbols(text: &str, bytes: Range<usize>) -> Vec<Symbol> {
    let cursor = Cursor::new(text, bytes.start);
    let (Some(frame), Within::Text) = (cursor.frame(0), cursor.within) else { return Vec::new() };
    let outer = cursor.frame(1);
    let key = |up: usize| cursor.frame(up).and_then(|frame| frame.key);
    let is_path = frame.key == Some("by")
        || (cursor.at_key(text)
            && (key(1) == Some("set")
                || outer.is_some_and(|outer| matches!(outer.name, Some("Grid" | "Paired" | "At")))));
    let is_pass = key(2) == Some("phases");
    let is_figure = key(1) == Some("figures") && !cursor.at_key(text);
    let word = &text[bytes.clone()];
    let symbol = |kind, name: &str, at: usize, of: &str| {
        let start = (bytes.start + at) as u32;
        Symbol {
            kind,
            name: Name::from(name),
            of: Name::from(of),
            scope: Name::default(),
            place: Place { file: 0, start, end: start + name.len() as u32 },
            declares: false,
        }
    };
    match word.rsplit_once('.') {
        _ if is_pass => vec![symbol(SymbolKind::Pass, word, 0, "")],
        _ if is_figure => {
            let pass = word.split('.').next().unwrap_or_default();
            vec![symbol(SymbolKind::Pass, pass, 0, "")]
        }
        Some((pass, setting)) if is_path => vec![
            symbol(SymbolKind::Pass, pass, 0, ""),
            symbol(SymbolKind::Setting, setting, pass.len() + 1, pass),
        ],
        None if is_path => vec![symbol(SymbolKind::Parameter, word, 0, "")],
        _ => Vec::new(),
    }
}

/// The pipelines that a study names.
struct Study<'s> {
    workspace: &'s Workspace,
    pipelines: &'s Pipelines,
    source: &'s Arc<Source>,
    files: Vec<Arc<File>>,
}

impl<'s> Study<'s> {
    fn new(workspace: &'s Workspace, pipelines: &'s Pipelines, source: &'s Arc<Source>) -> Study<'s> {
        let text = &*source.text;
        // Behind the comment with which the file begins.
        let form = text.find("\nStudy").unwrap_or(0);
        let open = text[form..].find('(').map_or(text.len(), |open| form + open);
        let fields = entries(text, open);
        let list = fields.iter().find(|(field, _)| *field == "pipelines").map_or("", |(_, value)| *value);
        let named = quoted(list).filter_map(|bytes| named_pipeline(workspace, &source.name, &list[bytes]));
        let files = named.filter_map(|name| pipelines.file(workspace, &name)).collect();
        Study { workspace, pipelines, source, files }
    }

    /// Returns what a text in quotes names, in any of the pipelines.
    fn mentions(&self, bytes: Range<usize>) -> Vec<Mention> {
        let symbols = symbols(&self.source.text, bytes).into_iter();
        let mentions = symbols.flat_map(|symbol| {
            let of = |file| self.pipelines.mentions(self.workspace, file, &symbol);
            self.files.iter().flat_map(of).collect::<Vec<_>>()
        });
        let here = |mention: Mention| {
            let span = Span { source: Arc::clone(self.source), ..mention.span };
            Mention { span, ..mention }
        };
        mentions.map(here).collect()
    }
}

/// Returns where a study names what is named.
pub(crate) fn uses(
    workspace: &Workspace,
    pipelines: &Pipelines,
    source: &Arc<Source>,
    entity: &Entity,
) -> Vec<Mention> {
    let has = |bytes: &Range<usize>| source.text[bytes.clone()].contains(&*entity.name);
    let words: Vec<Range<usize>> = quoted(&source.text).filter(has).collect();
    if words.is_empty() {
        return Vec::new();
    }
    let study = Study::new(workspace, pipelines, source);
    // Several pipelines may have it from one file.
    let first = |bytes| study.mentions(bytes).into_iter().find(|mention| mention.entity == *entity);
    words.into_iter().filter_map(first).collect()
}

/// Returns what the name at a byte of a study names in the first pipeline that has it.
pub(crate) fn mention_at(
    workspace: &Workspace,
    pipelines: &Pipelines,
    source: &Arc<Source>,
    at: usize,
) -> Option<Mention> {
    let bytes = quoted(&source.text).find(|bytes| (bytes.start..=bytes.end).contains(&at))?;
    let mentions = Study::new(workspace, pipelines, source).mentions(bytes);
    mentions.into_iter().find(|mention| (mention.span.start..=mention.span.end).contains(&(at as u32)))
}
