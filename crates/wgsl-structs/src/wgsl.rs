//! Structs and constants of a WGSL file, with the layout that WGSL gives them.

use std::collections::BTreeMap;

/// Why a declaration is refused.
#[derive(Debug)]
pub(crate) struct Error {
    /// The line of the file, from 1.
    pub(crate) line: usize,
    pub(crate) message: String,
}

/// A struct.
#[derive(Debug)]
pub(crate) struct Struct {
    pub(crate) name: String,
    pub(crate) docs: Vec<String>,
    pub(crate) members: Vec<Member>,
    pub(crate) align: u32,
    /// Size in bytes, with the padding at the end; without `rows`.
    pub(crate) size: u32,
    /// The array at the end that is sized at run time; its size is 0.
    pub(crate) rows: Option<Member>,
}

impl Struct {
    /// Returns the type of members that hold this struct, by its name in Rust.
    pub(crate) fn as_type(&self, rust: &str) -> Type {
        Type { wgsl: self.name.clone(), rust: rust.to_owned(), align: self.align, size: self.size }
    }
}

#[derive(Debug)]
pub(crate) struct Member {
    pub(crate) name: String,
    pub(crate) docs: Vec<String>,
    pub(crate) ty: Type,
    /// Bytes from the start of the struct.
    pub(crate) offset: u32,
}

/// A type that both languages have.
#[derive(Clone, Debug)]
pub(crate) struct Type {
    /// The type in WGSL, without short names: `vec3<f32>`.
    pub(crate) wgsl: String,
    /// The type in Rust: `[f32; 3]`.
    pub(crate) rust: String,
    pub(crate) align: u32,
    /// Size in bytes; 0 where it is known at run time.
    pub(crate) size: u32,
}

impl Type {
    fn stride(&self) -> u32 {
        self.size.next_multiple_of(self.align)
    }
}

/// A constant whose value is a literal.
pub(crate) struct Constant {
    pub(crate) docs: Vec<String>,
    /// `u32`, `i32` or `f32`.
    pub(crate) ty: String,
    /// The literal in Rust.
    pub(crate) value: String,
}

/// Returns the struct of that name. `known` are the structs that its members may have as their type.
///
/// # Errors
/// Where there is no such struct, or a member has another form than `name: type`.
pub(crate) fn read_struct(source: &str, name: &str, known: &BTreeMap<String, Type>) -> Result<Struct, Error> {
    let (docs, mut tokens) = Tokens::after(source, "struct", name)?;
    tokens.expect("{")?;
    let mut structure =
        Struct { name: name.to_owned(), docs, members: Vec::new(), align: 1, size: 0, rows: None };
    let mut end: u32 = 0;
    while !tokens.next_is("}") {
        if structure.rows.is_some() {
            return Err(tokens.error("`}` after an array that is sized at run time"));
        }
        let docs = tokens.docs();
        let member = tokens.name()?;
        tokens.expect(":")?;
        let ty = tokens.ty(known)?;
        if !tokens.next_is(",") && tokens.peek() != "}" {
            return Err(tokens.error("`,` or `}`"));
        }
        let offset = end.next_multiple_of(ty.align);
        structure.align = structure.align.max(ty.align);
        end = offset + ty.size;
        let member = Member { name: member, docs, offset, ty };
        if member.ty.size == 0 {
            structure.rows = Some(member);
        } else {
            structure.members.push(member);
        }
    }
    structure.size = if structure.rows.is_some() { end } else { end.next_multiple_of(structure.align) };
    Ok(structure)
}

