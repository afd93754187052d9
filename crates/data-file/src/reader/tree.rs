//! The tree of a RON file.

use super::lexer::{Complaint, Lexeme, Token, Verbatim, lex};
use crate::diagnostic::MAX_ERRORS;

/// Deepest nesting of values: far beyond any pipeline, far below the stack.
pub(super) const MAX_DEPTH: u32 = 64;

/// A value, with the bytes it covers.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
    /// What it is.
    pub form: Form,
}

/// What stands in the text.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// `true` or `false`.
    Bool(bool),
    /// A number.
    Number(Number),
    /// A character in single quotes.
    Char(char),
    /// Text, and where its content starts if it holds no escapes.
    Text(String, Option<u32>),
    /// `b"…"`
    Bytes(Vec<u8>),
    /// A name alone: `Black`.
    Word(String),
    /// `Pass(kind: "x")` or, without a name, `(kind: "x")`.
    Struct(Option<Word>, Vec<Field>),
    /// `Replace("a", …)` or, without a name, `(1, 2)`; also `()`.
    Tuple(Option<Word>, Vec<Node>),
    /// `[…]`
    List(Vec<Node>),
    /// `{ key: value }`
    Map(Vec<(Node, Node)>),
    /// Something unreadable, already reported.
    Bad,
}

/// A number, as it is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Number {
    /// Whole.
    Integer(i128),
    /// With a point or an exponent; also `inf` and `NaN`.
    Float(f64),
}

/// A name in the text.
#[derive(Clone, Debug, PartialEq)]
pub struct Word {
    /// The name.
    pub text: String,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

/// A named field of a form.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Its name.
    pub name: Word,
    /// Its value.
    pub value: Node,
}

/// What went wrong while reading, with its bytes; nesting that is too deep apart from the rest.
#[derive(Debug, Default)]
pub(crate) struct Complaints {
    pub(crate) syntax: Vec<Complaint>,
    pub(crate) depth: Option<(u32, u32)>,
    /// For complaint number so much (from one), the bracket that it is about.
    pub(crate) opened: Vec<(usize, u32)>,
}

/// Reads a file. The tree is as whole as the text allows.
pub(crate) fn read(text: &str) -> (Node, Complaints) {
    let (tokens, syntax) = lex(text);
    let cut = syntax.iter().any(|(_, _, message)| message.ends_with("is not closed"));
    let lost = syntax.len() >= MAX_ERRORS;
    let mut parser =
        Parser { tokens, at: 0, complaints: Complaints { syntax, ..Complaints::default() }, lost, cut };
    while parser.peek() == &Token::Attribute {
        parser.at += 1;
    }
    let node = parser.value(0);
    if parser.peek() != &Token::End && !parser.lost {
        let at = parser.lexeme().clone();
        parser.complain(at.start, at.end, "expected the end of the file");
    }
    (node, parser.complaints)
}

struct Parser {
    tokens: Vec<Lexeme>,
    at: usize,
    complaints: Complaints,
    /// Set when brackets no longer match, or all is wrong: what follows would only be noise.
    lost: bool,
    /// Set when text or a comment runs to the end of the file: brackets that then seem open are not at fault.
    cut: bool,
}

impl Parser {
    fn lexeme(&self) -> &Lexeme {
        &self.tokens[self.at.min(self.tokens.len() - 1)]
    }

    fn peek(&self) -> &Token {
        &self.lexeme().token
    }

    fn next(&mut self) -> Lexeme {
        let lexeme = self.lexeme().clone();
        if lexeme.token != Token::End {
            self.at += 1;
        }
        lexeme
    }

    fn complain(&mut self, start: u32, end: u32, message: impl Into<String>) {
        let at_end = self.cut && self.peek() == &Token::End;
        if !self.lost && !at_end {
            self.complaints.syntax.push((start, end, message.into()));
            self.lost = self.complaints.syntax.len() >= MAX_ERRORS;
        }
    }

    fn value(&mut self, depth: u32) -> Node {
        let Lexeme { token, start, end } = self.next();
        let named = matches!(token, Token::Ident(_)) && self.peek() == &Token::Open('(');
        if depth > MAX_DEPTH && (named || matches!(token, Token::Open(_))) {
            self.complaints.depth.get_or_insert((start, end));
            self.at -= usize::from(!named);
            self.skip();
            return Node { start, end, form: Form::Bad };
        }
        let form = match token {
            Token::Number(n) => Form::Number(n),
            Token::Char(c) => Form::Char(c),
            Token::Text(text, Verbatim(content)) => Form::Text(text, content),
            Token::Bytes(bytes) => Form::Bytes(bytes),
            Token::Ident(word) if named => {
                let open = self.next().start;
                self.parens(Some(Word { text: word, start, end }), open, depth)
            }
            Token::Ident(word) => match word.as_str() {
                "true" => Form::Bool(true),
                "false" => Form::Bool(false),
                _ => Form::Word(word),
            },
            Token::Open('(') => self.parens(None, start, depth),
            Token::Open('[') => {
                let mut items = Vec::new();
                self.items(']', start, |p| items.push(p.value(depth + 1)));
                Form::List(items)
            }
            Token::Open(_) => {
                let mut entries = Vec::new();
                self.items('}', start, |p| {
                    let key = p.value(depth + 1);
                    if p.colon() {
                        let value = p.value(depth + 1);
                        entries.push((key, value));
                    }
                });
                Form::Map(entries)
            }
            Token::Bad => Form::Bad,
            Token::End => {
                self.complain(start, end, "expected a value, found the end of the file");
                self.lost = true;
                Form::Bad
            }
            Token::Close(_) | Token::Comma | Token::Colon | Token::Attribute => {
                self.at -= 1;
                self.complain(start, end, "expected a value");
                Form::Bad
            }
        };
        let end = self.tokens[self.at.saturating_sub(1)].end.max(end);
        Node { start, end, form }
    }

