//! Attributes in the doc comments of entry points and globals:
//!
//! ```wgsl
//! /// Sums along rows. [scratch]
//! var<storage, read_write> sums: array<f32>;
//!
//! /// Adds them up. [threads: elements(sums), repeat: rounds]
//! @compute @workgroup_size(64) fn add_up() { … }
//! ```

use crate::codes;
use crate::composed::Composed;
use crate::doc_reader::{Problem, Reader};
use crate::interface::ShaderInterface;
use crate::scan::{FoundDeclaration, find_documented};
use data_file::{Diagnostic, Diagnostics, nearest};
use std::ops::Range;

/// What the doc comments of a shader say in brackets of its entry points and globals.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attributes {
    /// The entry points that have attributes, in the order of the text.
    pub entries: Vec<EntryAttributes>,
    /// The globals that have attributes, in the order of the text.
    pub globals: Vec<GlobalAttributes>,
}

/// What is said of an entry point.
#[derive(Clone, Debug, PartialEq)]
pub struct EntryAttributes {
    /// The function's name.
    pub name: String,
    /// `[threads: …]`: how many threads it is run with.
    pub threads: Option<ThreadCount>,
    /// `[repeat: …]`: how often it is run.
    pub repeat: Option<Amount>,
    /// `[items: …]`: the number of items over which each of its threads loops.
    pub items: Option<Amount>,
    /// `[iterations: …]`: the loop iterations of an item.
    pub iterations: Option<Amount>,
    /// `[scratch]`: its results are seen by no other pass.
    pub scratch: bool,
    /// `[sampled]`: it takes another sample of the picture in each frame.
    pub sampled: bool,
    /// Where the bracket stands in the composed text; see [`Shader::place`](crate::Shader::place).
    pub place: Range<u32>,
}

/// What is said of a global.
#[derive(Clone, Debug, PartialEq)]
pub struct GlobalAttributes {
    /// The variable's name.
    pub name: String,
    /// `[scratch]`: it is shared by the entry points and seen by no other pass.
    pub scratch: bool,
    /// `[count: …]`: how many elements a scratch buffer has.
    pub count: Option<Amount>,
    /// `[size: …]`: the size of a scratch texture, as a directive says it.
    pub size: Option<Amount>,
    /// `[cleared]`: it is cleared to zero before the pass runs.
    pub cleared: bool,
    /// `[reads: …]`: the written global whose content it is.
    pub reads: Option<String>,
    /// Where the bracket stands in the composed text; see [`Shader::place`](crate::Shader::place).
    pub place: Range<u32>,
}

/// How many threads an entry point is run with.
#[derive(Clone, Debug, PartialEq)]
pub enum ThreadCount {
    /// `texels(NAME)`: one for each texel of a texture, and of each of its layers.
    Texels(String),
    /// `elements(NAME)`: one for each element of a buffer, in a row.
    Elements(String),
    /// `64`: a number in a row.
    Row(Amount),
    /// `(8, 8, 1)`: a number in each dimension.
    Grid([Amount; 3]),
}

/// The text of an expression over settings, facts and sizes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Amount(pub String);

/// The words of attributes.
pub const KEYS: [&str; 10] =
    ["threads", "repeat", "items", "iterations", "scratch", "sampled", "reads", "count", "size", "cleared"];
/// The keys that stand without a value.
const WORDS: [&str; 3] = ["scratch", "sampled", "cleared"];

/// What stands in the brackets of one declaration.
#[derive(Default)]
struct Said {
    threads: Option<ThreadCount>,
    repeat: Option<Amount>,
    items: Option<Amount>,
    iterations: Option<Amount>,
    scratch: bool,
    sampled: bool,
    reads: Option<String>,
    count: Option<Amount>,
    size: Option<Amount>,
    cleared: bool,
    range: Range<usize>,
}

