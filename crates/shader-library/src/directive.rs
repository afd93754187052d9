//! The `#` lines of the dialect: their grammar, and the values of options.

use crate::codes;
use crate::exact::{self, DeclaredExact};
use crate::port::{self, DeclaredPort};
use data_file::{Code, Source, Value};
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// The value of an option, which selects a variant of a shader.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Define {
    /// `true` or `false`.
    Bool(bool),
    /// An integer.
    Int(i64),
    /// A word.
    Text(String),
}

impl Define {
    /// Returns the name of the type in errors.
    pub(crate) fn type_name(&self) -> &'static str {
        match self {
            Define::Bool(_) => "true or false",
            Define::Int(_) => "a whole number",
            Define::Text(_) => "a word",
        }
    }

    /// Returns the value of a setting or of a module's option.
    pub fn to_value(&self) -> Value {
        match self {
            Define::Bool(on) => Value::Bool(*on),
            Define::Int(n) if *n < 0 => Value::I32((*n).max(i32::MIN.into()) as i32),
            Define::Int(n) => Value::U32((*n).min(u32::MAX.into()) as u32),
            Define::Text(word) => Value::Text(word.clone()),
        }
    }

    pub(crate) fn same_type(&self, other: &Define) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
    }
}

impl fmt::Display for Define {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Define::Bool(b) => write!(f, "{b}"),
            Define::Int(n) => write!(f, "{n}"),
            Define::Text(t) => f.write_str(t),
        }
    }
}

impl From<bool> for Define {
    fn from(b: bool) -> Self {
        Define::Bool(b)
    }
}

impl From<u32> for Define {
    fn from(n: u32) -> Self {
        Define::Int(n.into())
    }
}

impl From<&str> for Define {
    fn from(text: &str) -> Self {
        Define::Text(text.to_owned())
    }
}

impl TryFrom<&Value> for Define {
    /// The value, which is of real numbers, and no option is.
    type Error = Value;

    fn try_from(value: &Value) -> Result<Self, Value> {
        match value {
            Value::Bool(b) => Ok(Define::Bool(*b)),
            Value::U32(n) => Ok(Define::Int((*n).into())),
            Value::I32(n) => Ok(Define::Int((*n).into())),
            Value::Text(t) => Ok(Define::Text(t.clone())),
            Value::F32(_) | Value::Vector(_) => Err(value.clone()),
        }
    }
}

/// An error at a range of the file being read.
#[derive(Debug)]
pub(crate) struct Fault {
    pub(crate) code: &'static Code,
    pub(crate) range: Range<usize>,
    pub(crate) message: String,
    /// The message at the place itself.
    pub(crate) label: String,
    pub(crate) notes: Vec<String>,
}

impl Fault {
    pub(crate) fn new(code: &'static Code, range: Range<usize>, message: impl Into<String>) -> Self {
        Fault { code, range, message: message.into(), label: String::new(), notes: Vec::new() }
    }

    pub(crate) fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    pub(crate) fn note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }
}

/// A thing with its place in the file.
#[derive(Clone, Debug)]
pub(crate) struct Placed<T> {
    pub(crate) value: T,
    pub(crate) range: Range<usize>,
}

/// The values of an option.
#[derive(Debug)]
pub(crate) struct OptionValues {
    pub(crate) default: Placed<Define>,
    /// All of them; empty where any will do.
    pub(crate) one_of: Vec<Placed<Define>>,
    /// That which `auto` means where the scene has a trait, and the trait.
    pub(crate) auto: Option<(Placed<Define>, String)>,
}

/// A `#` line.
#[derive(Debug)]
pub(crate) enum Directive {
    Import(Placed<String>),
    Interface(Placed<String>),
    Option {
        name: Placed<String>,
        values: OptionValues,
        internal: bool,
        doc: String,
    },
    Port {
        input: bool,
        port: DeclaredPort,
        /// Where its name stands.
        name: Range<usize>,
    },
    Lights,
    Exact(Placed<DeclaredExact>),
    If(Condition),
    Elif(Condition),
    Else,
    Endif,
}

/// The condition behind `#if`.
#[derive(Debug)]
pub(crate) enum Condition {
    /// The option is true.
    Is(Placed<String>),
    /// The option has, or has not, the value.
    Compare {
        name: Placed<String>,
        equal: bool,
        value: Placed<Define>,
    },
    Not(Box<Condition>),
    All(Vec<Condition>),
    Any(Vec<Condition>),
}

/// The value of an option that a condition names, given what it is compared with.
pub(crate) type OptionValue<'a> =
    dyn FnMut(&Placed<String>, Option<&Placed<Define>>) -> Result<Define, Fault> + 'a;

