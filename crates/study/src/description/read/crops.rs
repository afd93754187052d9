//! Reads the crops of a study.

use super::Grammar;
use frame_graph::codes::study as codes;
use frame_graph::reader::{Form, Node, Number};

const CROP: &str = "a part of the picture, in shares of its sides: (left, top, width, height)";

impl Grammar<'_, '_> {
    /// Reads crops; those that do not lie in the picture are reported.
    pub(super) fn crops(&mut self, node: &Node) -> Vec<[f64; 4]> {
        let items = self.items(node, "a list: [(left, top, width, height), …]");
        items.iter().filter_map(|item| self.crop(item)).collect()
    }

    fn crop(&mut self, node: &Node) -> Option<[f64; 4]> {
        let numbers: Vec<f64> = match &node.form {
            Form::Tuple(None, items) => items
                .iter()
                .filter_map(|item| match &item.form {
                    Form::Number(Number::Integer(n)) => Some(*n as f64),
                    Form::Number(Number::Float(x)) => Some(*x),
                    _ => None,
                })
                .collect(),
            _ => Vec::new(),
        };
        let Ok(crop) = <[f64; 4]>::try_from(numbers) else {
            self.reader.wrong(node, CROP);
            return None;
        };
        let [left, top, width, height] = crop;
        // What was rounded may reach a little over the edge.
        let lies_in = |start: f64, length: f64| start >= 0.0 && length > 0.0 && start + length <= 1.0 + 1e-6;
        if !(lies_in(left, width) && lies_in(top, height)) {
            let span = self.reader.span_of(node);
            let message = "a crop lies in the picture, whose sides are 1, and has a width and a height";
            self.error(&codes::RANGE, span, message);
            return None;
        }
        Some(crop)
    }
}
