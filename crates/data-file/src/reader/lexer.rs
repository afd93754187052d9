//! Cuts RON text into tokens.

use super::tree::Number;
use crate::diagnostic::{MAX_ERRORS, MAX_QUOTED, shortened};

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Open(char),
    Close(char),
    Comma,
    Colon,
    Ident(String),
    /// Text, and whether its bytes are those between the quotes.
    Text(String, Verbatim),
    Bytes(Vec<u8>),
    Char(char),
    Number(Number),
    /// `#![enable(…)]`, read whole.
    Attribute,
    /// Something unreadable, already reported.
    Bad,
    End,
}

/// Where the content of a text token starts, if it holds no escapes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Verbatim(pub(super) Option<u32>);

#[derive(Clone, Debug)]
pub(super) struct Lexeme {
    pub(super) token: Token,
    pub(super) start: u32,
    pub(super) end: u32,
}

/// An error: from, to, what.
pub(super) type Complaint = (u32, u32, String);

struct Lexer<'a> {
    text: &'a str,
    at: usize,
    complaints: Vec<Complaint>,
}

/// The longest `#![enable(…)]` that is looked for: where brackets are missing, each `#!` would search all that follows.
const MAX_ATTRIBUTE: usize = 1024;

/// All tokens of `text`, closed by [`Token::End`], and what could not be read; nothing behind the
/// [`MAX_ERRORS`]-th error is looked at.
pub(super) fn lex(text: &str) -> (Vec<Lexeme>, Vec<Complaint>) {
    let mut lexer = Lexer { text, at: 0, complaints: Vec::new() };
    let mut tokens = Vec::new();
    loop {
        lexer.skip_blanks();
        let start = lexer.at as u32;
        let token = lexer.token();
        let done = token == Token::End || lexer.complaints.len() >= MAX_ERRORS;
        let token = if done { Token::End } else { token };
        tokens.push(Lexeme { token, start, end: lexer.at as u32 });
        if done {
            return (tokens, lexer.complaints);
        }
    }
}

/// Returns where the next token begins at or after byte `at`, which is between two tokens: past blanks and comments.
/// For those who edit a text by the places of its tree.
pub fn skip_blanks(text: &str, at: usize) -> usize {
    let mut lexer = Lexer { text, at, complaints: Vec::new() };
    lexer.skip_blanks();
    lexer.at
}

fn is_blank(c: char) -> bool {
    matches!(c, ' ' | '\t'..='\r' | '\u{85}' | '\u{200E}' | '\u{200F}' | '\u{2028}' | '\u{2029}' | '\u{FEFF}')
}

fn is_ident_start(c: char) -> bool {
    c == '_' || c.is_alphabetic()
}

fn is_ident(c: char) -> bool {
    c == '_' || c.is_alphanumeric()
}

fn is_raw_ident(c: char) -> bool {
    is_ident(c) || matches!(c, '.' | '+' | '-')
}

