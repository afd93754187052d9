//! The ports that a shader declares:
//!
//! ```wgsl
//! #input view: GBuffer // The surfaces to light.
//! #input past: RadianceMean optional // The mean so far.
//! #output lights: VirtualLights(count: settings.count) // Dark where a texel is empty.
//! #output soft: Visibility(taps: settings.taps) hands on maps module "lookup.wgsl" // The same maps.
//! ```

use crate::codes;
use crate::directive::{Fault, Placed};
use crate::line_map::span;
use data_file::{Source, Span, nearest};
use std::ops::Range;
use std::sync::Arc;

/// An input or an output that a shader declares.
#[derive(Clone, Debug)]
pub struct DeclaredPort {
    /// The name.
    pub name: String,
    /// The name of its interface.
    pub interface: String,
    /// Whether an input may be left unlinked.
    pub optional: bool,
    /// The input whose size, or number of elements, an input must have, for `like INPUT`.
    pub like: Option<String>,
    /// Members and facts that what is linked to an input must have, for `with NAME`.
    pub with: Vec<String>,
    /// Members that it must not have, for `without MEMBER`.
    pub without: Vec<String>,
    /// The arguments of an output, in order: sizes and facts.
    pub arguments: Vec<Argument>,
    /// The input whose members an output has, for `hands on INPUT`.
    pub hands_on: Option<String>,
    /// The input with whose content the members of an output begin, for `continues INPUT`.
    pub continues: Option<String>,
    /// Whether the members of an output are cleared to zero before the pass runs.
    pub cleared: bool,
    /// The module of an output, as the directive names it.
    pub module: Option<String>,
    /// The documentation: what an input is used for, or what an output holds.
    pub doc: String,
    /// Where the name stands.
    pub place: Span,
}

/// A size or a fact of an output, or a value of a setting: `NAME: VALUE when CONDITION`.
#[derive(Clone, Debug)]
pub struct Argument {
    /// The name: `count`, `size`, `layers`, a fact or a setting.
    pub name: String,
    /// Where the name stands.
    pub place: Span,
    /// The expression that has its value.
    pub value: FormulaText,
    /// The condition under which the output has it.
    pub when: Option<FormulaText>,
}

/// An expression of a directive or an attribute, as written.
#[derive(Clone, Debug)]
pub struct FormulaText {
    /// The text.
    pub text: String,
    /// Where it stands.
    pub place: Span,
}

/// Returns the bytes of a text that a directive takes whose first line has `line` bytes: further lines while a parenthesis
/// is open, and comments that are indented below it.
pub(crate) fn extent(text: &str, line: usize) -> usize {
    let opened = |line: &str| {
        let code = line.split("//").next().unwrap_or_default();
        code.matches('(').count() as i64 - code.matches(')').count() as i64
    };
    let (first, rest) = text.split_at(line);
    let mut open = opened(first);
    let mut end = line;
    for next in rest.split_inclusive('\n') {
        let comment = next.starts_with([' ', '\t']) && next.trim_start().starts_with("//");
        if !comment && (open <= 0 || next.trim_start().starts_with('#')) {
            break;
        }
        open += opened(next);
        end += next.len();
    }
    end
}

/// Reads `NAME: INTERFACE…` from byte `pos` of a text on, which starts at byte `at` of its file. Also returns where the name
/// stands.
pub(crate) fn parse(
    source: &Arc<Source>,
    text: &str,
    (at, pos): (usize, usize),
    input: bool,
) -> Result<(DeclaredPort, Range<usize>), Fault> {
    let mut reader = Reader { text, at, pos };
    let place = |range: &Range<usize>| span(source, range.clone());
    let name = reader.name("the name of the port")?;
    if !reader.eat(':') {
        return Err(reader.expected("`:` and an interface, as in `#input view: GBuffer`"));
    }
    let interface = reader.name("the name of an interface, such as `GBuffer`")?.value;
    let mut port = DeclaredPort {
        place: place(&name.range),
        name: name.value,
        interface,
        optional: false,
        like: None,
        with: Vec::new(),
        without: Vec::new(),
        arguments: Vec::new(),
        hands_on: None,
        continues: None,
        cleared: false,
        module: None,
        doc: String::new(),
    };
    if !input {
        port.arguments = reader.arguments(source)?;
    }
    loop {
        reader.skip();
        if reader.rest().is_empty() || reader.rest().starts_with("//") {
            break;
        }
        let known: &[&str] = if input {
            &["optional", "like", "with", "without"]
        } else {
            &["hands on", "continues", "cleared", "module"]
        };
        let word = reader.name(&format!("{}, or the end of the line", known.join(", ")))?;
        match (word.value.as_str(), input) {
            ("optional", true) => port.optional = true,
            ("like", true) => port.like = Some(reader.name("the name of an input")?.value),
            ("with", true) => port.with.push(reader.name("the name of a member or a fact")?.value),
            ("without", true) => port.without.push(reader.name("the name of a member")?.value),
            ("cleared", false) => port.cleared = true,
            ("continues", false) => port.continues = Some(reader.name("the name of an input")?.value),
            ("hands", false) => {
                if reader.name("`on`")?.value != "on" {
                    return Err(reader.expected("`hands on INPUT`"));
                }
                port.hands_on = Some(reader.name("the name of an input")?.value);
            }
            ("module", false) => port.module = Some(reader.quoted()?),
            (other, _) => {
                let fault =
                    Fault::new(&codes::DIRECTIVE, word.range, format!("`{other}` means nothing here"));
                return Err(match nearest(other, known.iter().copied()) {
                    Some(near) => fault.note(format!("did you mean `{near}`?")),
                    None => fault.note(format!("there are {}", known.join(", "))),
                });
            }
        }
    }
    port.doc = reader.comment()?;
    Ok((port, name.range))
}