impl Condition {
    /// Whether it holds. Every part of `&&` and `||` is looked at, so that an error in any is found in
    /// every variant.
    pub(crate) fn holds(&self, option: &mut OptionValue<'_>) -> Result<bool, Fault> {
        Ok(match self {
            Condition::Is(name) => match option(name, None)? {
                Define::Bool(b) => b,
                other => {
                    let message = format!("`{}` is {}, not true or false", name.value, other.type_name());
                    return Err(Fault::new(&codes::CONDITION, name.range.clone(), message)
                        .note(format!("compare it: `{} == {other}`", name.value)));
                }
            },
            Condition::Compare { name, equal, value } => {
                (option(name, Some(value))? == value.value) == *equal
            }
            Condition::Not(inner) => !inner.holds(option)?,
            Condition::All(parts) => {
                parts.iter().try_fold(true, |all, part| Ok(part.holds(option)? && all))?
            }
            Condition::Any(parts) => {
                parts.iter().try_fold(false, |any, part| Ok(part.holds(option)? || any))?
            }
        })
    }
}

/// Reads the directive in `line`, which starts at byte `at` of the file and may have several lines: see
/// [`port::extent`].
pub(crate) fn parse(source: &Arc<Source>, line: &str, at: usize) -> Result<Directive, Fault> {
    let indent = line.len() - line.trim_start().len();
    let mut tokens = Tokens { line, at, pos: indent + 1, depth: 0 };
    let name = tokens.next()?;
    let directive = match name.value {
        Token::Word("import") => match tokens.next()? {
            Placed { value: Token::Quoted(path), range } => {
                Directive::Import(Placed { value: path.to_owned(), range })
            }
            Placed { value: Token::Word("interface"), .. } => match tokens.next()? {
                Placed { value: Token::Quoted(name), range } => {
                    Directive::Interface(Placed { value: name.to_owned(), range })
                }
                other => {
                    return Err(
                        other.expected("the interface's name, as in `#import interface \"visibility\"`")
                    );
                }
            },
            other => return Err(other.expected("a path in quotes, as in `#import \"random.wgsl\"`")),
        },
        Token::Word("option") => tokens.option()?,
        Token::Word(word @ ("input" | "output")) => {
            let input = word == "input";
            let (port, name) = port::parse(source, line, (at, tokens.pos), input)?;
            return Ok(Directive::Port { input, port, name });
        }
        Token::Word("lights") => Directive::Lights,
        Token::Word("exact") => return Ok(Directive::Exact(exact::parse(source, line, (at, tokens.pos))?)),
        Token::Word("if") => Directive::If(tokens.any()?),
        Token::Word("elif") => Directive::Elif(tokens.any()?),
        Token::Word("else") => Directive::Else,
        Token::Word("endif") => Directive::Endif,
        Token::Word(other) => {
            let known =
                ["import", "input", "output", "option", "lights", "exact", "if", "elif", "else", "endif"];
            let fault = Fault::new(&codes::DIRECTIVE, name.range, format!("there is no `#{other}`"));
            return Err(match data_file::nearest(other, known) {
                Some(near) => fault.note(format!("did you mean `#{near}`?")),
                None => fault.note(
                    "there are #import, #input, #output, #option, #lights, #exact, #if, #elif, #else, #endif",
                ),
            });
        }
        _ => {
            return Err(
                name.expected("one of import, input, output, option, lights, exact, if, elif, else, endif")
            );
        }
    };
    match tokens.next()? {
        Placed { value: Token::End, .. } => Ok(directive),
        other => Err(other.expected("the end of the line")),
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Token<'a> {
    Word(&'a str),
    Int(i64),
    Quoted(&'a str),
    Symbol(&'static str),
    /// The end of the line; with the text of the comment there.
    End,
}

impl Placed<Token<'_>> {
    fn expected(self, what: &str) -> Fault {
        let found = match self.value {
            Token::Word(word) => format!("`{word}`"),
            Token::Int(n) => format!("`{n}`"),
            Token::Quoted(text) => format!("\"{text}\""),
            Token::Symbol(symbol) => format!("`{symbol}`"),
            Token::End => "the end of the line".to_owned(),
        };
        Fault::new(&codes::DIRECTIVE, self.range, format!("expected {what}")).label(format!("found {found}"))
    }
}

/// Deep enough for any condition a person writes, and shallow enough for any stack.
const MAX_DEPTH: u32 = 32;

struct Tokens<'a> {
    line: &'a str,
    /// Where the line starts in the file.
    at: usize,
    pos: usize,
    depth: u32,
}

impl<'a> Tokens<'a> {
    fn next(&mut self) -> Result<Placed<Token<'a>>, Fault> {
        let rest = self.line[self.pos..].trim_start();
        let start = self.line.len() - rest.len();
        let (token, len) = Self::token(rest).map_err(|(len, message)| {
            Fault::new(&codes::DIRECTIVE, self.at + start..self.at + start + len, message)
        })?;
        if token == Token::End {
            // The end of the line is where its last character ends, not past the newline.
            let end = self.at + self.line[..start].trim_end().len();
            return Ok(Placed { value: token, range: end..end });
        }
        self.pos = start + len;
        Ok(Placed { value: token, range: self.at + start..self.at + start + len })
    }

    fn token(rest: &'a str) -> Result<(Token<'a>, usize), (usize, String)> {
        let Some(first) = rest.chars().next() else { return Ok((Token::End, 0)) };
        if rest.starts_with("//") {
            return Ok((Token::End, 0));
        }
        for symbol in ["==", "!=", "&&", "||", "!", "(", ")", "[", "]", ","] {
            if rest.starts_with(symbol) {
                return Ok((Token::Symbol(symbol), symbol.len()));
            }
        }
        let word = |rest: &str| {
            rest.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == '-')).unwrap_or(rest.len())
        };
        match first {
            '"' => match rest[1..].find(['"', '\n']) {
                Some(end) if rest.as_bytes()[1 + end] == b'"' => {
                    Ok((Token::Quoted(&rest[1..1 + end]), end + 2))
                }
                _ => Err((rest.trim_end().len(), "a quote that does not end on its line".to_owned())),
            },
            '0'..='9' | '-' => {
                let len = word(rest);
                match rest[..len].parse() {
                    Ok(number) => Ok((Token::Int(number), len)),
                    Err(_) => Err((len, format!("`{}` is not a whole number", &rest[..len]))),
                }
            }
            c if c.is_alphabetic() || c == '_' => {
                let len = word(rest);
                Ok((Token::Word(&rest[..len]), len))
            }
            c => Err((c.len_utf8(), format!("`{}` means nothing here", c.escape_debug()))),
        }
    }

    fn peek(&mut self) -> Result<Placed<Token<'a>>, Fault> {
        let pos = self.pos;
        let token = self.next();
        self.pos = pos;
        token
    }

    fn accept(&mut self, symbol: &str) -> Result<bool, Fault> {
        let found = matches!(self.peek()?.value, Token::Symbol(s) if s == symbol);
        if found {
            self.next()?;
        }
        Ok(found)
    }

    fn accept_word(&mut self, word: &str) -> Result<bool, Fault> {
        let found = self.peek()?.value == Token::Word(word);
        if found {
            self.next()?;
        }
        Ok(found)
    }

    fn name(&mut self) -> Result<Placed<String>, Fault> {
        match self.next()? {
            Placed { value: Token::Word(word), range }
                if !word.contains('-') && word != "true" && word != "false" =>
            {
                Ok(Placed { value: word.to_owned(), range })
            }
            other => Err(other.expected("the name of an option")),
        }
    }

    fn value(&mut self) -> Result<Placed<Define>, Fault> {
        let token = self.next()?;
        let value = match token.value {
            Token::Word("true") => Define::Bool(true),
            Token::Word("false") => Define::Bool(false),
            Token::Word(text) | Token::Quoted(text) => Define::Text(text.to_owned()),
            Token::Int(number) => Define::Int(number),
            _ => return Err(token.expected("a value: true, false, a whole number or a word")),
        };
        Ok(Placed { value, range: token.range })
    }

    /// `#option NAME default [one_of [a, b]] [auto b where TRAIT] [internal]`
    fn option(&mut self) -> Result<Directive, Fault> {
        let name = self.name()?;
        let default = self.value()?;
        let mut one_of = Vec::new();
        if self.accept_word("one_of")? {
            if !self.accept("[")? {
                return Err(self.next()?.expected("`[`, as in `one_of [1, 4, 9]`"));
            }
            loop {
                one_of.push(self.value()?);
                if self.accept("]")? {
                    break;
                }
                if !self.accept(",")? {
                    return Err(self.next()?.expected("`,` or `]`"));
                }
            }
        }
        let mut auto = None;
        if self.accept_word("auto")? {
            let value = self.value()?;
            if !self.accept_word("where")? {
                return Err(self.next()?.expected("`where`, as in `auto query where RAY_QUERIES`"));
            }
            auto = Some((value, self.name()?.value.to_lowercase()));
        }
        let internal = self.accept_word("internal")?;
        let comments = self.line[self.pos..].lines().map(|line| line.trim().trim_start_matches('/').trim());
        let doc = comments.filter(|line| !line.is_empty()).collect::<Vec<_>>().join(" ");
        Ok(Directive::Option { name, values: OptionValues { default, one_of, auto }, internal, doc })
    }

    fn any(&mut self) -> Result<Condition, Fault> {
        let mut parts = vec![self.all()?];
        while self.accept("||")? {
            parts.push(self.all()?);
        }
        Ok(Condition::Any(parts))
    }

    fn all(&mut self) -> Result<Condition, Fault> {
        let mut parts = vec![self.one()?];
        while self.accept("&&")? {
            parts.push(self.one()?);
        }
        Ok(Condition::All(parts))
    }

    fn one(&mut self) -> Result<Condition, Fault> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            let range = self.peek()?.range;
            return Err(Fault::new(&codes::DIRECTIVE, range, "this condition is nested too deeply"));
        }
        let condition = if self.accept("!")? {
            Condition::Not(Box::new(self.one()?))
        } else if self.accept("(")? {
            let inner = self.any()?;
            if !self.accept(")")? {
                return Err(self.next()?.expected("`)`"));
            }
            inner
        } else {
            let name = self.name()?;
            if self.accept("==")? {
                Condition::Compare { name, equal: true, value: self.value()? }
            } else if self.accept("!=")? {
                Condition::Compare { name, equal: false, value: self.value()? }
            } else {
                Condition::Is(name)
            }
        };
        self.depth -= 1;
        Ok(condition)
    }
}