/// Reads the attributes of the entry points and globals of a composed text.
pub(crate) fn read(composed: &Composed, interface: &ShaderInterface) -> Result<Attributes, Diagnostics> {
    let mut attributes = Attributes::default();
    let mut errors: Vec<Diagnostic> = Vec::new();
    for found in find_documented(&composed.text) {
        let entry = interface.entry(&found.name).is_some();
        if !entry && interface.global(&found.name).is_none() {
            continue;
        }
        let said = declaration(&found).and_then(|said| match said {
            Some(Said { threads, repeat, items, iterations, sampled, .. })
                if !entry
                    && (threads.is_some()
                        || sampled
                        || [&repeat, &items, &iterations].iter().any(|said| said.is_some())) =>
            {
                let message = "`threads`, `repeat`, `items`, `iterations` and `sampled` are of entry points";
                Err(Problem::new(0..0, message))
            }
            Some(Said { reads, count, size, cleared, .. })
                if entry && (reads.is_some() || count.is_some() || size.is_some() || cleared) =>
            {
                Err(Problem::new(0..0, "`reads`, `count`, `size` and `cleared` are of globals"))
            }
            said => Ok(said),
        });
        match said {
            Ok(None) => {}
            Ok(Some(Said { threads, repeat, items, iterations, scratch, sampled, range, .. })) if entry => {
                let place = found.doc.place(range);
                attributes.entries.push(EntryAttributes {
                    name: found.name,
                    threads,
                    repeat,
                    items,
                    iterations,
                    scratch,
                    sampled,
                    place,
                });
            }
            Ok(Some(Said { scratch, reads, count, size, cleared, range, .. })) => {
                let place = found.doc.place(range);
                let name = found.name;
                let global = GlobalAttributes { name, scratch, count, size, cleared, reads, place };
                attributes.globals.push(global);
            }
            Err(problem) => {
                let whole = 0..found.doc.text.len();
                let place = found.doc.place(if problem.range.is_empty() { whole } else { problem.range });
                errors.push(composed.diagnostic(
                    &codes::ATTRIBUTE,
                    format!("the attributes of `{}`: {}", found.name, problem.message),
                    [(place, String::new())],
                    problem.note,
                ));
            }
        }
    }
    if errors.is_empty() { Ok(attributes) } else { Err(Diagnostics(errors)) }
}

/// Whether a bracket is an attribute and not prose such as `[px]`: it begins with a key, or with what is nearly one
/// and stands as that key would, with a colon or without.
fn attributes_begin(inside: &str) -> bool {
    let inside = inside.trim_start();
    let len = inside.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(inside.len());
    let (word, rest) = inside.split_at(len);
    let rest = rest.trim_start();
    let ends: &[char] =
        if matches!(word, "count" | "size" | "items" | "iterations") { &[':'] } else { &[':', ',', ']'] };
    let known = KEYS.contains(&word) && rest.starts_with(ends);
    let misspelt = match rest.chars().next() {
        Some(':') => nearest(word, KEYS),
        Some(',' | ']') if !KEYS.contains(&word) => nearest(word, WORDS),
        _ => None,
    };
    known || misspelt.is_some()
}

fn declaration(found: &FoundDeclaration) -> Result<Option<Said>, Problem> {
    let text = &found.doc.text;
    let starts = text.match_indices('[').map(|(at, _)| at).filter(|at| attributes_begin(&text[at + 1..]));
    let mut said: Option<Said> = None;
    for start in starts {
        if said.is_some() {
            return Err(Problem::new(start..start + 1, "there are two brackets of attributes"));
        }
        let mut reader = Reader::new(text, start + 1);
        let mut read = fields(&mut reader)?;
        read.range = start..reader.at;
        said = Some(read);
    }
    Ok(said)
}