/// Returns the constant of that name.
///
/// # Errors
/// Where there is no such constant, or its value is not a literal.
pub(crate) fn read_const(source: &str, name: &str) -> Result<Constant, Error> {
    let (docs, mut tokens) = Tokens::after(source, "const", name)?;
    let declared = if tokens.next_is(":") { Some(tokens.name()?) } else { None };
    tokens.expect("=")?;
    let sign = if tokens.next_is("-") { "-" } else { "" };
    let literal = tokens.take();
    let (digits, suffix) = match literal.char_indices().last() {
        Some((end, 'u')) => (&literal[..end], Some("u32")),
        Some((end, 'i')) => (&literal[..end], Some("i32")),
        Some((end, 'f')) if !literal.starts_with("0x") => (&literal[..end], Some("f32")),
        _ => (literal, None),
    };
    let ty = declared.or(suffix.map(str::to_owned)).filter(|ty| ["u32", "i32", "f32"].contains(&ty.as_str()));
    match ty {
        Some(ty) if literal.starts_with(|c: char| c.is_ascii_digit()) && tokens.peek() == ";" => {
            let point = if ty == "f32" && !digits.contains(['.', 'e']) { ".0" } else { "" };
            Ok(Constant { docs, ty, value: format!("{sign}{digits}{point}") })
        }
        _ => Err(tokens.error("a literal of the type u32, i32 or f32")),
    }
}

/// A word, number or sign, with the documentation before it.
struct Token<'a> {
    text: &'a str,
    line: usize,
    docs: Vec<String>,
}

/// The tokens of a file that are yet to be read.
struct Tokens<'a> {
    rest: std::vec::IntoIter<Token<'a>>,
    last_line: usize,
}

impl<'a> Tokens<'a> {
    fn new(source: &'a str) -> Tokens<'a> {
        let (mut tokens, mut docs) = (Vec::new(), Vec::new());
        for (line, mut text) in source.lines().enumerate() {
            loop {
                text = text.trim_start();
                if let Some(doc) = text.strip_prefix("///") {
                    docs.push(doc.trim().to_owned());
                    break;
                }
                if text.is_empty() || text.starts_with("//") {
                    break;
                }
                let is_number = text.starts_with(|c: char| c.is_ascii_digit());
                let in_word = |c: char| c.is_alphanumeric() || c == '_' || (is_number && c == '.');
                let word = text.find(|c| !in_word(c)).unwrap_or(text.len());
                let length = if word > 0 { word } else { text.chars().next().map_or(0, char::len_utf8) };
                let (token, rest) = text.split_at(length);
                tokens.push(Token { text: token, line: line + 1, docs: std::mem::take(&mut docs) });
                text = rest;
            }
        }
        let last_line = tokens.last().map_or(1, |token| token.line);
        Tokens { rest: tokens.into_iter(), last_line }
    }

    /// Returns the tokens after a keyword and a name outside of functions, and the documentation before them.
    fn after(source: &'a str, keyword: &str, name: &str) -> Result<(Vec<String>, Tokens<'a>), Error> {
        let mut tokens = Tokens::new(source);
        let mut depth = 0;
        while let Some(token) = tokens.rest.next() {
            match token.text {
                "{" => depth += 1,
                "}" => depth -= 1,
                text if depth == 0 && text == keyword && tokens.next_is(name) => {
                    return Ok((token.docs, tokens));
                }
                _ => {}
            }
        }
        Err(Error { line: tokens.last_line, message: format!("there is no `{keyword} {name}`") })
    }

    fn peek(&self) -> &'a str {
        self.rest.as_slice().first().map_or("", |token| token.text)
    }

