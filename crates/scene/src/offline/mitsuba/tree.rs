//! The elements of a Mitsuba scene, with includes in their places and parameters replaced.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::sync::Arc;

use data_file::{Source, Span};
use roxmltree::{Document, Node};

use crate::codes;
use crate::error::SceneError;
use crate::offline::report::{MAX_DEPTH, Report, error, shortened, unknown};

/// The most elements within each other.
const MAX_NESTED: usize = 64;

/// The most elements of all files.
const MAX_ELEMENTS: u32 = 1 << 22;

/// The bytes that an element takes, without its texts.
const BYTES: usize = 256;

/// An element.
pub(super) struct Element {
    pub(super) tag: String,
    attributes: Vec<(String, String, Span)>,
    pub(super) children: Vec<Element>,
    /// The place of its tag.
    pub(super) span: Span,
    pub(super) used: Cell<bool>,
}

impl Element {
    /// Returns an attribute.
    pub(super) fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(known, ..)| known == name).map(|(_, value, _)| value.as_str())
    }

    /// Returns the place of an attribute, or of the element.
    pub(super) fn place(&self, name: &str) -> &Span {
        self.attributes.iter().find(|(known, ..)| known == name).map_or(&self.span, |(.., place)| place)
    }

    /// Returns an attribute that must be there.
    pub(super) fn required(&self, name: &str) -> Result<&str, SceneError> {
        self.attribute(name).ok_or_else(|| {
            let message = format!("`<{}>` has no attribute `{name}`", shortened(&self.tag));
            error(&codes::FORMAT, &self.span, message, "this element")
        })
    }

    /// Returns the type of a plugin.
    pub(super) fn kind(&self) -> Result<&str, SceneError> {
        self.required("type")
    }
}

/// Reads the file of a scene, and the files that it includes.
pub(super) fn read(source: Arc<Source>, report: &mut Report<'_>) -> Result<Element, SceneError> {
    let mut reader = Reader { report, parameters: BTreeMap::new(), is_old: false };
    reader.file(source, 0)
}

struct Reader<'r, 'a> {
    report: &'r mut Report<'a>,
    /// Values of `<default>`.
    parameters: BTreeMap<String, String>,
    /// Whether the file is of Mitsuba 0.x, whose names are written like `toWorld`.
    is_old: bool,
}

impl Reader<'_, '_> {
    fn file(&mut self, source: Arc<Source>, depth: usize) -> Result<Element, SceneError> {
        let options = roxmltree::ParsingOptions { nodes_limit: MAX_ELEMENTS, ..Default::default() };
        let document = Document::parse_with_options(&source.text, options).map_err(|problem| {
            let place = problem.pos();
            let line =
                source.text.split_inclusive('\n').take(place.row as usize - 1).map(str::len).sum::<usize>();
            let rest = source.text[line.min(source.text.len())..].chars();
            let column: usize = rest.take(place.col as usize - 1).map(char::len_utf8).sum();
            let start = (line + column).min(source.text.len()) as u32;
            let span = Span { source: Arc::clone(&source), start, end: start };
            error(
                &codes::FORMAT,
                &span,
                format!("the text is not XML: {}", shortened(&problem.to_string())),
                "here",
            )
        })?;
        let root = document.root_element();
        if root.tag_name().name() != "scene" {
            let message = format!("expected `<scene>`, found `<{}>`", shortened(root.tag_name().name()));
            return Err(error(&codes::FORMAT, &span(&source, &root), message, "the root"));
        }
        if depth == 0 {
            self.is_old = root.attribute("version").is_some_and(|version| version.starts_with("0."));
        }
        self.element(root, &source, 0, depth)
    }

    fn element(
        &mut self,
        node: Node<'_, '_>,
        source: &Arc<Source>,
        nested: usize,
        depth: usize,
    ) -> Result<Element, SceneError> {
        let place = span(source, &node);
        if nested > MAX_NESTED {
            let message = format!("more than {MAX_NESTED} elements are within each other");
            return Err(error(&codes::FORMAT, &place, message, "the innermost one"));
        }
        let size: usize = node.attributes().map(|attribute| attribute.value().len() + BYTES).sum();
        self.report.take(1, size + BYTES, &place)?;
        let mut attributes = Vec::new();
        for attribute in node.attributes() {
            let range = attribute.range_value();
            let place = Span { source: Arc::clone(source), start: range.start as u32, end: range.end as u32 };
            let mut value = self.replaced(attribute.value(), &place)?;
            if self.is_old && attribute.name() == "name" {
                value = in_snake_case(&value);
            }
            attributes.push((attribute.name().to_owned(), value, place));
        }
        let tag = if self.is_old {
            node.tag_name().name().to_lowercase()
        } else {
            node.tag_name().name().to_owned()
        };
        let mut element =
            Element { tag, attributes, children: Vec::new(), span: place, used: Cell::new(false) };
        for child in node.children().filter(Node::is_element) {
            let child = self.element(child, source, nested + 1, depth)?;
            match child.tag.as_str() {
                "default" => {
                    let (name, value) = (child.required("name")?, child.required("value")?);
                    self.parameters.entry(name.to_owned()).or_insert_with(|| value.to_owned());
                }
                "include" => {
                    let (name, place) = (child.required("filename")?, child.place("filename"));
                    if depth + 1 >= MAX_DEPTH {
                        let message = format!("files are included more than {MAX_DEPTH} deep");
                        return Err(error(&codes::FORMAT, place, message, "included here"));
                    }
                    let source = self.report.text(name, place)?;
                    element.children.extend(self.file(source, depth + 1)?.children);
                }
                _ => element.children.push(child),
            }
        }
        Ok(element)
    }

    /// Returns a value with `$name` replaced.
    fn replaced(&self, value: &str, place: &Span) -> Result<String, SceneError> {
        let mut parts = value.split('$');
        let mut text = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            let is_end = |character: char| !(character.is_ascii_alphanumeric() || character == '_');
            let (name, rest) = part.split_at(part.find(is_end).unwrap_or(part.len()));
            let known = self.parameters.keys().map(String::as_str);
            let replacement = self.parameters.get(name);
            text += replacement.ok_or_else(|| unknown(place, ("parameter", "parameters"), name, known))?;
            text += rest;
            self.report.take(text.len(), 1, place)?;
        }
        Ok(text)
    }
}

/// Returns the place of the tag of an element.
fn span(source: &Arc<Source>, node: &Node<'_, '_>) -> Span {
    let start = node.range().start;
    let length = source.text[start..].find([' ', '\t', '\r', '\n', '>', '/']).unwrap_or(1);
    Span { source: Arc::clone(source), start: start as u32, end: (start + length) as u32 }
}

/// Returns `toWorld` as `to_world`, and `intIOR` as `int_ior`.
fn in_snake_case(name: &str) -> String {
    let mut text = String::with_capacity(name.len() + 4);
    let mut before_is_lower = false;
    for character in name.chars() {
        if character.is_ascii_uppercase() && before_is_lower {
            text.push('_');
        }
        before_is_lower = character.is_ascii_lowercase();
        text.push(character.to_ascii_lowercase());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_older_files_become_those_of_newer_ones() {
        for (old, new) in
            [("toWorld", "to_world"), ("intIOR", "int_ior"), ("alpha", "alpha"), ("fovAxis", "fov_axis")]
        {
            assert_eq!(in_snake_case(old), new);
        }
    }
}