/// `key: value, …]`
fn fields(reader: &mut Reader<'_>) -> Result<Said, Problem> {
    let mut said = Said::default();
    loop {
        let (key, range) = reader.word();
        let colon = |reader: &mut Reader<'_>| match reader.accept(':') {
            true => Ok(()),
            false => Err(Problem::new(reader.here(), format!("expected `:` after `{key}`"))),
        };
        let twice = match key.as_str() {
            "scratch" => std::mem::replace(&mut said.scratch, true),
            "sampled" => std::mem::replace(&mut said.sampled, true),
            "cleared" => std::mem::replace(&mut said.cleared, true),
            "count" | "size" | "repeat" | "items" | "iterations" => {
                colon(reader)?;
                let slot = match key.as_str() {
                    "count" => &mut said.count,
                    "size" => &mut said.size,
                    "repeat" => &mut said.repeat,
                    "items" => &mut said.items,
                    _ => &mut said.iterations,
                };
                slot.replace(amount(reader)?).is_some()
            }
            "threads" => {
                colon(reader)?;
                said.threads.replace(threads(reader)?).is_some()
            }
            "reads" => {
                colon(reader)?;
                said.reads.replace(name(reader, "the name of a global that is written")?).is_some()
            }
            other => {
                let problem = Problem::new(range, format!("there is no `{other}`"));
                return Err(match nearest(other, KEYS) {
                    Some(near) => problem.note(format!("did you mean `{near}`?")),
                    None => problem.note(format!("there are {}", KEYS.join(", "))),
                });
            }
        };
        if twice {
            return Err(Problem::new(range, format!("`{key}` is given twice")));
        }
        if reader.accept(']') {
            return Ok(said);
        }
        if !reader.accept(',') {
            return Err(Problem::new(reader.here(), "expected `,` or `]`"));
        }
    }
}

/// `texels(NAME)`, `elements(NAME)`, `64` or `(8, 8, 1)`
fn threads(reader: &mut Reader<'_>) -> Result<ThreadCount, Problem> {
    let start = reader.at;
    if reader.accept('(') && is_list(reader) {
        let mut sides = [const { Amount(String::new()) }; 3];
        for (i, side) in sides.iter_mut().enumerate() {
            *side = amount(reader)?;
            let end = if i == 2 { ')' } else { ',' };
            if !reader.accept(end) {
                let message = format!("expected `{end}`, as in `(8, 8, 1)`");
                return Err(Problem::new(reader.here(), message));
            }
        }
        return Ok(ThreadCount::Grid(sides));
    }
    reader.at = start;
    let (word, range) = reader.word();
    let of: fn(String) -> ThreadCount = match word.as_str() {
        "texels" => ThreadCount::Texels,
        "elements" => ThreadCount::Elements,
        other => {
            if !matches!(other, "" | "min" | "max") && reader.accept('(') {
                let problem = Problem::new(range, format!("there is no `{other}(…)`"));
                return Err(problem.note("there are `texels(NAME)` and `elements(NAME)`"));
            }
            reader.at = start;
            return amount(reader).map(ThreadCount::Row);
        }
    };
    if !reader.accept('(') {
        return Err(Problem::new(reader.here(), format!("expected `(`, as in `{word}(NAME)`")));
    }
    let of = of(name(reader, "the name of an input, an output or a scratch resource")?);
    if !reader.accept(')') {
        return Err(Problem::new(reader.here(), "expected `)`"));
    }
    Ok(of)
}

fn name(reader: &mut Reader<'_>, expected: &str) -> Result<String, Problem> {
    let (word, range) = reader.word();
    if word.is_empty() {
        return Err(Problem::new(reader.here(), format!("expected {expected}")));
    }
    let is_name = word.chars().all(|c| c.is_alphanumeric() || c == '_');
    if is_name { Ok(word) } else { Err(Problem::new(range, format!("expected {expected}"))) }
}

/// Whether there is a comma before the parenthesis that has been opened is closed.
fn is_list(reader: &Reader<'_>) -> bool {
    let mut depth = 0;
    let ends = reader.text[reader.at..].chars().find(|c| {
        let found = depth == 0 && matches!(c, ',' | ')');
        depth += i32::from(*c == '(') - i32::from(*c == ')');
        found
    });
    ends == Some(',')
}

/// The text of an expression, up to a comma or a bracket that ends it.
fn amount(reader: &mut Reader<'_>) -> Result<Amount, Problem> {
    reader.skip();
    let (start, mut depth) = (reader.at, 0);
    let rest = &reader.text[start..];
    let end = rest.char_indices().find(|(_, c)| {
        let ends = depth == 0 && matches!(c, ',' | ')' | ']');
        depth += i32::from(*c == '(') - i32::from(*c == ')');
        ends
    });
    reader.at = end.map_or(reader.text.len(), |(i, _)| start + i);
    let text = reader.text[start..reader.at].trim();
    if text.is_empty() {
        return Err(Problem::new(reader.here(), "expected a whole number, or an expression that is one"));
    }
    Ok(Amount(text.to_owned()))
}