    fn take(&mut self) -> &'a str {
        self.rest.next().map_or("", |token| token.text)
    }

    /// Takes the next token where it is this one, and returns whether it is.
    fn next_is(&mut self, text: &str) -> bool {
        let is = self.peek() == text;
        if is {
            self.take();
        }
        is
    }

    fn docs(&self) -> Vec<String> {
        self.rest.as_slice().first().map_or(Vec::new(), |token| token.docs.clone())
    }

    fn error(&self, expected: &str) -> Error {
        let (line, found) = match self.rest.as_slice().first() {
            Some(token) => (token.line, format!("`{}`", token.text)),
            None => (self.last_line, "the end of the file".to_owned()),
        };
        Error { line, message: format!("expected {expected}; found {found}") }
    }

    fn expect(&mut self, text: &str) -> Result<(), Error> {
        if self.next_is(text) { Ok(()) } else { Err(self.error(&format!("`{text}`"))) }
    }

    fn name(&mut self) -> Result<String, Error> {
        if !self.peek().starts_with(|c: char| c.is_alphabetic() || c == '_') {
            return Err(self.error("a name"));
        }
        Ok(self.take().to_owned())
    }

    fn ty(&mut self, known: &BTreeMap<String, Type>) -> Result<Type, Error> {
        let unknown = self.error("a scalar, a vector, a matrix, an array or a struct that is listed before");
        let name = self.name()?;
        if let Some(ty) = known.get(&name) {
            return Ok(ty.clone());
        }
        if name == "array" {
            return self.array(known);
        }
        let (shape, short) = name.split_at(name.trim_end_matches(['f', 'u', 'i']).len());
        let sizes: Vec<u32> = match shape.strip_prefix("vec").or(shape.strip_prefix("mat")) {
            Some(sizes) => sizes.split('x').filter_map(|n| n.parse().ok()).collect(),
            None => Vec::new(),
        };
        let vector = |scalar: &str, n: u32| {
            let align = if n == 2 { 8 } else { 16 };
            Type { wgsl: format!("vec{n}<{scalar}>"), rust: format!("[{scalar}; {n}]"), align, size: 4 * n }
        };
        let ty = match sizes[..] {
            [] if ["f32", "u32", "i32"].contains(&name.as_str()) => {
                Type { wgsl: name.clone(), rust: name, align: 4, size: 4 }
            }
            [n @ 2..=4] if shape == format!("vec{n}") => vector(&self.scalar(short)?, n),
            [columns @ 2..=4, rows @ 2..=4] if shape == format!("mat{columns}x{rows}") => {
                let scalar = self.scalar(short)?;
                // A column of three rows takes as much as one of four.
                let column = vector(&scalar, if rows == 3 { 4 } else { rows });
                Type {
                    wgsl: format!("mat{columns}x{rows}<{scalar}>"),
                    rust: format!("[{}; {columns}]", column.rust),
                    align: column.align,
                    size: column.size * columns,
                }
            }
            _ => return Err(unknown),
        };
        Ok(ty)
    }

    /// Reads the scalar of a vector or a matrix: the letter at the end of the name, or a type in `<>`.
    fn scalar(&mut self, short: &str) -> Result<String, Error> {
        if !short.is_empty() {
            return Ok(format!("{short}32"));
        }
        self.expect("<")?;
        if !["f32", "u32", "i32"].contains(&self.peek()) {
            return Err(self.error("`f32`, `u32` or `i32`"));
        }
        let scalar = self.name()?;
        self.expect(">")?;
        Ok(scalar)
    }

    fn array(&mut self, known: &BTreeMap<String, Type>) -> Result<Type, Error> {
        self.expect("<")?;
        // The layout of a header needs only the alignment of its elements.
        let element = self.ty(known)?;
        let count = if self.next_is(",") {
            let count = self.peek().trim_end_matches(['u', 'i']).parse().ok().filter(|count| *count > 0);
            let count: u32 = count.ok_or_else(|| self.error("the number of elements"))?;
            if element.stride() != element.size {
                return Err(self.error("an array of elements without padding between them"));
            }
            self.take();
            Some(count)
        } else {
            None
        };
        self.expect(">")?;
        Ok(match count {
            Some(n) => Type {
                wgsl: format!("array<{}, {n}>", element.wgsl),
                rust: format!("[{}; {n}]", element.rust),
                align: element.align,
                size: element.stride() * n,
            },
            None => Type { wgsl: format!("array<{}>", element.wgsl), size: 0, ..element },
        })
    }
}

#[cfg(test)]
mod tests;
