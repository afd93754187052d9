//! Reads what a study measures: measures by name, phases and figures.

use super::{Grammar, twice};
use crate::description::{At, Phase, StudyFigure};
use crate::measure::Measure;
use frame_graph::Diagnostic;
use frame_graph::codes::study as codes;
use frame_graph::reader::{Form, Node};

impl Grammar<'_, '_> {
    pub(super) fn measures(&mut self, node: &Node) -> Vec<At<Measure>> {
        let mut found: Vec<At<Measure>> = Vec::new();
        for name in self.names(node, "a measure") {
            let Some(measure) = Measure::find(&name.value) else {
                let error = Diagnostic::new(&codes::MEASURE, format!("there is no measure `{}`", name.value))
                    .label(name.span.clone(), "")
                    .suggest("measures", &name.value, Measure::all().map(Measure::key))
                    .note("`lightloom measures` says what each of them is");
                self.reader.tell(error);
                continue;
            };
            match found.iter().find(|at| at.value == measure) {
                Some(first) => self.reader.tell(twice(&format!("`{}`", name.value), &name.span, &first.span)),
                None => found.push(At { value: measure, span: name.span }),
            }
        }
        found
    }

    pub(super) fn phases(&mut self, node: &Node) -> Vec<Phase> {
        let entries = self.entries(node, "phases: { \"name\": [\"pass\", …] }");
        if entries.is_empty() && node.form == Form::Map(Vec::new()) {
            let span = self.reader.span_of(node);
            self.error(&codes::EMPTY, span, "there is no phase in it");
        }
        let phase = |(name, node): (At<String>, &Node)| {
            if name.value.trim().is_empty() {
                self.error(&codes::EMPTY, name.span.clone(), "a phase needs a name");
            }
            Phase { name, passes: self.names(node, "a pass or sub-graph") }
        };
        entries.into_iter().map(phase).collect()
    }

    pub(super) fn figures(&mut self, node: &Node) -> Vec<StudyFigure> {
        let entries = self.entries(node, "figures: { \"name\": \"pass.port.figure\" }");
        if entries.is_empty() && node.form == Form::Map(Vec::new()) {
            let span = self.reader.span_of(node);
            self.error(&codes::EMPTY, span, "there is no figure in it");
        }
        let mut found = Vec::new();
        for (name, node) in entries {
            if name.value.trim().is_empty() {
                self.error(&codes::EMPTY, name.span.clone(), "a figure needs a name");
            }
            let of = self.text_at(node, "the name of a figure: \"pass.port.figure\"");
            found.extend(of.map(|of| StudyFigure { name, of }));
        }
        found
    }
}