    fn colon(&mut self) -> bool {
        if self.peek() == &Token::Colon {
            self.at += 1;
            return true;
        }
        let (start, end) = (self.lexeme().start, self.lexeme().end);
        self.complain(start, end, "expected `:` and a value");
        false
    }

    /// What stands between `(` and `)`: named fields if it starts with one, else values.
    fn parens(&mut self, name: Option<Word>, open: u32, depth: u32) -> Form {
        let named = matches!(self.peek(), Token::Ident(_))
            && self.tokens.get(self.at + 1).is_some_and(|l| l.token == Token::Colon);
        if !named {
            let mut items = Vec::new();
            self.items(')', open, |p| items.push(p.value(depth + 1)));
            return Form::Tuple(name, items);
        }
        let mut fields = Vec::new();
        self.items(')', open, |p| {
            let Lexeme { token, start, end } = p.next();
            let Token::Ident(text) = token else {
                p.at -= usize::from(token != Token::End);
                p.complain(start, end, "expected the name of a field");
                return;
            };
            if p.colon() {
                let value = p.value(depth + 1);
                fields.push(Field { name: Word { text, start, end }, value });
            }
        });
        Form::Struct(name, fields)
    }

    /// Items up to the closing bracket, with commas between them. After an error it goes on at the next one.
    fn items(&mut self, close: char, open: u32, mut item: impl FnMut(&mut Parser)) {
        loop {
            if self.lost {
                return;
            }
            let Lexeme { token, start, end } = self.lexeme().clone();
            if token == Token::Close(close) {
                self.at += 1;
                return;
            }
            if matches!(token, Token::Close(_)) {
                self.complain(start, end, format!("expected `{close}` before this"));
                self.complaints.opened.push((self.complaints.syntax.len(), open));
                self.lost = true;
                return;
            }
            let errors = self.complaints.syntax.len();
            let from = self.at;
            item(self);
            let Lexeme { token, start, end } = self.lexeme().clone();
            match token {
                Token::Comma => self.at += 1,
                Token::Close(c) if c == close => {}
                _ => {
                    if token == Token::End {
                        self.complain(open, open + 1, format!("this is not closed: expected `{close}`"));
                        self.lost = true;
                        return;
                    }
                    // Where all was well, and the next thing reads as an item, only the comma was forgotten.
                    let next = self.tokens.get(self.at + 1).map(|lexeme| &lexeme.token);
                    let forgotten = self.complaints.syntax.len() == errors
                        && self.at > from
                        && match close {
                            ']' => !matches!(token, Token::Close(_) | Token::Colon),
                            _ => next == Some(&Token::Colon),
                        };
                    if self.complaints.syntax.len() == errors && !matches!(token, Token::Close(_)) {
                        self.complain(start, end, format!("expected `,` or `{close}`"));
                    }
                    if !forgotten {
                        self.skip_to_comma(close, open);
                    }
                }
            }
        }
    }

    /// Goes to the next comma or closing bracket of this level.
    fn skip_to_comma(&mut self, close: char, open: u32) {
        loop {
            match self.peek() {
                Token::Comma => {
                    self.at += 1;
                    return;
                }
                Token::Close(c) if *c == close => return,
                Token::Close(_) | Token::End => {
                    let (start, end) = (self.lexeme().start, self.lexeme().end);
                    if self.peek() == &Token::End {
                        self.complain(open, open + 1, format!("this is not closed: expected `{close}`"));
                    } else {
                        self.complain(start, end, format!("expected `{close}` before this"));
                        self.complaints.opened.push((self.complaints.syntax.len(), open));
                    }
                    self.lost = true;
                    return;
                }
                Token::Open(_) => self.skip(),
                _ => self.at += 1,
            }
        }
    }

    /// Passes over a bracket and all that is in it.
    fn skip(&mut self) {
        let mut depth = 0u32;
        loop {
            match self.next().token {
                Token::Open(_) => depth += 1,
                Token::Close(_) => depth -= 1,
                Token::End => return,
                _ => {}
            }
            if depth == 0 {
                return;
            }
        }
    }
}
