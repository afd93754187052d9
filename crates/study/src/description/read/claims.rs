//! The grammar of claims.

use super::Grammar;
use crate::description::{At, Claim, Pick, Pins, Relation, SIZE, size_value};
use crate::record::AxisValue;
use frame_graph::Diagnostic;
use frame_graph::codes::study as codes;
use frame_graph::reader::{Fields, Form, Node};

const CLAIM: &str = "`Order(measure: \"tid\", rising: [\"a\", \"b\"])`, `Ratio(measure: \"gpu-ms\", of: \"a\", to: \"b\", at_most: 0.5)` or `Growth(measure: \"gpu-ms\", of: \"a\", over: \"lights\", at_most: 1)`";
const PICK: &str = "the name of a pipeline, or `At(\"name\", { \"axis\": value })`";

impl Grammar<'_, '_> {
    pub(super) fn claims(&mut self, node: &Node) -> Vec<Claim> {
        let items = self.items(node, &format!("a list of claims: [{CLAIM}, …]"));
        items.iter().filter_map(|item| self.claim(item)).collect()
    }

    fn claim(&mut self, node: &Node) -> Option<Claim> {
        let forms: [(&'static str, &'static [&'static str]); 3] = [
            ("Order", &["measure", "rising", "at", "scenes", "says"]),
            ("Ratio", &["measure", "of", "to", "at_least", "at_most", "at", "scenes", "says"]),
            ("Growth", &["measure", "of", "over", "at_least", "at_most", "at", "scenes", "says"]),
        ];
        let fields = self.reader.fields(node, CLAIM, &forms)?;
        let measure = self.need_text(&fields, "measure");
        let relation = match fields.form() {
            "Order" => self.order(&fields),
            "Ratio" => self.ratio(&fields, node),
            _ => self.growth(&fields, node),
        };
        let at = fields.get("at").map(|node| self.axes_at(node)).unwrap_or_default();
        let scenes = fields.get("scenes").map(|node| self.names(node, "a scene")).unwrap_or_default();
        let says = fields.get("says").and_then(|node| self.reader.text(node, "text"));
        let says = says.unwrap_or_default().to_owned();
        Some(Claim { measure: measure?, relation: relation?, at, scenes, says })
    }

    fn order(&mut self, fields: &Fields<'_>) -> Option<Relation> {
        let node = self.reader.need(fields, "rising")?;
        let items = self.items(node, &format!("a list: [{PICK}, …]"));
        let rising: Vec<Pick> = items.iter().filter_map(|item| self.pick(item)).collect();
        if items.len() == 1 {
            let span = self.reader.span_of(node);
            self.error(&codes::CLAIM, span, "an order is of two pipelines at least");
        }
        Some(Relation::Order(rising))
    }

    fn ratio(&mut self, fields: &Fields<'_>, node: &Node) -> Option<Relation> {
        let of = self.reader.need(fields, "of").and_then(|node| self.pick(node));
        let to = self.reader.need(fields, "to").and_then(|node| self.pick(node));
        let help = ("a ratio needs a bound", "add `at_most: 0.5` or `at_least: 2.0`");
        let (at_least, at_most) = self.bounds(fields, node, help, Self::positive);
        Some(Relation::Ratio { of: of?, to: to?, at_least, at_most })
    }

    fn growth(&mut self, fields: &Fields<'_>, node: &Node) -> Option<Relation> {
        let of = self.reader.need(fields, "of").and_then(|node| self.pick(node));
        let over = self.need_text(fields, "over");
        let help = ("an exponent needs a bound", "add `at_most: 1.0` or `at_least: 0.5`");
        let (at_least, at_most) = self.bounds(fields, node, help, Self::finite);
        Some(Relation::Growth { of: of?, over: over?, at_least, at_most })
    }

    /// Reads `at_least` and `at_most`, of which there must be one; `missing` is said otherwise, with a note.
    fn bounds(
        &mut self,
        fields: &Fields<'_>,
        node: &Node,
        (missing, note): (&str, &str),
        read: fn(&mut Self, &Node) -> Option<f64>,
    ) -> (Option<f64>, Option<f64>) {
        let mut bound = |name: &str| fields.get(name).map(|node| read(self, node));
        let (at_least, at_most) = (bound("at_least"), bound("at_most"));
        if at_least.is_none() && at_most.is_none() {
            let error =
                Diagnostic::new(&codes::CLAIM, missing).label(self.reader.head_of(node), "").note(note);
            self.reader.tell(error);
        }
        let (at_least, at_most) = (at_least.flatten(), at_most.flatten());
        if let (Some(least), Some(most)) = (at_least, at_most)
            && least > most
        {
            let span = self.reader.head_of(node);
            self.error(&codes::CLAIM, span, format!("nothing is at least {least} and at most {most}"));
        }
        (at_least, at_most)
    }

    /// Reads a number, which may be negative: measures fall as well.
    fn finite(&mut self, node: &Node) -> Option<f64> {
        match (&node.form, self.value(node)?.value) {
            (Form::Number(_), AxisValue::Number(number)) => Some(number),
            _ => {
                self.reader.wrong(node, "a number");
                None
            }
        }
    }

    fn pick(&mut self, node: &Node) -> Option<Pick> {
        match &node.form {
            Form::Text(..) => Some(Pick { pipeline: self.text_at(node, PICK)?, at: Vec::new() }),
            Form::Tuple(Some(name), items) if name.text == "At" && items.len() == 2 => {
                let pipeline = self.text_at(&items[0], "the name of a pipeline");
                let at = self.axes_at(&items[1]);
                Some(Pick { pipeline: pipeline?, at })
            }
            _ => {
                self.reader.wrong(node, PICK);
                None
            }
        }
    }

    /// Reads values of axes.
    fn axes_at(&mut self, node: &Node) -> Pins {
        let entries = self.entries(node, "values of axes: { \"axis\": value }");
        let pair = |(axis, node): (At<String>, &Node)| {
            let value = if axis.value == SIZE {
                At { value: size_value(self.size(node)?), span: self.reader.span_of(node) }
            } else {
                self.value(node)?
            };
            Some((axis, value))
        };
        entries.into_iter().filter_map(pair).collect()
    }
}
