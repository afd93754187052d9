//! Scans of WGSL for what naga does not keep: comments, doc comments with their places, and braces.

use std::ops::Range;

/// A struct in the text.
#[derive(Debug)]
pub(crate) struct FoundStruct {
    /// Where its name stands.
    pub(crate) name: Range<usize>,
    /// Its members.
    pub(crate) members: Vec<FoundMember>,
}

#[derive(Debug)]
pub(crate) struct FoundMember {
    pub(crate) name: String,
    /// Where the name stands.
    pub(crate) range: Range<usize>,
    /// The type as written, without space.
    pub(crate) ty: String,
    pub(crate) doc: Doc,
}

/// The text of `///` comments, and where each byte of it stands.
#[derive(Debug, Default)]
pub(crate) struct Doc {
    pub(crate) text: String,
    places: Vec<usize>,
}

impl Doc {
    fn push(&mut self, line: &str, at: usize) {
        if !self.text.is_empty() {
            self.text.push(' ');
            self.places.push(at);
        }
        self.text.push_str(line);
        self.places.extend(at..at + line.len());
    }

    /// Where a range of the doc text stands.
    pub(crate) fn place(&self, range: Range<usize>) -> Range<u32> {
        let start = self.places.get(range.start).or(self.places.last()).copied().unwrap_or(0);
        let end =
            range.end.checked_sub(1).and_then(|last| self.places.get(last)).map_or(start, |last| last + 1);
        start as u32..end.max(start) as u32
    }
}

/// A word, a symbol or a doc comment.
#[derive(Debug, PartialEq)]
pub(crate) enum Lexeme<'a> {
    Word(&'a str),
    Doc(&'a str),
    Symbol(char),
}

/// The text's words, symbols and doc comments, without other comments and space, with their places.
pub(crate) fn lexemes(text: &str) -> impl Iterator<Item = (Lexeme<'_>, usize)> {
    let mut at = 0;
    std::iter::from_fn(move || {
        loop {
            let rest = &text[at..];
            let first = rest.chars().next()?;
            let start = at;
            if rest.starts_with("//") {
                let end = rest.find('\n').unwrap_or(rest.len());
                at += end;
                match rest[..end].strip_prefix("///") {
                    Some(doc) if !doc.starts_with('/') => {
                        let indent = doc.len() - doc.trim_start().len();
                        return Some((Lexeme::Doc(doc.trim()), start + 3 + indent));
                    }
                    _ => continue,
                }
            }
            if rest.starts_with("/*") {
                let mut depth = 0;
                let bytes = rest.as_bytes();
                let mut i = 0;
                while i < bytes.len() {
                    let step = match bytes.get(i..i + 2) {
                        Some(b"/*") => {
                            depth += 1;
                            2
                        }
                        Some(b"*/") => {
                            depth -= 1;
                            2
                        }
                        _ => 1,
                    };
                    i += step;
                    if depth == 0 {
                        break;
                    }
                }
                at += i;
                continue;
            }
            if first.is_alphabetic() || first == '_' {
                let len = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
                at += len;
                return Some((Lexeme::Word(&rest[..len]), start));
            }
            at += first.len_utf8();
            if !first.is_whitespace() {
                return Some((Lexeme::Symbol(first), start));
            }
        }
    })
}

/// Finds `struct name`, with the doc comments of its members. The text is one that naga accepts.
pub(crate) fn find_struct(text: &str, name: &str) -> Option<FoundStruct> {
    let mut lexemes = lexemes(text).peekable();
    let at = loop {
        if lexemes.next()?.0 == Lexeme::Word("struct")
            && let Some((Lexeme::Word(found), at)) = lexemes.peek()
            && *found == name
        {
            break *at;
        }
    };
    let mut members = Vec::new();
    let mut doc = Doc::default();
    // Depth inside `<>`, `()` and `[]`; a member's name stands at depth 0 before its `:`.
    let mut depth = 0_i32;
    let mut word = None;
    let mut in_type = false;
    for (lexeme, at) in lexemes.skip_while(|(lexeme, _)| *lexeme != Lexeme::Symbol('{')).skip(1) {
        let of_type = in_type && !matches!(lexeme, Lexeme::Symbol('}') | Lexeme::Doc(_));
        if let Some(FoundMember { ty, .. }) = members.last_mut().filter(|_| of_type) {
            match lexeme {
                Lexeme::Symbol(',') if depth == 0 => {}
                Lexeme::Symbol(symbol) => ty.push(symbol),
                Lexeme::Word(word) => ty.push_str(word),
                Lexeme::Doc(_) => {}
            }
        }
        match lexeme {
            Lexeme::Symbol('}') => break,
            Lexeme::Symbol('<' | '(' | '[') => depth += 1,
            Lexeme::Symbol('>' | ')' | ']') => depth -= 1,
            Lexeme::Symbol(',') if depth == 0 => in_type = false,
            Lexeme::Symbol(':') if depth == 0 => {
                if let Some((name, at)) = word.take() {
                    let name: &str = name;
                    let range = at..at + name.len();
                    members.push(FoundMember {
                        name: name.to_owned(),
                        range,
                        ty: String::new(),
                        doc: std::mem::take(&mut doc),
                    });
                    in_type = true;
                }
            }
            Lexeme::Symbol(_) => {}
            Lexeme::Word(found) => word = Some((found, at)).filter(|_| depth == 0 && !in_type),
            Lexeme::Doc(line) => doc.push(line, at),
        }
    }
    Some(FoundStruct { name: at..at + name.len(), members })
}

/// A function in the text.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct FoundFunction {
    /// Where its parameters stand, without the parentheses.
    pub(crate) parameters: Range<usize>,
    /// Where its body begins, behind the `{`.
    pub(crate) body: usize,
}

