//! Names that may be typed, as editors list them.

use crate::text;
use data_file::Setting;
use lsp_types::{
    CompletionItem, CompletionItemKind, CompletionTextEdit, Documentation, MarkupContent, MarkupKind,
    TextEdit,
};

/// A name that may be typed.
pub(crate) struct Offer {
    pub(crate) name: String,
    pub(crate) kind: CompletionItemKind,
    detail: String,
    doc: String,
}

impl Offer {
    pub(crate) fn new(name: impl Into<String>, kind: CompletionItemKind) -> Offer {
        Offer { name: name.into(), kind, detail: String::new(), doc: String::new() }
    }

    pub(crate) fn detail(self, detail: impl Into<String>) -> Offer {
        Offer { detail: detail.into(), ..self }
    }

    pub(crate) fn doc(self, doc: impl Into<String>) -> Offer {
        Offer { doc: doc.into(), ..self }
    }

    /// Returns the item that puts `text` in place of some bytes.
    pub(crate) fn item(
        self,
        whole: &str,
        range: std::ops::Range<usize>,
        text: String,
        order: usize,
    ) -> CompletionItem {
        let some = |text: String| Some(text).filter(|text| !text.is_empty());
        CompletionItem {
            kind: Some(self.kind),
            detail: some(self.detail),
            documentation: some(self.doc).map(markdown).map(Documentation::MarkupContent),
            sort_text: Some(format!("{order:04}")),
            filter_text: Some(if whole[range.clone()].starts_with('"') {
                text.clone()
            } else {
                self.name.clone()
            }),
            label: self.name,
            text_edit: Some(CompletionTextEdit::Edit(TextEdit::new(text::range(whole, range), text))),
            ..CompletionItem::default()
        }
    }
}

pub(crate) fn markdown(value: String) -> MarkupContent {
    MarkupContent { kind: MarkupKind::Markdown, value }
}

/// Describes what a setting takes: `u32, 1 to 512 px, default 64`.
pub(crate) fn takes(setting: &Setting) -> String {
    let unit = if setting.unit.is_empty() { String::new() } else { format!(" {}", setting.unit) };
    let range = match (setting.min, setting.max) {
        (Some(min), Some(max)) => format!(", {min} to {max}{unit}"),
        (Some(min), None) => format!(", at least {min}{unit}"),
        (None, Some(max)) => format!(", at most {max}{unit}"),
        (None, None) if unit.is_empty() => String::new(),
        (None, None) => format!(", in{unit}"),
    };
    let choices: Vec<String> = setting.one_of.iter().map(ToString::to_string).collect();
    let choices = if choices.is_empty() { String::new() } else { format!(", one of {}", choices.join(", ")) };
    format!("{}{range}{choices}, default {}", setting.ty, setting.default)
}