/// Reads the parts of a directive one after the other.
pub(crate) struct Reader<'a> {
    pub(crate) text: &'a str,
    /// Where the text starts in its file.
    pub(crate) at: usize,
    pub(crate) pos: usize,
}

impl<'a> Reader<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.pos..]
    }

    fn skip(&mut self) {
        self.pos = self.text.len() - self.rest().trim_start().len();
    }

    pub(crate) fn eat(&mut self, symbol: char) -> bool {
        self.skip();
        let found = self.rest().starts_with(symbol);
        if found {
            self.pos += symbol.len_utf8();
        }
        found
    }

    fn place(&self, range: Range<usize>) -> Range<usize> {
        self.at + range.start..self.at + range.end
    }

    pub(crate) fn expected(&self, what: &str) -> Fault {
        let rest = self.rest().trim_start();
        let found = rest.split([' ', '\n', ',', '(']).next().unwrap_or_default();
        // The end of the line is where its last character ends.
        let end = if found.is_empty() { self.text.trim_end().len() } else { self.text.len() };
        let start = end - rest.len();
        let label = if found.is_empty() {
            "found the end of the line".to_owned()
        } else {
            format!("found `{found}`")
        };
        let range = self.place(start..start + found.len());
        Fault::new(&codes::DIRECTIVE, range, format!("expected {what}")).label(label)
    }

    pub(crate) fn name(&mut self, what: &str) -> Result<Placed<String>, Fault> {
        self.skip();
        let rest = self.rest();
        let len = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
        if len == 0 {
            return Err(self.expected(what));
        }
        let range = self.place(self.pos..self.pos + len);
        self.pos += len;
        Ok(Placed { value: rest[..len].to_owned(), range })
    }

    /// The name of a pass type.
    pub(crate) fn kind(&mut self) -> Result<String, Fault> {
        self.skip();
        let rest = self.rest();
        let len = rest.find(|c: char| !(c.is_alphanumeric() || c == '-')).unwrap_or(rest.len());
        if len == 0 {
            return Err(self.expected("a pass type, such as `visibility-ray-traced`"));
        }
        self.pos += len;
        Ok(rest[..len].to_owned())
    }

    /// `(NAME: EXPRESSION when CONDITION, …)`, or nothing.
    pub(crate) fn arguments(&mut self, source: &Arc<Source>) -> Result<Vec<Argument>, Fault> {
        let place = |range: &Range<usize>| span(source, range.clone());
        let formula = |range: Range<usize>| FormulaText {
            text: source.text[range.clone()].to_owned(),
            place: place(&range),
        };
        let mut arguments = Vec::new();
        if !self.eat('(') {
            return Ok(arguments);
        }
        while !self.eat(')') {
            let name = self.name("the name of a value, or `)`")?;
            if !self.eat(':') {
                return Err(self.expected("`:` and an expression"));
            }
            let (value, when) = self.expression()?;
            arguments.push(Argument {
                place: place(&name.range),
                name: name.value,
                value: formula(value),
                when: when.map(formula),
            });
            if !self.eat(',') && !self.rest().starts_with(')') {
                return Err(self.expected("`,` or `)`"));
            }
        }
        Ok(arguments)
    }

    /// The comment that ends a directive.
    pub(crate) fn comment(&mut self) -> Result<String, Fault> {
        self.skip();
        if !(self.rest().is_empty() || self.rest().starts_with("//")) {
            return Err(self.expected("the end of the line"));
        }
        let lines = self.rest().lines().map(|line| line.trim().trim_start_matches('/').trim());
        Ok(lines.filter(|line| !line.is_empty()).collect::<Vec<_>>().join(" "))
    }

    fn quoted(&mut self) -> Result<String, Fault> {
        let found = self.eat('"').then(|| self.rest().find(['"', '\n'])).flatten();
        match found.filter(|end| self.rest()[*end..].starts_with('"')) {
            Some(end) => {
                let text = self.rest()[..end].to_owned();
                self.pos += end + 1;
                Ok(text)
            }
            None => Err(self.expected("a path in quotes")),
        }
    }

    /// `EXPRESSION` or `EXPRESSION when CONDITION`, up to a comma or the parenthesis that ends the arguments.
    fn expression(&mut self) -> Result<(Range<usize>, Option<Range<usize>>), Fault> {
        self.skip();
        let start = self.pos;
        let mut depth = 0;
        let end = self.rest().char_indices().find(|(_, c)| {
            let ends = depth == 0 && matches!(c, ',' | ')' | '\n');
            depth += i32::from(*c == '(') - i32::from(*c == ')');
            ends
        });
        let end = end.map_or(self.text.len(), |(i, _)| start + i);
        let whole = &self.text[start..end];
        if whole.trim().is_empty() {
            return Err(self.expected("an expression"));
        }
        self.pos = end;
        let trimmed = |range: Range<usize>| {
            let text = &self.text[range.clone()];
            let start = range.start + text.len() - text.trim_start().len();
            self.place(start..start + text.trim().len())
        };
        Ok(match whole.find(" when ") {
            Some(i) => (trimmed(start..start + i), Some(trimmed(start + i + " when ".len()..end))),
            None => (trimmed(start..end), None),
        })
    }
}