/// Finds `fn name`. The text is one that naga accepts.
pub(crate) fn find_function(text: &str, name: &str) -> Option<FoundFunction> {
    let mut lexemes = lexemes(text);
    loop {
        if lexemes.next()?.0 == Lexeme::Word("fn") && lexemes.next()?.0 == Lexeme::Word(name) {
            break;
        }
    }
    let start = lexemes.find(|(lexeme, _)| *lexeme == Lexeme::Symbol('('))?.1 + 1;
    let mut depth = 1;
    let end = lexemes.find_map(|(lexeme, at)| {
        match lexeme {
            Lexeme::Symbol('(') => depth += 1,
            Lexeme::Symbol(')') => depth -= 1,
            _ => {}
        }
        (depth == 0).then_some(at)
    })?;
    let body = lexemes.find(|(lexeme, _)| *lexeme == Lexeme::Symbol('{'))?.1 + 1;
    Some(FoundFunction { parameters: start..end, body })
}

/// A function or a global variable with a doc comment.
#[derive(Debug)]
pub(crate) struct FoundDeclaration {
    pub(crate) name: String,
    pub(crate) doc: Doc,
}

/// Finds the functions and global variables that have doc comments, in order.
pub(crate) fn find_documented(text: &str) -> Vec<FoundDeclaration> {
    let mut lexemes = lexemes(text).peekable();
    let mut found = Vec::new();
    let mut doc = Doc::default();
    // Depth inside `{}`, where nothing is a declaration.
    let mut depth = 0_u32;
    while let Some((lexeme, at)) = lexemes.next() {
        match lexeme {
            Lexeme::Symbol('{') => {
                depth += 1;
                doc = Doc::default();
            }
            Lexeme::Symbol('}') => {
                depth = depth.saturating_sub(1);
                doc = Doc::default();
            }
            Lexeme::Symbol(';') => doc = Doc::default(),
            Lexeme::Doc(line) if depth == 0 => doc.push(line, at),
            Lexeme::Word("fn" | "var") if depth == 0 => {
                if let Some((Lexeme::Symbol('<'), _)) = lexemes.peek() {
                    lexemes.by_ref().find(|(lexeme, _)| *lexeme == Lexeme::Symbol('>'));
                }
                if let Some((Lexeme::Word(name), _)) = lexemes.next()
                    && !doc.text.is_empty()
                {
                    found.push(FoundDeclaration { name: name.to_owned(), doc: std::mem::take(&mut doc) });
                }
            }
            _ => {}
        }
    }
    found
}

/// Returns where a name is declared: a function, a type, a variable or a constant outside of functions, a member of a
/// struct, or what a directive declares. The text need not be whole.
pub fn declaration(text: &str, name: &str) -> Option<Range<usize>> {
    let mut lexemes = lexemes(text).peekable();
    let (mut depth, mut in_struct, mut keyword, mut member) = (0_u32, false, None, None);
    while let Some((lexeme, at)) = lexemes.next() {
        let range = at..at + name.len();
        match lexeme {
            Lexeme::Symbol('{') => depth += 1,
            Lexeme::Symbol('}') => {
                depth = depth.saturating_sub(1);
                in_struct &= depth > 0;
            }
            // `var<storage> name`
            Lexeme::Symbol('<') if keyword == Some("var") => {
                lexemes.by_ref().find(|(lexeme, _)| *lexeme == Lexeme::Symbol('>'));
                continue;
            }
            Lexeme::Word(word) => {
                let declares =
                    ["fn", "struct", "const", "override", "alias", "var", "option", "input", "output"];
                let is_member = depth == 1 && in_struct;
                if word == name && depth == 0 && keyword.is_some_and(|keyword| declares.contains(&keyword)) {
                    return Some(range);
                }
                if word == name
                    && is_member
                    && lexemes.peek().is_some_and(|next| next.0 == Lexeme::Symbol(':'))
                {
                    member.get_or_insert(range);
                }
                in_struct |= depth == 0 && word == "struct";
                keyword = Some(word);
                continue;
            }
            Lexeme::Symbol(_) | Lexeme::Doc(_) => {}
        }
        keyword = None;
    }
    member
}