impl Lexer<'_> {
    fn rest(&self) -> &str {
        &self.text[self.at..]
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    fn bump(&mut self) -> Option<char> {
        let c = self.peek()?;
        self.at += c.len_utf8();
        Some(c)
    }

    fn eat(&mut self, text: &str) -> bool {
        let found = self.rest().starts_with(text);
        if found {
            self.at += text.len();
        }
        found
    }

    fn eat_while(&mut self, accept: impl Fn(char) -> bool) {
        while self.peek().is_some_and(&accept) {
            self.bump();
        }
    }

    fn complain(&mut self, start: usize, message: impl Into<String>) {
        self.complaints.push((start as u32, self.at as u32, message.into()));
    }

    fn skip_blanks(&mut self) {
        loop {
            self.eat_while(is_blank);
            let start = self.at;
            if self.eat("//") {
                self.eat_while(|c| c != '\n');
            } else if self.eat("/*") {
                let mut depth = 1;
                while depth > 0 {
                    if self.eat("/*") {
                        depth += 1;
                    } else if self.eat("*/") {
                        depth -= 1;
                    } else if self.bump().is_none() {
                        self.complaints.push((
                            start as u32,
                            start as u32 + 2,
                            "this comment is not closed".into(),
                        ));
                        return;
                    }
                }
            } else {
                return;
            }
        }
    }

    fn token(&mut self) -> Token {
        let start = self.at;
        let Some(c) = self.peek() else { return Token::End };
        match c {
            '(' | '[' | '{' => {
                self.bump();
                Token::Open(c)
            }
            ')' | ']' | '}' => {
                self.bump();
                Token::Close(c)
            }
            ',' => {
                self.bump();
                Token::Comma
            }
            ':' => {
                self.bump();
                Token::Colon
            }
            '"' => self.text(),
            '\'' => self.character(),
            '#' if self.rest().starts_with("#!") => self.attribute(),
            '0'..='9' | '.' | '+' | '-' => self.number(),
            _ if self.eat("br\"") || self.rest().starts_with("br#") => {
                self.at = start + 2;
                self.raw_text(start, true)
            }
            _ if self.eat("b\"") => self.bytes(start),
            _ if self.eat("b'") => self.byte(start),
            _ if self.rest().starts_with("r\"") || self.is_raw_text() => {
                self.at += 1;
                self.raw_text(start, false)
            }
            _ if self.eat("r#") => {
                let from = self.at;
                self.eat_while(is_raw_ident);
                if self.at == from {
                    self.complain(start, "a name must follow `r#`");
                    return Token::Bad;
                }
                Token::Ident(self.text[from..self.at].to_owned())
            }
            _ if is_ident_start(c) => {
                self.eat_while(is_ident);
                let word = &self.text[start..self.at];
                match float_word(word) {
                    Some(x) => Token::Number(Number::Float(x)),
                    None => Token::Ident(word.to_owned()),
                }
            }
            _ => {
                // A row of the same is one error: a file of zeros has millions of them.
                self.eat_while(|next| next == c);
                self.complain(start, format!("`{}` has no meaning here", c.escape_debug()));
                Token::Bad
            }
        }
    }

    /// `r#"`, with any number of `#`.
    fn is_raw_text(&self) -> bool {
        self.rest()
            .strip_prefix('r')
            .is_some_and(|r| r.starts_with('#') && r.trim_start_matches('#').starts_with('"'))
    }

    fn attribute(&mut self) -> Token {
        let start = self.at;
        let rest = &self.rest()[..self.rest().floor_char_boundary(MAX_ATTRIBUTE)];
        let end = rest.find(']').map(|end| end + 1).or_else(|| rest.find('\n'));
        self.at += end.unwrap_or(rest.len());
        let inside: String = self.text[start..self.at].chars().filter(|c| !is_blank(*c)).collect();
        let known = |name: &str| {
            matches!(
                name,
                "implicit_some"
                    | "unwrap_newtypes"
                    | "unwrap_variant_newtypes"
                    | "explicit_struct_names"
                    | ""
            )
        };
        let list = inside.strip_prefix("#![enable(").and_then(|rest| rest.strip_suffix(")]"));
        if !list.is_some_and(|list| list.split(',').all(known)) {
            self.complain(start, "expected an attribute such as `#![enable(implicit_some)]`");
        }
        Token::Attribute
    }

    fn text(&mut self) -> Token {
        let start = self.at;
        self.bump();
        let content = self.at;
        let mut text = String::new();
        let mut verbatim = true;
        loop {
            let at = self.at;
            match self.bump() {
                None => {
                    self.complaints.push((start as u32, start as u32 + 1, "this text is not closed".into()));
                    return Token::Bad;
                }
                Some('"') => break,
                Some('\\') => {
                    verbatim = false;
                    match self.escape() {
                        Some(c) => text.push(c),
                        None => self.complain(at, "this escape is not known"),
                    }
                }
                Some(c) => text.push(c),
            }
        }
        Token::Text(text, Verbatim(verbatim.then_some(content as u32)))
    }

    /// What follows a backslash.
    fn escape(&mut self) -> Option<char> {
        match self.bump()? {
            '\'' => Some('\''),
            '"' => Some('"'),
            '\\' => Some('\\'),
            'n' => Some('\n'),
            'r' => Some('\r'),
            't' => Some('\t'),
            '0' => Some('\0'),
            'x' => {
                // The bytes of one character, each as `\xNN`.
                let mut bytes = vec![self.hex_byte()?];
                loop {
                    match std::str::from_utf8(&bytes) {
                        Ok(text) => return text.chars().next(),
                        Err(_) if bytes.len() < 4 && self.eat("\\x") => bytes.push(self.hex_byte()?),
                        Err(_) => return None,
                    }
                }
            }
            'u' => {
                if !self.eat("{") {
                    return None;
                }
                let from = self.at;
                self.eat_while(|c| c.is_ascii_hexdigit());
                let digits = &self.text[from..self.at];
                let code = if digits.len() <= 6 { u32::from_str_radix(digits, 16).ok() } else { None };
                if self.eat("}") { code.and_then(char::from_u32) } else { None }
            }
            _ => None,
        }
    }

    fn hex_byte(&mut self) -> Option<u8> {
        let digits = self.rest().get(..2).filter(|d| d.bytes().all(|b| b.is_ascii_hexdigit()))?;
        let byte = u8::from_str_radix(digits, 16).ok()?;
        self.at += 2;
        Some(byte)
    }

    /// From the `#`s or the quote on.
    fn raw_text(&mut self, start: usize, bytes: bool) -> Token {
        let from = self.at;
        self.eat_while(|c| c == '#');
        let close = format!("\"{}", "#".repeat(self.at - from));
        let opened = self.eat("\"");
        let content = self.at;
        let Some(len) = self.rest().find(&close).filter(|_| opened) else {
            self.complaints.push((start as u32, content as u32, "this text is not closed".into()));
            self.at = self.text.len();
            return Token::Bad;
        };
        let text = self.rest()[..len].to_owned();
        self.at += len + close.len();
        if bytes {
            Token::Bytes(text.into_bytes())
        } else {
            Token::Text(text, Verbatim(Some(content as u32)))
        }
    }

    fn bytes(&mut self, start: usize) -> Token {
        let mut bytes = Vec::new();
        loop {
            let at = self.at;
            match self.bump() {
                None => {
                    self.complaints.push((start as u32, start as u32 + 2, "this text is not closed".into()));
                    return Token::Bad;
                }
                Some('"') => return Token::Bytes(bytes),
                Some('\\') => match self.byte_escape() {
                    Some(byte) => bytes.extend(byte),
                    None => self.complain(at, "this escape is not known"),
                },
                Some(c) => bytes.extend(c.encode_utf8(&mut [0; 4]).bytes()),
            }
        }
    }

    fn byte_escape(&mut self) -> Option<Vec<u8>> {
        if self.eat("x") {
            return Some(vec![self.hex_byte()?]);
        }
        Some(self.escape()?.encode_utf8(&mut [0; 4]).bytes().collect())
    }

    fn byte(&mut self, start: usize) -> Token {
        let byte = if self.eat("\\") {
            self.byte_escape().filter(|b| b.len() == 1).map(|b| b[0])
        } else {
            self.bump().filter(char::is_ascii).map(|c| c as u8)
        };
        match byte {
            Some(byte) if self.eat("'") => Token::Number(Number::Integer(byte.into())),
            _ => {
                self.complain(start, "expected one byte in quotes, such as b'a'");
                Token::Bad
            }
        }
    }

    fn character(&mut self) -> Token {
        let start = self.at;
        self.bump();
        let c = if self.eat("\\") { self.escape() } else { self.bump() };
        match c {
            Some(c) if self.eat("'") => Token::Char(c),
            _ => {
                // Most likely text in single quotes: it is passed over whole.
                let line = self.text[start + 1..].find('\n').map_or(self.text.len(), |at| start + 1 + at);
                if let Some(close) = self.text[start + 1..line].rfind('\'') {
                    self.at = start + close + 2;
                }
                self.complain(start, "expected one character in quotes; text stands in double quotes");
                Token::Bad
            }
        }
    }

    fn number(&mut self) -> Token {
        let start = self.at;
        let sign = if self.eat("-") { -1 } else { 1 };
        if sign == 1 {
            self.eat("+");
        }
        if self.peek().is_some_and(is_ident_start) {
            let from = self.at;
            self.eat_while(is_ident);
            if let Some(x) = float_word(&self.text[from..self.at]) {
                return Token::Number(Number::Float(x * sign as f64));
            }
            self.complain(start, "expected a number after the sign");
            return Token::Bad;
        }
        let radix =
            [("0x", 16), ("0b", 2), ("0o", 8)].into_iter().find(|(p, _)| self.eat(p)).map_or(10, |(_, r)| r);
        let from = self.at;
        if radix == 10 {
            self.eat_while(|c| c.is_ascii_digit() || c == '_');
            let whole_end = self.at;
            if self.eat(".") {
                self.eat_while(|c| c.is_ascii_digit() || c == '_');
            }
            if self.peek().is_some_and(|c| matches!(c, 'e' | 'E')) {
                self.bump();
                let _ = self.eat("-") || self.eat("+");
                self.eat_while(|c| c.is_ascii_digit() || c == '_');
            }
            if self.at > whole_end || ["f32", "f64"].iter().any(|s| self.rest().starts_with(s)) {
                let digits = self.text[from..self.at].replace('_', "");
                let _ = self.eat("f32") || self.eat("f64");
                return match digits.parse::<f64>() {
                    Ok(x) if !self.text[from..].starts_with('_') && !self.peek().is_some_and(is_ident) => {
                        Token::Number(Number::Float(x * sign as f64))
                    }
                    _ => self.bad_number(start),
                };
            }
        } else {
            self.eat_while(|c| c == '_' || c.is_digit(radix));
        }
        let digits = self.text[from..self.at].replace('_', "");
        let bad = self.text[from..].starts_with('_');
        if let Some(suffix) = ["i8", "i16", "i32", "i64", "i128", "u8", "u16", "u32", "u64", "u128"]
            .into_iter()
            .find(|s| self.rest().strip_prefix(s).is_some_and(|rest| !rest.starts_with(is_ident)))
        {
            self.at += suffix.len();
        }
        if bad || self.peek().is_some_and(is_ident) {
            return self.bad_number(start);
        }
        match i128::from_str_radix(&digits, radix) {
            Ok(n) if n <= u64::MAX.into() => Token::Number(Number::Integer(n * sign)),
            // As the `ron` crate does, a decimal integer beyond all integer types is taken as a real number.
            _ => match digits.parse::<f64>() {
                Ok(x) if radix == 10 => Token::Number(Number::Float(x * sign as f64)),
                _ => self.bad_number(start),
            },
        }
    }

    fn bad_number(&mut self, start: usize) -> Token {
        self.eat_while(|c| is_ident(c) || c == '.');
        self.complain(
            start,
            format!("`{}` is not a number", shortened(&self.text[start..self.at], MAX_QUOTED)),
        );
        Token::Bad
    }
}

/// `inf` and `NaN`, with the suffixes they may carry.
fn float_word(word: &str) -> Option<f64> {
    match word {
        "inf" | "inff32" | "inff64" => Some(f64::INFINITY),
        "NaN" | "NaNf32" | "NaNf64" => Some(f64::NAN),
        _ => None,
    }
}