/// Returns the names that a text declares outside of functions, each with what declares it.
pub fn declared(text: &str) -> Vec<(&str, &str)> {
    let (mut depth, mut keyword, mut found) = (0_u32, None, Vec::new());
    let mut lexemes = lexemes(text);
    while let Some((lexeme, _)) = lexemes.next() {
        match lexeme {
            Lexeme::Symbol('{') => depth += 1,
            Lexeme::Symbol('}') => depth = depth.saturating_sub(1),
            Lexeme::Symbol('<') if keyword == Some("var") => {
                lexemes.by_ref().find(|(lexeme, _)| *lexeme == Lexeme::Symbol('>'));
                continue;
            }
            Lexeme::Word(word) => {
                let declares = ["fn", "struct", "const", "override", "alias", "var", "option"];
                if let Some(keyword) = keyword.filter(|keyword| depth == 0 && declares.contains(keyword)) {
                    found.push((keyword, word));
                }
                keyword = Some(word);
                continue;
            }
            Lexeme::Symbol(_) | Lexeme::Doc(_) => {}
        }
        keyword = None;
    }
    found
}

/// A function or a struct of a WGSL file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    /// `fn` or `struct`.
    pub keyword: &'static str,
    /// The name.
    pub name: String,
    /// The declaration: of a function its name, arguments and type; of a struct all of it, with comments.
    pub declaration: String,
    /// The doc comment above it, in one line.
    pub doc: String,
    /// Whether it is an entry point.
    pub is_entry: bool,
}

/// Returns the functions and structs of a text, in its order.
pub fn items(text: &str) -> Vec<Item> {
    let named = |(keyword, name): (&str, &str)| {
        let keyword = ["fn", "struct"].into_iter().find(|known| *known == keyword)?;
        let at = declaration(text, name)?.start;
        let start = text[..at].rfind('\n').map_or(0, |end| end + 1);
        let rest = &text[start..];
        let declaration = if keyword == "fn" {
            let head = &rest[..rest.find('{').unwrap_or(rest.len())];
            head.split_whitespace().collect::<Vec<_>>().join(" ").replace("( ", "(").replace(", )", ")")
        } else {
            rest[..rest.find("\n}").map_or(rest.len(), |end| end + 2)].to_owned()
        };
        let above = || text[..start].lines().rev().map(str::trim);
        let is_entry = above().next().is_some_and(|line| line.starts_with('@'));
        let doc = above().skip_while(|line| line.starts_with('@')).map_while(|line| line.strip_prefix("///"));
        let mut doc: Vec<&str> = doc.map(str::trim).collect();
        doc.reverse();
        Some(Item { keyword, name: name.to_owned(), declaration, doc: doc.join(" "), is_entry })
    };
    declared(text).into_iter().filter_map(named).collect()
}

/// Returns where `word` first stands alone.
pub(crate) fn find_word(text: &str, word: &str) -> Option<usize> {
    lexemes(text).find(|(lexeme, _)| *lexeme == Lexeme::Word(word)).map(|(_, at)| at)
}

/// The first `{` that is not closed before another file begins, or the text ends; `same_file` says whether
/// two bytes are of one file.
pub(crate) fn unclosed_brace(text: &str, same_file: impl Fn(usize, usize) -> bool) -> Option<usize> {
    let mut open: Vec<usize> = Vec::new();
    for (lexeme, at) in lexemes(text) {
        match lexeme {
            Lexeme::Symbol('{') => open.push(at),
            Lexeme::Symbol('}') => match open.pop() {
                Some(brace) if !same_file(brace, at) => return Some(brace),
                _ => {}
            },
            _ => {}
        }
    }
    open.first().copied()
}

/// Where the text is inside block comments, line by line.
#[derive(Default)]
pub(crate) struct Comments {
    /// Starts of the comments that are open; WGSL's block comments nest.
    pub(crate) open: Vec<usize>,
}

impl Comments {
    /// Takes in the next line, which starts at byte `start`.
    pub(crate) fn scan(&mut self, line: &str, start: usize) {
        let bytes = line.as_bytes();
        let mut i = 0;
        while i + 1 < bytes.len() {
            match &bytes[i..i + 2] {
                b"//" if self.open.is_empty() => return,
                b"/*" => self.open.push(start + i),
                b"*/" => {
                    self.open.pop();
                }
                _ => {
                    i += 1;
                    continue;
                }
            }
            i += 2;
        }
    }
}
